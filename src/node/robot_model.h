// A robot from URDF: links with their collision geometry as triangles, joints, mimic joints, and
// forward kinematics.
//
// RobotModel never changes after it was read and may be shared by threads. RobotPose holds the
// joint values of one robot; one thread at a time.
#pragma once

#include "link_meshes.h"

#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

namespace robot_cloth {

/// How a joint moves.
enum class JointKind {
  fixed,
  revolute,
  continuous,
  prismatic,
  planar,  // not driven by joint states: RobotPose::place(), e.g. from tf
  floating // as planar
};

const char *jointKindName(JointKind kind);

/// A joint. Its frame is its child link's frame.
struct Joint {
  std::string name;
  JointKind kind = JointKind::fixed;
  int parent_link = -1, child_link = -1;                    // indices into RobotModel::links()
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity(); // joint in the parent link, at zero
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();          // unit, joint frame
  double lower = -std::numeric_limits<double>::infinity();  // rad or m
  double upper = std::numeric_limits<double>::infinity();   // rad or m
  double velocity_max = std::numeric_limits<double>::infinity(); // rad/s or m/s

  // A mimic joint follows another: value = multiplier * value(source) + offset. Chains of mimics
  // are resolved: the source is never a mimic joint itself.
  int mimic_source = -1; // joint index, or -1: not a mimic
  double mimic_multiplier = 1, mimic_offset = 0;

  /// Revolute, continuous or prismatic: has one value.
  bool movable() const
  {
    return kind == JointKind::revolute || kind == JointKind::continuous ||
           kind == JointKind::prismatic;
  }
  /// Planar or floating: has a pose instead of a value.
  bool placed() const { return kind == JointKind::planar || kind == JointKind::floating; }
  bool mimic() const { return mimic_source >= 0; }
};

/// A rigid link.
struct Link {
  std::string name;
  int index = -1;
  int parent_joint = -1;   // joint index; -1: the root
  int parent_link = -1;    // link index; -1: the root
  int collision_tags = 0;  // <collision> elements in the XML
  int collisions_used = 0; // of which became triangles
  int visual_tags = 0;     // <visual> elements in the XML
  TriangleMesh mesh;       // all collision geometry of the link, link frame; may be empty
};

/// Something about the model that its user should hear.
struct ModelProblem {
  enum Kind {
    dropped_collision, // a <collision> that cannot be used and was left out
    mesh_warning,      // a mesh file that was repaired or is very large
    unusual_joint,     // planar, floating, limits in the wrong order, a mimic that never moves
  };
  Kind kind;
  std::string link_or_joint;
  std::string text; // one sentence that names the element, the value and what to fix
};

/// A model that cannot be used. what() lists every reason, one a line, with what to fix.
class ModelError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

struct ModelOptions {
  MeshOptions mesh;
  /// Leave out collision geometry with a nonsense size or an unreadable mesh, and report it as a
  /// problem, instead of refusing the model. A robot with holes: cloth passes through them.
  bool tolerate_bad_collisions = false;
  /// Read the collision meshes; false: kinematics only, every Link::mesh stays empty.
  bool load_meshes = true;
};

/// A robot as described by URDF.
class RobotModel {
public:
  /// Read a URDF document. Blocks for mesh files.
  ///
  /// Elements that urdfdom would drop silently are found in the XML and listed in problems().
  /// Throws ModelError: empty or invalid XML, no links, two roots, unknown or repeated names, a
  /// revolute or prismatic joint without limits, a mimic of a missing joint or of itself in a
  /// cycle, sizes, origins or axes that are negative, zero or not finite, meshes that cannot be
  /// read.
  static std::shared_ptr<const RobotModel> fromUrdf(const std::string &xml,
                                                    const ModelOptions &options = ModelOptions());

  const std::string &name() const { return name_; }
  /// Parents before children; links()[0] is the root.
  const std::vector<Link> &links() const { return links_; }
  /// In the order of the links that they carry: joints()[i].child_link == i + 1.
  const std::vector<Joint> &joints() const { return joints_; }
  const Link &root() const { return links_.front(); }
  int findLink(const std::string &name) const;  // index, or -1
  int findJoint(const std::string &name) const; // index, or -1

  /// Links that can be seen but not touched: <visual> and no <collision>.
  const std::vector<std::string> &visualOnlyLinks() const { return visual_only_; }
  const std::vector<ModelProblem> &problems() const { return problems_; }
  /// How many <collision> elements are in the XML but not in the model.
  int droppedCollisions() const;

  /// Pose of every link in the root frame.
  ///
  /// value   [joints().size()] rad or m; of movable joints that are no mimics; others are not read
  /// placed  [joints().size()] pose of planar and floating joints; nullptr: all at identity
  /// out     resized to links().size(); no allocation when it has that size already
  void forwardKinematics(const std::vector<double> &value,
                         const std::vector<Eigen::Isometry3d> *placed,
                         std::vector<Eigen::Isometry3d> *out) const;

private:
  friend class UrdfReader;
  std::string name_;
  std::vector<Link> links_;
  std::vector<Joint> joints_;
  std::unordered_map<std::string, int> link_index_, joint_index_;
  std::vector<std::string> visual_only_;
  std::vector<ModelProblem> problems_;
};

/// What became of a joint value.
enum class JointUpdate {
  taken,
  unknown,       // no such joint in the model, first time that this name was seen: report it
  unknown_again, // ... and seen before: stay silent
  not_movable,   // a fixed, planar or floating joint: ignored
  mimic,         // a mimic joint: ignored, it follows its source
  not_finite,    // NaN or infinite: refused, the old value stays
};

/// Joint values of a robot, and where they put its links.
class RobotPose {
public:
  /// All joints at zero, or at the limit nearest to zero; none counts as given.
  explicit RobotPose(std::shared_ptr<const RobotModel> model);

  const RobotModel &model() const { return *model_; }

  /// Set a joint by name. `value` rad or m. Values beyond the limits are taken as they are: a
  /// driver knows better where its joint is.
  JointUpdate set(const std::string &joint, double value);

  /// Put a planar or floating joint's child where tf says, relative to the joint's origin. False
  /// (and nothing changed): no such joint, or not finite.
  bool place(const std::string &joint, const Eigen::Isometry3d &pose);

  /// Value of a joint [rad or m], mimics resolved; 0 of fixed, planar and floating ones.
  double value(int joint) const;

  /// Movable joints, mimics aside, that were never given a value since the start or forget().
  std::vector<std::string> missing() const;
  bool complete() const { return missing_count_ == 0; }

  /// Names that set() did not know, each once.
  const std::vector<std::string> &unknown() const { return unknown_; }

  /// Back to the state after construction.
  void forget();

  /// Poses of all links in the root frame, indexed as model().links(). Computed when a value has
  /// changed; valid until the next call on this object. No allocation after the first call.
  const std::vector<Eigen::Isometry3d> &links();

private:
  std::shared_ptr<const RobotModel> model_;
  std::vector<double> value_;             // [joints]
  std::vector<char> given_;               // [joints]
  std::vector<Eigen::Isometry3d> placed_; // [joints]
  std::vector<Eigen::Isometry3d> links_;  // [links]
  std::vector<std::string> unknown_;
  int missing_count_ = 0;
  bool stale_ = true;
};

} // namespace robot_cloth
