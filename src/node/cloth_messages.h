// A cloth as sensor_msgs/PointCloud2, ClothMesh and Topology.
#pragma once

#include "settings.h"
#include "snapshot.h"

#include <robot_cloth/ClothMesh.h>
#include <robot_cloth/Topology.h>
#include <sensor_msgs/PointCloud2.h>

namespace robot_cloth {

/// Row i is vertex i: x y z and, where wanted and known, normal_x.., velocity_x.., pinned (all
/// float32).
sensor_msgs::PointCloud2 cloudMessage(const std_msgs::Header &header, const ClothShape &shape,
                                      const ClothFrame &frame, const Settings &settings);
ClothMesh meshMessage(const std_msgs::Header &header, const ClothShape &shape,
                      const ClothFrame &frame);
Topology topologyMessage(const std_msgs::Header &header, const ClothShape &shape);

/// Area-weighted unit normals [vertices x 3]; zero where there is no area.
std::vector<double> vertexNormals(const std::vector<double> &positions,
                                  const std::vector<int> &triangles);

} // namespace robot_cloth
