#include "fcl_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/detail/primitive_shape_algorithm/triangle_distance.h>
#include <functional>
#include <limits>
#include <stdexcept>
#include <tuple>

namespace robot_cloth {
namespace {

using Tree = fcl::BVHModel<fcl::OBBRSS<double>>;
using Corners = std::array<Eigen::Vector3d, 3>;

// Rounding in FCL's boxes, as a fraction of the size of the coordinates: never lets a pair slip.
constexpr double box_slack = 1e-9;
// Twice the area below this fraction of the longest edge squared: no normal in double.
constexpr double flat = 1e-12;

[[noreturn]] void refuse(const std::string &text) { throw std::invalid_argument(text); }

void requireFinite(const double *x, int count, const std::string &what)
{
  for (int i = 0; i < 3 * count; i++)
    if (!std::isfinite(x[i])) refuse(what + ": vertex " + std::to_string(i / 3) + " is not finite");
}

void requireFinite(const Eigen::Isometry3d &pose, const std::string &what)
{
  if (!pose.matrix().allFinite()) refuse(what + ": the pose is not finite");
}

std::vector<Eigen::Vector3d> points(const double *x, int count)
{
  std::vector<Eigen::Vector3d> out;
  out.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; i++) out.emplace_back(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
  return out;
}

// A mesh with FCL's tree over it. The tree is in the mesh's own frame, `world` in the scene frame.
struct Mesh {
  std::vector<std::array<int, 3>> triangle;
  std::vector<Eigen::Vector3d> local, world;
  std::unique_ptr<Tree> tree; // nullptr: no triangles
  fcl::Transform3d pose = fcl::Transform3d::Identity();

  Mesh(const cloth_mesh_view &v, const std::string &what)
  {
    if (v.vertex_count < 0 || v.triangle_count < 0) refuse(what + ": negative counts");
    requireFinite(v.position, v.vertex_count, what);
    for (int t = 0; t < v.triangle_count; t++) {
      const int *c = v.triangle + 3 * t;
      for (int k = 0; k < 3; k++)
        if (c[k] < 0 || c[k] >= v.vertex_count)
          refuse(what + ": triangle " + std::to_string(t) + " names vertex " +
                 std::to_string(c[k]) + " of " + std::to_string(v.vertex_count));
      triangle.push_back({c[0], c[1], c[2]});
    }
    local = world = points(v.position, v.vertex_count);
    if (!triangle.empty()) build();
  }

  void build()
  {
    tree = std::make_unique<Tree>();
    std::vector<fcl::Triangle> corners;
    corners.reserve(triangle.size());
    for (const auto &t : triangle)
      corners.emplace_back(static_cast<size_t>(t[0]), static_cast<size_t>(t[1]),
                           static_cast<size_t>(t[2]));
    tree->beginModel(static_cast<int>(corners.size()), static_cast<int>(local.size()));
    tree->addSubModel(local, corners);
    tree->endModel();
    tree->computeLocalAABB();
  }

  // FCL's "replace", not its "update": that one keeps the previous positions too and bounds the
  // sweep from there, for continuous collision. And every node fitted to its own vertices ("top
  // down"), not to its two children: the union of two boxes in FCL 0.7 (merge_smalldist in
  // OBB-inl.h) looks at a corner for the minimum only if it did not raise the maximum, so the union
  // may leave out a corner, and triangles with it. The local AABB does not follow by itself.
  void refit(std::vector<Eigen::Vector3d> &&position)
  {
    local = std::move(position);
    world = local;
    if (!tree) return;
    tree->beginReplaceModel();
    tree->replaceSubModel(local);
    tree->endReplaceModel(true, false);
    tree->computeLocalAABB();
  }

  void place(const Eigen::Isometry3d &to)
  {
    pose.linear() = to.linear();
    pose.translation() = to.translation();
    for (size_t i = 0; i < local.size(); i++) world[i] = pose * local[i];
  }

