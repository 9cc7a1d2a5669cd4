// URDF to links, joints and forward kinematics. The oracles: transforms worked out by hand, and
// KDL. Bad robot descriptions are a table, one row each.
#include "node/robot_model.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl_parser/kdl_parser.hpp>
#include <map>
#include <new>
#include <random>
#include <sstream>

using namespace robot_cloth;

// ---- counting allocations ----

namespace {
std::atomic<long> allocations{0};
}

// Not inlined: gcc otherwise sees a free() of what operator new gave, and warns of a mismatch.
#define NOT_INLINED __attribute__((noinline))
NOT_INLINED void *operator new(size_t size)
{
  allocations++;
  if (void *p = std::malloc(size ? size : 1)) return p;
  throw std::bad_alloc();
}
NOT_INLINED void *operator new(size_t size, std::align_val_t align)
{
  allocations++;
  const size_t a = static_cast<size_t>(align);
  if (void *p = std::aligned_alloc(a, (size + a - 1) / a * a)) return p;
  throw std::bad_alloc();
}
NOT_INLINED void operator delete(void *p) noexcept { std::free(p); }
NOT_INLINED void operator delete(void *p, size_t) noexcept { std::free(p); }
NOT_INLINED void operator delete(void *p, std::align_val_t) noexcept { std::free(p); }
NOT_INLINED void operator delete(void *p, size_t, std::align_val_t) noexcept { std::free(p); }

namespace {

constexpr double pi = 3.14159265358979323846;

std::string robot(const std::string &inside) { return "<robot name=\"r\">" + inside + "</robot>"; }

std::string link(const std::string &name, const std::string &inside = "")
{
  return "<link name=\"" + name + "\">" + inside + "</link>";
}

std::string collision(const std::string &shape, const std::string &origin = "")
{
  return "<collision>" + origin + "<geometry>" + shape + "</geometry></collision>";
}

std::string joint(const std::string &name, const std::string &type, const std::string &parent,
                  const std::string &child, const std::string &inside = "")
{
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + inside + "</joint>";
}

const std::string limit = "<limit lower=\"-3\" upper=\"3\" effort=\"1\" velocity=\"2\"/>";
const std::string box = "<box size=\"1 1 1\"/>";

std::string mimic(const std::string &of, double multiplier, double offset)
{
  return "<mimic joint=\"" + of + "\" multiplier=\"" + std::to_string(multiplier) + "\" offset=\"" +
         std::to_string(offset) + "\"/>";
}

// Base, a turning column, a sliding carriage, a wheel that turns for ever, and two mimics: `follow`
// follows `turn`, `chain` follows `follow`.
std::string arm()
{
  return robot(
      link("base", collision(box)) + link("column") + link("carriage") + link("wheel") +
      link("finger") + link("tip") +
      joint("turn", "revolute", "base", "column",
            "<origin xyz=\"0 0 0.5\" rpy=\"0 0 0\"/><axis xyz=\"0 0 2\"/>" + limit) +
      joint("slide", "prismatic", "column", "carriage",
            "<origin xyz=\"0.1 0 0\" rpy=\"1.5707963267948966 0 0\"/><axis xyz=\"0 1 0\"/>" +
                limit) +
      joint("roll", "continuous", "carriage", "wheel", "<origin xyz=\"0 0 1\"/>") +
      joint("follow", "revolute", "column", "finger",
            "<origin xyz=\"1 0 0\"/><axis xyz=\"0 0 1\"/>" + limit + mimic("turn", -1, .25)) +
      joint("chain", "prismatic", "finger", "tip",
            "<axis xyz=\"0 1 0\"/>" + limit + mimic("follow", 2, .5)));
}

std::string refusal(const std::string &xml, const ModelOptions &options = ModelOptions())
{
  try {
    RobotModel::fromUrdf(xml, options);
  } catch (const ModelError &e) {
    return e.what();
  }
  return "";
}

Eigen::Isometry3d make(const Eigen::Vector3d &p, double angle = 0,
                       const Eigen::Vector3d &axis = Eigen::Vector3d::UnitZ())
{
  Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
  t.translate(p).rotate(Eigen::AngleAxisd(angle, axis));
  return t;
}

double difference(const Eigen::Isometry3d &a, const Eigen::Isometry3d &b)
{
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

Eigen::Isometry3d fromKdl(const KDL::Frame &f)
{
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; r++) {
    out.translation()[r] = f.p(r);
    for (int c = 0; c < 3; c++) out.linear()(r, c) = f.M(r, c);
  }
  return out;
}

// Against KDL at random values: every link of the robot. KDL knows no mimics, it gets their values.
void expectSameAsKdl(const std::string &xml, int rounds)
{
  ModelOptions kinematics;
  kinematics.load_meshes = false;
  const auto model = RobotModel::fromUrdf(xml, kinematics);
  KDL::Tree tree;
  ASSERT_TRUE(kdl_parser::treeFromString(xml, tree));
  RobotPose pose(model);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-3, 3);
  for (int round = 0; round < rounds; round++) {
    for (const Joint &j : model->joints())
      if (j.movable() && !j.mimic()) {
        ASSERT_EQ(pose.set(j.name, uniform(random)), JointUpdate::taken);
      }
    const std::vector<Eigen::Isometry3d> &links = pose.links();
    for (const Link &l : model->links()) {
      KDL::Chain chain;
      ASSERT_TRUE(tree.getChain(model->root().name, l.name, chain));
      KDL::JntArray q(chain.getNrOfJoints());
      unsigned n = 0;
      for (const KDL::Segment &s : chain.segments)
        if (s.getJoint().getType() != KDL::Joint::None)
          q(n++) = pose.value(model->findJoint(s.getJoint().getName()));
      KDL::Frame frame;
      ASSERT_GE(KDL::ChainFkSolverPos_recursive(chain).JntToCart(q, frame), 0);
      // Products of some ten rotations in double.
      ASSERT_LT(difference(links[static_cast<size_t>(l.index)], fromKdl(frame)), 1e-13) << l.name;
    }
  }
}

