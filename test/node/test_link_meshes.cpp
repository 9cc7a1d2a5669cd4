// Mesh files and primitives become triangles. Every fixture is written here, into a temporary
// folder, byte by byte, so that nothing but the loader stands between the numbers and the checks.
#include "node/link_meshes.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <sys/stat.h>

using namespace robot_cloth;

namespace {

constexpr double pi = 3.14159265358979323846;

// A temporary folder for all tests of this run; removed at the end.
std::string folder()
{
  struct Temporary {
    std::string path = (std::filesystem::temp_directory_path() / "link_meshes_XXXXXX").string();
    Temporary() { path = mkdtemp(&path[0]); }
    ~Temporary() { std::filesystem::remove_all(path); }
  };
  static const Temporary temporary;
  return temporary.path;
}

std::string write(const std::string &name, const std::string &content)
{
  std::ofstream(folder() + "/" + name, std::ios::binary) << content;
  return "file://" + folder() + "/" + name;
}

// Six times the volume inside: positive when the outside is outside.
double volume6(const TriangleMesh &m)
{
  double sum = 0;
  for (const auto &t : m.triangles)
    sum += m.vertices[t[0]].dot(m.vertices[t[1]].cross(m.vertices[t[2]]));
  return sum;
}

double volume(const TriangleMesh &m) { return volume6(m) / 6; }

// Every edge is used once in each direction: closed and consistently wound.
bool watertight(const TriangleMesh &m)
{
  std::map<std::pair<int, int>, int> edges;
  for (const auto &t : m.triangles)
    for (int k = 0; k < 3; k++) edges[{t[k], t[(k + 1) % 3]}]++;
  for (const auto &[e, n] : edges)
    if (n != 1 || edges.count({e.second, e.first}) == 0) return false;
  return true;
}

// A tetrahedron: corners at the origin and at a, b, c on the axes. Volume a b c / 6.
using Tetra = std::vector<std::array<std::array<float, 3>, 3>>;
Tetra tetra(float a, float b, float c)
{
  const std::array<float, 3> o = {0, 0, 0}, x = {a, 0, 0}, y = {0, b, 0}, z = {0, 0, c};
  return {{o, y, x}, {o, x, z}, {o, z, y}, {x, y, z}};
}

std::string binaryStl(const Tetra &t, const std::string &head = "made by a test")
{
  std::string out(80, '\0');
  head.copy(&out[0], 79);
  const uint32_t count = static_cast<uint32_t>(t.size());
  out.append(reinterpret_cast<const char *>(&count), 4);
  float normal = 1;
  for (const auto &f : t) {
    // Different normals at equal positions: what a loader that welds by normals too would keep
    // apart.
    const float n[3] = {0, 0, normal};
    normal = -normal;
    out.append(reinterpret_cast<const char *>(n), 12);
    for (const auto &v : f) out.append(reinterpret_cast<const char *>(v.data()), 12);
    out.append(2, '\0');
  }
  return out;
}

std::string asciiStl(const Tetra &t)
{
  std::string out = "solid test\n";
  for (const auto &f : t) {
    out += " facet normal 0 0 1\n  outer loop\n";
    for (const auto &v : f)
      out += "   vertex " + std::to_string(v[0]) + " " + std::to_string(v[1]) + " " +
             std::to_string(v[2]) + "\n";
    out += "  endloop\n endfacet\n";
  }
  return out + "endsolid test\n";
}

const char *obj = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\n"
                  "vn 0 0 1\nvn 1 0 0\n"
                  "f 1//1 3//1 2//1\nf 1//2 2//2 4//2\nf 1//1 4//1 3//1\nf 2//2 3//2 4//2\n";

struct Dae {
  std::string unit = "<unit name=\"meter\" meter=\"1\"/>";
  std::string up = "Z_UP";
  std::string nodes = "<node id=\"n\"><instance_geometry url=\"#g\"/></node>";
  std::string positions = "0 0 0 1 0 0 0 2 0 0 0 3";
  std::string indices = "0 2 1 0 1 3 0 3 2 1 2 3";
};

std::string dae(const Dae &d)
{
  return "<?xml version=\"1.0\"?>\n"
         "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">"
         "<asset>" +
         d.unit + "<up_axis>" + d.up +
         "</up_axis></asset>"
         "<library_geometries><geometry id=\"g\"><mesh>"
         "<source id=\"p\"><float_array id=\"pa\" count=\"12\">" +
         d.positions +
         "</float_array><technique_common><accessor source=\"#pa\" count=\"4\" stride=\"3\">"
         "<param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/>"
         "<param name=\"Z\" type=\"float\"/></accessor></technique_common></source>"
         "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>"
         "<triangles count=\"4\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>" +
         d.indices +
         "</p></triangles></mesh></geometry></library_geometries>"
         "<library_visual_scenes><visual_scene id=\"s\">" +
         d.nodes +
         "</visual_scene></library_visual_scenes>"
         "<scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
}

const Eigen::Vector3d one(1, 1, 1);

std::string refusal(const std::string &uri, const Eigen::Vector3d &scale = one,
                    const MeshOptions &options = MeshOptions())
{
  try {
    loadMesh(uri, scale, options);
  } catch (const MeshError &e) {
    return e.what();
  }
  return "";
}

// Floats in the files: relative rounding 6e-8.
constexpr double tol = 1e-6;

void expectTetra(const TriangleMesh &m, const Eigen::Vector3d &far_corner, double abc)
{
  EXPECT_EQ(m.vertices.size(), 4u);
  EXPECT_EQ(m.triangles.size(), 4u);
  EXPECT_TRUE(watertight(m));
  EXPECT_NEAR(volume6(m), abc, tol * abc);
  const Eigen::AlignedBox3d box = m.bounds();
  EXPECT_LT((box.max() - far_corner.cwiseMax(0)).norm(), tol * far_corner.norm());
  EXPECT_LT((box.min() - far_corner.cwiseMin(0)).norm(), tol * far_corner.norm());
}

} // namespace

