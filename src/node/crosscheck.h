// FCL beside the engine's broad phase: a low-priority thread that works on frozen snapshots. The
// engine's candidates are taken by the simulation thread; the truth is FCL's.
#pragma once

#include "fcl_check.h"
#include "settings.h"

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <robot_cloth/RunCrossCheck.h>
#include <ros/callback_queue.h>
#include <ros/publisher.h>
#include <ros/service_server.h>
#include <thread>
#include <vector>

namespace robot_cloth {

/// A state of the scene that no longer changes.
struct FrozenScene {
  std_msgs::Header header;
  int64_t step = 0;
  double margin = 0;                          // m
  double epsilon = 0;                         // m, band for float against double
  std::shared_ptr<FclCheck> fcl;              // of this world; only the cross-check thread uses it
  std::vector<std::vector<double>> positions; // per cloth
  std::vector<cloth_pose> bodies;
  std::vector<std::string> body_names, cloth_names;
  std::vector<cloth_body_pair> pairs;
};

/// Read everything a cross-check needs. Called by the simulation thread. CLOTH_... as
/// cloth_body_pairs().
cloth_status freezeScene(cloth_scene *scene, double margin, FrozenScene *out, cloth_error *err);

class CrossChecker {
public:
  CrossChecker(const ros::NodeHandle &priv, const Settings &settings);
  ~CrossChecker();

  /// Does somebody wait for a snapshot? The margin they want [m], or 0. Cheap; for the simulation
  /// thread.
  double requestedMargin() const { return requested_; }
  /// Is the thread free for a periodic check?
  bool idle() const { return idle_; }
  void submit(std::unique_ptr<FrozenScene> scene);
  /// The request cannot be met: the text goes to whoever waits.
  void refuse(const std::string &why);

  struct Totals {
    uint64_t checks = 0, missed = 0, intersecting_body = 0, intersecting_self = 0;
    double ratio = 0; // of the last check
  };
  Totals totals() const;

private:
  void run();
  bool onRequest(RunCrossCheckRequest &request, RunCrossCheckResponse &response);
  CrossCheck check(FrozenScene &scene);

  const Settings &settings_;
  ros::CallbackQueue queue_;
  ros::Publisher publisher_;
  ros::ServiceServer service_;
  std::atomic<double> requested_{0};
  std::atomic<bool> idle_{true}, stop_{false};
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::unique_ptr<FrozenScene> scene_;
  std::string refused_;
  Totals totals_;
  std::thread thread_;
};

} // namespace robot_cloth
