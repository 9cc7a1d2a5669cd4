// Joint states over time: what came in, checked, and the robot's joints at any time.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <sensor_msgs/JointState.h>
#include <set>
#include <string>
#include <vector>

namespace robot_cloth {

/// What was wrong with the messages so far; published in /diagnostics.
struct InputCounts {
  uint64_t messages = 0;
  uint64_t unequal_length = 0; // names and positions differ: whole message refused
  uint64_t not_finite = 0;     // joint left out
  uint64_t unknown_joint = 0;  // no joint of this robot: left out
  uint64_t stamp_zero = 0;     // time of receipt taken instead
  uint64_t stamp_old = 0;      // older than what the joint has: left out
  uint64_t stamp_future = 0;   // of the previous pass of a bag, or a wrong clock: refused
  uint64_t held = 0;           // steps that went on with old joints
  std::string refused_why;     // what was wrong the last time that something was refused
};

/// The recent past of every joint. Not thread-safe: the simulation thread owns it.
class JointHistory {
public:
  /// The joints that must have a value; forgets all values. Joints in `wrapping` have no limits:
  /// their values are taken modulo a full turn. Joints in `idle` are the robot's, too, but have no
  /// value of their own (mimic, fixed): drivers send them all the same. Others count as unknown.
  void need(const std::vector<std::string> &joints, const std::vector<std::string> &wrapping,
            const std::vector<std::string> &idle = {});

  /// Take a message. `now` is the present time of the clock that stamps [s]; a message that is more
  /// than future_max ahead of it is refused. use_receipt: stamps are of another clock, take `now`.
  void add(const sensor_msgs::JointState &message, double now, bool use_receipt);

  /// Set one joint at one time, unchecked (lockstep).
  void set(const std::string &joint, double time, double position);

  /// Does every joint have a value?
  bool complete() const { return missing_.empty(); }
  const std::set<std::string> &missing() const { return missing_; }

  /// Time up to which every joint is known [s]; -infinity before the robot is complete.
  double knownUntil() const;

  /// Joints whose newest value is older than `time` [s].
  std::vector<std::string> olderThan(double time) const;

  /// Value of a joint at a time: interpolated, held before the first and after the last sample.
  /// false: never heard of.
  bool at(const std::string &joint, double time, double *position) const;

  /// Forget all values, as after a backward jump of the clock.
  void clear();

  InputCounts counts;
  static constexpr double future_max = 0.5; // s
  static constexpr double memory = 3.0;     // s of samples that are kept

private:
  void refuse(const std::string &why);

  struct Sample {
    double time, position;
  };
  std::map<std::string, std::deque<Sample>> joints_; // needed joints only
  std::set<std::string> missing_, wrapping_, idle_;
};

} // namespace robot_cloth