// ---- primitives ----

TEST(primitives, box_is_exact_and_closed)
{
  const TriangleMesh m = boxMesh({1, 2, 3});
  EXPECT_EQ(m.triangles.size(), 12u);
  EXPECT_TRUE(watertight(m));
  EXPECT_DOUBLE_EQ(volume(m), 6);
  EXPECT_EQ(m.bounds().max(), Eigen::Vector3d(.5, 1, 1.5));
  EXPECT_EQ(m.bounds().min(), Eigen::Vector3d(-.5, -1, -1.5));
}

TEST(primitives, cylinder_has_its_vertices_on_the_surface_and_the_volume_of_its_prism)
{
  for (int n : {3, 8, 32}) {
    const TriangleMesh m = cylinderMesh(.2, .7, n);
    EXPECT_TRUE(watertight(m));
    // Regular n-gon inscribed in a circle: n/2 r^2 sin(2 pi / n).
    EXPECT_NEAR(volume(m), .7 * n / 2. * .04 * std::sin(2 * pi / n), 1e-14);
    for (const auto &v : m.vertices) {
      EXPECT_DOUBLE_EQ(std::abs(v.z()), .35);
      const double r = v.head<2>().norm();
      EXPECT_TRUE(r == 0 || std::abs(r - .2) < 1e-15);
    }
  }
}

TEST(primitives, sphere_has_its_vertices_on_the_surface_and_converges_to_the_ball)
{
  double error = 1;
  for (int n : {3, 8, 16, 32, 64}) {
    const TriangleMesh m = sphereMesh(.3, n);
    EXPECT_TRUE(watertight(m)) << n;
    for (const auto &v : m.vertices) EXPECT_NEAR(v.norm(), .3, 1e-15);
    const double now = 1 - volume(m) / (4. / 3 * pi * .027);
    EXPECT_GT(now, 0); // inscribed
    EXPECT_LT(now, error);
    error = now;
  }
  EXPECT_LT(error, .006); // second order: (2 pi / 64)^2 / 2 plus the rings' share
}

TEST(primitives, segments_out_of_range_are_clamped)
{
  EXPECT_EQ(cylinderMesh(1, 1, -5).triangles.size(), 12u);
  EXPECT_TRUE(watertight(sphereMesh(1, 0)));
}