std::string sharedData()
{
  if (const char *env = std::getenv("CLOTH_SHARED_DATA")) return env;
  return std::string(CLOTH_SOURCE_DIR) + "/../shared/data";
}

std::string slurp(const std::string &path)
{
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

} // namespace

// ---- kinematics ----

TEST(kinematics, links_are_where_the_closed_form_says)
{
  const auto model = RobotModel::fromUrdf(arm());
  RobotPose pose(model);
  const double turn = .7, slide = -.3, roll = 9;
  EXPECT_EQ(pose.set("turn", turn), JointUpdate::taken);
  EXPECT_EQ(pose.set("slide", slide), JointUpdate::taken);
  EXPECT_EQ(pose.set("roll", roll), JointUpdate::taken);
  EXPECT_TRUE(pose.complete());
  const auto &at = pose.links();
  const auto of = [&](const char *name) { return at[static_cast<size_t>(model->findLink(name))]; };
  const Eigen::Isometry3d column = make({0, 0, .5}, turn);
  // The carriage slides along its y axis, which the origin has turned to the column's z axis.
  const Eigen::Isometry3d carriage =
      column * make({.1, 0, slide}, pi / 2, Eigen::Vector3d::UnitX());
  const Eigen::Isometry3d wheel = carriage * make({0, 0, 1}, roll, Eigen::Vector3d::UnitX());
  const double follow = -turn + .25, chain = 2 * follow + .5;
  const Eigen::Isometry3d finger = column * make({1, 0, 0}, follow);
  const Eigen::Isometry3d tip = finger * make({0, chain, 0});
  // A handful of products in double.
  const double tol = 1e-14;
  EXPECT_LT(difference(of("base"), Eigen::Isometry3d::Identity()), tol);
  EXPECT_LT(difference(of("column"), column), tol);
  EXPECT_LT(difference(of("carriage"), carriage), tol);
  EXPECT_LT(difference(of("wheel"), wheel), tol);
  EXPECT_LT(difference(of("finger"), finger), tol);
  EXPECT_LT(difference(of("tip"), tip), tol);
}

TEST(kinematics, links_are_where_kdl_says) { expectSameAsKdl(arm(), 50); }

