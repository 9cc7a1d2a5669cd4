// One world in time: a step with all that belongs to it, reset, states, jumps of the clock. Used by
// the simulation thread alone; knows no callbacks.
#pragma once

#include "clock.h"
#include "grasping.h"
#include "outputs.h"
#include "robot_motion.h"
#include "summary.h"
#include "world.h"

#include <map>
#include <memory>
#include <ros/publisher.h>
#include <string>
#include <vector>

namespace robot_cloth {

/// What a control request came to.
struct Answer {
  bool success = false;
  std::string message;
};

/// What /diagnostics tells; a copy is taken after every turn.
struct Health {
  bool paused = false, waiting_for_clock = false, lost = false;
  std::string paused_why, robot_waits_for, last_failure;
  std::string fell_back; // why the CPU stands in for a GPU; empty: it does not
  double real_time_factor = 0, skipped = 0, lag = 0;
  std::vector<std::string> blocking; // bodies and holds that leave the cloth no room, by name
  uint64_t teleports = 0, failures = 0, mailbox_lost = 0;
  size_t grasps = 0;
  InputCounts inputs;
  cloth_step_report report = {};
  std::vector<std::string> problems, robot_warnings;
};

class Simulation {
public:
  Simulation(const Settings &settings, const ros::NodeHandle &priv, tf2::BufferCore *tf,
             std::unique_ptr<World> world, Outputs *outputs, CrossChecker *checker);

  /// Look at the clock and do what is due. False: nothing was.
  bool turn();

  /// One step whose end is at this time of the inputs [s]. latest: take tf's newest. On failure the
  /// state is that of before; after failures_max in a row the simulation pauses. When a GPU is lost
  /// that `backend: auto` chose, the CPU goes on from the last state that there is; when nothing
  /// can go on, the simulation waits for reload().
  bool step(double end, bool latest, std::string *why);

  /// Serve a waiting cross-check, and publish what a service has changed. Between steps.
  void tend();

  Answer pause(bool on, const std::string &why);
  Answer reset(const std::string &why);
  Answer saveState(const std::string &name, std::string *path);
  Answer loadState(const std::string &name);
  Answer reload();
  Answer setObstacle(const std::string &body, const std::string &frame,
                     const geometry_msgs::Pose &pose, bool place);
  /// Something outside step() has changed what ~state or ~grasps tell.
  void touch() { touched_ = true; }
  /// The state changed other than by a step: a new epoch, and an event.
  void changed(const std::string &kind, const std::string &text);
  void event(const std::string &kind, const std::string &subject, const std::string &text);

  World &world() { return *world_; }
  RobotMotion &motion() { return motion_; }
  Grasping &grasping() { return grasping_; }
  Clock &clock() { return clock_; }
  const Settings &settings() const { return settings_; }
  cloth_scene *scene() { return world_->scene.get(); }
  double time() const { return cloth_time(world_->scene.get()); }
  ros::Time stamp() const;
  bool paused() const { return paused_; }
  bool finished() const { return finished_; } // run_duration is over, or cannot be reached
  bool lost() const { return lost_; }
  std::string summary() const;
  uint64_t stepsTaken() const { return summary_.steps(); }
  Health health() const;

private:
  void follow();
  void jumpBack();
  bool refused(cloth_status status, const cloth_error &err, std::string *why);
  void lose(const cloth_error &err, std::string *why);
  bool goOnOnCpu(const std::string &path, bool saved, std::string *why);
  void keep();
  std::string keptName() const;
  void publish(bool stepped);
  void readCloths(const Outputs::Wanted &wanted, Snapshot *s);
  void readContacts(Snapshot *s);
  void crossCheck(double margin);
  std::vector<cloth_tangle_view> tangles();
  void warnTangles();
  void tellPlacedInto();
  std::vector<std::string> blockingNames() const;
  bool statePath(const std::string &name, std::string *path, std::string *why) const;
  void claimClock();

  const Settings &settings_;
  ros::NodeHandle nh_;
  const std::string ns_;
  tf2::BufferCore *tf_;
  Outputs *outputs_;
  CrossChecker *checker_;
  std::unique_ptr<World> world_;
  RobotMotion motion_;
  Grasping grasping_;
  Clock clock_;
  Summary summary_;
  ros::Publisher clock_publisher_;
  std::shared_ptr<FclCheck> fcl_; // of this world; made when first needed
  cloth_step_report report_ = {};
  uint32_t epoch_ = 0;
  bool paused_ = false, touched_ = true, finished_ = false, lost_ = false, obstacle_moved_ = false;
  bool settled_ =
      false; // the bodies' last step ended where this one begins (no pause, jump or reset between)
  double last_end_ = 0;
  double kept_at_ = 0, keeping_took_ = 0; // wall clock, s
  bool kept_ = false;                     // there is a state of this world to go back to
  std::string paused_why_, checkpoint_, last_failure_, fell_back_;
  int failures_in_a_row_ = 0;
  uint64_t failures_ = 0;
};

} // namespace robot_cloth