TEST(primitives, append_places_and_renumbers)
{
  TriangleMesh m = boxMesh(one);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(5, 0, 0)).rotate(Eigen::AngleAxisd(1, Eigen::Vector3d::UnitZ()));
  m.append(boxMesh(one), pose);
  EXPECT_EQ(m.triangles.size(), 24u);
  EXPECT_TRUE(watertight(m));
  EXPECT_NEAR(volume(m), 2, 1e-12);
  EXPECT_NEAR(m.bounds().max().x(), 5 + (std::cos(1) + std::sin(1)) / 2, 1e-12);
  EXPECT_EQ(m.view().vertex_count, 16);
  EXPECT_EQ(m.view().position[3 * 8], m.vertices[8].x());
}

// ---- files that are fine ----

TEST(files, stl_binary_ascii_obj_and_dae_give_the_same_welded_tetrahedron)
{
  const std::string uris[] = {
      write("b.stl", binaryStl(tetra(1, 2, 3))),
      write("a.stl", asciiStl(tetra(1, 2, 3))),
      write("UPPER.STL", binaryStl(tetra(1, 2, 3), "solid but binary all the same")),
      write("o.obj", obj),
      write("d.dae", dae({})),
  };
  for (const std::string &uri : uris) {
    SCOPED_TRACE(uri);
    MeshReport report;
    expectTetra(loadMesh(uri, one, {}, &report), {1, 2, 3}, 6);
    EXPECT_EQ(report.meshes, 1);
    EXPECT_TRUE(report.warnings.empty());
    EXPECT_FALSE(report.flipped);
  }
}

TEST(files, scale_is_per_axis_and_a_mirror_keeps_the_outside_outside)
{
  for (const std::string &uri :
       {write("s.stl", binaryStl(tetra(1, 2, 3))), write("s.dae", dae({}))}) {
    expectTetra(loadMesh(uri, {.001, .001, .001}), {.001, .002, .003}, 6e-9);
    expectTetra(loadMesh(uri, {2, 3, .5}), {2, 6, 1.5}, 18);
    MeshReport report;
    expectTetra(loadMesh(uri, {-1, 1, 1}, {}, &report), {-1, 2, 3}, 6);
    EXPECT_TRUE(report.flipped);
    expectTetra(loadMesh(uri, {-1, -1, 1}, {}, &report), {-1, -2, 3}, 6);
    EXPECT_FALSE(report.flipped);
    expectTetra(loadMesh(uri, {-1, -1, -1}), {-1, -2, -3}, 6);
  }
}

TEST(files, collada_unit_is_honoured_as_rviz_does_unless_switched_off)
{
  Dae d;
  d.unit = "<unit name=\"millimeter\" meter=\"0.001\"/>";
  const std::string uri = write("mm.dae", dae(d));
  MeshReport report;
  expectTetra(loadMesh(uri, one, {}, &report), {.001, .002, .003}, 6e-9);
  EXPECT_DOUBLE_EQ(report.unit, .001);
  MeshOptions moveit;
  moveit.collada_unit = false;
  expectTetra(loadMesh(uri, one, moveit, &report), {1, 2, 3}, 6);
  EXPECT_DOUBLE_EQ(report.unit, 1);
  // No <unit>: metres. That is what grippers in millimetres with scale .001 in the URDF count on.
  d.unit = "";
  expectTetra(loadMesh(write("none.dae", dae(d)), {.001, .001, .001}), {.001, .002, .003}, 6e-9);
}

TEST(files, collada_unit_that_is_no_number_is_taken_as_one_and_reported)
{
  for (const char *meter : {"-1", "0", "nan", "big"}) {
    Dae d;
    d.unit = std::string("<unit meter=\"") + meter + "\"/>";
    MeshReport report;
    expectTetra(loadMesh(write("unit.dae", dae(d)), one, {}, &report), {1, 2, 3}, 6);
    ASSERT_EQ(report.warnings.size(), 1u) << meter;
    EXPECT_NE(report.warnings[0].find(meter), std::string::npos);
  }
}

TEST(files, collada_up_axis_is_left_alone_as_rviz_does_unless_switched_on)
{
  MeshOptions turn;
  turn.collada_up_axis = true;
  // Where the file's axes go when its up-axis becomes z (Collada 1.4.1, table of up_axis).
  const std::map<std::string, Eigen::Vector3d> turned = {
      {"Z_UP", {1, 2, 3}}, {"Y_UP", {1, -3, 2}}, {"X_UP", {-2, -3, 1}}};
  for (const auto &[up, corner] : turned) {
    SCOPED_TRACE(up);
    Dae d;
    d.up = up;
    const std::string uri = write("up.dae", dae(d));
    expectTetra(loadMesh(uri, one), {1, 2, 3}, 6);
    expectTetra(loadMesh(uri, one, turn), corner, 6);
  }
}