TEST(kinematics, chains_of_mimics_are_resolved_to_the_joint_that_moves)
{
  const auto model = RobotModel::fromUrdf(arm());
  const Joint &chain = model->joints()[static_cast<size_t>(model->findJoint("chain"))];
  EXPECT_EQ(chain.mimic_source, model->findJoint("turn"));
  EXPECT_DOUBLE_EQ(chain.mimic_multiplier, -2);
  EXPECT_DOUBLE_EQ(chain.mimic_offset, 1);
  RobotPose pose(model);
  pose.set("turn", .5);
  EXPECT_DOUBLE_EQ(pose.value(model->findJoint("chain")), 0);
}

TEST(kinematics, parents_come_before_children_and_joint_i_carries_link_i_plus_one)
{
  const auto model = RobotModel::fromUrdf(arm());
  EXPECT_EQ(model->root().name, "base");
  for (size_t i = 0; i < model->joints().size(); i++) {
    EXPECT_EQ(model->joints()[i].child_link, static_cast<int>(i) + 1);
    EXPECT_LT(model->joints()[i].parent_link, model->joints()[i].child_link);
    EXPECT_EQ(model->links()[i + 1].parent_joint, static_cast<int>(i));
  }
}

TEST(kinematics, nothing_is_allocated_once_warm)
{
  const auto model = RobotModel::fromUrdf(arm());
  RobotPose pose(model);
  const std::string turn = "turn";
  pose.set(turn, 0);
  pose.links();
  const long before = allocations;
  double sum = 0;
  for (int i = 0; i < 100; i++) {
    pose.set(turn, .01 * i);
    sum += pose.links().back().translation().norm();
  }
  EXPECT_EQ(allocations, before);
  EXPECT_GT(sum, 0);
}

TEST(kinematics, planar_and_floating_joints_stay_until_they_are_placed)
{
  for (const char *type : {"planar", "floating"}) {
    const auto model = RobotModel::fromUrdf(
        robot(link("a") + link("b") + joint("j", type, "a", "b", "<origin xyz=\"1 0 0\"/>")));
    ASSERT_EQ(model->problems().size(), 1u);
    EXPECT_EQ(model->problems()[0].kind, ModelProblem::unusual_joint);
    EXPECT_TRUE(model->joints()[0].placed());
    RobotPose pose(model);
    EXPECT_TRUE(pose.complete());
    EXPECT_EQ(pose.set("j", 1), JointUpdate::not_movable);
    EXPECT_LT(difference(pose.links()[1], make({1, 0, 0})), 1e-15);
    EXPECT_TRUE(pose.place("j", make({0, 2, 0}, .3)));
    EXPECT_LT(difference(pose.links()[1], make({1, 2, 0}, .3)), 1e-15);
    Eigen::Isometry3d nan = make({0, NAN, 0});
    EXPECT_FALSE(pose.place("j", nan));
    EXPECT_FALSE(pose.place("nobody", make({0, 0, 0})));
    EXPECT_LT(difference(pose.links()[1], make({1, 2, 0}, .3)), 1e-15);
  }
}

// ---- joint values ----

TEST(joint_values, unknown_names_are_told_once_and_missing_ones_named)
{
  RobotPose pose(RobotModel::fromUrdf(arm()));
  std::vector<std::string> missing = pose.missing();
  std::sort(missing.begin(), missing.end());
  EXPECT_EQ(missing, (std::vector<std::string>{"roll", "slide", "turn"}));
  EXPECT_EQ(pose.set("elbow", 1), JointUpdate::unknown);
  EXPECT_EQ(pose.set("elbow", 2), JointUpdate::unknown_again);
  EXPECT_EQ(pose.unknown(), std::vector<std::string>{"elbow"});
  pose.set("turn", 0);
  pose.set("roll", 0);
  EXPECT_FALSE(pose.complete());
  EXPECT_EQ(pose.missing(), std::vector<std::string>{"slide"});
  pose.forget();
  EXPECT_EQ(pose.missing().size(), 3u);
  EXPECT_EQ(pose.set("elbow", 1), JointUpdate::unknown);
}

TEST(joint_values, not_finite_is_refused_and_the_old_value_stays)
{
  const auto model = RobotModel::fromUrdf(arm());
  RobotPose pose(model);
  pose.set("turn", .5);
  for (double bad : {double(NAN), double(INFINITY), -double(INFINITY)}) {
    EXPECT_EQ(pose.set("turn", bad), JointUpdate::not_finite);
    EXPECT_EQ(pose.set("slide", bad), JointUpdate::not_finite);
  }
  EXPECT_EQ(pose.value(model->findJoint("turn")), .5);
  EXPECT_EQ(pose.missing().size(), 2u); // a refused value does not count as given
}

