#include "simulation.h"

#include <algorithm>
#include <cmath>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/this_node.h>
#include <rosgraph_msgs/Clock.h>
#include <set>

namespace robot_cloth {

Simulation::Simulation(const Settings &settings, const ros::NodeHandle &priv, tf2::BufferCore *tf,
                       std::unique_ptr<World> world, Outputs *outputs, CrossChecker *checker)
    : settings_(settings), nh_(priv), ns_(priv.getNamespace()), tf_(tf), outputs_(outputs),
      checker_(checker), world_(std::move(world)),
      motion_(settings, tf,
              [this](auto &kind, auto &subject, auto &text) { event(kind, subject, text); }),
      grasping_(settings, motion_,
                [this](auto &kind, auto &subject, auto &text) { event(kind, subject, text); }),
      clock_(settings)
{
  if (settings.publish_clock) claimClock();
  follow();
  event("start", settings.scene_file,
        "mode " + settings.time_mode + ", " + std::to_string(cloth_count(scene())) + " cloths, " +
            std::to_string(cloth_body_count(scene())) + " bodies");
}

void Simulation::follow()
{
  motion_.follow(world_.get());
  grasping_.follow(world_.get());
  outputs_->follow(*world_);
  fcl_.reset();
  report_ = {};
  settled_ = kept_ = lost_ = false;
  touched_ = true;
  warnTangles();
}

// What intersects now. What cannot be looked at is told, and counts as nothing.
std::vector<cloth_tangle_view> Simulation::tangles()
{
  std::vector<cloth_tangle_view> pair(100);
  for (;;) {
    int count = 0;
    cloth_error err = {};
    if (cloth_tangles(scene(), pair.data(), static_cast<int>(pair.size()), &count, &err) !=
        CLOTH_OK) {
      ROS_ERROR_STREAM("intersecting triangles: " << err.text);
      return {};
    }
    const bool all = static_cast<size_t>(count) <= pair.size();
    pair.resize(static_cast<size_t>(count));
    if (all) return pair;
  }
}

// what intersects before the first step, pair by pair
void Simulation::warnTangles()
{
  const std::vector<cloth_tangle_view> pair = tangles();
  if (pair.empty()) return;
  ROS_WARN_STREAM("the start intersects: " << pair.size() << " pairs of triangles; set untangle: "
                                           << "true to have them worked out");
  for (size_t i = 0; i < std::min<size_t>(pair.size(), 10); i++) {
    const cloth_tangle_view &p = pair[i];
    const bool body = p.other_body >= 0;
    ROS_WARN_STREAM("  cloth " << cloth_name(scene(), p.cloth) << " triangle " << p.triangle << ", "
                               << (body ? "body " : "cloth ")
                               << (body ? cloth_body_name(scene(), p.other_body)
                                        : cloth_name(scene(), p.other_cloth))
                               << " triangle " << p.other_triangle);
  }
}

// A robot that is placed, not moved, may be placed into the cloth. The cloth then slides out of it
// over the next steps, whatever `untangle` says (cloth_body_place).
void Simulation::tellPlacedInto()
{
  std::set<std::string> links;
  int count = 0;
  for (const cloth_tangle_view &p : tangles()) {
    if (p.other_body < 0 || world_->linkOfBody(p.other_body) < 0) continue;
    links.insert(cloth_body_name(scene(), p.other_body));
    count++;
  }
  if (links.empty()) return;
  std::string text = "placed into the cloth, " + std::to_string(count) + " pairs of triangles:";
  for (const std::string &link : links) text += " " + link;
  event("teleport", world_->robot->name(), text + "; they are worked out over the next steps");
}

std::vector<std::string> Simulation::blockingNames() const
{
  std::vector<std::string> names;
  cloth_scene *scene = world_->scene.get();
  std::vector<int> body(static_cast<size_t>(report_.bodies_blocking));
  std::vector<cloth_hold_view> hold(static_cast<size_t>(report_.holds_blocking));
  int bodies = 0, holds = 0;
  if (!body.empty())
    cloth_blocking_bodies(scene, body.data(), report_.bodies_blocking, &bodies, nullptr);
  if (!hold.empty())
    cloth_blocking_holds(scene, hold.data(), report_.holds_blocking, &holds, nullptr);
  for (int i = 0; i < std::min(bodies, report_.bodies_blocking); i++)
    names.emplace_back(cloth_body_name(scene, body[static_cast<size_t>(i)]));
  for (int i = 0; i < std::min(holds, report_.holds_blocking); i++) {
    const cloth_hold_view &h = hold[static_cast<size_t>(i)];
    names.push_back(std::string(cloth_name(scene, h.cloth)) + "/" +
                    (h.group ? h.group : "(a grasp)"));
  }
  return names;
}

// ---- time
// -----------------------------------------------------------------------------------------

ros::Time Simulation::stamp() const
{
  const double t = clock_.stamp(time());
  return t > 0 && t < 4e9 ? ros::Time(t) : ros::Time();
}

bool Simulation::turn()
{
  if (paused_ || finished_ || lost_ || clock_.lockstep()) return false;
  std::string why;
  if (settings_.wait_for_robot && world_->robot && !motion_.robotKnown() &&
      !motion_.take(clock_.now(), true, &why)) {
    clock_.restart();
    return false;
  }
  const Clock::Turn t =
      clock_.turn(time(), world_->time_step, [this](double end) { return motion_.knownAt(end); });
  switch (t) {
  case Clock::wait:
    return false;
  case Clock::jumped_back:
    jumpBack();
    return true;
  case Clock::jumped_ahead:
    event("time_jump", "", "the clock leapt ahead: bodies are placed where they are now");
    motion_.forgetPlacement();
    settled_ = false;
    return true;
  case Clock::step:
    return step(clock_.end(), false, &why);
  }
  return false;
}

void Simulation::jumpBack()
{
  tf_->clear(); // else tf serves transforms of the future until they come round again
  motion_.forgetInputs();
  const std::string what = "the clock ran back; policy: " + settings_.on_backward_jump;
  ROS_WARN_STREAM(what);
  if (settings_.on_backward_jump == "checkpoint" && !checkpoint_.empty()) {
    event("time_jump", "", what);
    const Answer a = loadState(checkpoint_);
    if (a.success) return;
    ROS_ERROR_STREAM("checkpoint " << checkpoint_ << ": " << a.message << "; resetting");
  }
  if (settings_.on_backward_jump == "reset" || settings_.on_backward_jump == "checkpoint") {
    event("time_jump", "", what);
    reset("the clock ran back");
    return;
  }
  clock_.restart();
  settled_ = false;
  changed("time_jump", what);
  if (settings_.on_backward_jump == "pause") pause(true, "the clock ran back");
}

// ---- a step
// ---------------------------------------------------------------------------------------

bool Simulation::step(double end, bool latest, std::string *why)
{
  const double start = ros::SteadyTime::now().toSec();
  std::string waits;
  if (lost_) {
    *why = "the scene is lost: " + last_failure_ + "; ~reload_model starts anew";
    return false;
  }
  if (!motion_.take(end, latest, &waits))
    ROS_WARN_STREAM_THROTTLE(5, "robot not in the scene: " << waits);
  else if (!motion_.heldWhy().empty())
    ROS_WARN_STREAM_THROTTLE(5, "robot held where it was: " << waits);
  if (!clock_.lockstep() && motion_.robotKnown() && !motion_.knownAt(end))
    motion_.joints.counts.held++;
  cloth_error err = {};
  const double elapsed = settled_ ? end - last_end_ : world_->time_step;
  const uint64_t placements = motion_.placements();
  cloth_status status = motion_.moveBodies(scene(), elapsed, &err);
  if (status == CLOTH_OK) status = grasping_.moveFrames(&err);
  if (status == CLOTH_OK) status = cloth_step(scene(), world_->time_step, &report_, &err);
  if (status != CLOTH_OK) return refused(status, err, why);
  failures_in_a_row_ = 0;
  settled_ = true;
  last_end_ = end;
  if (motion_.placements() > placements && report_.tangles > 0) tellPlacedInto();
  grasping_.noticeBroken();
  grasping_.runGrippers();
  summary_.add(report_, ros::SteadyTime::now().toSec() - start);
  keep();
  publish(true);
  if (settings_.crosscheck_every > 0 && report_.step % settings_.crosscheck_every == 0 &&
      checker_->idle())
    crossCheck(settings_.crosscheck_margin);
  if (settings_.run_duration > 0 && time() >= settings_.run_duration - 1e-9) {
    finished_ = true;
    event("summary", "", summary());
  }
  return true;
}

bool Simulation::refused(cloth_status status, const cloth_error &err, std::string *why)
{
  *why = err.text;
  last_failure_ = err.text;
  failures_++, failures_in_a_row_++;
  motion_.forgetPlacement(); // whatever the bodies did, they do not sweep there again
  settled_ = false;
  if (status < 0) {
    lose(err, why);
    return false;
  }
  event("rollback", "", *why + "; the state is that of before the step");
  if (failures_in_a_row_ >= settings_.failures_max)
    pause(true, std::to_string(failures_in_a_row_) + " steps were refused in a row: " + *why);
  return false;
}

void Simulation::crossCheck(double margin)
{
  auto frozen = std::make_unique<FrozenScene>();
  cloth_error err = {};
  try {
    if (!fcl_) fcl_ = std::make_shared<FclCheck>(FclCheck::fromScene(scene()));
  } catch (const std::exception &e) {
    checker_->refuse(e.what());
    return;
  }
  if (freezeScene(scene(), margin, frozen.get(), &err) != CLOTH_OK) {
    checker_->refuse(err.text);
    ROS_ERROR_STREAM_THROTTLE(5, "cross-check: " << err.text);
    return;
  }
  frozen->header.stamp = stamp();
  frozen->header.frame_id = settings_.world_frame;
  frozen->step = report_.step;
  frozen->fcl = fcl_;
  checker_->submit(std::move(frozen));
}

void Simulation::tend()
{
  const double margin = checker_->requestedMargin();
  if (margin > 0) crossCheck(margin);
  if (touched_) publish(false);
}

// ---- what others see
// ------------------------------------------------------------------------------

void Simulation::event(const std::string &kind, const std::string &subject, const std::string &text)
{
  Event e;
  e.header.stamp = stamp();
  e.header.frame_id = settings_.world_frame;
  e.epoch = epoch_;
  e.kind = kind;
  e.subject = subject;
  e.text = text;
  ROS_INFO_STREAM("[" << kind << "] " << subject << (subject.empty() ? "" : ": ") << text);
  outputs_->event(e);
}

void Simulation::publish(bool stepped)
{
  auto s = std::make_unique<Snapshot>();
  const Outputs::Wanted wanted = outputs_->wanted();
  State &m = s->state;
#define CLOTH_REPORT(type, name, unit, meaning) m.name = report_.name;
#include "report.inl"
#define CLOTH_STAGE(name, file, meaning) m.ms_##name = report_.ms[CLOTH_STAGE_##name];
#include "stages.inl"
  m.header.stamp = stamp();
  m.header.frame_id = settings_.world_frame;
  m.time = time();
  m.epoch = epoch_;
  m.mode = settings_.time_mode;
  m.paused = paused_;
  m.real_time_factor = summary_.realTimeFactor();
  m.time_skipped = clock_.skipped();
  s->shapes = outputs_->shapes();
  s->grasps_changed = grasping_.changed();
  s->stream = wanted.stream, s->markers = wanted.markers;
  s->grasps = grasping_.message();
  s->grasps.header = m.header;
  if (wanted.wrenches && stepped) s->wrenches = grasping_.wrenches();
  if (wanted.positions() || s->grasps_changed) readCloths(wanted, s.get());
  if (wanted.contacts) readContacts(s.get());
  if (clock_publisher_ && stepped) {
    rosgraph_msgs::Clock clock;
    clock.clock = m.header.stamp;
    clock_publisher_.publish(clock);
  }
  if (obstacle_moved_) outputs_->publishBodies(*world_);
  if (stepped) obstacle_moved_ = false; // a body that was told to move is there after a step
  touched_ = false;
  outputs_->post(std::move(s), clock_.lockstep());
}

void Simulation::readCloths(const Outputs::Wanted &wanted, Snapshot *s)
{
  for (int c = 0; c < cloth_count(scene()); c++) {
    const int n = cloth_vertex_count(scene(), c);
    ClothFrame f;
    f.positions.resize(3 * static_cast<size_t>(n));
    if (cloth_positions(scene(), c, f.positions.data(), n, nullptr) != CLOTH_OK)
      f.positions.clear();
    if (wanted.velocities) {
      f.velocities.resize(3 * static_cast<size_t>(n));
      if (cloth_velocities(scene(), c, f.velocities.data(), n, nullptr) != CLOTH_OK)
        f.velocities.clear();
    }
    if (settings_.pinned) {
      f.held.resize(static_cast<size_t>(n));
      if (cloth_held(scene(), c, f.held.data(), n, nullptr) != CLOTH_OK) f.held.clear();
    }
    s->cloths.push_back(std::move(f));
  }
  for (GraspState &g : s->grasps.grasps) {
    const int c = cloth_find(scene(), g.cloth.c_str());
    if (c < 0) continue;
    const std::vector<double> &x = s->cloths[static_cast<size_t>(c)].positions;
    for (uint32_t v : g.vertices)
      if (3 * v + 2 < x.size()) g.points.insert(g.points.end(), &x[3 * v], &x[3 * v] + 3);
  }
}

void Simulation::readContacts(Snapshot *s)
{
  std::vector<cloth_contact_view> list(static_cast<size_t>(settings_.contacts_max));
  int count = 0;
  if (cloth_contacts(scene(), list.data(), settings_.contacts_max, &count, nullptr) != CLOTH_OK)
    return;
  s->contacts = std::make_unique<Contacts>();
  s->contacts->header = s->state.header;
  s->contacts->total = static_cast<uint32_t>(count);
  for (int i = 0; i < std::min(count, settings_.contacts_max); i++) {
    const cloth_contact_view &v = list[static_cast<size_t>(i)];
    ContactPoint p;
    p.cloth = cloth_name(scene(), v.cloth);
    if (v.body >= 0) p.body = cloth_body_name(scene(), v.body);
    p.position.x = v.position[0], p.position.y = v.position[1], p.position.z = v.position[2];
    p.normal.x = v.normal[0], p.normal.y = v.normal[1], p.normal.z = v.normal[2];
    p.distance = v.distance;
    p.force = v.force;
    s->contacts->contacts.push_back(p);
  }
}

std::string Simulation::summary() const
{
  std::string text = summary_.text(checker_->totals(), clock_.skipped());
  for (int e = 0; e < cloth_effect_count(); e++) {
    cloth_effect_info info = {};
    if (cloth_effect_describe(world_->scene.get(), e, &info, nullptr) == CLOTH_OK)
      text += "\neffect                " + effectText(info, summary_.steps());
  }
  return text;
}

Health Simulation::health() const
{
  Health h;
  h.paused = paused_, h.paused_why = paused_why_, h.lost = lost_, h.fell_back = fell_back_;
  h.waiting_for_clock = clock_.waitingForClock();
  h.robot_waits_for = world_->robot ? motion_.waitingFor() : "";
  h.last_failure = last_failure_;
  h.real_time_factor = summary_.realTimeFactor();
  h.skipped = clock_.skipped(), h.lag = clock_.lag();
  h.teleports = motion_.teleports(), h.failures = failures_;
  h.grasps = grasping_.count();
  h.inputs = motion_.joints.counts;
  h.report = report_;
  h.blocking = blockingNames();
  h.problems = world_->problems;
  h.robot_warnings = motion_.warnings();
  return h;
}

void Simulation::claimClock()
{
  XmlRpc::XmlRpcValue request, response, payload;
  request = ros::this_node::getName();
  if (ros::master::execute("getSystemState", request, response, payload, false) &&
      payload.size() > 0)
    for (int i = 0; i < payload[0].size(); i++)
      if (std::string(payload[0][i][0]) == "/clock" && payload[0][i][1].size() > 0)
        throw StartError("parameter " + ns_ + "/time/publish_clock is true, but " +
                         std::string(payload[0][i][1][0]) +
                         " publishes /clock already: stop it or set false");
  if (settings_.time_mode == "clock")
    throw StartError("parameter " + ns_ +
                     "/time/publish_clock is true, but time/mode clock follows /clock: "
                     "set time/mode to step or wall");
  clock_publisher_ = nh_.advertise<rosgraph_msgs::Clock>("/clock", 10);
}

} // namespace robot_cloth