TEST(files, nodes_of_a_file_keep_their_transforms_and_instances)
{
  Dae d;
  d.nodes = "<node id=\"a\"><translate>10 0 0</translate>"
            "<node id=\"b\"><matrix>0 -1 0 0 1 0 0 0 0 0 1 5 0 0 0 1</matrix>"
            "<instance_geometry url=\"#g\"/></node></node>"
            "<node id=\"c\"><scale>-1 1 1</scale><instance_geometry url=\"#g\"/></node>";
  MeshReport report;
  const TriangleMesh m = loadMesh(write("nodes.dae", dae(d)), one, {}, &report);
  EXPECT_EQ(report.meshes, 2);
  EXPECT_TRUE(report.flipped);
  EXPECT_EQ(m.triangles.size(), 8u);
  EXPECT_NEAR(volume6(m), 12, 12 * tol);
  // a: x -> y, y -> -x, then (10, 0, 5): x in [8, 10], y in [0, 1], z in [5, 8]. c: x in [-1, 0].
  EXPECT_LT((m.bounds().max() - Eigen::Vector3d(10, 2, 8)).norm(), 1e-5);
  EXPECT_LT((m.bounds().min() - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-5);
}

TEST(files, triangles_without_area_and_repeated_ones_are_dropped_and_counted)
{
  Tetra t = tetra(1, 2, 3);
  t.push_back({{{0, 0, 0}, {1, 0, 0}, {.5f, 0, 0}}}); // on a line
  t.push_back({{{0, 0, 0}, {0, 0, 0}, {5, 5, 5}}});   // two corners in one place
  t.push_back(t[0]);
  MeshReport report;
  const TriangleMesh m = loadMesh(write("bad.stl", binaryStl(t)), one, {}, &report);
  expectTetra(m, {1, 2, 3}, 6);
  EXPECT_EQ(report.zero_area_triangles, 2);
  EXPECT_EQ(report.duplicate_triangles, 1);
  EXPECT_EQ(report.warnings.size(), 2u);
}

TEST(files, small_and_large_units_weld_alike)
{
  for (float unit : {1e-6f, 1e6f})
    expectTetra(loadMesh(write("unit.stl", binaryStl(tetra(unit, unit, unit))), one),
                Eigen::Vector3d::Constant(unit), std::pow(double(unit), 3));
}

TEST(files, percent_encoded_and_plain_blanks_and_long_names_are_found)
{
  write("a b.stl", binaryStl(tetra(1, 2, 3)));
  expectTetra(loadMesh("file://" + folder() + "/a%20b.stl", one), {1, 2, 3}, 6);
  expectTetra(loadMesh("file://" + folder() + "/a b.stl", one), {1, 2, 3}, 6);
  expectTetra(loadMesh(write(std::string(240, 'n') + ".stl", binaryStl(tetra(1, 2, 3))), one),
              {1, 2, 3}, 6);
}

TEST(files, a_polygon_is_cut_into_triangles)
{
  const TriangleMesh m =
      loadMesh(write("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"), one);
  EXPECT_EQ(m.triangles.size(), 2u);
  EXPECT_EQ(m.vertices.size(), 4u);
}

TEST(files, too_many_triangles_are_reported_then_refused)
{
  const std::string uri = write("many.stl", binaryStl(tetra(1, 2, 3)));
  MeshOptions options;
  options.triangles_warn = 3;
  MeshReport report;
  loadMesh(uri, one, options, &report);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("4 triangles"), std::string::npos);
  options.triangles_max = 3;
  EXPECT_NE(refusal(uri, one, options).find("more than 3 triangles"), std::string::npos);
}

TEST(files, package_uris_are_resolved)
{
  mkdir((folder() + "/robot_x").c_str(), 0755);
  write("robot_x/package.xml", "<package format=\"2\"><name>robot_x</name></package>");
  write("robot_x/t.stl", binaryStl(tetra(1, 2, 3)));
  setenv("ROS_PACKAGE_PATH", folder().c_str(), 1);
  MeshReport report;
  expectTetra(loadMesh("package://robot_x/t.stl", one, {}, &report), {1, 2, 3}, 6);
  EXPECT_TRUE(report.warnings.empty());
}