TEST(joint_values, a_mimic_joint_follows_its_source_whatever_a_driver_says)
{
  const auto model = RobotModel::fromUrdf(arm());
  RobotPose pose(model);
  pose.set("turn", 1);
  EXPECT_EQ(pose.set("follow", 7), JointUpdate::mimic);
  EXPECT_DOUBLE_EQ(pose.value(model->findJoint("follow")), -.75);
}

TEST(joint_values, a_joint_that_was_never_given_waits_at_the_limit_nearest_to_zero)
{
  const auto model = RobotModel::fromUrdf(
      robot(link("a") + link("b") +
            joint("j", "revolute", "a", "b",
                  "<limit lower=\"0.5\" upper=\"1\" effort=\"1\" velocity=\"1\"/>")));
  EXPECT_EQ(RobotPose(model).value(0), .5);
}

// ---- collision geometry ----

TEST(collisions, all_of_a_link_become_one_mesh_in_the_link_frame)
{
  const auto model = RobotModel::fromUrdf(
      robot(link("a", collision("<box size=\"1 2 3\"/>",
                                "<origin xyz=\"10 0 0\" rpy=\"0 0 1.5707963267948966\"/>") +
                          collision("<sphere radius=\"0.5\"/>", "<origin xyz=\"0 0 7\"/>") +
                          collision("<cylinder radius=\"0.25\" length=\"1\"/>"))));
  const Link &a = model->root();
  EXPECT_EQ(a.collision_tags, 3);
  EXPECT_EQ(a.collisions_used, 3);
  const Eigen::AlignedBox3d box3 = a.mesh.bounds();
  EXPECT_NEAR(box3.max().x(), 11, 1e-12); // the box's y edge of 2 m lies along x
  EXPECT_NEAR(box3.max().y(), .5, 1e-12);
  EXPECT_NEAR(box3.max().z(), 7.5, 1e-12);
  EXPECT_NEAR(box3.min().z(), -1.5, 1e-12);
  EXPECT_EQ(model->droppedCollisions(), 0);
  EXPECT_TRUE(model->problems().empty());
}

TEST(collisions, links_that_can_be_seen_and_not_touched_are_listed)
{
  const std::string visual = "<visual><geometry>" + box + "</geometry></visual>";
  const auto model = RobotModel::fromUrdf(
      robot(link("a", visual) + link("b", visual + collision(box)) + link("c") +
            joint("j", "fixed", "a", "b") + joint("k", "fixed", "a", "c")));
  EXPECT_EQ(model->visualOnlyLinks(), std::vector<std::string>{"a"});
}

struct Dropped {
  const char *name, *element, *says;
};

class dropped : public testing::TestWithParam<Dropped> {};

// urdfdom alone drops the good box after the bad element, too.
TEST_P(dropped, is_named_with_its_link_and_the_elements_around_it_survive)
{
  const auto model = RobotModel::fromUrdf(
      robot(link("hand", collision(box) + GetParam().element + collision(box))));
  const Link &hand = model->root();
  EXPECT_EQ(hand.collision_tags, 3);
  EXPECT_EQ(hand.collisions_used, 2);
  EXPECT_EQ(hand.mesh.triangles.size(), 24u);
  EXPECT_EQ(model->droppedCollisions(), 1);
  ASSERT_EQ(model->problems().size(), 1u);
  const ModelProblem &p = model->problems()[0];
  EXPECT_EQ(p.kind, ModelProblem::dropped_collision);
  EXPECT_EQ(p.link_or_joint, "hand");
  EXPECT_NE(p.text.find("'hand'"), std::string::npos) << p.text;
  EXPECT_NE(p.text.find("number 2"), std::string::npos) << p.text;
  EXPECT_NE(p.text.find(GetParam().says), std::string::npos) << p.text;
}

#define GEOMETRY(shape) "<collision><geometry>" shape "</geometry></collision>"

