#include "robot_model.h"

#include "urdf_inspect.h"

#include <algorithm>
#include <cmath>
#include <console_bridge/console.h>
#include <mutex>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

namespace robot_cloth {
namespace {

Eigen::Isometry3d toEigen(const urdf::Pose &pose)
{
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  const urdf::Rotation &r = pose.rotation;
  out.linear() = Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix();
  out.translation() = Eigen::Vector3d(pose.position.x, pose.position.y, pose.position.z);
  return out;
}

JointKind toKind(const urdf::Joint &joint)
{
  switch (joint.type) {
  case urdf::Joint::REVOLUTE:
    return JointKind::revolute;
  case urdf::Joint::CONTINUOUS:
    return JointKind::continuous;
  case urdf::Joint::PRISMATIC:
    return JointKind::prismatic;
  case urdf::Joint::FLOATING:
    return JointKind::floating;
  case urdf::Joint::PLANAR:
    return JointKind::planar;
  default:
    return JointKind::fixed;
  }
}

std::string numberText(double v)
{
  char text[32];
  std::snprintf(text, sizeof text, "%g", v);
  return text;
}

constexpr double size_max = 1e4;   // m; no robot, and the engine takes no larger primitive either
constexpr double size_warn = 20;   // m; a mesh in millimetres makes a link of this size
constexpr double size_tiny = 1e-4; // m; one in metres that is scaled as if in millimetres

// What a size of a primitive should be and is not; empty: it is fine. `!(v > 0)` is true of NaN.
std::string badSize(const char *what, double v)
{
  if (v > 0 && v <= size_max) return "";
  return std::string(what) + " is " + numberText(v) + " m; it must be positive and at most " +
         numberText(size_max) + " m";
}

// urdfdom tells its reasons to console_bridge only, which is one for the whole process.
class CaptureUrdfdom : public console_bridge::OutputHandler {
public:
  CaptureUrdfdom() : lock_(mutex()) { console_bridge::useOutputHandler(this); }
  ~CaptureUrdfdom() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string &text, console_bridge::LogLevel level, const char *, int) override
  {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR)
      said += (said.empty() ? "" : "; ") + text;
  }
  std::string said;

private:
  static std::mutex &mutex()
  {
    static std::mutex m;
    return m;
  }
  std::lock_guard<std::mutex> lock_;
};

std::string lines(const std::vector<std::string> &errors)
{
  std::string text = "robot_description cannot be used:";
  for (const std::string &e : errors) text += "\n  - " + e;
  return text;
}

} // namespace

const char *jointKindName(JointKind kind)
{
  switch (kind) {
  case JointKind::fixed:
    return "fixed";
  case JointKind::revolute:
    return "revolute";
  case JointKind::continuous:
    return "continuous";
  case JointKind::prismatic:
    return "prismatic";
  case JointKind::planar:
    return "planar";
  case JointKind::floating:
    return "floating";
  }
  return "unknown";
}

// ---- reading ----------------------------------------------------------------------------------

// One reading of one document; fills a RobotModel.
class UrdfReader {
public:
  explicit UrdfReader(const ModelOptions &options)
      : options_(options), model_(std::make_shared<RobotModel>())
  {
  }

  std::shared_ptr<const RobotModel> read(const std::string &xml)
  {
    const urdf::ModelInterfaceSharedPtr source = parse(xml);
    model_->name_ = source->getName();
    links(*source);
    mimics(*source);
    for (Link &link : model_->links_) collisions(*source->getLink(link.name), &link);
    if (!errors_.empty()) throw ModelError(lines(errors_));
    return model_;
  }

private:
  urdf::ModelInterfaceSharedPtr parse(const std::string &xml)
  {
    if (xml.find_first_not_of(" \t\r\n") == std::string::npos)
      throw ModelError(lines({"it is empty; load a URDF into it (is robot_description set?)"}));
    tinyxml2::XMLDocument document;
    if (document.Parse(xml.c_str(), xml.size()) != tinyxml2::XML_SUCCESS)
      throw ModelError(lines({"it is not valid XML: " + std::string(document.ErrorStr())}));
    inspection_ = inspectUrdf(&document);
    if (!inspection_.errors.empty()) throw ModelError(lines(inspection_.errors));
    model_->problems_ = inspection_.problems;
    tinyxml2::XMLPrinter printer(nullptr, true);
    document.Print(&printer);
    CaptureUrdfdom capture;
    urdf::ModelInterfaceSharedPtr source;
    try {
      source = urdf::parseURDF(printer.CStr());
    } catch (const std::exception &e) {
      throw ModelError(lines({std::string("urdfdom refuses it: ") + e.what()}));
    }
    if (!source || !source->getRoot())
      throw ModelError(lines(
          {"urdfdom refuses it: " + (capture.said.empty() ? "no reason given" : capture.said)}));
    return source;
  }

