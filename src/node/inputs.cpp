#include "inputs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ros/console.h>

namespace robot_cloth {

void JointHistory::need(const std::vector<std::string> &joints,
                        const std::vector<std::string> &wrapping,
                        const std::vector<std::string> &idle)
{
  idle_ = std::set<std::string>(idle.begin(), idle.end());
  wrapping_ = std::set<std::string>(wrapping.begin(), wrapping.end());
  joints_.clear();
  for (const std::string &j : joints) joints_[j];
  clear();
}

void JointHistory::clear()
{
  missing_.clear();
  for (auto &j : joints_) {
    j.second.clear();
    missing_.insert(j.first);
  }
}

void JointHistory::refuse(const std::string &why)
{
  counts.refused_why = why;
  ROS_WARN_STREAM_THROTTLE(5, "joint_states: " << why);
}

void JointHistory::add(const sensor_msgs::JointState &m, double now, bool use_receipt)
{
  counts.messages++;
  if (m.name.size() != m.position.size()) {
    counts.unequal_length++;
    refuse(std::to_string(m.name.size()) + " names but " + std::to_string(m.position.size()) +
           " positions: message refused");
    return;
  }
  double time = m.header.stamp.toSec();
  if (use_receipt)
    time = now;
  else if (m.header.stamp.isZero()) {
    counts.stamp_zero++;
    time = now;
  }
  if (time > now + future_max) {
    counts.stamp_future++;
    refuse("stamp is " + std::to_string(time - now) + " s in the future, at most " +
           std::to_string(future_max) + " s: message refused");
    return;
  }
  for (size_t i = 0; i < m.name.size(); i++) {
    auto joint = joints_.find(m.name[i]);
    if (joint == joints_.end())
      counts.unknown_joint += idle_.count(m.name[i]) == 0;
    else if (!std::isfinite(m.position[i])) {
      counts.not_finite++;
      refuse(m.name[i] + " is not finite: held");
    } else if (!joint->second.empty() && time <= joint->second.back().time) {
      if (time < joint->second.back().time) counts.stamp_old++;
    } else
      set(m.name[i], time, m.position[i]);
  }
}

void JointHistory::set(const std::string &name, double time, double position)
{
  auto joint = joints_.find(name);
  if (joint == joints_.end()) return;
  std::deque<Sample> &samples = joint->second;
  while (!samples.empty() && samples.back().time >= time) samples.pop_back();
  if (!samples.empty() && wrapping_.count(name)) // drivers wrap at pi: go the short way
    position += 2 * M_PI * std::round((samples.back().position - position) / (2 * M_PI));
  samples.push_back({time, position});
  // the second sample stays until the first is of no use for any time in the memory
  while (samples.size() > 2 && samples[1].time < time - memory) samples.pop_front();
  missing_.erase(name);
}

double JointHistory::knownUntil() const
{
  double time = std::numeric_limits<double>::infinity();
  for (const auto &j : joints_)
    time = std::min(time, j.second.empty() ? -std::numeric_limits<double>::infinity()
                                           : j.second.back().time);
  return time;
}

std::vector<std::string> JointHistory::olderThan(double time) const
{
  std::vector<std::string> names;
  for (const auto &j : joints_)
    if (!j.second.empty() && j.second.back().time < time) names.push_back(j.first);
  return names;
}

bool JointHistory::at(const std::string &name, double time, double *position) const
{
  auto joint = joints_.find(name);
  if (joint == joints_.end() || joint->second.empty()) return false;
  const std::deque<Sample> &s = joint->second;
  auto after = std::lower_bound(s.begin(), s.end(), time,
                                [](const Sample &a, double t) { return a.time < t; });
  if (after == s.end())
    *position = s.back().position;
  else if (after == s.begin() || after->time == time) // exact, whatever came before it
    *position = after->position;
  else {
    const Sample &a = *(after - 1), &b = *after;
    *position = a.position + (b.position - a.position) * ((time - a.time) / (b.time - a.time));
  }
  return true;
}

} // namespace robot_cloth