INSTANTIATE_TEST_SUITE_P(
    table, dropped,
    testing::Values(
        Dropped{"scale_of_one_number",
                GEOMETRY("<mesh filename='package://p/a.stl' scale='0.001'/>"),
                "scale=\"0.001\" is not three"},
        Dropped{"capsule", GEOMETRY("<capsule radius='1' length='1'/>"), "<capsule>"},
        Dropped{"nan_radius", GEOMETRY("<sphere radius='nan'/>"), "radius=\"nan\""},
        Dropped{"inf_length", GEOMETRY("<cylinder radius='1' length='inf'/>"), "length=\"inf\""},
        Dropped{"overflow", GEOMETRY("<sphere radius='1e999'/>"), "1e999"},
        Dropped{"trailing_letters", GEOMETRY("<sphere radius='0.1m'/>"), "0.1m"},
        Dropped{"comma", GEOMETRY("<sphere radius='0,1'/>"), "0,1"},
        Dropped{"nan_box", GEOMETRY("<box size='1 nan 1'/>"), "size=\"1 nan 1\""},
        Dropped{"box_of_two", GEOMETRY("<box size='1 1'/>"), "not three"},
        Dropped{"no_size", GEOMETRY("<box/>"), "missing"},
        Dropped{"no_radius", GEOMETRY("<cylinder length='1'/>"), "no radius"},
        Dropped{"no_length", GEOMETRY("<cylinder radius='1'/>"), "no length"},
        Dropped{"no_filename", GEOMETRY("<mesh scale='1 1 1'/>"), "no filename"},
        Dropped{"empty_geometry", GEOMETRY(""), "<geometry> is empty"},
        Dropped{"no_geometry", "<collision/>", "no <geometry>"},
        Dropped{
            "origin",
            "<collision><origin xyz='0 0'/><geometry><box size='1 1 1'/></geometry></collision>",
            "origin xyz=\"0 0\""},
        Dropped{"rpy",
                "<collision><origin rpy='0 nan 0'/><geometry><box size='1 1 "
                "1'/></geometry></collision>",
                "origin rpy"}),
    [](const testing::TestParamInfo<Dropped> &i) { return i.param.name; });

TEST(collisions, survive_a_broken_visual_inertial_or_material)
{
  const auto model = RobotModel::fromUrdf(robot(
      "<material name=\"m\"><color rgba=\"red\"/></material>" +
      link("a", "<inertial/><visual><geometry><capsule/></geometry></visual>" + collision(box))));
  EXPECT_EQ(model->root().collisions_used, 1);
  EXPECT_TRUE(model->problems().empty());
}

// ---- what is refused ----

struct Bad {
  const char *name;
  std::string xml;
  std::vector<const char *> says;
};

class bad : public testing::TestWithParam<Bad> {};

TEST_P(bad, is_refused_with_what_to_fix)
{
  const std::string text = refusal(GetParam().xml);
  EXPECT_FALSE(text.empty()) << "accepted";
  for (const char *says : GetParam().says) EXPECT_NE(text.find(says), std::string::npos) << text;
}

std::string two(const std::string &type, const std::string &inside)
{
  return robot(link("a") + link("b") + joint("j", type, "a", "b", inside));
}

std::string boxes(const std::string &shape) { return robot(link("hand", collision(shape))); }

const std::string axis_z = "<axis xyz=\"0 0 1\"/>";