  Corners corners(int t) const
  {
    const auto &c = triangle[static_cast<size_t>(t)];
    return {world[static_cast<size_t>(c[0])], world[static_cast<size_t>(c[1])],
            world[static_cast<size_t>(c[2])]};
  }
};

double twiceArea(const Corners &c) { return (c[1] - c[0]).cross(c[2] - c[0]).norm(); }

bool degenerate(const Corners &c)
{
  const double longest_sq = std::max(
      {(c[1] - c[0]).squaredNorm(), (c[2] - c[1]).squaredNorm(), (c[0] - c[2]).squaredNorm()});
  return !(twiceArea(c) > flat * longest_sq);
}

std::vector<char> degenerates(const Mesh &m)
{
  std::vector<char> out(m.triangle.size());
  for (size_t t = 0; t < out.size(); t++) out[t] = degenerate(m.corners(static_cast<int>(t)));
  return out;
}

// FCL's triangle distance takes a triangle whose |normal|^2 is below 1e-15 for a line, whatever the
// unit: that is one with edges of .2 mm. So it is asked about the pair moved to the origin and
// scaled until the smaller triangle has a normal of length one.
double distance(const Corners &a, const Corners &b)
{
  const double scale = 1 / std::sqrt(std::min(twiceArea(a), twiceArea(b)));
  fcl::Vector3d s[3], t[3], p, q;
  for (size_t k = 0; k < 3; k++) {
    s[k] = scale * (a[k] - a[0]);
    t[k] = scale * (b[k] - a[0]);
  }
  return fcl::detail::TriangleDistanced::triDistance(s, t, p, q) / scale;
}

// Every pair of leaves whose boxes, grown by `margin`, overlap.
//
// FCL itself offers either all colliding pairs or the one closest pair of two meshes, not all pairs
// within a distance. So its trees are walked here, with its boxes and its box test: a box grown by
// margin on each side holds every point within margin of the box.
class Walk {
public:
  using Visit = std::function<void(int body_triangle, int cloth_triangle)>;

  Walk(const Mesh &body, const Mesh &cloth, double margin, Visit visit)
      : body_(*body.tree), cloth_(*cloth.tree), visit_(std::move(visit))
  {
    const fcl::Transform3d to_body = body.pose.inverse(Eigen::Isometry);
    rotation_ = to_body.linear();
    translation_ = to_body.translation();
    double size = translation_.norm();
    for (const Mesh *m : {&body, &cloth})
      for (const Eigen::Vector3d &v : m->local) size = std::max(size, v.norm());
    grow_ = margin + box_slack * size;
    down(0, 0);
  }

private:
  void down(int b, int c)
  {
    const auto &body = body_.getBV(b);
    const auto &cloth = cloth_.getBV(c);
    fcl::OBB<double> grown = body.bv.obb;
    grown.extent.array() += grow_;
    if (!fcl::overlap(rotation_, translation_, grown, cloth.bv.obb)) return;
    if (body.isLeaf() && cloth.isLeaf()) {
      visit_(body.primitiveId(), cloth.primitiveId());
      return;
    }
    const bool split_body =
        cloth.isLeaf() ||
        (!body.isLeaf() && body.bv.obb.extent.squaredNorm() > cloth.bv.obb.extent.squaredNorm());
    if (split_body) {
      down(body.leftChild(), c);
      down(body.rightChild(), c);
    } else {
      down(b, cloth.leftChild());
      down(b, cloth.rightChild());
    }
  }