TEST(files, a_package_may_be_a_bare_folder_of_its_name_and_that_is_reported)
{
  mkdir((folder() + "/bare").c_str(), 0755);
  write("bare/t.stl", binaryStl(tetra(1, 2, 3)));
  for (const std::string &path : {folder(), "/nowhere:" + folder() + "/bare"}) {
    setenv("ROS_PACKAGE_PATH", path.c_str(), 1);
    MeshReport report;
    expectTetra(loadMesh("package://bare/t.stl", one, {}, &report), {1, 2, 3}, 6);
    ASSERT_EQ(report.warnings.size(), 1u);
    EXPECT_NE(report.warnings[0].find("package.xml"), std::string::npos);
  }
  EXPECT_NE(refusal("package://bare/nothing.stl").find("nothing.stl"), std::string::npos);
}

// ---- files that are not ----

struct Broken {
  const char *name;
  std::function<std::string()> uri;
  const char *says;
};

class broken : public testing::TestWithParam<Broken> {};

TEST_P(broken, is_refused_with_uri_and_reason)
{
  const std::string uri = GetParam().uri();
  const std::string text = refusal(uri);
  EXPECT_NE(text.find(GetParam().says), std::string::npos) << text;
  EXPECT_NE(text.find("'" + uri + "'"), std::string::npos) << text;
}

std::string nanStl(float bad)
{
  Tetra t = tetra(1, 2, 3);
  t[1][1][2] = bad;
  return binaryStl(t);
}

INSTANTIATE_TEST_SUITE_P(
    table, broken,
    testing::Values(
        Broken{"no_scheme", [] { return folder() + "/b.stl"; }, "is not a URI"},
        Broken{"empty_uri", [] { return std::string(); }, "is not a URI"},
        Broken{"missing", [] { return "file://" + folder() + "/nothing.stl"; }, "cannot be read"},
        Broken{"package", [] { return std::string("package://no_such_package/a.stl"); },
               "no_such_package"},
        Broken{"refused", [] { return std::string("http://127.0.0.1:1/a.stl"); }, "cannot be read"},
        Broken{"scheme", [] { return std::string("gopherish://x/a.stl"); }, "cannot be read"},
        Broken{"directory",
               [] {
                 mkdir((folder() + "/dir.stl").c_str(), 0755);
                 return "file://" + folder() + "/dir.stl";
               },
               "empty file or a directory"},
        Broken{"zero_bytes", [] { return write("zero.stl", ""); }, "empty file or a directory"},
        Broken{"garbage_stl", [] { return write("g.stl", std::string(500, '\x7f')); },
               "understood"},
        Broken{"garbage_dae", [] { return write("g.dae", "this is no XML"); }, "not valid Collada"},
        Broken{"garbage_obj", [] { return write("g.obj", "\x01\x02\x03 nothing"); }, "mesh"},
        Broken{"no_extension", [] { return write("noext", "hello"); }, "understood"},
        Broken{"truncated_stl",
               [] { return write("t.stl", binaryStl(tetra(1, 2, 3)).substr(0, 150)); }, "mesh"},
        Broken{"truncated_dae", [] { return write("t.dae", dae({}).substr(0, 700)); },
               "not valid Collada"},
        Broken{"empty_ascii_stl", [] { return write("e.stl", "solid e\nendsolid e\n"); }, "mesh"},
        Broken{"empty_binary_stl", [] { return write("e2.stl", binaryStl({})); }, "mesh"},
        Broken{"only_slivers",
               [] {
                 return write("l.stl", binaryStl({{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}}}));
               },
               "1 triangles without area"},
        Broken{"only_lines", [] { return write("l.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n"); }, "mesh"},
        Broken{"nan", [] { return write("n.stl", nanStl(std::nanf(""))); }, "not finite"},
        Broken{"inf", [] { return write("i.stl", nanStl(std::numeric_limits<float>::infinity())); },
               "not finite"}),
    [](const testing::TestParamInfo<Broken> &i) { return i.param.name; });

TEST(files, scale_zero_or_not_finite_is_refused)
{
  const std::string uri = write("scale.stl", binaryStl(tetra(1, 2, 3)));
  for (double bad : {0., double(NAN), double(INFINITY)})
    EXPECT_NE(refusal(uri, {1, bad, 1}).find("scale"), std::string::npos);
}
