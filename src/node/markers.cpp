#include "markers.h"

#include "cloth_messages.h"
#include "pose.h"

#include <Eigen/Core>

namespace robot_cloth {
namespace {

using visualization_msgs::Marker;

Marker makeMarker(const std_msgs::Header &header, const std::string &ns, int type)
{
  Marker m;
  m.header = header;
  m.ns = ns;
  m.type = type;
  m.action = Marker::ADD;
  m.pose.orientation.w = 1;
  m.scale.x = m.scale.y = m.scale.z = 1;
  m.color.r = m.color.g = m.color.b = m.color.a = 1;
  return m;
}

geometry_msgs::Point point(const Eigen::Vector3d &p)
{
  geometry_msgs::Point out;
  out.x = p.x(), out.y = p.y(), out.z = p.z();
  return out;
}

std_msgs::ColorRGBA colour(const Eigen::Vector3d &c)
{
  std_msgs::ColorRGBA out;
  out.r = static_cast<float>(c.x()), out.g = static_cast<float>(c.y()),
  out.b = static_cast<float>(c.z());
  out.a = 1;
  return out;
}

// The triangles of one side of a cloth, moved off the middle surface so that RViz, which draws both
// sides of a triangle alike, shows each side in its own colour. side: +1 front, -1 back.
void addSide(const std::vector<Eigen::Vector3d> &x, const std::vector<double> &normal,
             const std::vector<int> &triangles, double side, const Eigen::Vector3d &hue, Marker &m)
{
  // from above, a little from the front and left of a viewer who looks along +x
  static const Eigen::Vector3d light = Eigen::Vector3d(-0.45, -0.35, 0.82).normalized();
  const double offset = 4e-4; // m
  for (int v : triangles) {
    const Eigen::Vector3d n =
        side * Eigen::Map<const Eigen::Vector3d>(&normal[3 * static_cast<size_t>(v)]);
    const double lit = 0.5 + 0.5 * n.dot(light); // wrapped: nothing is black
    m.points.push_back(point(x[static_cast<size_t>(v)] + offset * n));
    m.colors.push_back(colour((0.40 + 0.60 * lit) * hue));
  }
}

Marker clothMarker(const Snapshot &s, size_t cloth)
{
  static const Eigen::Vector3d front(0.96, 0.94, 0.89), back(0.25, 0.52, 0.78);
  const ClothShape &shape = (*s.shapes)[cloth];
  const std::vector<double> &flat = s.cloths[cloth].positions;
  std::vector<Eigen::Vector3d> x(flat.size() / 3);
  for (size_t i = 0; i < x.size(); i++)
    x[i] = Eigen::Vector3d(flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]);
  const std::vector<double> normal = vertexNormals(flat, shape.triangles);
  Marker m = makeMarker(s.state.header, "cloth/" + shape.name, Marker::TRIANGLE_LIST);
  m.points.reserve(2 * shape.triangles.size());
  m.colors.reserve(2 * shape.triangles.size());
  addSide(x, normal, shape.triangles, 1, front, m);
  addSide(x, normal, shape.triangles, -1, back, m);
  return m;
}

} // namespace

visualization_msgs::MarkerArray clothMarkers(const Snapshot &s)
{
  visualization_msgs::MarkerArray out;
  for (size_t i = 0; i < s.cloths.size(); i++)
    if (!s.cloths[i].positions.empty()) out.markers.push_back(clothMarker(s, i));
  Marker held = makeMarker(s.state.header, "grasps", Marker::SPHERE_LIST);
  held.scale.x = held.scale.y = held.scale.z = 0.012;
  held.color.g = 0.35f, held.color.b = 0.1f;
  for (const GraspState &g : s.grasps.grasps)
    for (size_t i = 0; i + 2 < g.points.size(); i += 3)
      held.points.push_back(point({g.points[i], g.points[i + 1], g.points[i + 2]}));
  if (held.points.empty()) held.action = Marker::DELETE;
  out.markers.push_back(held);
  return out;
}

visualization_msgs::MarkerArray bodyMarkers(const World &world, const std::string &world_frame)
{
  visualization_msgs::MarkerArray out;
  for (int body = 0; body < cloth_body_count(world.scene.get()); body++) {
    const cloth_mesh_view mesh = cloth_body_mesh(world.scene.get(), body);
    if (mesh.triangle_count == 0) continue;
    std_msgs::Header header; // stamp 0: the newest transform
    const bool link = world.linkOfBody(body) >= 0;
    header.frame_id = link ? cloth_body_name(world.scene.get(), body) : world_frame;
    Marker m = makeMarker(header, std::string("body/") + cloth_body_name(world.scene.get(), body),
                          Marker::TRIANGLE_LIST);
    m.frame_locked = link;
    if (!link) m.pose = toMessage(toPose(cloth_body_pose(world.scene.get(), body)));
    m.color = colour(link ? Eigen::Vector3d(0.55, 0.58, 0.62) : Eigen::Vector3d(0.93, 0.80, 0.62));
    for (int i = 0; i < 3 * mesh.triangle_count; i++) {
      const double *p = mesh.position + 3 * mesh.triangle[i];
      m.points.push_back(point({p[0], p[1], p[2]}));
    }
    out.markers.push_back(m);
  }
  return out;
}

} // namespace robot_cloth