  const Tree &body_, &cloth_;
  Visit visit_;
  fcl::Matrix3d rotation_;
  fcl::Vector3d translation_;
  double grow_ = 0;
};

bool before(const cloth_body_pair &a, const cloth_body_pair &b)
{
  return std::tie(a.body, a.body_triangle, a.cloth, a.cloth_triangle) <
         std::tie(b.body, b.body_triangle, b.cloth, b.cloth_triangle);
}

bool same(const cloth_body_pair &a, const cloth_body_pair &b)
{
  return !before(a, b) && !before(b, a);
}

// Triangle pairs that FCL finds colliding.
std::vector<std::pair<int, int>> colliding(const Mesh &a, const Mesh &b)
{
  std::vector<std::pair<int, int>> out;
  if (!a.tree || !b.tree) return out;
  // All of them: the default of one contact is one of the silent caps of this field.
  const fcl::CollisionRequestd all(std::numeric_limits<size_t>::max(), false);
  fcl::CollisionResultd result;
  fcl::collide(a.tree.get(), a.pose, b.tree.get(), b.pose, all, result);
  out.reserve(result.numContacts());
  for (size_t i = 0; i < result.numContacts(); i++) {
    const fcl::Contactd &c = result.getContact(i);
    out.emplace_back(static_cast<int>(c.b1), static_cast<int>(c.b2));
  }
  std::sort(out.begin(), out.end());
  return out;
}

bool shareVertex(const std::array<int, 3> &a, const std::array<int, 3> &b)
{
  for (int x : a)
    for (int y : b)
      if (x == y) return true;
  return false;
}

} // namespace

struct FclCheck::Impl {
  std::vector<Mesh> body, cloth;

