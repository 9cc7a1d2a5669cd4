// The node: threads, subscriptions, and the loop of the simulation thread.
//
//   simulation thread   owns the engine; serves services and ~grasp_command between steps
//   I/O spinner         joint_states and ~grasp_command into a bounded mailbox; diagnostics timer
//   tf2 listener        its own thread
//   publisher           Outputs, on snapshots
//   cross-check         CrossChecker, low priority, on frozen snapshots
#pragma once

#include "diagnostics.h"
#include "mailbox.h"
#include "services.h"

#include <atomic>
#include <memory>
#include <mutex>
#include <ros/callback_queue.h>
#include <ros/spinner.h>
#include <ros/subscriber.h>
#include <ros/wall_timer.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>
#include <thread>
#include <variant>

namespace robot_cloth {

class ClothNode {
public:
  /// Read parameters, scene and robot. Blocks for meshes and for robot_description. StartError
  /// names the parameter, topic or file to fix. Nothing runs before start().
  ///
  /// nh    for topics of the robot (joint_states)
  /// priv  the node's private namespace
  ClothNode(const ros::NodeHandle &nh, const ros::NodeHandle &priv);
  ~ClothNode();

  void start();
  /// Is the run over (run_duration, or the scene is lost)?
  bool finished() const { return finished_; }
  /// Did it end because the engine could not go on?
  bool failed() const { return failed_; }
  /// What the run was like; after finished() or stop().
  std::string summary() const;
  /// Stop all threads; they finish the step at hand. Idempotent.
  void stop();

private:
  struct ReceivedJoints {
    sensor_msgs::JointState::ConstPtr message;
  };
  using Mail = std::variant<ReceivedJoints, GraspCommand::ConstPtr>;

  void run();
  void readMail();
  void remember();

  ros::NodeHandle nh_, priv_;
  const Settings settings_;
  tf2_ros::Buffer tf_;
  tf2_ros::TransformListener tf_listener_;
  ros::CallbackQueue io_queue_, control_queue_;
  Mailbox<Mail> mailbox_{2048};
  std::unique_ptr<Outputs> outputs_;
  std::unique_ptr<CrossChecker> checker_;
  std::unique_ptr<Simulation> simulation_; // the simulation thread's once started
  std::unique_ptr<Services> services_;
  std::unique_ptr<ros::AsyncSpinner> io_spinner_;
  ros::Subscriber joints_, commands_;
  ros::Publisher diagnostics_;
  ros::WallTimer diagnostics_timer_;
  std::atomic<bool> stop_{false}, finished_{false}, failed_{false};
  mutable std::mutex health_mutex_;
  Health health_;
  std::string summary_;
  ros::WallTime last_turn_;
  std::thread thread_;
};

} // namespace robot_cloth
