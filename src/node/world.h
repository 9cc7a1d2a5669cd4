// What is simulated: the engine's scene, the robot, and which body is which link. Built at start
// and by ~reload_model; owned by the simulation thread.
#pragma once

#include "engine.h"
#include "robot_model.h"
#include "settings.h"

#include <memory>
#include <string>
#include <vector>

namespace robot_cloth {

/// A body of the scene that is a link of the robot.
struct LinkBody {
  int link; // index into RobotModel::links()
  int body; // index into the scene
};

struct World {
  ScenePtr scene;
  double time_step = 0;                    // s
  bool may_be_lost = false;                // on a device that the CPU can stand in for
  std::shared_ptr<const RobotModel> robot; // null: none
  std::vector<LinkBody> links;
  std::vector<std::string> parameters; // one line each, for ~get_info
  std::vector<std::string> problems;   // of the robot model, for the log and /diagnostics

  int linkOfBody(int body) const; // link index, or -1
  int bodyOfLink(int link) const; // body index, or -1
  /// Index of a cloth by name; an empty name means the only cloth. -1, and *why, when there is
  /// none.
  int findCloth(const std::string &name, std::string *why) const;
  std::vector<std::string> clothNames() const;
};

/// An effect for logs: active or not, why, its memory and, after some steps, the time of its
/// kernels.
std::string effectText(const cloth_effect_info &effect, uint64_t steps);

/// Read the scene file and robot_description and build everything. Blocks for mesh files and, for
/// at most robot_timeout of wall time, for robot_description. StartError names what to fix; nothing
/// is left behind. on_cpu: whatever the scene and ~params say of backend and devices.
std::unique_ptr<World> loadWorld(const Settings &settings, const ros::NodeHandle &nh,
                                 const std::string &ns, bool on_cpu = false);

/// Where links wait until the robot's first valid pose: below everything, out of every cloth's way.
cloth_pose parkedPose(int link);

} // namespace robot_cloth