  // Depth first, so that parents come before children, and joint i carries link i + 1.
  void links(const urdf::ModelInterface &source)
  {
    std::vector<std::pair<urdf::LinkConstSharedPtr, int>> todo = {{source.getRoot(), -1}};
    while (!todo.empty()) {
      const auto [from, parent] = todo.back();
      todo.pop_back();
      Link link;
      link.name = from->name;
      link.index = static_cast<int>(model_->links_.size());
      link.parent_link = parent;
      const UrdfInspection::LinkTags &tags = inspection_.links[link.name];
      link.collision_tags = tags.collisions;
      link.visual_tags = tags.visuals;
      if (tags.visuals > 0 && tags.collisions == 0) model_->visual_only_.push_back(link.name);
      if (parent >= 0) link.parent_joint = joint(*from->parent_joint, parent, link.index);
      model_->link_index_[link.name] = link.index;
      model_->links_.push_back(link);
      for (auto child = from->child_links.rbegin(); child != from->child_links.rend(); ++child)
        todo.emplace_back(*child, link.index);
    }
  }

  int joint(const urdf::Joint &from, int parent, int child)
  {
    Joint j;
    j.name = from.name;
    j.kind = toKind(from);
    j.parent_link = parent;
    j.child_link = child;
    j.origin = toEigen(from.parent_to_joint_origin_transform);
    const Eigen::Vector3d axis(from.axis.x, from.axis.y, from.axis.z);
    if (axis.norm() > 0) j.axis = axis.normalized();
    if (from.limits) {
      const bool bounded = j.kind == JointKind::revolute || j.kind == JointKind::prismatic;
      if (bounded && from.limits->lower <= from.limits->upper) {
        j.lower = from.limits->lower;
        j.upper = from.limits->upper;
      }
      if (from.limits->velocity > 0) j.velocity_max = from.limits->velocity;
    }
    const int index = static_cast<int>(model_->joints_.size());
    model_->joint_index_[j.name] = index;
    model_->joints_.push_back(j);
    return index;
  }

  // value = m1 (m2 (... source ...) + o2) + o1; cycles and missing joints were refused before.
  void mimics(const urdf::ModelInterface &source)
  {
    for (Joint &j : model_->joints_) {
      if (!j.movable()) continue;
      double multiplier = 1, offset = 0;
      int at = model_->joint_index_[j.name];
      while (model_->joints_[static_cast<size_t>(at)].movable()) {
        const auto mimic = source.getJoint(model_->joints_[static_cast<size_t>(at)].name)->mimic;
        if (!mimic) break;
        offset += multiplier * mimic->offset;
        multiplier *= mimic->multiplier;
        at = model_->joint_index_[mimic->joint_name];
      }
      if (model_->joints_[static_cast<size_t>(at)].name == j.name) continue;
      j.mimic_source = at;
      j.mimic_multiplier = multiplier;
      j.mimic_offset = offset;
    }
  }

  void collisions(const urdf::Link &from, Link *link)
  {
    const int readable = inspection_.links[link->name].readable;
    const int read = static_cast<int>(from.collision_array.size());
    // The inspection takes out what urdfdom cannot read. Should they ever disagree, say so.
    if (read < readable)
      model_->problems_.push_back({ModelProblem::dropped_collision, link->name,
                                   "link '" + link->name + "': urdfdom dropped " +
                                       std::to_string(readable - read) +
                                       " more <collision> elements and gave no reason"});
    for (size_t i = 0; i < from.collision_array.size(); i++) {
      const urdf::Collision &c = *from.collision_array[i];
      std::string wrong;
      try {
        wrong = collision(c, link);
      } catch (const MeshError &e) {
        wrong = e.what();
      }
      if (wrong.empty()) {
        link->collisions_used++;
        continue;
      }
      const std::string text = "link '" + link->name + "': collision geometry: " + wrong;
      if (options_.tolerate_bad_collisions)
        model_->problems_.push_back(
            {ModelProblem::dropped_collision, link->name, text + "; left out"});
      else
        errors_.push_back(text);
    }
  }

