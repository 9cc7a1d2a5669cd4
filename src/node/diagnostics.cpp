#include "diagnostics.h"

#include <ros/time.h>
#include <sstream>

namespace robot_cloth {
namespace {

using diagnostic_msgs::DiagnosticStatus;

struct Entry {
  DiagnosticStatus status;
  Entry(const std::string &node, const char *name)
  {
    status.name = node + ": " + name;
    status.hardware_id = "robot_cloth";
    status.message = "ok";
  }
  void raise(signed char level, const std::string &text)
  {
    if (level < status.level) return;
    status.message = status.level == DiagnosticStatus::OK ? text : status.message + "; " + text;
    status.level = level;
  }
  template <class T> void value(const char *key, const T &v)
  {
    std::ostringstream text;
    text << v;
    diagnostic_msgs::KeyValue kv;
    kv.key = key;
    kv.value = text.str();
    status.values.push_back(kv);
  }
};

Entry timeEntry(const Health &h, double since_turn, const std::string &node)
{
  Entry e(node, "time");
  if (h.waiting_for_clock)
    e.raise(DiagnosticStatus::WARN,
            "waiting for /clock: use_sim_time is true and nobody has published it");
  if (h.paused) e.raise(DiagnosticStatus::WARN, "paused: " + h.paused_why);
  if (h.skipped > 0) e.raise(DiagnosticStatus::WARN, "slower than the clock: time was skipped");
  if (since_turn > 5)
    e.raise(DiagnosticStatus::WARN, "the simulation thread has been busy for a long time");
  e.value("simulated [s]", h.report.time);
  e.value("real-time factor", h.real_time_factor);
  e.value("behind the clock [s]", h.lag);
  e.value("skipped [s]", h.skipped);
  return e;
}

Entry engineEntry(const Health &h, const std::string &node)
{
  Entry e(node, "engine");
  if (h.failures > 0)
    e.raise(DiagnosticStatus::WARN, "steps were refused, last: " + h.last_failure);
  if (h.report.pcg_unconverged > 0)
    e.raise(DiagnosticStatus::WARN, "a linear solve gave up in the last step");
  if (h.report.impacts_left > 0)
    e.raise(DiagnosticStatus::WARN, "pairs pass through in the last step");
  if (!h.blocking.empty()) {
    std::string names;
    for (const std::string &name : h.blocking) names += (names.empty() ? "" : ", ") + name;
    e.raise(DiagnosticStatus::WARN, "bodies or holds leave the cloth no room: " + names);
  }
  if (h.report.tangles > 0)
    e.raise(DiagnosticStatus::WARN, std::to_string(h.report.tangles) +
                                        " pairs of triangles intersect (parameter untangle)");
  if (!h.fell_back.empty()) e.raise(DiagnosticStatus::WARN, h.fell_back);
  if (h.lost) e.raise(DiagnosticStatus::ERROR, "the scene is lost: " + h.last_failure);
  e.value("step", h.report.step);
  e.value("wall [ms]", h.report.wall_ms);
  e.value("substeps", h.report.substeps);
  e.value("linear iterations", h.report.pcg_iterations);
  e.value("contacts", h.report.contacts_self + h.report.contacts_body);
  e.value("intersecting pairs", h.report.tangles);
  e.value("worst stretch", h.report.stretch_max);
  e.value("grasps", h.grasps);
  e.value("refused steps", h.failures);
  e.value("memory [B]", h.report.memory_bytes);
  return e;
}

Entry robotEntry(const Health &h, const std::string &node)
{
  Entry e(node, "robot");
  if (!h.robot_waits_for.empty())
    e.raise(DiagnosticStatus::WARN, "not in the scene: " + h.robot_waits_for);
  for (const std::string &w : h.robot_warnings) e.raise(DiagnosticStatus::WARN, w);
  for (const std::string &p : h.problems) e.raise(DiagnosticStatus::WARN, p);
  const InputCounts &i = h.inputs;
  if (i.unequal_length + i.not_finite + i.stamp_future > 0)
    e.raise(DiagnosticStatus::WARN, "joint_states were refused, last: " + i.refused_why);
  if (h.mailbox_lost > 0)
    e.raise(DiagnosticStatus::WARN, "messages were lost: the simulation thread was too slow");
  e.value("joint_states", i.messages);
  e.value("unequal lengths", i.unequal_length);
  e.value("not finite", i.not_finite);
  e.value("unknown joints", i.unknown_joint);
  e.value("stamp zero", i.stamp_zero);
  e.value("stamp old", i.stamp_old);
  e.value("stamp in the future", i.stamp_future);
  e.value("steps with held joints", i.held);
  e.value("teleports", h.teleports);
  e.value("messages lost", h.mailbox_lost);
  return e;
}

Entry checkEntry(const CrossChecker::Totals &c, const Outputs &outputs, const std::string &node)
{
  Entry e(node, "cross-check");
  if (c.intersecting_body + c.intersecting_self > 0)
    e.raise(DiagnosticStatus::WARN, "FCL found triangles that intersect");
  if (outputs.notFinite() > 0)
    e.raise(DiagnosticStatus::ERROR, "numbers that are not finite were not published");
  if (c.missed > 0) e.raise(DiagnosticStatus::ERROR, "the broad phase missed pairs that FCL found");
  if (c.checks == 0) e.status.message += " (never run)";
  e.value("checks", c.checks);
  e.value("pairs missed", c.missed);
  e.value("ours / truth", c.ratio);
  e.value("cloth-body intersections", c.intersecting_body);
  e.value("cloth-cloth intersections", c.intersecting_self);
  e.value("snapshots dropped by slow publishing", outputs.dropped());
  return e;
}

} // namespace

diagnostic_msgs::DiagnosticArray diagnose(const Health &h, const CrossChecker::Totals &checks,
                                          const Outputs &outputs, double since_turn,
                                          const std::string &node)
{
  diagnostic_msgs::DiagnosticArray m;
  m.header.stamp = ros::Time::now();
  m.status = {timeEntry(h, since_turn, node).status, engineEntry(h, node).status,
              robotEntry(h, node).status, checkEntry(checks, outputs, node).status};
  return m;
}

} // namespace robot_cloth
