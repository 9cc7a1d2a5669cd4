// Where the robot and every other frame are at a time, and how that moves bodies: joints from
// joint_states through our own forward kinematics, world -> root and frames that are not in the
// URDF from tf, or from the request in lockstep.
#pragma once

#include "inputs.h"
#include "pose.h"
#include "world.h"

#include <functional>
#include <geometry_msgs/TransformStamped.h>
#include <map>
#include <memory>
#include <string>
#include <tf2/buffer_core.h>
#include <vector>

namespace robot_cloth {

/// A frame's name without the leading slash that tf1 users still write.
std::string bareFrame(const std::string &frame);

/// kind, subject, text: as in msg/Event.
using EventSink =
    std::function<void(const std::string &, const std::string &, const std::string &)>;

class RobotMotion {
public:
  RobotMotion(const Settings &settings, const tf2::BufferCore *tf, EventSink events);

  /// Follow this world's robot from now on; forgets joints and placement.
  void follow(const World *world);

  JointHistory joints;

  /// Transforms of a lockstep request; they stay until replaced or forgotten. False: not finite,
  /// named.
  bool setFrames(const std::vector<geometry_msgs::TransformStamped> &frames, std::string *why);

  /// Is everything known up to a time? Without a robot always.
  bool knownAt(double time) const;

  /// Take the pose of everything at a time [s]; false, and why, while a joint or world -> root is
  /// not known. What is known only up to an earlier time is held. latest: take the newest of tf
  /// whatever its stamp.
  bool take(double time, bool latest, std::string *why);

  /// Move the bodies of the robot to the poses taken; place them the first time, and when a link is
  /// faster than the speed limit over `elapsed` [s].
  cloth_status moveBodies(cloth_scene *scene, double elapsed, cloth_error *err);

  /// World pose of a frame at the time taken last. False, and why: nobody knows the frame.
  bool frame(const std::string &name, Pose *out, std::string *why) const;

  /// Value of a joint at the time taken last [rad or m]; mimic joints too. False: not known.
  bool jointValue(const std::string &name, double *value) const;

  /// The next bodies are placed, not moved: after a reset, a jump, a load.
  void forgetPlacement() { placed_ = false; }
  /// Joints and request frames, too: what was heard belongs to another time.
  void forgetInputs();

  bool placed() const { return placed_; }
  bool robotKnown() const { return known_; }
  const std::string &waitingFor() const
  {
    return waiting_for_;
  } // why the robot is not known; empty: it is
  /// Why the robot was held at the time taken last though its joints are known; empty: it was not.
  const std::string &heldWhy() const { return held_why_; }
  /// What is wrong with the robot's inputs at the time taken last, a sentence each: values beyond
  /// limits, joints and transforms that stopped coming, planar and floating joints without tf.
  std::vector<std::string> warnings() const;
  uint64_t teleports() const { return teleports_; }
  uint64_t placements() const { return placements_; } // teleports and what else placed the bodies

private:
  bool rootPose(Pose *out, std::string *why);
  bool tfPose(const std::string &frame, Pose *out, std::string *why) const;
  bool lookup(const std::string &parent, const std::string &child, Pose *out, std::string *why,
              double *age = nullptr) const;
  bool tfKnownAt(const std::string &parent, const std::string &child, double time) const;
  std::string outOfReach() const;
  bool findFrame(const std::string &name, int depth, Pose *out, std::string *why) const;
  std::string tooFast(double elapsed) const;

  struct RequestFrame {
    std::string parent;
    Pose pose;
  };
  const Settings &settings_;
  const tf2::BufferCore *tf_;
  EventSink events_;
  const World *world_ = nullptr;
  std::unique_ptr<RobotPose> robot_;
  std::map<std::string, RequestFrame> request_frames_;
  double time_ = 0;
  bool latest_ = false, known_ = false, placed_ = false;
  std::string waiting_for_, held_why_;
  double root_age_ = 0;                // s; of world -> root at the time taken last
  std::vector<std::string> not_in_tf_; // planar and floating joints
  Pose root_ = Pose::Identity();
  std::vector<Pose> links_, links_before_, links_next_; // world frame; of the model's links
  uint64_t teleports_ = 0, placements_ = 0;
};

} // namespace robot_cloth