  // Empty: added to the link. Otherwise what is wrong.
  std::string collision(const urdf::Collision &c, Link *link)
  {
    const int segments = options_.mesh.segments;
    TriangleMesh mesh;
    std::string wrong;
    if (const auto *box = dynamic_cast<const urdf::Box *>(c.geometry.get())) {
      for (double edge : {box->dim.x, box->dim.y, box->dim.z})
        if (wrong.empty()) wrong = badSize("an edge of a box", edge);
      if (wrong.empty()) mesh = boxMesh({box->dim.x, box->dim.y, box->dim.z});
    } else if (const auto *cylinder = dynamic_cast<const urdf::Cylinder *>(c.geometry.get())) {
      wrong = badSize("the radius of a cylinder", cylinder->radius);
      if (wrong.empty()) wrong = badSize("the length of a cylinder", cylinder->length);
      if (wrong.empty()) mesh = cylinderMesh(cylinder->radius, cylinder->length, segments);
    } else if (const auto *sphere = dynamic_cast<const urdf::Sphere *>(c.geometry.get())) {
      wrong = badSize("the radius of a sphere", sphere->radius);
      if (wrong.empty()) mesh = sphereMesh(sphere->radius, segments);
    } else if (const auto *file = dynamic_cast<const urdf::Mesh *>(c.geometry.get())) {
      if (options_.load_meshes) mesh = meshFile(*file, *link);
    } else {
      wrong = "a kind of geometry that is neither box, cylinder, sphere nor mesh";
    }
    if (wrong.empty() && options_.load_meshes) link->mesh.append(mesh, toEigen(c.origin));
    return wrong;
  }

  TriangleMesh meshFile(const urdf::Mesh &file, const Link &link)
  {
    MeshReport report;
    const Eigen::Vector3d scale(file.scale.x, file.scale.y, file.scale.z);
    TriangleMesh mesh = loadMesh(file.filename, scale, options_.mesh, &report);
    for (const std::string &warning : report.warnings)
      model_->problems_.push_back(
          {ModelProblem::mesh_warning, link.name,
           "link '" + link.name + "': mesh '" + file.filename + "': " + warning});
    const double size = mesh.bounds().diagonal().norm();
    const std::string across = numberText(size) + " m across with scale " + numberText(scale.x()) +
                               " " + numberText(scale.y()) + " " + numberText(scale.z());
    if (!(size <= size_max))
      throw MeshError("mesh '" + file.filename + "' is " + across + "; at most " +
                      numberText(size_max) + " m");
    if (size > size_warn || size < size_tiny)
      model_->problems_.push_back({ModelProblem::mesh_warning, link.name,
                                   "link '" + link.name + "': mesh '" + file.filename + "' is " +
                                       across + ": is its scale right? Of a file in millimetres " +
                                       "it is 0.001 0.001 0.001"});
    return mesh;
  }

  const ModelOptions &options_;
  std::shared_ptr<RobotModel> model_;
  UrdfInspection inspection_;
  std::vector<std::string> errors_;
};

std::shared_ptr<const RobotModel> RobotModel::fromUrdf(const std::string &xml,
                                                       const ModelOptions &options)
{
  return UrdfReader(options).read(xml);
}

// ---- RobotModel -------------------------------------------------------------------------------

int RobotModel::findLink(const std::string &name) const
{
  const auto found = link_index_.find(name);
  return found == link_index_.end() ? -1 : found->second;
}

int RobotModel::findJoint(const std::string &name) const
{
  const auto found = joint_index_.find(name);
  return found == joint_index_.end() ? -1 : found->second;
}

int RobotModel::droppedCollisions() const
{
  int dropped = 0;
  for (const Link &link : links_) dropped += link.collision_tags - link.collisions_used;
  return dropped;
}