std::vector<Bad> badRobots()
{
  return {
      {"empty", "", {"empty"}},
      {"blank", " \n\t ", {"empty"}},
      {"not_xml", "hello", {"not valid XML"}},
      {"cut_off", "<robot name=\"r\"><link name=\"a\">", {"not valid XML"}},
      {"mismatched",
       "<robot name=\"r\"><link name=\"a\"></joint></robot>",
       {"not valid XML", "ine"}},
      {"sdf", "<sdf version=\"1.6\"><model name=\"m\"/></sdf>", {"<sdf>", "<robot>"}},
      {"xacro", robot("<xacro:include filename=\"a\"/>" + link("a")), {"xacro"}},
      {"no_robot_name", "<robot><link name=\"a\"/></robot>", {"urdfdom refuses", "name"}},
      {"no_links", robot(""), {"no <link>"}},
      {"link_without_name", robot("<link/>"), {"no name"}},
      {"link_twice", robot(link("a") + link("a")), {"two links", "'a'"}},
      {"joint_twice",
       robot(link("a") + link("b") + link("c") + joint("j", "fixed", "a", "b") +
             joint("j", "fixed", "a", "c")),
       {"two joints", "'j'"}},
      {"joint_without_name", robot(link("a") + "<joint type=\"fixed\"/>"), {"no name"}},
      {"two_roots", robot(link("a") + link("b")), {"2 roots", "a, b"}},
      {"no_root",
       robot(link("a") + link("b") + joint("j", "fixed", "a", "b") + joint("k", "fixed", "b", "a")),
       {"cycle"}},
      {"cycle_beside_the_root",
       robot(link("r") + link("a") + link("b") + joint("j", "fixed", "a", "b") +
             joint("k", "fixed", "b", "a")),
       {"cycle", "'r'"}},
      {"two_parents",
       robot(link("a") + link("b") + link("c") + joint("j", "fixed", "a", "c") +
             joint("k", "fixed", "b", "c") + joint("l", "fixed", "a", "b")),
       {"two joints", "'j'", "'k'"}},
      {"no_parent",
       robot(link("a") + "<joint name=\"j\" type=\"fixed\"><child link=\"a\"/></joint>"),
       {"'j'", "parent"}},
      {"unknown_child", robot(link("a") + joint("j", "fixed", "a", "ghost")), {"'j'", "'ghost'"}},
      {"type_unknown", two("hinge", axis_z), {"'j'", "hinge", "revolute"}},
      {"type_missing",
       robot(link("a") + link("b") +
             "<joint name=\"j\"><parent link=\"a\"/><child link=\"b\"/></joint>"),
       {"'j'", "type missing"}},
      {"revolute_without_limit", two("revolute", axis_z), {"'j'", "<limit", "continuous"}},
      {"prismatic_without_limit", two("prismatic", axis_z), {"'j'", "<limit"}},
      {"limit_nan",
       two("revolute", "<limit lower=\"nan\" upper=\"1\" effort=\"1\" velocity=\"1\"/>"),
       {"'j'", "lower", "nan"}},
      {"limit_without_effort",
       two("revolute", "<limit lower=\"0\" upper=\"1\" velocity=\"1\"/>"),
       {"'j'", "effort", "missing"}},
      {"axis_zero", two("revolute", "<axis xyz=\"0 0 0\"/>" + limit), {"'j'", "axis", "0 0 0"}},
      {"axis_nan", two("revolute", "<axis xyz=\"0 nan 0\"/>" + limit), {"'j'", "axis", "nan"}},
      {"origin_nan", two("fixed", "<origin xyz=\"nan 0 0\"/>"), {"'j'", "origin xyz", "nan"}},
      {"origin_of_two", two("fixed", "<origin rpy=\"0 0\"/>"), {"'j'", "origin rpy"}},
      {"mimic_of_nobody",
       two("revolute", axis_z + limit + mimic("ghost", 1, 0)),
       {"'j'", "'ghost'", "does not exist"}},
      {"mimic_of_itself", two("revolute", axis_z + limit + mimic("j", 1, 0)), {"cycle", "j -> j"}},
      {"mimic_in_a_cycle",
       robot(link("a") + link("b") + link("c") +
             joint("j", "revolute", "a", "b", axis_z + limit + mimic("k", 1, 0)) +
             joint("k", "revolute", "a", "c", axis_z + limit + mimic("j", 1, 0))),
       {"cycle", "j -> k -> j"}},
      {"mimic_into_a_cycle",
       robot(link("a") + link("b") + link("c") + link("d") +
             joint("first", "revolute", "a", "d", axis_z + limit + mimic("j", 1, 0)) +
             joint("j", "revolute", "a", "b", axis_z + limit + mimic("k", 1, 0)) +
             joint("k", "revolute", "a", "c", axis_z + limit + mimic("j", 1, 0))),
       {"'j': mimics itself"}},
      {"mimic_multiplier",
       two("revolute", axis_z + limit + "<mimic joint=\"j\" multiplier=\"nan\"/>"),
       {"'j'", "multiplier", "nan"}},
      {"box_negative", boxes("<box size=\"1 -1 1\"/>"), {"'hand'", "box", "-1 m", "positive"}},
      {"box_zero", boxes("<box size=\"1 1 0\"/>"), {"'hand'", "box", "0 m"}},
      {"box_huge", boxes("<box size=\"1 1 1e6\"/>"), {"'hand'", "1e+06 m", "at most 10000 m"}},
      {"sphere_negative", boxes("<sphere radius=\"-0.5\"/>"), {"'hand'", "sphere", "-0.5 m"}},
      {"sphere_zero", boxes("<sphere radius=\"0\"/>"), {"'hand'", "sphere"}},
      {"cylinder_radius", boxes("<cylinder radius=\"-1\" length=\"1\"/>"), {"'hand'", "radius"}},
      {"cylinder_length", boxes("<cylinder radius=\"1\" length=\"0\"/>"), {"'hand'", "length"}},
      {"mesh_missing",
       boxes("<mesh filename=\"file:///no/such.stl\"/>"),
       {"'hand'", "file:///no/such.stl", "cannot be read"}},
      {"mesh_package",
       boxes("<mesh filename=\"package://no_such_package/a.stl\"/>"),
       {"'hand'", "no_such_package"}},
      {"mesh_http", boxes("<mesh filename=\"http://127.0.0.1:1/a.stl\"/>"), {"'hand'", "http://"}},
      {"mesh_scale_zero",
       boxes("<mesh filename=\"file:///a.stl\" scale=\"1 0 1\"/>"),
       {"'hand'", "scale"}},
      {"mesh_without_a_name", boxes("<mesh filename=\"\"/>"), {"'hand'", "not a URI"}},
      {"several_at_once",
       robot(link("a", collision("<sphere radius=\"-1\"/>") + collision("<box size=\"0 1 1\"/>"))),
       {"sphere", "box"}},
  };
}

