// What changes a running simulation from outside: pause, reset, states, reload, obstacles.
#include "simulation.h"

#include <algorithm>
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
  fell_back_.clear();
  failures_in_a_row_ = 0;
  clock_.restart();
  changed("reload", settings_.scene_file);
  return {true, "scene and robot were read anew"};
}

// ---- a device that is lost ---------------------------------------------------------------------

std::string Simulation::keptName() const
{
  std::string name = "last_good" + ns_;
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

// what a lost GPU held is gone; at most a fiftieth of the time goes into this
void Simulation::keep()
{
  const double now = ros::SteadyTime::now().toSec();
  const double pause = std::max(settings_.keep_every, 50 * keeping_took_);
  if (!world_->may_be_lost || settings_.keep_every == 0 || (kept_ && now - kept_at_ < pause))
    return;
  std::string path, why;
  cloth_error err = {};
  kept_ = statePath(keptName(), &path, &why) &&
          cloth_state_save(scene(), path.c_str(), &err) == CLOTH_OK &&
          grasping_.save(path + ".grasps");
  if (!kept_) ROS_WARN_STREAM_THROTTLE(60, "the state cannot be kept: " << why << err.text);
  kept_at_ = ros::SteadyTime::now().toSec();
  keeping_took_ = kept_at_ - now;
}

// the engine takes no further step, but may still know its last state
void Simulation::lose(const cloth_error &err, std::string *why)
{
  std::string path, no_path;
  cloth_error unsaved = {};
  const bool has_path = statePath(keptName(), &path, &no_path);
  const bool saved = has_path && cloth_state_save(scene(), path.c_str(), &unsaved) == CLOTH_OK &&
                     grasping_.save(path + ".grasps");
  *why = err.text;
  const bool device = err.status == CLOTH_DEVICE_LOST || err.status == CLOTH_NO_MEMORY;
  if (device && world_->may_be_lost && goOnOnCpu(saved || kept_ ? path : "", saved, why)) return;
  lost_ = true;
  if (settings_.run_duration > 0) finished_ = true; // somebody waits for its end
  if (saved || kept_)
    *why += "; its last state" + std::string(saved ? "" : " that was kept") + " is in " + path;
  last_failure_ = *why;
  ROS_FATAL_STREAM("the scene is lost: " << *why << "; ~reload_model starts anew");
  event("fallback", "", "the scene is lost: " + *why);
  touched_ = false; // nobody knows what it would tell
}

bool Simulation::goOnOnCpu(const std::string &path, bool saved, std::string *why)
{
  const double lost_at = time();
  std::unique_ptr<World> fresh;
  cloth_error err = {};
  try {
    fresh = loadWorld(settings_, nh_, ns_, true);
  } catch (const StartError &e) {
    *why += std::string("; the CPU cannot stand in: ") + e.what();
    return false;
  }
  world_.swap(fresh);
  follow();
  const bool loaded = !path.empty() && cloth_state_load(scene(), path.c_str(), &err) == CLOTH_OK;
  if (loaded)
    grasping_.load(path + ".grasps");
  else
    cloth_reset(scene(), nullptr);
  motion_.forgetPlacement();
  failures_in_a_row_ = 0;
  clock_.restart();
  const std::string from = !loaded
                               ? std::string(" from the start: no state was left")
                               : " from its " + std::string(saved ? "last" : "kept") +
                                     " state at " + std::to_string(time()) + " s (" + path + ")";
  fell_back_ =
      "the GPU failed at " + std::to_string(lost_at) + " s (" + *why + "); the CPU goes on" + from;
  *why = fell_back_;
  ROS_ERROR_STREAM(fell_back_);
  changed("fallback", fell_back_);
  return true;
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
