#include "cloth_messages.h"

#include <Eigen/Geometry>
#include <cstring>

namespace robot_cloth {

std::vector<double> vertexNormals(const std::vector<double> &positions,
                                  const std::vector<int> &triangles)
{
  using Rows = Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>>;
  const Rows x(positions.data(), 3, static_cast<Eigen::Index>(positions.size() / 3));
  std::vector<double> out(positions.size(), 0);
  Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic>> n(out.data(), 3, x.cols());
  for (size_t t = 0; t + 2 < triangles.size(); t += 3) {
    const int *v = &triangles[t];
    const Eigen::Vector3d a = x.col(v[1]) - x.col(v[0]), b = x.col(v[2]) - x.col(v[0]);
    const Eigen::Vector3d area = a.cross(b);
    for (int k = 0; k < 3; k++) n.col(v[k]) += area;
  }
  for (Eigen::Index i = 0; i < n.cols(); i++)
    if (n.col(i).norm() > 0) n.col(i).normalize();
  return out;
}

sensor_msgs::PointCloud2 cloudMessage(const std_msgs::Header &header, const ClothShape &shape,
                                      const ClothFrame &frame, const Settings &settings)
{
  struct Column {
    const char *name;
    const double *value; // [vertices x stride], starting at this column
    int stride;
  };
  const size_t count = frame.positions.size() / 3;
  std::vector<double> normals, pinned;
  std::vector<Column> columns;
  auto addVector = [&](const char *const(&names)[3], const std::vector<double> &v) {
    for (int k = 0; k < 3; k++) columns.push_back({names[k], v.data() + k, 3});
  };
  addVector({"x", "y", "z"}, frame.positions);
  if (settings.normals) {
    normals = vertexNormals(frame.positions, shape.triangles);
    addVector({"normal_x", "normal_y", "normal_z"}, normals);
  }
  if (settings.velocities && frame.velocities.size() == frame.positions.size())
    addVector({"velocity_x", "velocity_y", "velocity_z"}, frame.velocities);
  if (settings.pinned && frame.held.size() == count) {
    pinned.assign(frame.held.begin(), frame.held.end());
    columns.push_back({"pinned", pinned.data(), 1});
  }
  sensor_msgs::PointCloud2 m;
  m.header = header;
  m.height = 1;
  m.width = static_cast<uint32_t>(count);
  m.point_step = static_cast<uint32_t>(columns.size() * sizeof(float));
  m.row_step = m.width * m.point_step;
  m.is_dense = true;
  m.data.resize(m.row_step);
  uint32_t offset = 0;
  for (const Column &c : columns) {
    sensor_msgs::PointField field;
    field.name = c.name;
    field.offset = offset;
    field.datatype = sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    m.fields.push_back(field);
    for (size_t i = 0; i < count; i++) {
      const float value = static_cast<float>(c.value[i * static_cast<size_t>(c.stride)]);
      std::memcpy(&m.data[i * m.point_step + offset], &value, sizeof value);
    }
    offset += sizeof(float);
  }
  return m;
}

ClothMesh meshMessage(const std_msgs::Header &header, const ClothShape &shape,
                      const ClothFrame &frame)
{
  ClothMesh m;
  m.header = header;
  m.cloth = shape.name;
  m.mesh.triangles.resize(shape.triangles.size() / 3);
  for (size_t t = 0; t < m.mesh.triangles.size(); t++)
    for (size_t k = 0; k < 3; k++)
      m.mesh.triangles[t].vertex_indices[k] = static_cast<uint32_t>(shape.triangles[3 * t + k]);
  m.mesh.vertices.resize(frame.positions.size() / 3);
  for (size_t i = 0; i < m.mesh.vertices.size(); i++) {
    m.mesh.vertices[i].x = frame.positions[3 * i];
    m.mesh.vertices[i].y = frame.positions[3 * i + 1];
    m.mesh.vertices[i].z = frame.positions[3 * i + 2];
  }
  return m;
}

Topology topologyMessage(const std_msgs::Header &header, const ClothShape &shape)
{
  Topology m;
  m.header = header;
  m.cloth = shape.name;
  m.vertex_count = static_cast<uint32_t>(shape.rest_positions.size() / 3);
  m.triangles.assign(shape.triangles.begin(), shape.triangles.end());
  m.rest_positions = shape.rest_positions;
  for (const auto &g : shape.groups) {
    VertexGroup group;
    group.name = g.first;
    group.vertices.assign(g.second.begin(), g.second.end());
    m.groups.push_back(group);
  }
  return m;
}

} // namespace robot_cloth
