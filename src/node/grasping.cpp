#include "grasping.h"

#include <algorithm>
#include <fstream>
#include <iomanip>
#include <ros/console.h>
#include <sstream>

namespace robot_cloth {
namespace {

std::string metres(double d)
{
  std::ostringstream text;
  text << std::setprecision(3) << d << " m";
  return text.str();
}

// Distance of a point from the box centred at the origin; 0 inside.
double boxDistance(const Eigen::Vector3d &p, const Eigen::Vector3d &half)
{
  return (p.cwiseAbs() - half).cwiseMax(0).norm();
}

} // namespace

Grasping::Grasping(const Settings &settings, const RobotMotion &motion, EventSink events)
    : settings_(settings), motion_(motion), events_(std::move(events))
{
  for (const GripperSettings &g : settings.grippers) grippers_.push_back({g});
}

void Grasping::follow(const World *world)
{
  world_ = world;
  held_.clear();
  changed_ = true;
  forgetGrippers();
}

void Grasping::forgetGrippers()
{
  for (Gripper &g : grippers_) g.state = Gripper::unknown;
}

bool Grasping::changed()
{
  const bool was = changed_;
  changed_ = false;
  return was;
}

// ---- what to hold
// ---------------------------------------------------------------------------------

bool Grasping::pickRegion(const GraspRequest &r, int cloth, Pick *out, std::string *why) const
{
  Pose frame, region;
  const std::string name = r.region_frame.empty() ? r.frame_id : r.region_frame;
  if (!motion_.frame(name, &frame, why)) return false;
  if (!readPose(r.region, &region)) {
    *why = "region is not finite or its quaternion is not of unit length";
    return false;
  }
  const Eigen::Vector3d half = Eigen::Vector3d(r.size.x, r.size.y, r.size.z) / 2;
  const bool box = r.how == "box", nearest = r.how == "nearest";
  if (box && !(half.minCoeff() > 0 && std::isfinite(half.sum()))) {
    *why = "how is box, so size must be three positive lengths [m]";
    return false;
  }
  if (!(r.radius >= 0 && std::isfinite(r.radius)) || (r.how == "radius" && r.radius == 0)) {
    *why = "radius is " + metres(r.radius) + ", but must be positive and finite";
    return false;
  }
  cloth_error err = {};
  const int count = cloth_vertex_count(world_->scene.get(), cloth);
  std::vector<double> x(3 * count);
  std::vector<uint8_t> held(count);
  if (cloth_positions(world_->scene.get(), cloth, x.data(), count, &err) != CLOTH_OK ||
      cloth_held(world_->scene.get(), cloth, held.data(), count, &err) != CLOTH_OK) {
    *why = err.text;
    return false;
  }
  const Pose to_region = (frame * region).inverse();
  std::vector<std::pair<double, int>> inside; // distance from the region's origin
  double nearest_free = INFINITY;             // distance of the nearest vertex from the region
  int held_inside = 0;
  for (int i = 0; i < count; i++) {
    const Eigen::Vector3d p = to_region * Eigen::Vector3d(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
    const double off = box ? boxDistance(p, half) : p.norm();
    const bool in = box ? off == 0 : off <= (nearest && r.radius == 0 ? INFINITY : r.radius);
    if (held[i])
      held_inside += in;
    else if (in)
      inside.emplace_back(p.norm(), i);
    if (!held[i]) nearest_free = std::min(nearest_free, off);
  }
  if (inside.empty()) {
    *why = held_inside
               ? "all " + std::to_string(held_inside) + " vertices in the region are held already"
               : "no vertex in the region: the nearest free vertex is " + metres(nearest_free) +
                     (box ? " from the box" : " from its origin, radius is " + metres(r.radius));
    return false;
  }
  std::sort(inside.begin(), inside.end());
  const size_t limit = nearest ? std::max(1u, r.limit) : (r.limit ? r.limit : inside.size());
  if (inside.size() > limit && !nearest)
    out->note += "; limit leaves out " + std::to_string(inside.size() - limit);
  inside.resize(std::min(inside.size(), limit));
  if (held_inside) out->note += "; " + std::to_string(held_inside) + " more are held already";
  for (const auto &v : inside) out->vertices.push_back(v.second);
  std::sort(out->vertices.begin(), out->vertices.end());
  return true;
}

std::string Grasping::holderOf(int cloth, int vertex) const
{
  for (const Held &h : held_)
    if (h.cloth == cloth && std::binary_search(h.vertices.begin(), h.vertices.end(), vertex))
      return h.id;
  return "";
}

bool Grasping::pickIds(const GraspRequest &r, int cloth, Pick *out, std::string *why) const
{
  const cloth_scene *scene = world_->scene.get();
  if (r.how == "group") {
    std::string known;
    for (int i = 0; i < cloth_group_count(scene, cloth); i++) {
      const cloth_group_view g = cloth_group(scene, cloth, i);
      known += std::string(" ") + g.name;
      if (r.group == g.name) out->vertices.assign(g.vertex, g.vertex + g.count);
    }
    if (out->vertices.empty()) {
      *why = "cloth " + std::string(cloth_name(scene, cloth)) + " has no group '" + r.group +
             "'; it has:" + known;
      return false;
    }
  } else {
    out->vertices.assign(r.ids.begin(), r.ids.end());
    if (out->vertices.empty()) {
      *why = "how is ids, but ids is empty";
      return false;
    }
  }
  if (r.limit && out->vertices.size() > r.limit) out->vertices.resize(r.limit);
  std::sort(out->vertices.begin(), out->vertices.end());
  for (int v : out->vertices) {
    const std::string holder = holderOf(cloth, v);
    if (holder.empty()) continue;
    *why = "vertex " + std::to_string(v) + " is held already, by grasp " + holder;
    return false;
  }
  return true;
}

bool Grasping::pick(const GraspRequest &r, int cloth, Pick *out, std::string *why) const
{
  if (r.how == "nearest" || r.how == "radius" || r.how == "box")
    return pickRegion(r, cloth, out, why);
  if (r.how == "ids" || r.how == "group") return pickIds(r, cloth, out, why);
  *why = "how is '" + r.how + "', but must be nearest, radius, box, ids or group";
  return false;
}

bool Grasping::ignoredBodies(const GraspRequest &r, std::vector<int> *out, std::string *why) const
{
  for (const std::string &name : r.ignore_links) {
    const int body = cloth_body_find(world_->scene.get(), name.c_str());
    if (body >= 0)
      out->push_back(body);
    else if (!world_->robot ||
             world_->robot->findLink(name) < 0) { // a link without geometry is fine
      *why = "ignore_links: there is no link or body '" + name + "'";
      return false;
    }
  }
  return true;
}

// ---- begin and end
// --------------------------------------------------------------------------------

bool Grasping::hold(const GraspRequest &r, int cloth, Pick picked, Held *held, std::string *why)
{
  std::vector<int> ignored;
  if (!motion_.frame(r.frame_id, &held->pose, why) || !ignoredBodies(r, &ignored, why))
    return false;
  const std::string frame = bareFrame(r.frame_id); // message headers take no leading slash
  const int link = world_->robot ? world_->robot->findLink(frame) : -1;
  held->frame = frame.empty() ? settings_.world_frame : frame;
  held->cloth = cloth;
  held->body = link >= 0 ? world_->bodyOfLink(link) : -1;
  held->stiffness = r.compliance > 0 ? 1 / r.compliance : 0;
  held->break_force = r.break_force;
  held->vertices = std::move(picked.vertices);
  cloth_grasp_view view = {};
  view.cloth = cloth;
  view.count = static_cast<int>(held->vertices.size());
  view.vertex = held->vertices.data();
  view.body = held->body;
  view.frame = toCloth(held->pose);
  view.stiffness = held->stiffness;
  view.break_force = held->break_force;
  view.ignore_count = static_cast<int>(ignored.size());
  view.ignore_body = ignored.data();
  cloth_error err = {};
  if (cloth_grasp(world_->scene.get(), &view, &held->handle, &err) == CLOTH_OK) return true;
  *why = err.text;
  return false;
}

GraspResponse Grasping::grasp(const GraspRequest &r, const std::string &gripper)
{
  GraspResponse answer;
  Held held = {};
  held.id = r.id;
  while (held.id.empty()) {
    const std::string id = "grasp_" + std::to_string(next_id_++);
    if (std::none_of(held_.begin(), held_.end(), [&](const Held &h) { return h.id == id; }))
      held.id = id;
  }
  held.gripper = gripper;
  Pick picked;
  std::string why;
  const bool taken =
      std::any_of(held_.begin(), held_.end(), [&](const Held &h) { return h.id == held.id; });
  if (taken)
    why = "grasp " + held.id + " holds already: release it first or take another id";
  else if (!(r.compliance >= 0 && std::isfinite(r.compliance)))
    why = "compliance must be a number [m/N] >= 0";
  else if (!(r.break_force >= 0 && std::isfinite(r.break_force)))
    why = "break_force must be a number [N] >= 0";
  else {
    const int cloth = world_->findCloth(r.cloth, &why);
    answer.success =
        cloth >= 0 && pick(r, cloth, &picked, &why) && hold(r, cloth, picked, &held, &why);
  }
  if (!answer.success) {
    answer.message = why;
    events_("grasp_failed", held.id, why);
    return answer;
  }
  answer.id = held.id;
  answer.vertices.assign(held.vertices.begin(), held.vertices.end());
  answer.message = "holds " + std::to_string(held.vertices.size()) + " vertices of " +
                   cloth_name(world_->scene.get(), held.cloth) + " in " + held.frame + picked.note;
  events_("grasp", held.id, answer.message);
  held_.push_back(std::move(held));
  changed_ = true;
  return answer;
}

ReleaseResponse Grasping::release(const std::string &id, const std::string &any_frame)
{
  ReleaseResponse answer;
  const std::string frame = bareFrame(any_frame);
  for (size_t i = 0; i < held_.size();) {
    const Held &h = held_[i];
    const bool chosen = id.empty() ? frame.empty() || h.frame == frame
                                   : h.id == id && (frame.empty() || h.frame == frame);
    if (!chosen) {
      i++;
      continue;
    }
    cloth_error err = {};
    if (cloth_grasp_alive(world_->scene.get(), h.handle) &&
        cloth_grasp_release(world_->scene.get(), h.handle, &err) != CLOTH_OK) {
      answer.message = "grasp " + h.id + ": " + err.text;
      return answer;
    }
    answer.released.push_back(h.id);
    events_("release", h.id, "let go of " + std::to_string(h.vertices.size()) + " vertices");
    held_.erase(held_.begin() + static_cast<std::ptrdiff_t>(i));
    changed_ = true;
  }
  answer.success = true;
  if (!answer.released.empty())
    answer.message = "released " + std::to_string(answer.released.size());
  else
    answer.message = "nothing to release: " + (!id.empty()      ? "no grasp " + id
                                               : !frame.empty() ? "no grasp in frame " + frame
                                                                : std::string("nothing is held"));
  return answer;
}

// ---- each step
// ------------------------------------------------------------------------------------

cloth_status Grasping::moveFrames(cloth_error *err)
{
  for (Held &h : held_) {
    std::string why;
    if (!motion_.frame(h.frame, &h.pose, &why)) // lost: held where it was
      ROS_WARN_STREAM_THROTTLE(5, "grasp " << h.id << " stays where it was: " << why);
    if (h.body >= 0 || !cloth_grasp_alive(world_->scene.get(), h.handle)) continue;
    const cloth_pose pose = toCloth(h.pose);
    CLOTH_TRY(cloth_grasp_move(world_->scene.get(), h.handle, &pose, err));
  }
  return CLOTH_OK;
}

void Grasping::noticeBroken()
{
  for (size_t i = 0; i < held_.size();) {
    if (cloth_grasp_alive(world_->scene.get(), held_[i].handle)) {
      i++;
      continue;
    }
    std::ostringstream text;
    text << "more than break_force (" << held_[i].break_force << " N): let go";
    events_("grasp_broken", held_[i].id, text.str());
    held_.erase(held_.begin() + static_cast<std::ptrdiff_t>(i));
    changed_ = true;
  }
}

void Grasping::forgetDead()
{
  const size_t before = held_.size();
  held_.erase(std::remove_if(
                  held_.begin(), held_.end(),
                  [&](const Held &h) { return !cloth_grasp_alive(world_->scene.get(), h.handle); }),
              held_.end());
  changed_ = changed_ || held_.size() != before;
}

// ---- automatic grippers
// ---------------------------------------------------------------------------

void Grasping::closeGripper(const GripperSettings &g)
{
  GraspRequest r;
  r.id = g.name;
  r.frame_id = g.frame;
  r.how = "box";
  r.region.position.x = g.region_center[0], r.region.position.y = g.region_center[1],
  r.region.position.z = g.region_center[2];
  r.size.x = g.region_size[0], r.size.y = g.region_size[1], r.size.z = g.region_size[2];
  r.limit = static_cast<uint32_t>(g.limit);
  r.compliance = g.compliance;
  r.break_force = g.break_force;
  r.ignore_links = g.links;
  std::vector<std::string> cloths = {g.cloth};
  if (g.cloth.empty()) cloths = world_->clothNames();
  for (size_t i = 0; i < cloths.size(); i++) {
    r.cloth = cloths[i];
    r.id = i == 0 ? g.name : g.name + "/" + cloths[i];
    grasp(r, g.name);
  }
}

void Grasping::runGrippers()
{
  for (Gripper &g : grippers_) {
    double value;
    if (!motion_.jointValue(g.settings.joint, &value)) {
      if (motion_.robotKnown() && !g.complained)
        ROS_WARN_STREAM("gripper " << g.settings.name << ": the robot has no joint "
                                   << g.settings.joint);
      g.complained = g.complained || motion_.robotKnown();
      continue;
    }
    value *= g.settings.sign;
    if (value < g.settings.close_below && g.state != Gripper::closed) {
      if (g.state == Gripper::open) closeGripper(g.settings);
      g.state = Gripper::closed;
    } else if (value > g.settings.open_above && g.state != Gripper::open) {
      g.state = Gripper::open;
      if (!g.settings.release) continue;
      std::vector<std::string> mine;
      for (const Held &h : held_)
        if (h.gripper == g.settings.name) mine.push_back(h.id);
      for (const std::string &id : mine) release(id, "");
    }
  }
}

// ---- what others see
// ------------------------------------------------------------------------------

Grasps Grasping::message() const
{
  Grasps m;
  for (const Held &h : held_) {
    GraspState g;
    g.id = h.id;
    g.cloth = cloth_name(world_->scene.get(), h.cloth);
    g.frame_id = h.frame;
    g.frame = robot_cloth::toMessage(h.pose);
    g.vertices.assign(h.vertices.begin(), h.vertices.end());
    g.stiffness = h.stiffness;
    g.break_force = h.break_force;
    g.gripper = h.gripper;
    m.grasps.push_back(g);
  }
  return m;
}

std::vector<geometry_msgs::WrenchStamped> Grasping::wrenches() const
{
  std::vector<geometry_msgs::WrenchStamped> out;
  for (const Held &h : held_) {
    Eigen::Vector3d force(0, 0, 0), torque(0, 0, 0);
    cloth_grasp_wrench(world_->scene.get(), h.handle, force.data(), torque.data(), nullptr);
    const Eigen::Matrix3d to_frame = h.pose.linear().transpose();
    force = to_frame * force, torque = to_frame * torque;
    geometry_msgs::WrenchStamped w;
    w.header.frame_id = h.frame;
    w.wrench.force.x = force.x(), w.wrench.force.y = force.y(), w.wrench.force.z = force.z();
    w.wrench.torque.x = torque.x(), w.wrench.torque.y = torque.y(), w.wrench.torque.z = torque.z();
    out.push_back(w);
  }
  return out;
}

// ---- beside a state file
// --------------------------------------------------------------------------

bool Grasping::save(const std::string &path) const
{
  std::ofstream file(path);
  file << std::setprecision(17);
  for (const Held &h : held_) {
    file << std::quoted(h.id) << " " << std::quoted(h.frame) << " " << std::quoted(h.gripper) << " "
         << h.handle.index1 << " " << h.handle.generation << " " << h.cloth << " " << h.body << " "
         << h.stiffness << " " << h.break_force << " " << h.vertices.size();
    for (int v : h.vertices) file << " " << v;
    file << "\n";
  }
  return bool(file.flush());
}

void Grasping::load(const std::string &path)
{
  held_.clear();
  changed_ = true;
  std::ifstream file(path);
  Held h = {};
  size_t count = 0;
  while (file >> std::quoted(h.id) >> std::quoted(h.frame) >> std::quoted(h.gripper) >>
         h.handle.index1 >> h.handle.generation >> h.cloth >> h.body >> h.stiffness >>
         h.break_force >> count) {
    h.vertices.assign(std::min(count, size_t(1) << 24), 0);
    for (int &v : h.vertices) file >> v;
    if (h.cloth < 0 || h.cloth >= cloth_count(world_->scene.get())) continue;
    std::string why;
    h.pose = Pose::Identity();
    motion_.frame(h.frame, &h.pose, &why);
    if (cloth_grasp_alive(world_->scene.get(), h.handle)) held_.push_back(h);
  }
}

} // namespace robot_cloth
