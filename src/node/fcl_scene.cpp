// FclCheck filled from a scene of libcloth; the rest of it knows meshes only.
#include "fcl_check.h"

#include <stdexcept>

namespace robot_cloth {
namespace {

Eigen::Isometry3d toEigen(const cloth_pose &pose)
{
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  const double *r = pose.rotation, *p = pose.position;
  out.linear() = Eigen::Quaterniond(r[3], r[0], r[1], r[2]).normalized().toRotationMatrix();
  out.translation() = Eigen::Vector3d(p[0], p[1], p[2]);
  return out;
}

std::vector<double> positions(cloth_scene *scene, int cloth)
{
  const int count = cloth_vertex_count(scene, cloth);
  std::vector<double> out(3 * static_cast<size_t>(count));
  cloth_error err = {};
  if (cloth_positions(scene, cloth, out.data(), count, &err) != CLOTH_OK)
    throw std::runtime_error("cross-check: positions of cloth '" +
                             std::string(cloth_name(scene, cloth)) + "': " + err.text);
  return out;
}

} // namespace

FclCheck FclCheck::fromScene(cloth_scene *scene)
{
  FclCheck check;
  for (int b = 0; b < cloth_body_count(scene); b++)
    check.addBody(cloth_body_mesh(scene, b), toEigen(cloth_body_pose(scene, b)));
  for (int c = 0; c < cloth_count(scene); c++) {
    const std::vector<double> x = positions(scene, c);
    cloth_mesh_view mesh = {};
    mesh.vertex_count = cloth_vertex_count(scene, c);
    mesh.triangle_count = cloth_triangle_count(scene, c);
    mesh.position = x.data();
    mesh.triangle = cloth_triangles(scene, c);
    check.addCloth(mesh);
  }
  return check;
}

void FclCheck::update(cloth_scene *scene)
{
  if (cloth_body_count(scene) != bodyCount() || cloth_count(scene) != clothCount())
    throw std::invalid_argument("cross-check: the scene has other bodies or cloths than before");
  for (int b = 0; b < bodyCount(); b++) moveBody(b, toEigen(cloth_body_pose(scene, b)));
  for (int c = 0; c < clothCount(); c++) {
    const std::vector<double> x = positions(scene, c);
    moveCloth(c, x.data(), cloth_vertex_count(scene, c));
  }
}

} // namespace robot_cloth
