#include "check_meshes.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/box_intersection_d.h>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <numeric>
#include <sstream>
#include <stdexcept>

namespace check_meshes {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = Kernel::Triangle_3;
using Segment = Kernel::Segment_3;
using Box = CGAL::Box_intersection_d::Box_d<double, 3>;
using Surface = CGAL::Surface_mesh<Point>;

/// A triangle with what is needed to intersect it. One without area is the segment it covers.
struct Face {
  int mesh, index;
  int vertex[3];
  Point corner[3];
  bool flat;   // no area
  Segment all; // of a flat one
};

struct FaceBox : Box {
  const Face *face;
  FaceBox(const CGAL::Bbox_3 &box, const Face *f) : Box(box), face(f) {}
};

Segment longest_edge(const Face &f)
{
  int best = 0;
  for (int k = 1; k < 3; k++)
    if (CGAL::squared_distance(f.corner[k], f.corner[(k + 1) % 3]) >
        CGAL::squared_distance(f.corner[best], f.corner[(best + 1) % 3]))
      best = k;
  return Segment(f.corner[best], f.corner[(best + 1) % 3]);
}

std::vector<Face> faces_of(const std::vector<Mesh> &meshes)
{
  std::vector<Face> faces;
  for (int m = 0; m < static_cast<int>(meshes.size()); m++) {
    const Mesh &mesh = meshes[m];
    for (int t = 0; t < static_cast<int>(mesh.triangle.size()) / 3; t++) {
      Face f;
      f.mesh = m;
      f.index = t;
      for (int k = 0; k < 3; k++) {
        f.vertex[k] = mesh.triangle[3 * t + k];
        const double *x = &mesh.position[3 * f.vertex[k]];
        f.corner[k] = Point(x[0], x[1], x[2]);
      }
      f.flat = CGAL::collinear(f.corner[0], f.corner[1], f.corner[2]);
      if (f.flat) f.all = longest_edge(f);
      faces.push_back(f);
    }
  }
  return faces;
}

std::vector<FaceBox> boxes_of(const std::vector<Face> &faces)
{
  std::vector<FaceBox> boxes;
  boxes.reserve(faces.size());
  for (const Face &f : faces)
    boxes.emplace_back(f.corner[0].bbox() + f.corner[1].bbox() + f.corner[2].bbox(), &f);
  return boxes;
}

bool meet(const Face &a, const Segment &s)
{
  if (s.is_degenerate()) {
    if (!a.flat) return Triangle(a.corner[0], a.corner[1], a.corner[2]).has_on(s.source());
    return a.all.is_degenerate() ? a.all.source() == s.source() : a.all.has_on(s.source());
  }
  if (!a.flat) return CGAL::do_intersect(Triangle(a.corner[0], a.corner[1], a.corner[2]), s);
  if (a.all.is_degenerate()) return s.has_on(a.all.source());
  return CGAL::do_intersect(a.all, s);
}

bool meet(const Face &a, const Face &b)
{
  if (b.flat) return meet(a, b.all);
  if (a.flat) return meet(b, a.all);
  return CGAL::do_intersect(Triangle(a.corner[0], a.corner[1], a.corner[2]),
                            Triangle(b.corner[0], b.corner[1], b.corner[2]));
}

// Two triangles with one common corner meet in a segment (or more) that starts there; its other end
// lies on the edge opposite to the corner, of one or of the other.
bool meet_at_corner(const Face &a, int i, const Face &b, int j)
{
  return meet(a, Segment(b.corner[(j + 1) % 3], b.corner[(j + 2) % 3])) ||
         meet(b, Segment(a.corner[(i + 1) % 3], a.corner[(i + 2) % 3]));
}

// Two triangles with a common edge meet elsewhere only if they lie in one plane on one side of it.
bool meet_at_edge(const Face &a, int i, const Face &b, int j)
{
  const Point &e0 = a.corner[(i + 1) % 3], &e1 = a.corner[(i + 2) % 3];
  if (a.flat || b.flat) return false; // between its neighbours, which are tested
  return CGAL::coplanar(e0, e1, a.corner[i], b.corner[j]) &&
         CGAL::coplanar_orientation(e0, e1, a.corner[i], b.corner[j]) == CGAL::POSITIVE;
}

bool meet_in_cloth(const Face &a, const Face &b)
{
  int shared = 0, ia = 0, ib = 0, own_a = 0, own_b = 0;
  if (a.mesh == b.mesh)
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        if (a.vertex[i] == b.vertex[j]) {
          shared++;
          ia = i, ib = j;
          own_a += i, own_b += j;
        }
  switch (shared) {
  case 0:
    return meet(a, b);
  case 1:
    return meet_at_corner(a, ia, b, ib);
  case 2:
    return meet_at_edge(a, 3 - own_a, b, 3 - own_b);
  default:
    return true; // the same triangle twice
  }
}

// ---- a piece of cloth inside a body ------------------------------------------------------------

bool closed_surface(const Mesh &mesh, Surface *out)
{
  std::vector<Surface::Vertex_index> vertex;
  for (size_t i = 0; i + 2 < mesh.position.size(); i += 3)
    vertex.push_back(
        out->add_vertex(Point(mesh.position[i], mesh.position[i + 1], mesh.position[i + 2])));
  for (size_t t = 0; t + 2 < mesh.triangle.size(); t += 3)
    if (out->add_face(vertex[mesh.triangle[t]], vertex[mesh.triangle[t + 1]],
                      vertex[mesh.triangle[t + 2]]) == Surface::null_face())
      return false; // not a manifold: it has no inside
  return CGAL::is_closed(*out);
}

int root_of(std::vector<int> &parent, int i)
{
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// one vertex of each connected piece
std::vector<int> pieces(const Mesh &mesh)
{
  std::vector<int> parent(mesh.position.size() / 3);
  std::iota(parent.begin(), parent.end(), 0);
  for (size_t t = 0; t + 2 < mesh.triangle.size(); t += 3)
    for (int k = 1; k < 3; k++)
      parent[root_of(parent, mesh.triangle[t + k])] = root_of(parent, mesh.triangle[t]);
  std::vector<int> roots;
  for (size_t t = 0; t + 2 < mesh.triangle.size(); t += 3)
    roots.push_back(root_of(parent, mesh.triangle[t]));
  std::sort(roots.begin(), roots.end());
  roots.erase(std::unique(roots.begin(), roots.end()), roots.end());
  return roots;
}

CGAL::Bbox_3 box_of(const Mesh &mesh)
{
  CGAL::Bbox_3 box;
  for (size_t i = 0; i + 2 < mesh.position.size(); i += 3)
    box += Point(mesh.position[i], mesh.position[i + 1], mesh.position[i + 2]).bbox();
  return box;
}

// Where no triangle cuts a body's surface, a piece of cloth is wholly inside or wholly outside, and
// one of its vertices tells.
void find_inside(const std::vector<Mesh> &cloths, const std::vector<Mesh> &bodies, Result *out)
{
  for (int b = 0; b < static_cast<int>(bodies.size()); b++) {
    CGAL::Bbox_3 box = box_of(bodies[b]);
    Surface surface;
    bool built = false, closed = false;
    for (int c = 0; c < static_cast<int>(cloths.size()); c++)
      for (int v : pieces(cloths[c])) {
        const double *x = &cloths[c].position[3 * v];
        Point p(x[0], x[1], x[2]);
        if (!CGAL::do_overlap(box, p.bbox())) continue;
        if (!built) closed = closed_surface(bodies[b], &surface), built = true;
        if (!closed) continue;
        CGAL::Side_of_triangle_mesh<Surface, Kernel> side(surface);
        if (side(p) != CGAL::ON_UNBOUNDED_SIDE) out->cloth_in_body.emplace_back(c, b);
      }
  }
}

// ---- reading -----------------------------------------------------------------------------------

[[noreturn]] void refuse(const std::string &path, int line, const char *what)
{
  throw std::runtime_error(path + ":" + std::to_string(line) + ": " + what);
}

void read_face(const char *at, Mesh *mesh, const std::string &path, int line)
{
  std::vector<int> corner;
  for (;;) {
    char *end;
    long index = std::strtol(at, &end, 10);
    if (end == at) break;
    int count = static_cast<int>(mesh->position.size() / 3);
    int vertex = static_cast<int>(index > 0 ? index - 1 : count + index);
    if (vertex < 0 || vertex >= count) refuse(path, line, "a vertex index is out of range");
    corner.push_back(vertex);
    at = end + std::strcspn(end, " \t\r\n"); // over /vt/vn
  }
  if (corner.size() < 3) refuse(path, line, "a face needs three corners");
  for (size_t k = 2; k < corner.size(); k++)
    mesh->triangle.insert(mesh->triangle.end(), {corner[0], corner[k - 1], corner[k]});
}

} // namespace

Mesh read_obj(const std::string &path)
{
  Mesh mesh;
  mesh.name = path;
  FILE *f = std::fopen(path.c_str(), "r");
  if (!f) throw std::runtime_error(path + ": cannot read it");
  char text[4096];
  int line = 0;
  try {
    while (std::fgets(text, sizeof text, f)) {
      line++;
      if (text[0] == 'v' && text[1] == ' ') {
        char *at = text + 1;
        for (int k = 0; k < 3; k++) {
          char *end;
          double x = std::strtod(at, &end);
          if (end == at || !(x - x == 0)) refuse(path, line, "a vertex needs three finite numbers");
          mesh.position.push_back(x);
          at = end;
        }
      } else if (text[0] == 'f' && text[1] == ' ') {
        read_face(text + 1, &mesh, path, line);
      }
    }
  } catch (...) {
    std::fclose(f);
    throw;
  }
  std::fclose(f);
  return mesh;
}

Result intersections(const std::vector<Mesh> &cloths, const std::vector<Mesh> &bodies)
{
  Result result;
  std::vector<Face> cloth_faces = faces_of(cloths), body_faces = faces_of(bodies);
  std::vector<FaceBox> cloth_boxes = boxes_of(cloth_faces), body_boxes = boxes_of(body_faces);

  CGAL::box_self_intersection_d(
      cloth_boxes.begin(), cloth_boxes.end(), [&](const FaceBox &a, const FaceBox &b) {
        if (meet_in_cloth(*a.face, *b.face))
          result.cloth_cloth.push_back({a.face->mesh, a.face->index, b.face->mesh, b.face->index});
      });
  CGAL::box_intersection_d(
      cloth_boxes.begin(), cloth_boxes.end(), body_boxes.begin(), body_boxes.end(),
      [&](const FaceBox &a, const FaceBox &b) {
        if (meet(*a.face, *b.face))
          result.cloth_body.push_back({a.face->mesh, a.face->index, b.face->mesh, b.face->index});
      });
  if (result.cloth_body.empty()) find_inside(cloths, bodies, &result);
  return result;
}

} // namespace check_meshes
