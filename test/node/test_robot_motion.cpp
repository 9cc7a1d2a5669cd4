// Where the robot is, from joint values and tf as drivers send them: RobotMotion without a master.
#include "robot_motion.h"

#include <gtest/gtest.h>

using namespace robot_cloth;

namespace {

const std::string urdf = R"(<robot name="r">
  <link name="odom"/><link name="base"/><link name="arm"/><link name="finger"/><link name="pad"/>
  <joint name="drive" type="planar"><parent link="odom"/><child link="base"/></joint>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.5" effort="1" velocity="1"/></joint>
  <joint name="close" type="prismatic"><parent link="arm"/><child link="finger"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.04" effort="1" velocity="1"/></joint>
  <joint name="follow" type="prismatic"><parent link="arm"/><child link="pad"/><axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.04" effort="1" velocity="1"/><mimic joint="close"/></joint>
</robot>)";

class robot_motion : public testing::Test {
protected:
  robot_motion() : motion(settings, &tf, [](auto &, auto &, auto &) {})
  {
    world.robot = RobotModel::fromUrdf(urdf);
    motion.follow(&world);
  }

  void sendTf(const std::string &parent, const std::string &child, double x, double time,
              bool fixed = false)
  {
    geometry_msgs::TransformStamped t;
    t.header.frame_id = parent, t.child_frame_id = child;
    t.header.stamp = ros::Time(time);
    t.transform.translation.x = x;
    t.transform.rotation.w = 1;
    ASSERT_TRUE(tf.setTransform(t, "test", fixed));
  }

  void sendJoints(double time, double lift, double close)
  {
    sensor_msgs::JointState m;
    m.header.stamp = ros::Time(time);
    m.name = {"lift", "close", "follow"};
    m.position = {lift, close, close};
    motion.joints.add(m, time, false);
  }

  Eigen::Vector3d at(const std::string &frame)
  {
    Pose pose = Pose::Identity();
    EXPECT_TRUE(motion.frame(frame, &pose, &why)) << why;
    return pose.translation();
  }

  bool take(double time) { return motion.take(time, false, &why); }
  std::string warnings() const
  {
    std::string text;
    for (const std::string &w : motion.warnings()) text += w + "\n";
    return text;
  }

  Settings settings;
  tf2::BufferCore tf;
  World world;
  RobotMotion motion;
  std::string why;
};

TEST_F(robot_motion, a_value_out_of_all_reach_holds_the_robot_and_the_next_one_moves_it)
{
  sendTf("world", "odom", 0, 0, true);
  sendTf("odom", "base", 1, 10);
  sendJoints(10, 0.1, 0);
  ASSERT_TRUE(take(10));
  EXPECT_TRUE(at("arm").isApprox(Eigen::Vector3d(1, 0, 0.1)));
  sendJoints(11, 1e30, 0);
  EXPECT_TRUE(take(11)) << "known, and held";
  EXPECT_TRUE(at("arm").isApprox(Eigen::Vector3d(1, 0, 0.1)));
  EXPECT_NE(motion.heldWhy().find("link arm would be at (1, 0, 1e+30) m"), std::string::npos)
      << motion.heldWhy();
  EXPECT_NE(warnings().find("held where it was: link arm"), std::string::npos) << warnings();
  sendJoints(12, 0.2, 0);
  ASSERT_TRUE(take(12));
  EXPECT_EQ(motion.heldWhy(), "");
  EXPECT_NEAR(at("arm").z(), 0.2, 1e-12);
}

TEST_F(robot_motion, a_robot_that_begins_out_of_all_reach_is_not_in_the_scene)
{
  sendTf("world", "odom", 0, 0, true);
  sendJoints(10, -1e300, 0);
  EXPECT_FALSE(take(10));
  EXPECT_NE(motion.waitingFor().find("link arm would be at"), std::string::npos);
  EXPECT_FALSE(motion.robotKnown());
}

TEST_F(robot_motion, a_planar_joint_is_waited_for_and_told_only_while_tf_does_not_know_it)
{
  sendTf("world", "odom", 0, 0, true);
  sendJoints(10, 0, 0);
  EXPECT_TRUE(motion.knownAt(10)) << "tf has never heard of base: it is not waited for";
  ASSERT_TRUE(take(10));
  EXPECT_NE(
      warnings().find("planar joint drive stays where it was: no transform from odom to base"),
      std::string::npos)
      << warnings();
  sendTf("odom", "base", 1, 9.9);
  EXPECT_FALSE(motion.knownAt(10)) << "its transform is late";
  sendTf("odom", "base", 2, 10.1);
  EXPECT_TRUE(motion.knownAt(10));
  ASSERT_TRUE(take(10));
  EXPECT_NEAR(at("base").x(), 1.5, 1e-9);
  EXPECT_EQ(warnings(), "");
}

TEST_F(robot_motion, a_value_beyond_its_limits_is_taken_and_told_with_unit_and_range)
{
  sendTf("world", "odom", 0, 0, true);
  sendTf("odom", "base", 0, 10);
  sendJoints(10, 0.2, 0.0405);
  ASSERT_TRUE(take(10));
  EXPECT_EQ(warnings(), "") << "an encoder is not that exact";
  sendJoints(11, 0.2, 4);
  sendTf("odom", "base", 0, 11);
  ASSERT_TRUE(take(11));
  EXPECT_EQ(warnings(), "joint close is at 4 m, beyond its limits [0, 0.04] m\n");
  EXPECT_NEAR(at("pad").y(), -4, 1e-12);
}

TEST_F(robot_motion, what_stops_coming_is_held_and_told_with_its_age)
{
  sendTf("world", "odom", 0, 10);
  sendTf("odom", "base", 0, 0, true);
  sendJoints(10, 0.1, 0);
  ASSERT_TRUE(take(10.5));
  EXPECT_EQ(warnings(), "");
  ASSERT_TRUE(take(13));
  EXPECT_NE(warnings().find("held for 3 s, no joint_states for close lift\n"), std::string::npos)
      << warnings();
  EXPECT_NE(warnings().find("held for 3 s, no transform from world to odom\n"), std::string::npos)
      << warnings();
  ASSERT_TRUE(motion.take(13, true, &why));
  EXPECT_EQ(warnings(), "") << "in lockstep what no request moves holds still";
}

TEST_F(robot_motion, a_joint_that_mimics_another_is_no_unknown_joint)
{
  sendJoints(10, 0, 0);
  EXPECT_EQ(motion.joints.counts.unknown_joint, 0u);
  sensor_msgs::JointState other;
  other.header.stamp = ros::Time(10);
  other.name = {"wheel"};
  other.position = {1};
  motion.joints.add(other, 10, false);
  EXPECT_EQ(motion.joints.counts.unknown_joint, 1u);
}

TEST_F(robot_motion, a_frame_that_cannot_be_used_is_named)
{
  sendTf("world", "odom", 0, 0, true);
  Pose pose = Pose::Identity();
  EXPECT_FALSE(motion.frame("hook", &pose, &why));
  EXPECT_NE(why.find("no transform from world to hook"), std::string::npos) << why;
  sendTf("world", "far", 1e30, 0, true);
  EXPECT_FALSE(motion.frame("far", &pose, &why));
  EXPECT_NE(why.find("frame far is at (1e+30, 0, 0) m"), std::string::npos) << why;
  EXPECT_TRUE(pose.isApprox(Pose::Identity())) << "what was asked for stays as it was";
}

} // namespace
