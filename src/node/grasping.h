// Grasps: who holds which vertices, by command or by a closing gripper.
#pragma once

#include "robot_motion.h"

#include <geometry_msgs/WrenchStamped.h>
#include <robot_cloth/GraspRequest.h>
#include <robot_cloth/GraspResponse.h>
#include <robot_cloth/Grasps.h>
#include <robot_cloth/ReleaseResponse.h>
#include <string>
#include <vector>

namespace robot_cloth {

class Grasping {
public:
  Grasping(const Settings &settings, const RobotMotion &motion, EventSink events);

  /// Hold vertices of this world's cloths from now on; forgets all grasps.
  void follow(const World *world);

  /// Hold what the request picks. Says why it failed, with the distance to the nearest vertex where
  /// that helps. `gripper`: the automatic gripper that asks, or empty.
  GraspResponse grasp(const GraspRequest &request, const std::string &gripper = "");

  /// Let go of one grasp, of all of a frame, or of all (both empty). What is not held is fine.
  ReleaseResponse release(const std::string &id, const std::string &frame);

  /// Tell the engine where the frames that are no bodies will be at the end of the next step.
  cloth_status moveFrames(cloth_error *err);

  /// After a step: notice grasps that broke.
  void noticeBroken();

  /// After a step: close and open the automatic grippers.
  void runGrippers();

  /// After cloth_reset() or a load: forget what no longer holds.
  void forgetDead();
  /// Grippers start anew: one that is closed has to open before it grasps.
  void forgetGrippers();

  /// Write, read the names of the grasps beside a state file; the engine keeps what they hold.
  bool save(const std::string &path) const;
  void load(const std::string &path);

  Grasps message() const;
  /// Wrench that each grasp exerts on the cloth, in the grasp's frame; in the order of message().
  std::vector<geometry_msgs::WrenchStamped> wrenches() const;

  size_t count() const { return held_.size(); }
  /// Has the list changed since the last call?
  bool changed();

private:
  struct Held {
    std::string id, frame, gripper;
    cloth_grasp_id handle;
    int cloth, body;
    Pose pose; // of the frame in the world, now
    double stiffness, break_force;
    std::vector<int> vertices;
  };
  struct Gripper {
    GripperSettings settings;
    enum { unknown, open, closed } state = unknown;
    bool complained = false;
  };
  struct Pick {
    std::vector<int> vertices;
    std::string note; // what a message should add
  };

  bool pick(const GraspRequest &r, int cloth, Pick *out, std::string *why) const;
  bool pickRegion(const GraspRequest &r, int cloth, Pick *out, std::string *why) const;
  bool pickIds(const GraspRequest &r, int cloth, Pick *out, std::string *why) const;
  bool ignoredBodies(const GraspRequest &r, std::vector<int> *out, std::string *why) const;
  bool hold(const GraspRequest &r, int cloth, Pick pick, Held *held, std::string *why);
  void closeGripper(const GripperSettings &g);
  std::string holderOf(int cloth, int vertex) const;

  const Settings &settings_;
  const RobotMotion &motion_;
  EventSink events_;
  const World *world_ = nullptr;
  std::vector<Held> held_; // in the order of grasping
  std::vector<Gripper> grippers_;
  bool changed_ = true;
  int next_id_ = 1;
};

} // namespace robot_cloth
