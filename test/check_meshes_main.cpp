// check_meshes: do triangles of the meshes that `cloth run --mesh-every` wrote intersect?
//
//   check_meshes DIR                                      every step of a run
//   check_meshes --cloth A.obj ... [--body B.obj ...]     these files together
//
// --list N shows the first N pairs of a step (default 3). Exit code 0: none; 1: some; 2: bad input.
#include "check_meshes.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>

using check_meshes::Hit;
using check_meshes::Mesh;
using check_meshes::Result;

namespace {

struct Files {
  std::vector<std::string> cloth, body;
};

struct Totals {
  long steps = 0, steps_bad = 0, cloth_cloth = 0, cloth_body = 0, inside = 0;
  double slowest_ms = 0, ms = 0;
};

// meshes.csv: kind,file,name; NAME_STEP.obj begins with `file`
std::map<std::string, std::string> kinds_of(const std::string &dir)
{
  std::string path = dir + "/meshes.csv", text;
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path + ": cannot read it; is this the --out of cloth run?");
  std::map<std::string, std::string> kinds;
  std::getline(in, text); // heading
  while (std::getline(in, text)) {
    size_t first = text.find(','), second = text.find(',', first + 1);
    if (second == std::string::npos) throw std::runtime_error(path + ": broken line: " + text);
    kinds[text.substr(first + 1, second - first - 1)] = text.substr(0, first);
  }
  return kinds;
}

// NAME_000123.obj by step
std::map<long, Files> files_of(const std::string &dir)
{
  std::map<std::string, std::string> kinds = kinds_of(dir);
  std::map<long, Files> steps;
  std::vector<std::string> paths;
  for (const auto &entry : std::filesystem::directory_iterator(dir))
    if (entry.path().extension() == ".obj") paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  for (const std::string &path : paths) {
    std::string stem = std::filesystem::path(path).stem().string();
    size_t end = stem.rfind('_');
    auto kind = kinds.find(stem.substr(0, end == std::string::npos ? 0 : end));
    if (kind == kinds.end())
      throw std::runtime_error(path + ": meshes.csv does not say what this is");
    Files &files = steps[std::atol(stem.c_str() + end + 1)];
    (kind->second == "cloth" ? files.cloth : files.body).push_back(path);
  }
  if (steps.empty()) throw std::runtime_error(dir + ": no NAME_STEP.obj in it");
  // a step with a mesh missing would be checked without it, and look clean
  for (const auto &step : steps)
    if (step.second.cloth.size() + step.second.body.size() != kinds.size())
      throw std::runtime_error(dir + ": step " + std::to_string(step.first) + " has " +
                               std::to_string(step.second.cloth.size() + step.second.body.size()) +
                               " meshes of " + std::to_string(kinds.size()));
  return steps;
}

std::vector<Mesh> read_all(const std::vector<std::string> &paths)
{
  std::vector<Mesh> meshes;
  for (const std::string &path : paths) meshes.push_back(check_meshes::read_obj(path));
  return meshes;
}

void list(const std::vector<Hit> &hits, const std::vector<Mesh> &first,
          const std::vector<Mesh> &second, int most)
{
  for (int i = 0; i < std::min<int>(most, static_cast<int>(hits.size())); i++)
    std::printf("  %s triangle %d, %s triangle %d\n", first[hits[i].mesh0].name.c_str(),
                hits[i].triangle0, second[hits[i].mesh1].name.c_str(), hits[i].triangle1);
}

void check(long step, const Files &files, int most, Totals *totals)
{
  auto start = std::chrono::steady_clock::now();
  std::vector<Mesh> cloths = read_all(files.cloth), bodies = read_all(files.body);
  Result r = check_meshes::intersections(cloths, bodies);
  double ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  totals->steps++;
  totals->ms += ms;
  totals->slowest_ms = std::max(totals->slowest_ms, ms);
  totals->cloth_cloth += static_cast<long>(r.cloth_cloth.size());
  totals->cloth_body += static_cast<long>(r.cloth_body.size());
  totals->inside += static_cast<long>(r.cloth_in_body.size());
  if (r.cloth_cloth.empty() && r.cloth_body.empty() && r.cloth_in_body.empty()) return;
  totals->steps_bad++;
  std::printf("step %ld: %zu cloth-cloth, %zu cloth-body intersections, %zu pieces inside a body\n",
              step, r.cloth_cloth.size(), r.cloth_body.size(), r.cloth_in_body.size());
  list(r.cloth_cloth, cloths, cloths, most);
  list(r.cloth_body, cloths, bodies, most);
  for (const auto &in : r.cloth_in_body)
    std::printf("  %s has a piece inside %s\n", cloths[in.first].name.c_str(),
                bodies[in.second].name.c_str());
}

struct Options {
  std::string dir;
  Files files;
  int most = 3;
};

Options parse(int argc, char **argv)
{
  Options o;
  std::vector<std::string> *list = nullptr;
  for (int i = 1; i < argc; i++) {
    std::string word = argv[i];
    if (word == "--cloth")
      list = &o.files.cloth;
    else if (word == "--body")
      list = &o.files.body;
    else if (word == "--list" && i + 1 < argc)
      o.most = std::atoi(argv[++i]);
    else if (word.rfind("--", 0) == 0)
      throw std::runtime_error("unknown option " + word +
                               "; there are --cloth, --body and --list N");
    else if (list)
      list->push_back(word);
    else if (o.dir.empty())
      o.dir = word;
    else
      throw std::runtime_error("one directory, please; '" + word + "' is a second");
  }
  if (o.dir.empty() == o.files.cloth.empty())
    throw std::runtime_error("usage: check_meshes DIR, or check_meshes --cloth A.obj ... "
                             "[--body B.obj ...]");
  return o;
}

} // namespace

int main(int argc, char **argv)
{
  try {
    Options o = parse(argc, argv);
    Totals t;
    if (o.dir.empty()) {
      check(0, o.files, o.most, &t);
    } else {
      for (const auto &step : files_of(o.dir)) check(step.first, step.second, o.most, &t);
    }
    std::printf("%ld steps checked, %ld with intersections: %ld cloth-cloth, %ld cloth-body, %ld "
                "inside (%.1f ms a step, slowest %.1f ms)\n",
                t.steps, t.steps_bad, t.cloth_cloth, t.cloth_body, t.inside,
                t.ms / static_cast<double>(t.steps), t.slowest_ms);
    return t.steps_bad ? 1 : 0;
  } catch (const std::exception &e) {
    std::fprintf(stderr, "check_meshes: %s\n", e.what());
    return 2;
  }
}
