#include "link_meshes.h"

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <resource_retriever/retriever.h>
#include <set>
#include <sstream>
#include <tinyxml2.h>
#include <unordered_map>

namespace robot_cloth {
namespace {

constexpr double pi = 3.14159265358979323846;

// A triangle whose height is below this fraction of its longest edge has no usable normal. Mesh
// files hold floats (relative step 6e-8), so a flatter one is rounding and not shape.
constexpr double flat = 1e-7;

std::string number(double v)
{
  char text[32];
  std::snprintf(text, sizeof text, "%g", v);
  return text;
}

// ---- file -> memory ---------------------------------------------------------------------------

// curl refuses a blank in a URI, people write them all the same.
std::string encodeBlanks(const std::string &uri)
{
  std::string out;
  for (char c : uri) {
    if (c == ' ')
      out += "%20";
    else
      out += c;
  }
  return out;
}

// "stl" of "package://p/a%20b.STL?x"; empty where there is none.
std::string extension(const std::string &uri)
{
  const std::string path = uri.substr(0, uri.find_first_of("?#"));
  const size_t dot = path.find_last_of("./");
  if (dot == std::string::npos || path[dot] != '.') return "";
  std::string ext = path.substr(dot + 1);
  std::transform(ext.begin(), ext.end(), ext.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ext;
}

// rospack finds only folders with a package.xml. Robot descriptions are also handed around as bare
// folders; one with the package's name on ROS_PACKAGE_PATH is taken then. Empty: there is none.
std::string findByFolderName(const std::string &uri)
{
  const size_t begin = std::strlen("package://"), slash = uri.find('/', begin);
  const char *paths = std::getenv("ROS_PACKAGE_PATH");
  if (slash == std::string::npos || !paths) return "";
  const std::string package = uri.substr(begin, slash - begin);
  std::stringstream list(paths);
  for (std::string entry; std::getline(list, entry, ':');) {
    const std::filesystem::path folder = entry;
    std::error_code ignored;
    for (const std::filesystem::path &candidate : {folder / package, folder})
      if (candidate.filename() == package && std::filesystem::is_directory(candidate, ignored))
        return "file://" + candidate.string() + uri.substr(slash);
  }
  return "";
}

resource_retriever::MemoryResource get(const std::string &uri, std::string *error)
{
  try {
    return resource_retriever::Retriever().get(encodeBlanks(uri));
  } catch (const std::exception &e) {
    *error = e.what();
    return {};
  }
}

resource_retriever::MemoryResource fetch(const std::string &uri, std::vector<std::string> *warnings)
{
  const size_t scheme = uri.find("://");
  if (scheme == std::string::npos || scheme == 0)
    throw MeshError("mesh '" + uri +
                    "' is not a URI; write package://PACKAGE/PATH or file:///ABSOLUTE/PATH");
  const bool package = uri.compare(0, scheme, "package") == 0;
  std::string error;
  resource_retriever::MemoryResource res = get(uri, &error);
  const std::string instead = package && !error.empty() ? findByFolderName(uri) : "";
  if (!instead.empty()) {
    error.clear();
    res = get(instead, &error);
    warnings->push_back("its package has no package.xml; read as '" + instead + "'");
  }
  if (!error.empty())
    throw MeshError("mesh '" + uri + "' cannot be read: " + error +
                    (package ? "; is the package on ROS_PACKAGE_PATH and the file in it?"
                             : "; is the address right and readable?"));
  // Also what the retriever answers for a directory: no exception, no bytes.
  if (res.size == 0)
    throw MeshError("mesh '" + uri + "' has no content: it is an empty file or a directory");
  return res;
}

// ---- Collada asset ----------------------------------------------------------------------------

struct ColladaAsset {
  bool collada = false;
  double unit = 1;
  Eigen::Matrix3d to_z_up = Eigen::Matrix3d::Identity();
  std::string warning;
};

// assimp (5.x) puts unit and up-axis together into the transform of the root node and offers no way
// to ask for either. RViz therefore leaves that node out and reads <unit> from the XML by itself,
// and so do we; the axis is ours to add when asked for.
ColladaAsset readColladaAsset(const resource_retriever::MemoryResource &res, const std::string &uri)
{
  ColladaAsset asset;
  const char *text = reinterpret_cast<const char *>(res.data.get());
  const size_t head = std::min<size_t>(res.size, 4096);
  const std::string start(text, head);
  asset.collada = extension(uri) == "dae" || start.find("<COLLADA") != std::string::npos;
  if (!asset.collada) return asset;
  tinyxml2::XMLDocument doc;
  if (doc.Parse(text, res.size) != tinyxml2::XML_SUCCESS)
    throw MeshError("mesh '" + uri + "' is not valid Collada: " + doc.ErrorStr());
  const tinyxml2::XMLElement *root = doc.FirstChildElement("COLLADA");
  const tinyxml2::XMLElement *info = root ? root->FirstChildElement("asset") : nullptr;
  const tinyxml2::XMLElement *unit = info ? info->FirstChildElement("unit") : nullptr;
  if (unit && unit->Attribute("meter")) {
    double meter = 0;
    if (unit->QueryDoubleAttribute("meter", &meter) == tinyxml2::XML_SUCCESS && meter > 0 &&
        std::isfinite(meter))
      asset.unit = meter;
    else
      asset.warning = std::string("<unit meter=\"") + unit->Attribute("meter") +
                      "\"> is not a positive number; taken as 1 m";
  }
  const tinyxml2::XMLElement *up = info ? info->FirstChildElement("up_axis") : nullptr;
  const std::string axis = up && up->GetText() ? up->GetText() : "Y_UP"; // Collada's default
  // Collada 1.4.1: X_UP is right -y, up x, in z; Y_UP right x, up y, in z; Z_UP right x, up z, in
  // -y.
  if (axis == "X_UP")
    asset.to_z_up << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  else if (axis == "Y_UP")
    asset.to_z_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return asset;
}

// assimp calls what it reads from memory by a name of its own, which says nothing to anybody.
std::string withoutMagicName(std::string text)
{
  for (const char *name :
       {" file \"$$$___magic___$$$", " for $$$___magic___$$$", "$$$___magic___$$$"}) {
    const size_t at = text.find(name);
    if (at != std::string::npos) return text.substr(0, at);
  }
  return text;
}

// ---- assimp -> soup ---------------------------------------------------------------------------

Eigen::Matrix4d toEigen(const aiMatrix4x4 &m)
{
  Eigen::Matrix4d out;
  out << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3,
      m.d4;
  return out;
}

struct Collector {
  const aiScene *scene;
  const MeshOptions &options;
  const std::string &uri;
  TriangleMesh mesh;
  MeshReport report;

  void add(const aiMesh &in, const Eigen::Matrix4d &pose, bool flip)
  {
    report.meshes++;
    if (!(mesh.triangles.size() + in.mNumFaces <= static_cast<size_t>(options.triangles_max)))
      throw MeshError("mesh '" + uri + "' has more than " + std::to_string(options.triangles_max) +
                      " triangles; decimate it or raise the limit");
    const int first = static_cast<int>(mesh.vertices.size());
    const Eigen::Affine3d affine(pose);
    for (unsigned i = 0; i < in.mNumVertices; i++) {
      const aiVector3D &p = in.mVertices[i];
      const Eigen::Vector3d raw(p.x, p.y, p.z);
      const Eigen::Vector3d x = affine * raw;
      if (!x.allFinite())
        throw MeshError("mesh '" + uri + "': vertex " + std::to_string(i) + " is (" +
                        number(raw.x()) + ", " + number(raw.y()) + ", " + number(raw.z()) +
                        "), not finite" + (raw.allFinite() ? " once placed and scaled" : ""));
      mesh.vertices.push_back(x);
    }
    for (unsigned f = 0; f < in.mNumFaces; f++) {
      const aiFace &face = in.mFaces[f];
      if (face.mNumIndices != 3) {
        report.not_triangles++;
        continue;
      }
      Eigen::Vector3i t;
      for (int k = 0; k < 3; k++) {
        if (!(face.mIndices[k] < in.mNumVertices))
          throw MeshError("mesh '" + uri + "': face " + std::to_string(f) + " names vertex " +
                          std::to_string(face.mIndices[k]) + " of " +
                          std::to_string(in.mNumVertices));
        t[k] = first + static_cast<int>(face.mIndices[k]);
      }
      if (flip) std::swap(t[1], t[2]);
      mesh.triangles.push_back(t);
    }
  }

  // `above` is the transform from this node's parent to the file's frame, scale included.
  void walk(const aiNode &node, const Eigen::Matrix4d &above, bool skip_own)
  {
    const Eigen::Matrix4d pose = skip_own ? above : above * toEigen(node.mTransformation);
    const bool flip = pose.topLeftCorner<3, 3>().determinant() < 0;
    for (unsigned i = 0; i < node.mNumMeshes; i++) {
      report.flipped = report.flipped || flip;
      add(*scene->mMeshes[node.mMeshes[i]], pose, flip);
    }
    for (unsigned i = 0; i < node.mNumChildren; i++) walk(*node.mChildren[i], pose, false);
  }
};

// ---- clean-up ---------------------------------------------------------------------------------

struct PointHash {
  size_t operator()(const std::array<double, 3> &p) const
  {
    size_t h = 0;
    for (double v : p) h = h * 1000003u ^ std::hash<double>()(v);
    return h;
  }
};

// Vertices are welded by position alone, so that normals and texture seams split nothing (assimp's
// JoinIdenticalVertices compares those too, and positions with a tolerance of 1e-5 in the unit of
// the file, which is a centimetre in a file in kilometres and nothing in one in micrometres). Equal
// means equal bits: STL repeats a vertex exactly.
void weld(TriangleMesh *mesh)
{
  std::unordered_map<std::array<double, 3>, int, PointHash> seen;
  seen.reserve(mesh->vertices.size());
  std::vector<int> to(mesh->vertices.size(), -1);
  std::vector<Eigen::Vector3d> kept;
  for (Eigen::Vector3i &t : mesh->triangles) {
    for (int k = 0; k < 3; k++) {
      int &target = to[static_cast<size_t>(t[k])];
      if (target < 0) {
        const Eigen::Vector3d &v = mesh->vertices[static_cast<size_t>(t[k])];
        // -0 + 0 is +0: the two zeros are one place.
        const std::array<double, 3> key = {v.x() + 0.0, v.y() + 0.0, v.z() + 0.0};
        const auto found = seen.emplace(key, static_cast<int>(kept.size()));
        if (found.second) kept.push_back(v);
        target = found.first->second;
      }
      t[k] = target;
    }
  }
  mesh->vertices.swap(kept);
}

bool hasArea(const TriangleMesh &m, const Eigen::Vector3i &t)
{
  const Eigen::Vector3d &a = m.vertices[static_cast<size_t>(t[0])];
  const Eigen::Vector3d &b = m.vertices[static_cast<size_t>(t[1])];
  const Eigen::Vector3d &c = m.vertices[static_cast<size_t>(t[2])];
  const double longest =
      std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
  return (b - a).cross(c - a).norm() > flat * longest * longest;
}

// Also forgets vertices that no triangle uses any more: weld() walks the triangles.
void dropBadTriangles(TriangleMesh *mesh, MeshReport *report)
{
  std::set<std::array<int, 3>> seen;
  std::vector<Eigen::Vector3i> kept;
  kept.reserve(mesh->triangles.size());
  for (const Eigen::Vector3i &t : mesh->triangles) {
    if (!hasArea(*mesh, t)) {
      report->zero_area_triangles++;
      continue;
    }
    std::array<int, 3> key = {t[0], t[1], t[2]};
    std::sort(key.begin(), key.end());
    if (!seen.insert(key).second) {
      report->duplicate_triangles++;
      continue;
    }
    kept.push_back(t);
  }
  mesh->triangles.swap(kept);
  weld(mesh);
}

void describe(const MeshOptions &options, size_t triangles, MeshReport *r)
{
  if (r->zero_area_triangles)
    r->warnings.push_back(std::to_string(r->zero_area_triangles) +
                          " triangles without area dropped");
  if (r->duplicate_triangles)
    r->warnings.push_back(std::to_string(r->duplicate_triangles) + " repeated triangles dropped");
  if (r->not_triangles)
    r->warnings.push_back(std::to_string(r->not_triangles) + " points or lines dropped");
  if (triangles > static_cast<size_t>(std::max(options.triangles_warn, 0)))
    r->warnings.push_back(std::to_string(triangles) + " triangles, more than " +
                          std::to_string(options.triangles_warn) +
                          ": use a decimated mesh for collision");
}

} // namespace

// ---- TriangleMesh -----------------------------------------------------------------------------

cloth_mesh_view TriangleMesh::view() const
{
  static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double), "vertices must be packed");
  static_assert(sizeof(Eigen::Vector3i) == 3 * sizeof(int), "triangles must be packed");
  cloth_mesh_view v = {};
  v.vertex_count = static_cast<int>(vertices.size());
  v.triangle_count = static_cast<int>(triangles.size());
  v.position = vertices.empty() ? nullptr : vertices.front().data();
  v.triangle = triangles.empty() ? nullptr : triangles.front().data();
  return v;
}

