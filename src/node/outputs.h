// Publishers, and the thread that serves them from snapshots. What has no subscriber is neither
// read from the engine nor built.
#pragma once

#include "settings.h"
#include "snapshot.h"
#include "world.h"

#include <atomic>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <ros/publisher.h>
#include <thread>

namespace robot_cloth {

class Outputs {
public:
  Outputs(const ros::NodeHandle &priv, const Settings &settings);
  ~Outputs();

  /// Advertise and latch what belongs to this world. Called by the simulation thread.
  void follow(const World &world);
  /// Latch ~collision_markers again: a body that is no link was moved.
  void publishBodies(const World &world);

  /// What the next snapshot should hold; cheap. Marks rate-limited topics as served.
  struct Wanted {
    bool stream, markers, velocities, contacts, wrenches;
    bool positions() const { return stream || markers; }
  };
  Wanted wanted();

  /// Hand over. When the publisher is behind: wait (lockstep, where a test counts on every
  /// message), or let the oldest snapshot go and count it.
  void post(std::unique_ptr<Snapshot> snapshot, bool wait);

  /// Publish an event now. From any thread.
  void event(const Event &event);

  std::shared_ptr<const std::vector<ClothShape>> shapes() const { return shapes_; }
  uint64_t dropped() const { return dropped_; }
  uint64_t notFinite() const { return not_finite_; }

private:
  struct ClothTopics {
    ros::Publisher vertices, topology, mesh;
  };
  void run();
  void publish(const Snapshot &s);
  void publishCloth(const Snapshot &s, size_t cloth, const ClothTopics &topics);
  void publishGrasps(const Snapshot &s);
  bool finite(const ClothFrame &f);

  ros::NodeHandle nh_;
  const Settings &settings_;
  ros::Publisher state_, markers_, collision_markers_, grasps_, contacts_, events_;
  std::shared_ptr<const std::vector<ClothShape>> shapes_;
  mutable std::mutex topics_mutex_; // cloths_ and wrenches_: reload against publishing
  std::vector<ClothTopics> cloths_;
  std::map<std::string, ros::Publisher> wrenches_; // by grasp id
  ros::WallTime next_stream_, next_markers_;
  size_t marked_cloths_ = 0;

  std::mutex mutex_;
  std::condition_variable wake_, room_;
  std::deque<std::unique_ptr<Snapshot>> queue_;
  bool stop_ = false;
  std::atomic<uint64_t> dropped_{0}, not_finite_{0};
  std::thread thread_;
};

} // namespace robot_cloth
