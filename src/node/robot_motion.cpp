#include "robot_motion.h"

#include <ros/time.h>
#include <sstream>
#include <tf2/exceptions.h>

namespace robot_cloth {
namespace {

// A pose farther from the scene's origin than this is nonsense: a value in a wrong unit, a number
// that was never set. The engine refuses them, and a step that is refused for the same inputs again
// and again would stop the simulation.
constexpr double reach_max = 1e5; // m

constexpr double stopped_after = 1; // s without news

bool inReach(const Pose &p) { return p.translation().norm() <= reach_max; } // false for NaN

std::string farAway(const Pose &p)
{
  std::ostringstream text;
  const Eigen::Vector3d x = p.translation();
  text << "at (" << x.x() << ", " << x.y() << ", " << x.z() << ") m, more than " << reach_max
       << " m from the scene's origin";
  return text.str();
}

} // namespace

std::string bareFrame(const std::string &frame)
{
  return !frame.empty() && frame[0] == '/' ? frame.substr(1) : frame;
}

RobotMotion::RobotMotion(const Settings &settings, const tf2::BufferCore *tf, EventSink events)
    : settings_(settings), tf_(tf), events_(std::move(events))
{
}

void RobotMotion::follow(const World *world)
{
  world_ = world;
  robot_.reset();
  links_.clear();
  known_ = placed_ = false;
  request_frames_.clear();
  std::vector<std::string> needed, wrapping, idle;
  if (world->robot) {
    robot_ = std::make_unique<RobotPose>(world->robot);
    needed = robot_->missing();
    for (const Joint &j : world->robot->joints())
      if (j.kind == JointKind::continuous) wrapping.push_back(j.name);
    for (const Joint &j : world->robot->joints()) idle.push_back(j.name);
  }
  joints.need(needed, wrapping, idle);
}

void RobotMotion::forgetInputs()
{
  joints.clear();
  request_frames_.clear();
  if (robot_) robot_->forget();
  known_ = placed_ = false;
}

bool RobotMotion::setFrames(const std::vector<geometry_msgs::TransformStamped> &frames,
                            std::string *why)
{
  std::map<std::string, RequestFrame> next = request_frames_;
  for (const geometry_msgs::TransformStamped &f : frames) {
    RequestFrame entry = {bareFrame(f.header.frame_id), Pose::Identity()};
    const std::string child = bareFrame(f.child_frame_id);
    if (child.empty() || entry.parent.empty() || child == entry.parent) {
      *why = "a frame needs header.frame_id (the parent) and another child_frame_id";
      return false;
    }
    if (!readPose(f.transform, &entry.pose)) {
      *why = "frame " + child + " is not finite or its quaternion is not of unit length";
      return false;
    }
    next[child] = entry;
  }
  request_frames_.swap(next);
  return true;
}

bool RobotMotion::lookup(const std::string &parent, const std::string &child, Pose *out,
                         std::string *why, double *age) const
{
  if (age) *age = 0;
  if (parent == child) {
    *out = Pose::Identity();
    return true;
  }
  // the time of the step if tf has it, else the newest: a frame that is late is held
  for (int held = latest_ || !(time_ > 0); held < 2; held++) {
    try {
      const ros::Time stamp = held ? ros::Time() : ros::Time(time_);
      const geometry_msgs::TransformStamped found = tf_->lookupTransform(parent, child, stamp);
      if (!readPose(found.transform, out)) {
        *why = "tf from " + parent + " to " + child + " is not finite";
        return false;
      }
      if (age && held && !latest_ && !found.header.stamp.isZero()) // zero: static
        *age = time_ - found.header.stamp.toSec();
      return true;
    } catch (const tf2::TransformException &e) {
      *why = std::string("tf: ") + e.what();
    } catch (const std::runtime_error &e) { // a time that ros::Time cannot hold
      *why = e.what();
    }
  }
  return false;
}

bool RobotMotion::tfPose(const std::string &name, Pose *out, std::string *why) const
{
  // A frame that hangs below a link follows our own forward kinematics of that link.
  if (robot_ && known_) {
    std::string frame = name, parent;
    for (int depth = 0; depth < 32 && tf_->_getParent(frame, ros::Time(), parent); depth++) {
      frame = bareFrame(parent);
      const int link = world_->robot->findLink(frame);
      if (link < 0) continue;
      if (!lookup(frame, name, out, why)) return false;
      *out = links_[link] * *out;
      return true;
    }
  }
  if (lookup(settings_.world_frame, name, out, why)) return true;
  *why = "no transform from " + settings_.world_frame + " to " + name + ": " + *why;
  return false;
}

bool RobotMotion::findFrame(const std::string &name, int depth, Pose *out, std::string *why) const
{
  if (name.empty() || name == settings_.world_frame) {
    *out = Pose::Identity();
    return true;
  }
  const int link = robot_ ? world_->robot->findLink(name) : -1;
  if (link >= 0) {
    if (known_)
      *out = links_[link];
    else
      *why = "link " + name + ": the robot's pose is not known yet: " + waiting_for_;
    return known_;
  }
  auto given = request_frames_.find(name);
  if (given == request_frames_.end()) return tfPose(name, out, why);
  if (depth > 32) {
    *why = "the frames of the request form a ring at " + name;
    return false;
  }
  if (!findFrame(given->second.parent, depth + 1, out, why)) return false;
  *out = *out * given->second.pose;
  return true;
}

bool RobotMotion::frame(const std::string &name, Pose *out, std::string *why) const
{
  Pose found;
  if (!findFrame(bareFrame(name), 0, &found, why)) return false;
  if (!inReach(found)) {
    *why = "frame " + name + " is " + farAway(found);
    return false;
  }
  *out = found;
  return true;
}

bool RobotMotion::rootPose(Pose *out, std::string *why)
{
  const std::string &root = world_->robot->root().name;
  Pose pose = Pose::Identity();
  std::string frame = root;
  for (int depth = 0; depth < 32; depth++) {
    auto given = request_frames_.find(frame);
    if (given == request_frames_.end()) break;
    pose = given->second.pose * pose;
    frame = given->second.parent;
  }
  Pose rest;
  if (!lookup(settings_.world_frame, frame, &rest, why, &root_age_)) return false;
  *out = rest * pose;
  return true;
}

bool RobotMotion::knownAt(double time) const
{
  if (!robot_) return true;
  if (!(joints.knownUntil() >= time)) return false;
  const std::vector<Link> &links = world_->robot->links();
  if (!tfKnownAt(settings_.world_frame, links.front().name, time)) return false;
  for (const Joint &j : world_->robot->joints())
    if (j.placed() && !tfKnownAt(links[j.parent_link].name, links[j.child_link].name, time))
      return false;
  return true;
}

// a frame that tf has never heard of is not waited for
bool RobotMotion::tfKnownAt(const std::string &parent, const std::string &child, double time) const
{
  return parent == child || !tf_->_frameExists(child) || !tf_->_frameExists(parent) ||
         tf_->canTransform(parent, child, ros::Time(time));
}

bool RobotMotion::take(double time, bool latest, std::string *why)
{
  time_ = time;
  latest_ = latest;
  if (!robot_) return true;
  waiting_for_.clear(), held_why_.clear(), not_in_tf_.clear();
  if (!joints.complete()) {
    waiting_for_ = "no joint_states yet for";
    for (const std::string &j : joints.missing()) waiting_for_ += " " + j;
  }
  Pose root;
  std::string root_why;
  if (waiting_for_.empty() && !rootPose(&root, &root_why))
    waiting_for_ = "no transform from " + settings_.world_frame + " to " +
                   world_->robot->root().name + ": " + root_why;
  if (!waiting_for_.empty()) {
    *why = waiting_for_;
    return known_; // held where it was, if it ever was anywhere
  }
  for (const Joint &j : world_->robot->joints()) {
    double value;
    if (j.movable() && !j.mimic() && joints.at(j.name, time, &value)) robot_->set(j.name, value);
    if (!j.placed()) continue;
    Pose moved;
    const std::vector<Link> &links = world_->robot->links();
    if (lookup(links[j.parent_link].name, links[j.child_link].name, &moved, why))
      robot_->place(j.name, j.origin.inverse() * moved);
    else
      not_in_tf_.push_back(j.name);
  }
  const std::vector<Pose> &in_root = robot_->links();
  links_next_.resize(in_root.size());
  for (size_t i = 0; i < in_root.size(); i++) links_next_[i] = root * in_root[i];
  held_why_ = outOfReach();
  if (!held_why_.empty()) {
    if (!known_) waiting_for_ = held_why_;
    *why = held_why_;
    return known_;
  }
  root_ = root;
  links_.swap(links_next_);
  known_ = true;
  return true;
}

std::string RobotMotion::outOfReach() const
{
  for (size_t i = 0; i < links_next_.size(); i++)
    if (!inReach(links_next_[i]))
      return "link " + world_->robot->links()[i].name + " would be " + farAway(links_next_[i]);
  return "";
}

std::vector<std::string> RobotMotion::warnings() const
{
  std::vector<std::string> out;
  if (!robot_ || !waiting_for_.empty()) return out;
  if (!held_why_.empty()) out.push_back("held where it was: " + held_why_);
  const std::vector<Joint> &all = world_->robot->joints();
  for (size_t i = 0; i < all.size(); i++) {
    const Joint &j = all[i];
    const double value = robot_->value(static_cast<int>(i));
    const double margin = 1e-3 + 0.01 * (j.upper - j.lower); // encoders are not that exact
    if (!j.movable() || j.mimic() || (value >= j.lower - margin && value <= j.upper + margin))
      continue;
    std::ostringstream text;
    const char *unit = j.kind == JointKind::prismatic ? " m" : " rad";
    text << "joint " << j.name << " is at " << value << unit << ", beyond its limits [" << j.lower
         << ", " << j.upper << "]" << unit;
    out.push_back(text.str());
  }
  const std::vector<Link> &links = world_->robot->links();
  for (const std::string &name : not_in_tf_) {
    const Joint &j = all[static_cast<size_t>(world_->robot->findJoint(name))];
    out.push_back(std::string(jointKindName(j.kind)) + " joint " + name +
                  " stays where it was: no transform from " + links[j.parent_link].name + " to " +
                  links[j.child_link].name);
  }
  if (latest_) return out; // lockstep: what no request changes holds still
  std::ostringstream old;
  const std::vector<std::string> silent = joints.olderThan(time_ - stopped_after);
  if (!silent.empty()) {
    old << "held for " << time_ - joints.knownUntil() << " s, no joint_states for";
    for (const std::string &j : silent) old << " " << j;
    out.push_back(old.str());
  }
  if (root_age_ > stopped_after) {
    old.str("");
    old << "held for " << root_age_ << " s, no transform from " << settings_.world_frame << " to "
        << links.front().name;
    out.push_back(old.str());
  }
  return out;
}

std::string RobotMotion::tooFast(double elapsed) const
{
  if (links_before_.size() != links_.size() || !(elapsed > 0)) return "";
  for (size_t i = 0; i < links_.size(); i++) {
    const double distance = (links_[i].translation() - links_before_[i].translation()).norm();
    const double angle =
        Eigen::AngleAxisd(links_before_[i].linear().transpose() * links_[i].linear()).angle();
    if (distance <= settings_.speed_limit_linear * elapsed &&
        angle <= settings_.speed_limit_angular * elapsed)
      continue;
    std::ostringstream text;
    text << "link " << world_->robot->links()[i].name << " moved " << distance << " m and " << angle
         << " rad in " << elapsed << " s, beyond speed_limit (" << settings_.speed_limit_linear
         << " m/s, " << settings_.speed_limit_angular << " rad/s): placed, not swept";
    return text.str();
  }
  return "";
}

cloth_status RobotMotion::moveBodies(cloth_scene *scene, double elapsed, cloth_error *err)
{
  if (!known_) return CLOTH_OK;
  const std::string jump = placed_ ? tooFast(elapsed) : "";
  if (!jump.empty()) {
    teleports_++;
    events_("teleport", world_->robot->name(), jump);
  }
  if (!placed_ || !jump.empty()) placements_++;
  for (const LinkBody &l : world_->links) {
    const cloth_pose pose = toCloth(links_[l.link]);
    if (placed_ && jump.empty())
      CLOTH_TRY(cloth_body_move(scene, l.body, &pose, err));
    else
      CLOTH_TRY(cloth_body_place(scene, l.body, &pose, err));
  }
  placed_ = true;
  links_before_ = links_;
  return CLOTH_OK;
}

bool RobotMotion::jointValue(const std::string &name, double *value) const
{
  if (!robot_ || !known_) return false;
  const int joint = world_->robot->findJoint(name);
  if (joint < 0) return false;
  *value = robot_->value(joint);
  return true;
}

} // namespace robot_cloth