Eigen::AlignedBox3d TriangleMesh::bounds() const
{
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d &v : vertices) box.extend(v);
  return box;
}

void TriangleMesh::append(const TriangleMesh &other, const Eigen::Isometry3d &pose)
{
  const int first = static_cast<int>(vertices.size());
  vertices.reserve(vertices.size() + other.vertices.size());
  triangles.reserve(triangles.size() + other.triangles.size());
  for (const Eigen::Vector3d &v : other.vertices) vertices.push_back(pose * v);
  for (const Eigen::Vector3i &t : other.triangles)
    triangles.push_back(t + Eigen::Vector3i::Constant(first));
}

// ---- primitives -------------------------------------------------------------------------------

TriangleMesh boxMesh(const Eigen::Vector3d &size)
{
  TriangleMesh m;
  for (int i = 0; i < 8; i++) {
    const Eigen::Vector3d corner(i & 1 ? .5 : -.5, i & 2 ? .5 : -.5, i & 4 ? .5 : -.5);
    m.vertices.push_back(corner.cwiseProduct(size));
  }
  static const int face[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                  {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  for (const int(&f)[3] : face) m.triangles.emplace_back(f[0], f[1], f[2]);
  return m;
}

TriangleMesh cylinderMesh(double radius, double length, int segments)
{
  const int n = std::clamp(segments, 3, 512);
  TriangleMesh m;
  for (int i = 0; i < n; i++) {
    const double angle = 2 * pi * i / n;
    const double x = radius * std::cos(angle), y = radius * std::sin(angle);
    m.vertices.emplace_back(x, y, -length / 2);
    m.vertices.emplace_back(x, y, length / 2);
  }
  const int bottom = 2 * n, top = 2 * n + 1;
  m.vertices.emplace_back(0, 0, -length / 2);
  m.vertices.emplace_back(0, 0, length / 2);
  for (int i = 0; i < n; i++) {
    const int a = 2 * i, b = 2 * ((i + 1) % n);
    m.triangles.emplace_back(a, b, b + 1);
    m.triangles.emplace_back(a, b + 1, a + 1);
    m.triangles.emplace_back(bottom, b, a);
    m.triangles.emplace_back(top, a + 1, b + 1);
  }
  return m;
}

TriangleMesh sphereMesh(double radius, int segments)
{
  const int n = std::clamp(segments, 3, 512);
  const int rings = std::max(n / 2, 2); // from pole to pole
  TriangleMesh m;
  m.vertices.emplace_back(0, 0, -radius);
  for (int r = 1; r < rings; r++) {
    const double polar = pi * r / rings;
    for (int i = 0; i < n; i++) {
      const double angle = 2 * pi * i / n;
      m.vertices.emplace_back(radius * std::sin(polar) * std::cos(angle),
                              radius * std::sin(polar) * std::sin(angle),
                              -radius * std::cos(polar));
    }
  }
  const int north = static_cast<int>(m.vertices.size());
  m.vertices.emplace_back(0, 0, radius);
  const auto at = [n](int ring, int i) { return 1 + (ring - 1) * n + i % n; };
  for (int i = 0; i < n; i++) {
    m.triangles.emplace_back(0, at(1, i + 1), at(1, i));
    m.triangles.emplace_back(north, at(rings - 1, i), at(rings - 1, i + 1));
    for (int r = 1; r + 1 < rings; r++) {
      m.triangles.emplace_back(at(r, i), at(r, i + 1), at(r + 1, i + 1));
      m.triangles.emplace_back(at(r, i), at(r + 1, i + 1), at(r + 1, i));
    }
  }
  return m;
}

// ---- files ------------------------------------------------------------------------------------

TriangleMesh loadMesh(const std::string &uri, const Eigen::Vector3d &scale,
                      const MeshOptions &options, MeshReport *report)
{
  if (!scale.allFinite() || !(scale.cwiseAbs().minCoeff() > 0))
    throw MeshError("mesh '" + uri + "': scale (" + number(scale.x()) + ", " + number(scale.y()) +
                    ", " + number(scale.z()) + ") must be finite and not 0 on every axis");
  MeshReport begun;
  const resource_retriever::MemoryResource res = fetch(uri, &begun.warnings);
  const ColladaAsset asset = readColladaAsset(res, uri);

  Assimp::Importer importer;
  const aiScene *scene = nullptr;
  try {
    scene = importer.ReadFileFromMemory(res.data.get(), res.size, aiProcess_Triangulate,
                                        extension(uri).c_str());
  } catch (const std::exception &e) {
    throw MeshError("mesh '" + uri + "' cannot be understood: " + e.what());
  }
  if (!scene || !scene->mRootNode)
    throw MeshError("mesh '" + uri +
                    "' cannot be understood: " + withoutMagicName(importer.GetErrorString()));

  Collector all{scene, options, uri, {}, begun};
  all.report.unit = options.collada_unit ? asset.unit : 1;
  if (!asset.warning.empty()) all.report.warnings.push_back(asset.warning);
  Eigen::Matrix4d above = Eigen::Matrix4d::Identity();
  Eigen::Matrix3d linear = scale.asDiagonal() * (Eigen::Matrix3d::Identity() * all.report.unit);
  if (options.collada_up_axis) linear = linear * asset.to_z_up;
  above.topLeftCorner<3, 3>() = linear;
  // As RViz: what hangs below the root does not get the root's transform, in no format.
  const bool skip_root = asset.collada || scene->mRootNode->mNumMeshes == 0;
  all.walk(*scene->mRootNode, above, skip_root);

  weld(&all.mesh);
  dropBadTriangles(&all.mesh, &all.report);
  if (all.mesh.empty())
    throw MeshError("mesh '" + uri + "' holds no triangles (" + std::to_string(all.report.meshes) +
                    " meshes, " + std::to_string(all.report.zero_area_triangles) +
                    " triangles without area, " + std::to_string(all.report.not_triangles) +
                    " points or lines)");
  describe(options, all.mesh.triangles.size(), &all.report);
  if (report) *report = all.report;
  return std::move(all.mesh);
}

} // namespace robot_cloth
