// Between the poses of the engine, of Eigen and of ROS messages.
#pragma once

#include "cloth.h"

#include <Eigen/Geometry>
#include <cmath>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>

namespace robot_cloth {

using Pose = Eigen::Isometry3d;

inline Pose makePose(const Eigen::Vector3d &position, const Eigen::Quaterniond &rotation)
{
  Pose p = Pose::Identity();
  p.linear() = rotation.toRotationMatrix();
  p.translation() = position;
  return p;
}

inline Pose toPose(const cloth_pose &p)
{
  const double *q = p.rotation;
  return makePose({p.position[0], p.position[1], p.position[2]},
                  Eigen::Quaterniond(q[3], q[0], q[1], q[2]));
}

inline cloth_pose toCloth(const Pose &p)
{
  const Eigen::Vector3d x = p.translation();
  const Eigen::Quaterniond q(p.linear());
  return {{x.x(), x.y(), x.z()}, {q.x(), q.y(), q.z(), q.w()}};
}

inline geometry_msgs::Pose toMessage(const Pose &p)
{
  geometry_msgs::Pose m;
  const Eigen::Quaterniond q(p.linear());
  m.position.x = p.translation().x(), m.position.y = p.translation().y(),
  m.position.z = p.translation().z();
  m.orientation.x = q.x(), m.orientation.y = q.y(), m.orientation.z = q.z(),
  m.orientation.w = q.w();
  return m;
}

/// A pose as received. An all-zero quaternion, as an empty message has it, is no rotation; false if
/// anything is not finite or the quaternion is far from unit length.
template <class V, class Q> bool readPose(const V &v, const Q &q, Pose *out)
{
  if (!std::isfinite(v.x + v.y + v.z + q.x + q.y + q.z + q.w)) return false;
  Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
  const double length = rotation.norm();
  if (length == 0)
    rotation.setIdentity();
  else if (!(std::fabs(length - 1) < 0.01))
    return false;
  else
    rotation.normalize();
  *out = makePose({v.x, v.y, v.z}, rotation);
  return true;
}

inline bool readPose(const geometry_msgs::Pose &m, Pose *out)
{
  return readPose(m.position, m.orientation, out);
}

inline bool readPose(const geometry_msgs::Transform &m, Pose *out)
{
  return readPose(m.translation, m.rotation, out);
}

} // namespace robot_cloth