INSTANTIATE_TEST_SUITE_P(table, bad, testing::ValuesIn(badRobots()),
                         [](const testing::TestParamInfo<Bad> &i) { return i.param.name; });

TEST(tolerance, bad_sizes_and_meshes_are_left_out_and_reported_if_asked_for)
{
  ModelOptions tolerant;
  tolerant.tolerate_bad_collisions = true;
  const auto model = RobotModel::fromUrdf(
      robot(link("a", collision("<sphere radius=\"-1\"/>") + collision(box) +
                          collision("<mesh filename=\"file:///no/such.stl\"/>"))),
      tolerant);
  EXPECT_EQ(model->root().collisions_used, 1);
  EXPECT_EQ(model->droppedCollisions(), 2);
  EXPECT_EQ(model->problems().size(), 2u);
}

TEST(tolerance, odd_limits_and_idle_mimics_are_reported_and_used_as_well_as_possible)
{
  const auto model = RobotModel::fromUrdf(
      robot(link("a") + link("b") + link("c") + link("d") +
            joint("j", "revolute", "a", "b",
                  axis_z + "<limit lower=\"1\" upper=\"-1\" effort=\"1\" velocity=\"1\"/>") +
            joint("k", "fixed", "a", "c") +
            joint("l", "revolute", "a", "d", axis_z + limit + mimic("k", 3, .25))));
  EXPECT_EQ(model->problems().size(), 2u);
  RobotPose pose(model);
  EXPECT_EQ(pose.value(model->findJoint("j")), 0);
  EXPECT_EQ(pose.value(model->findJoint("l")), .25);
  EXPECT_LT(
      difference(pose.links()[static_cast<size_t>(model->findLink("d"))], make({0, 0, 0}, .25)),
      1e-15);
  EXPECT_EQ(pose.missing(), std::vector<std::string>{"j"});
}

// A millimetre file without scale is the mistake that everybody makes once.
TEST(sizes, a_mesh_in_another_unit_is_told_with_its_size_and_one_beyond_reason_refused)
{
  const std::string path = testing::TempDir() + "/unit.obj";
  std::ofstream(path) << "v 0 0 0\nv 300 0 0\nv 0 400 0\nf 1 2 3\n";
  const auto hand = [&](const std::string &scale) {
    return boxes("<mesh filename=\"file://" + path + "\" scale=\"" + scale + "\"/>");
  };
  const auto millimetres = RobotModel::fromUrdf(hand("1 1 1"));
  ASSERT_EQ(millimetres->problems().size(), 1u);
  const std::string text = millimetres->problems()[0].text;
  for (const char *says : {"'hand'", path.c_str(), "500 m across", "millimetres", "0.001"})
    EXPECT_NE(text.find(says), std::string::npos) << text;
  EXPECT_TRUE(RobotModel::fromUrdf(hand("0.001 0.001 0.001"))->problems().empty());
  EXPECT_EQ(RobotModel::fromUrdf(hand("1e-9 1e-9 1e-9"))->problems().size(), 1u);
  EXPECT_NE(refusal(hand("1000 1000 1")).find("at most 10000 m"), std::string::npos);
}