void RobotModel::forwardKinematics(const std::vector<double> &value,
                                   const std::vector<Eigen::Isometry3d> *placed,
                                   std::vector<Eigen::Isometry3d> *out) const
{
  if (value.size() != joints_.size() || (placed && placed->size() != joints_.size()))
    throw std::invalid_argument("forwardKinematics: " + std::to_string(value.size()) +
                                " values for " + std::to_string(joints_.size()) + " joints");
  out->resize(links_.size());
  (*out)[0] = Eigen::Isometry3d::Identity();
  for (size_t i = 0; i < joints_.size(); i++) {
    const Joint &j = joints_[i];
    const Eigen::Isometry3d &parent = (*out)[static_cast<size_t>(j.parent_link)];
    Eigen::Isometry3d &child = (*out)[static_cast<size_t>(j.child_link)];
    child = parent * j.origin;
    if (j.placed()) {
      if (placed) child = child * (*placed)[i];
      continue;
    }
    if (!j.movable()) continue;
    double q = value[i];
    if (j.mimic()) {
      const size_t from = static_cast<size_t>(j.mimic_source);
      const double source = joints_[from].movable() ? value[from] : 0;
      q = j.mimic_multiplier * source + j.mimic_offset;
    }
    if (j.kind == JointKind::prismatic)
      child.translate(q * j.axis);
    else
      child.rotate(Eigen::AngleAxisd(q, j.axis));
  }
}

// ---- RobotPose --------------------------------------------------------------------------------

RobotPose::RobotPose(std::shared_ptr<const RobotModel> model) : model_(std::move(model))
{
  forget();
}

void RobotPose::forget()
{
  const std::vector<Joint> &joints = model_->joints();
  value_.assign(joints.size(), 0);
  given_.assign(joints.size(), 0);
  placed_.assign(joints.size(), Eigen::Isometry3d::Identity());
  unknown_.clear();
  missing_count_ = 0;
  for (size_t i = 0; i < joints.size(); i++) {
    if (!joints[i].movable() || joints[i].mimic()) continue;
    value_[i] = std::clamp(0.0, joints[i].lower, joints[i].upper);
    missing_count_++;
  }
  stale_ = true;
}

JointUpdate RobotPose::set(const std::string &joint, double value)
{
  const int index = model_->findJoint(joint);
  if (index < 0) {
    if (std::find(unknown_.begin(), unknown_.end(), joint) != unknown_.end())
      return JointUpdate::unknown_again;
    unknown_.push_back(joint);
    return JointUpdate::unknown;
  }
  const size_t i = static_cast<size_t>(index);
  const Joint &j = model_->joints()[i];
  if (!j.movable()) return JointUpdate::not_movable;
  if (!std::isfinite(value)) return JointUpdate::not_finite;
  if (j.mimic()) return JointUpdate::mimic;
  if (!given_[i]) {
    given_[i] = 1;
    missing_count_--;
  }
  // Comparing bits is what is meant: an equal value moves nothing.
  if (value != value_[i]) stale_ = true;
  value_[i] = value;
  return JointUpdate::taken;
}

bool RobotPose::place(const std::string &joint, const Eigen::Isometry3d &pose)
{
  const int index = model_->findJoint(joint);
  if (index < 0 || !model_->joints()[static_cast<size_t>(index)].placed()) return false;
  if (!pose.matrix().allFinite()) return false;
  placed_[static_cast<size_t>(index)] = pose;
  stale_ = true;
  return true;
}

double RobotPose::value(int joint) const
{
  const Joint &j = model_->joints().at(static_cast<size_t>(joint));
  if (!j.movable()) return 0;
  if (!j.mimic()) return value_[static_cast<size_t>(joint)];
  return j.mimic_multiplier * value_[static_cast<size_t>(j.mimic_source)] + j.mimic_offset;
}

std::vector<std::string> RobotPose::missing() const
{
  std::vector<std::string> names;
  const std::vector<Joint> &joints = model_->joints();
  for (size_t i = 0; i < joints.size(); i++)
    if (joints[i].movable() && !joints[i].mimic() && !given_[i]) names.push_back(joints[i].name);
  return names;
}

const std::vector<Eigen::Isometry3d> &RobotPose::links()
{
  if (stale_) model_->forwardKinematics(value_, &placed_, &links_);
  stale_ = false;
  return links_;
}

} // namespace robot_cloth
