#include "robot_motion.h"

#include <ros/time.h>
#include <sstream>
#include <tf2/exceptions.h>

namespace robot_cloth {
namespace {

std::string bare(const std::string &frame) // tf1 users still write "/base_link"
{
  return !frame.empty() && frame[0] == '/' ? frame.substr(1) : frame;
}

} // namespace

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
  std::vector<std::string> needed, wrapping;
  if (world->robot) {
    robot_ = std::make_unique<RobotPose>(world->robot);
    needed = robot_->missing();
    for (const Joint &j : world->robot->joints())
      if (j.kind == JointKind::continuous) wrapping.push_back(j.name);
  }
  joints.need(needed, wrapping);
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
    RequestFrame entry = {bare(f.header.frame_id), Pose::Identity()};
    const std::string child = bare(f.child_frame_id);
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
                         std::string *why) const
{
  if (parent == child) {
    *out = Pose::Identity();
    return true;
  }
  // the time of the step if tf has it, else the newest: a frame that is late is held
  for (int held = latest_ || !(time_ > 0); held < 2; held++) {
    try {
      const ros::Time stamp = held ? ros::Time() : ros::Time(time_);
      if (!readPose(tf_->lookupTransform(parent, child, stamp).transform, out)) {
        *why = "tf from " + parent + " to " + child + " is not finite";
        return false;
      }
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
      frame = bare(parent);
      const int link = world_->robot->findLink(frame);
      if (link < 0) continue;
      if (!lookup(frame, name, out, why)) return false;
      *out = links_[link] * *out;
      return true;
    }
  }
  return lookup(settings_.world_frame, name, out, why);
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
  return findFrame(bare(name), 0, out, why);
}

bool RobotMotion::rootPose(Pose *out, std::string *why) const
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
  if (!lookup(settings_.world_frame, frame, &rest, why)) return false;
  *out = rest * pose;
  return true;
}

bool RobotMotion::knownAt(double time) const
{
  if (!robot_) return true;
  if (!(joints.knownUntil() >= time)) return false;
  const std::string &root = world_->robot->root().name;
  if (root == settings_.world_frame || !tf_->_frameExists(root)) return true;
  return tf_->canTransform(settings_.world_frame, root, ros::Time(time));
}

bool RobotMotion::take(double time, bool latest, std::string *why)
{
  time_ = time;
  latest_ = latest;
  if (!robot_) return true;
  waiting_for_.clear();
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
    Pose moved;
    const std::vector<Link> &links = world_->robot->links();
    if (j.placed() && lookup(links[j.parent_link].name, links[j.child_link].name, &moved, why))
      robot_->place(j.name, j.origin.inverse() * moved);
  }
  root_ = root;
  const std::vector<Pose> &in_root = robot_->links();
  links_.resize(in_root.size());
  for (size_t i = 0; i < in_root.size(); i++) links_[i] = root_ * in_root[i];
  known_ = true;
  return true;
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
