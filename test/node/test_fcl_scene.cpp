// FCL's picture of a scene is the engine's, and the engine's broad phase misses nothing that FCL
// sees.
#include "node/fcl_check.h"
#include "node/link_meshes.h"

#include <gtest/gtest.h>
#include <limits>
#include <memory>

using namespace robot_cloth;

namespace {

struct SceneFree {
  void operator()(cloth_scene *s) const { cloth_scene_free(s); }
};
struct DefFree {
  void operator()(cloth_def *d) const { cloth_def_free(d); }
};
using ScenePtr = std::unique_ptr<cloth_scene, SceneFree>;

constexpr double box_top = .1;

// A 30 cm sheet of 13 x 13 vertices above a small box and beside a ball.
ScenePtr makeScene(double height)
{
  constexpr int n = 13;
  TriangleMesh sheet;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) sheet.vertices.emplace_back(.025 * i - .15, .025 * j - .15, 0);
  for (int i = 0; i + 1 < n; i++)
    for (int j = 0; j + 1 < n; j++) {
      const int a = i * n + j;
      sheet.triangles.emplace_back(a, a + n, a + 1);
      sheet.triangles.emplace_back(a + n, a + n + 1, a + 1);
    }
  cloth_error err = {};
  cloth_def *raw = nullptr;
  EXPECT_EQ(cloth_def_new(&raw, &err), CLOTH_OK) << err.text;
  const std::unique_ptr<cloth_def, DefFree> def(raw);
  cloth_cloth_view cloth = {};
  cloth.name = "sheet";
  cloth.mesh = sheet.view();
  cloth.material = cloth_material_default();
  cloth.pose = cloth_pose_identity();
  cloth.pose.position[2] = height;
  EXPECT_EQ(cloth_def_add_cloth(def.get(), &cloth, nullptr, &err), CLOTH_OK) << err.text;
  const TriangleMesh meshes[] = {boxMesh({.1, .1, .1}), sphereMesh(.03, 12)};
  const double place[][3] = {{0, 0, box_top - .05}, {.1, .1, .05}};
  for (int b = 0; b < 2; b++) {
    cloth_body_view body = {};
    body.name = b ? "ball" : "box";
    body.mesh = meshes[b].view();
    body.pose = cloth_pose_identity();
    std::copy(place[b], place[b] + 3, body.pose.position);
    body.friction = .5;
    EXPECT_EQ(cloth_def_add_body(def.get(), &body, nullptr, &err), CLOTH_OK) << err.text;
  }
  cloth_scene *scene = nullptr;
  EXPECT_EQ(cloth_scene_new(def.get(), &scene, &err), CLOTH_OK) << err.text;
  return ScenePtr(scene);
}

std::vector<cloth_body_pair> enginePairs(cloth_scene *scene, double margin)
{
  cloth_error err = {};
  int count = 0;
  EXPECT_EQ(cloth_body_pairs(scene, margin, nullptr, 0, &count, &err), CLOTH_OK) << err.text;
  std::vector<cloth_body_pair> pairs(static_cast<size_t>(count));
  EXPECT_EQ(cloth_body_pairs(scene, margin, pairs.data(), count, &count, &err), CLOTH_OK)
      << err.text;
  return pairs;
}

} // namespace

TEST(scene, is_seen_where_the_engine_has_it)
{
  const ScenePtr scene = makeScene(box_top + .004);
  ASSERT_TRUE(scene);
  const FclCheck check = FclCheck::fromScene(scene.get());
  EXPECT_EQ(check.bodyCount(), 2);
  EXPECT_EQ(check.clothCount(), 1);
  // Of the box's top only, and 4 mm away: the ball's top is 24 mm below the sheet.
  EXPECT_EQ(check.compare(.0039, 0, nullptr, 0).truth, 0);
  const PairComparison near = check.compare(.0041, 0, nullptr, 0);
  EXPECT_GT(near.truth, 0);
  for (const MissedPair &m : near.missed) {
    EXPECT_EQ(m.pair.body, 0);
    EXPECT_NEAR(m.distance, .004, 1e-7); // positions may be float inside the engine
  }
  EXPECT_EQ(check.intersections().cloth_body, 0);
}

TEST(scene, has_all_of_fcls_pairs_in_the_engines_broad_phase_while_bodies_move)
{
  const ScenePtr scene = makeScene(box_top + .01);
  ASSERT_TRUE(scene);
  FclCheck check = FclCheck::fromScene(scene.get());
  cloth_error err = {};
  int64_t truth = 0;
  for (int step = 1; step <= 20; step++) {
    cloth_pose pose = cloth_pose_identity();
    pose.position[0] = .1 - .004 * step;
    pose.position[1] = .1;
    pose.position[2] = .05 + .003 * step;
    ASSERT_EQ(cloth_body_move(scene.get(), 1, &pose, &err), CLOTH_OK) << err.text;
    // The box tilts, so that rotations count too.
    const Eigen::Quaterniond tilt(
        Eigen::AngleAxisd(.03 * step, Eigen::Vector3d(1, .5, 2).normalized()));
    cloth_pose box = cloth_pose_identity();
    box.position[2] = box_top - .05;
    std::copy(tilt.coeffs().data(), tilt.coeffs().data() + 4, box.rotation); // x y z w, both
    ASSERT_EQ(cloth_body_move(scene.get(), 0, &box, &err), CLOTH_OK) << err.text;
    ASSERT_EQ(cloth_step(scene.get(), .01, nullptr, &err), CLOTH_OK) << err.text;
    check.update(scene.get());
    const double margin = .01;
    const std::vector<cloth_body_pair> pairs = enginePairs(scene.get(), margin);
    // Float positions of some decimetres: 1e-6 is some thirty of their steps.
    const PairComparison c =
        check.compare(margin, 1e-6, pairs.data(), static_cast<int>(pairs.size()));
    EXPECT_TRUE(c.contained()) << "step " << step << ": " << c.missed_count << " of " << c.truth;
    truth += c.truth;
  }
  EXPECT_GT(truth, 100); // it was about something
}

TEST(scene, of_another_shape_is_refused)
{
  const ScenePtr scene = makeScene(.2);
  ASSERT_TRUE(scene);
  FclCheck other;
  EXPECT_THROW(other.update(scene.get()), std::invalid_argument);
}