// ---- robots of others ----

class ur5 : public testing::Test {
protected:
  void SetUp() override
  {
    const std::string folder = sharedData() + "/robots";
    xml = slurp(folder + "/ur5/ur5_robotiq_2f85.urdf");
    if (xml.empty()) GTEST_SKIP() << "no shared data at " << folder << "; set CLOTH_SHARED_DATA";
    const std::string path = folder + "/ur5:" + folder + "/robotiq_2f_85";
    setenv("ROS_PACKAGE_PATH", path.c_str(), 1);
  }
  std::string xml;
};

TEST_F(ur5, with_gripper_has_22_links_12_movable_and_5_mimic_joints)
{
  const auto model = RobotModel::fromUrdf(xml);
  EXPECT_EQ(model->links().size(), 22u);
  const auto &joints = model->joints();
  EXPECT_EQ(std::count_if(joints.begin(), joints.end(), [](const Joint &j) { return j.movable(); }),
            12);
  EXPECT_EQ(std::count_if(joints.begin(), joints.end(), [](const Joint &j) { return j.mimic(); }),
            5);
  EXPECT_EQ(model->droppedCollisions(), 0);
  RobotPose pose(model);
  EXPECT_EQ(pose.missing().size(), 7u);
}

TEST_F(ur5, with_gripper_moves_as_kdl_says) { expectSameAsKdl(xml, 10); }

// The sizes of the real things (m). A finger in millimetres, or a base scaled twice, is off by
// 1000.
TEST_F(ur5, meshes_have_the_size_of_the_robot)
{
  const auto model = RobotModel::fromUrdf(xml);
  // Longest edge of the box around a link [m]: from, to.
  const std::map<std::string, std::pair<double, double>> sizes = {
      {"base_link", {.15, .2}},           {"shoulder_link", {.1, .2}},
      {"upper_arm_link", {.5, .6}},       {"forearm_link", {.45, .55}},
      {"wrist_1_link", {.08, .13}},       {"wrist_2_link", {.08, .13}},
      {"wrist_3_link", {.06, .1}},        {"robotiq_arg2f_base_link", {.07, .12}},
      {"left_outer_knuckle", {.03, .07}}, {"left_outer_finger", {.04, .08}},
      {"left_inner_finger", {.03, .07}},  {"left_inner_finger_pad", {.037, .038}},
      {"left_inner_knuckle", {.04, .08}}, {"right_outer_finger", {.04, .08}}};
  for (const auto &[name, range] : sizes) {
    const int link = model->findLink(name);
    ASSERT_GE(link, 0) << name;
    const double size = model->links()[static_cast<size_t>(link)].mesh.bounds().sizes().maxCoeff();
    EXPECT_GT(size, range.first) << name;
    EXPECT_LT(size, range.second) << name;
  }
}

TEST_F(ur5, arm_at_zero_has_the_reach_of_its_data_sheet)
{
  ModelOptions kinematics;
  kinematics.load_meshes = false;
  const auto model = RobotModel::fromUrdf(xml, kinematics);
  RobotPose pose(model);
  for (const char *j : {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint",
                        "wrist_2_joint", "wrist_3_joint"})
    ASSERT_EQ(pose.set(j, 0), JointUpdate::taken) << j;
  const int wrist = model->findLink("wrist_3_link");
  ASSERT_GE(wrist, 0);
  // Universal Robots' DH table: a2 + a3 = .425 + .39225 along x; d4 = .10915 (and d6 = .0823 beyond
  // the wrist frame) along y; d1 - d5 = .089159 - .09465 in height.
  const Eigen::Vector3d p = pose.links()[static_cast<size_t>(wrist)].translation();
  EXPECT_NEAR(p.x(), .81725, 1e-6);
  EXPECT_NEAR(p.z(), .089159 - .09465, 1e-6);
}