  Mesh &at(std::vector<Mesh> &list, int index, const char *what)
  {
    if (index < 0 || static_cast<size_t>(index) >= list.size())
      refuse(std::string(what) + " " + std::to_string(index) + " of " +
             std::to_string(list.size()) + " does not exist");
    return list[static_cast<size_t>(index)];
  }
};

FclCheck::FclCheck() : impl_(std::make_unique<Impl>()) {}
FclCheck::~FclCheck() = default;
FclCheck::FclCheck(FclCheck &&) noexcept = default;
FclCheck &FclCheck::operator=(FclCheck &&) noexcept = default;

int FclCheck::addBody(const cloth_mesh_view &mesh, const Eigen::Isometry3d &pose)
{
  const std::string what = "body " + std::to_string(bodyCount());
  requireFinite(pose, what);
  Mesh m(mesh, what);
  m.place(pose);
  impl_->body.push_back(std::move(m));
  return bodyCount() - 1;
}

void FclCheck::moveBody(int body, const Eigen::Isometry3d &pose)
{
  Mesh &m = impl_->at(impl_->body, body, "body");
  requireFinite(pose, "body " + std::to_string(body));
  m.place(pose);
}

int FclCheck::addCloth(const cloth_mesh_view &mesh)
{
  impl_->cloth.emplace_back(mesh, "cloth " + std::to_string(clothCount()));
  return clothCount() - 1;
}

void FclCheck::moveCloth(int cloth, const double *position, int count)
{
  Mesh &m = impl_->at(impl_->cloth, cloth, "cloth");
  const std::string what = "cloth " + std::to_string(cloth);
  if (count < 0 || static_cast<size_t>(count) != m.local.size())
    refuse(what + ": " + std::to_string(count) + " positions for " +
           std::to_string(m.local.size()) + " vertices");
  requireFinite(position, count, what);
  m.refit(points(position, count));
}

int FclCheck::bodyCount() const { return static_cast<int>(impl_->body.size()); }
int FclCheck::clothCount() const { return static_cast<int>(impl_->cloth.size()); }

PairComparison FclCheck::compare(double margin, double epsilon, const cloth_body_pair *candidates,
                                 int count, int missed_max) const
{
  if (!(margin >= 0 && margin <= .1))
    refuse("margin " + std::to_string(margin) + " m is outside [0, 0.1]");
  if (!(epsilon >= 0)) refuse("epsilon " + std::to_string(epsilon) + " m is negative");
  std::vector<cloth_body_pair> offered(candidates, candidates + std::max(count, 0));
  for (const cloth_body_pair &p : offered) {
    const Mesh &b = impl_->at(impl_->body, p.body, "candidate: body");
    const Mesh &c = impl_->at(impl_->cloth, p.cloth, "candidate: cloth");
    if (p.body_triangle < 0 || static_cast<size_t>(p.body_triangle) >= b.triangle.size() ||
        p.cloth_triangle < 0 || static_cast<size_t>(p.cloth_triangle) >= c.triangle.size())
      refuse("candidate (body " + std::to_string(p.body) + " triangle " +
             std::to_string(p.body_triangle) + ", cloth " + std::to_string(p.cloth) + " triangle " +
             std::to_string(p.cloth_triangle) + ") names a triangle that does not exist");
  }
  std::sort(offered.begin(), offered.end(), before);
  offered.erase(std::unique(offered.begin(), offered.end(), same), offered.end());

  PairComparison out;
  out.margin = margin;
  out.candidates = static_cast<int64_t>(offered.size());
  std::vector<std::vector<char>> flat_cloth;
  for (const Mesh &c : impl_->cloth) {
    flat_cloth.push_back(degenerates(c));
    out.degenerate += std::count(flat_cloth.back().begin(), flat_cloth.back().end(), 1);
  }
  for (int b = 0; b < bodyCount(); b++) {
    const Mesh &body = impl_->body[static_cast<size_t>(b)];
    const std::vector<char> flat_body = degenerates(body);
    out.degenerate += std::count(flat_body.begin(), flat_body.end(), 1);
    for (int c = 0; c < clothCount(); c++) {
      const Mesh &cloth = impl_->cloth[static_cast<size_t>(c)];
      if (!body.tree || !cloth.tree) continue;
      Walk(body, cloth, margin, [&](int bt, int ct) {
        if (flat_body[static_cast<size_t>(bt)] ||
            flat_cloth[static_cast<size_t>(c)][static_cast<size_t>(ct)])
          return;
        const double d = distance(body.corners(bt), cloth.corners(ct));
        if (!(d < margin)) return;
        out.truth++;
        const cloth_body_pair pair = {b, bt, c, ct};
        if (d < margin - epsilon &&
            !std::binary_search(offered.begin(), offered.end(), pair, before))
          out.missed.push_back({pair, d});
      });
    }
  }
  out.missed_count = static_cast<int64_t>(out.missed.size());
  std::sort(out.missed.begin(), out.missed.end(), [](const MissedPair &x, const MissedPair &y) {
    return x.distance < y.distance || (x.distance == y.distance && before(x.pair, y.pair));
  });
  if (out.missed_count > missed_max)
    out.missed.resize(static_cast<size_t>(std::max(missed_max, 0)));
  if (out.truth > 0)
    out.ratio = static_cast<double>(out.candidates) / static_cast<double>(out.truth);
  return out;
}

Intersections FclCheck::intersections(int pairs_max) const
{
  Intersections out;
  const auto keep = [&](int64_t *count, const IntersectingPair &pair) {
    (*count)++;
    if (static_cast<int64_t>(out.pairs.size()) < pairs_max) out.pairs.push_back(pair);
  };
  for (int a = 0; a < clothCount(); a++) {
    const Mesh &first = impl_->cloth[static_cast<size_t>(a)];
    for (const auto &[x, y] : colliding(first, first)) {
      // Both (x, y) and (y, x) are there, and every triangle with itself.
      if (x >= y) continue;
      if (shareVertex(first.triangle[static_cast<size_t>(x)],
                      first.triangle[static_cast<size_t>(y)]))
        continue;
      keep(&out.cloth_cloth, {a, x, -1, a, y});
    }
    for (int b = a + 1; b < clothCount(); b++)
      for (const auto &[x, y] : colliding(first, impl_->cloth[static_cast<size_t>(b)]))
        keep(&out.cloth_cloth, {a, x, -1, b, y});
    for (int b = 0; b < bodyCount(); b++)
      for (const auto &[x, y] : colliding(first, impl_->body[static_cast<size_t>(b)]))
        keep(&out.cloth_body, {a, x, b, -1, y});
  }
  return out;
}

} // namespace robot_cloth
