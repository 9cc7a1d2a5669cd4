// What changes a running simulation from outside: pause, reset, states, reload, obstacles.
#include "simulation.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <ros/console.h>

namespace robot_cloth {

void Simulation::changed(const std::string &kind, const std::string &text)
{
  epoch_++;
  event(kind, "", text);
  touched_ = true;
}

Answer Simulation::pause(bool on, const std::string &why)
{
  const bool was = paused_;
  paused_ = on;
  paused_why_ = on ? why : "";
  if (was == on) return {true, on ? "paused already" : "running already"};
  failures_in_a_row_ = 0;
  settled_ = false;
  clock_.restart();
  event("pause", "", on ? "paused: " + why : "running");
  touched_ = true;
  return {true, on ? "paused at " + std::to_string(time()) + " s"
                   : "running from " + std::to_string(time()) + " s"};
}

Answer Simulation::reset(const std::string &why)
{
  cloth_error err = {};
  if (cloth_reset(scene(), &err) != CLOTH_OK) return {false, err.text};
  report_ = {};
  grasping_.forgetDead();
  grasping_.forgetGrippers();
  if (clock_.lockstep())
    motion_.forgetInputs(); // the same requests shall give the same states again
  motion_.forgetPlacement();
  settled_ = false;
  failures_in_a_row_ = 0;
  clock_.restart();
  changed("reset", why);
  return {true, "at the start again, epoch " + std::to_string(epoch_)};
}

bool Simulation::statePath(const std::string &name, std::string *path, std::string *why) const
{
  namespace fs = std::filesystem;
  const bool plain =
      !name.empty() && name[0] != '.' && name.size() <= 200 &&
      name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-") ==
          std::string::npos;
  if (!plain) {
    *why = "name is '" + name +
           "', but must be a file name of letters, digits and . _ - (no path: states stay in "
           "the state folder)";
    return false;
  }
  fs::path folder = settings_.state_folder;
  if (folder.empty()) {
    const char *ros = std::getenv("ROS_HOME"), *home = std::getenv("HOME");
    folder = ros ? fs::path(ros) : fs::path(home ? home : "/") / ".ros";
    folder /= "robot_cloth";
  }
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    *why = "state folder " + folder.string() + ": " + error.message() + "; set parameter " + ns_ +
           "/state_folder";
    return false;
  }
  *path = (folder / name).string();
  return true;
}

Answer Simulation::saveState(const std::string &name, std::string *path)
{
  cloth_error err = {};
  std::string why;
  if (!statePath(name, path, &why)) return {false, why};
  if (cloth_state_save(scene(), path->c_str(), &err) != CLOTH_OK) return {false, err.text};
  if (!grasping_.save(*path + ".grasps")) return {false, "cannot write " + *path + ".grasps"};
  checkpoint_ = name;
  return {true, "state at " + std::to_string(time()) + " s is in " + *path};
}

Answer Simulation::loadState(const std::string &name)
{
  cloth_error err = {};
  std::string path, why;
  if (!statePath(name, &path, &why)) return {false, why};
  if (cloth_state_load(scene(), path.c_str(), &err) != CLOTH_OK) return {false, err.text};
  grasping_.load(path + ".grasps");
  motion_.forgetPlacement();
  settled_ = false;
  failures_in_a_row_ = 0;
  clock_.restart();
  changed("load", path);
  return {true, "at " + std::to_string(time()) + " s of " + path};
}

Answer Simulation::reload()
{
  std::unique_ptr<World> fresh;
  try {
    fresh = loadWorld(settings_, nh_, ns_);
  } catch (const StartError &e) {
    return {false, std::string(e.what()) + "; what ran before goes on"};
  }
  world_.swap(fresh);
  follow();
  failures_in_a_row_ = 0;
  clock_.restart();
  changed("reload", settings_.scene_file);
  return {true, "scene and robot were read anew"};
}

Answer Simulation::setObstacle(const std::string &name, const std::string &frame,
                               const geometry_msgs::Pose &pose, bool place)
{
  const int body = cloth_body_find(scene(), name.c_str());
  if (body < 0) {
    std::string known;
    for (int i = 0; i < cloth_body_count(scene()); i++)
      if (world_->linkOfBody(i) < 0) known += std::string(" ") + cloth_body_name(scene(), i);
    return {false, "there is no body '" + name + "'; there is:" + known};
  }
  if (world_->linkOfBody(body) >= 0)
    return {false, name + " is a link of the robot: it moves with joint_states"};
  Pose parent, local;
  std::string why;
  if (!motion_.frame(frame, &parent, &why)) return {false, why};
  if (!readPose(pose, &local))
    return {false, "pose is not finite or its quaternion is not of unit length"};
  const cloth_pose target = toCloth(parent * local);
  cloth_error err = {};
  const cloth_status status = place ? cloth_body_place(scene(), body, &target, &err)
                                    : cloth_body_move(scene(), body, &target, &err);
  if (status != CLOTH_OK) return {false, err.text};
  event("set", name, place ? "placed" : "moves in the next step");
  obstacle_moved_ = touched_ = true;
  return {true, place ? "placed" : "moves there in the next step"};
}

} // namespace robot_cloth
