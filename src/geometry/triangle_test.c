// The tests follow from one another: point sets are met by segments, and two triangles that meet do
// so on an edge of one of them. Everything is decided by signs of predicates.h and by comparing
// coordinates.
#include "geometry/triangle_test.h"

#include "geometry/predicates.h"

// What a triangle covers: itself, a segment or a point.
typedef struct hull {
  int size; // corners: 3, 2, 1
  const double *x[3];
} hull;

static bool same_place(const double *p, const double *q)
{
  return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

// p before q in the order of x, then y, then z, which along a line is the line's
static bool before(const double *p, const double *q)
{
  for (int k = 0; k < 3; k++)
    if (p[k] != q[k]) return p[k] < q[k];
  return false;
}

// an axis along which a b c shows an area, -1 if they lie on one line
static int open_axis(const double *a, const double *b, const double *c)
{
  for (int axis = 2; axis >= 0; axis--)
    if (cloth_orient2d(a, b, c, axis) != 0) return axis;
  return -1;
}

static hull hull_of(const double *const x[3])
{
  hull h = {3, {x[0], x[1], x[2]}};
  if (open_axis(x[0], x[1], x[2]) >= 0) return h;
  const double *low = x[0], *high = x[0];
  for (int k = 1; k < 3; k++) {
    if (before(x[k], low)) low = x[k];
    if (before(high, x[k])) high = x[k];
  }
  return (hull){before(low, high) ? 2 : 1, {low, high, high}};
}

// ---- in a plane, seen along an axis ------------------------------------------------------------

// Is x, which lies on the line of p and q, between them?
static bool between(const double *x, const double *p, const double *q, int axis)
{
  for (int k = 1; k < 3; k++) {
    double at = x[(axis + k) % 3], a = p[(axis + k) % 3], b = q[(axis + k) % 3];
    if (!((a <= at && at <= b) || (b <= at && at <= a))) return false;
  }
  return true;
}

// segments p q and r s; either may be a point
static bool segments_meet_flat(const double *p, const double *q, const double *r, const double *s,
                               int axis)
{
  int a = cloth_orient2d(p, q, r, axis), b = cloth_orient2d(p, q, s, axis);
  if (a * b > 0) return false;
  int c = cloth_orient2d(r, s, p, axis), d = cloth_orient2d(r, s, q, axis);
  if (a * b < 0 && c * d < 0) return true;
  return (a == 0 && between(r, p, q, axis)) || (b == 0 && between(s, p, q, axis)) ||
         (c == 0 && between(p, r, s, axis)) || (d == 0 && between(q, r, s, axis));
}

// segment p q and triangle x with an area along the axis
static bool segment_meets_flat(const double *p, const double *q, const double *const x[3], int axis)
{
  int left = 0, right = 0;
  for (int k = 0; k < 3; k++) {
    int side = cloth_orient2d(x[k], x[(k + 1) % 3], p, axis);
    left += side > 0, right += side < 0;
  }
  if (left == 0 || right == 0) return true; // p is inside
  for (int k = 0; k < 3; k++)
    if (segments_meet_flat(p, q, x[k], x[(k + 1) % 3], axis)) return true;
  return false;
}

// ---- in space ----------------------------------------------------------------------------------

// segments p q and r s; either may be a point
static bool segments_meet(const double *p, const double *q, const double *r, const double *s)
{
  if (cloth_orient3d(p, q, r, s) != 0) return false;
  const double *const x[4] = {p, q, r, s};
  for (int left_out = 0; left_out < 4; left_out++) {
    int axis = open_axis(x[left_out == 0], x[left_out < 2 ? 2 : 1], x[left_out < 3 ? 3 : 2]);
    if (axis >= 0) return segments_meet_flat(p, q, r, s, axis);
  }
  // all four on one line
  const double *low = before(q, p) ? q : p, *high = before(q, p) ? p : q;
  const double *low2 = before(s, r) ? s : r, *high2 = before(s, r) ? r : s;
  return !before(high, low2) && !before(high2, low);
}

// segment p q and triangle x with an area, whose plane has p and q on these sides
static bool segment_meets_triangle(const double *p, const double *q, const double *const x[3],
                                   int side_p, int side_q)
{
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) return segment_meets_flat(p, q, x, open_axis(x[0], x[1], x[2]));
  // it meets the plane in one point; the line passes no two edges on different sides
  int left = 0, right = 0;
  for (int k = 0; k < 3; k++) {
    int side = cloth_orient3d(p, q, x[k], x[(k + 1) % 3]);
    left += side > 0, right += side < 0;
    if (left && right) return false;
  }
  return true;
}

static bool segment_meets(const double *p, const double *q, const hull *h)
{
  if (h->size < 3) return segments_meet(p, q, h->x[0], h->x[h->size - 1]);
  return segment_meets_triangle(p, q, h->x, cloth_orient3d(h->x[0], h->x[1], h->x[2], p),
                                cloth_orient3d(h->x[0], h->x[1], h->x[2], q));
}

// the sides of b's corners of a's plane; false if all are on one
static bool find_sides(const hull *a, const hull *b, int side[3])
{
  for (int k = 0; k < 3; k++) side[k] = cloth_orient3d(a->x[0], a->x[1], a->x[2], b->x[k]);
  return !(side[0] == side[1] && side[1] == side[2] && side[0] != 0);
}

static bool hulls_meet(const hull *a, const hull *b)
{
  if (a->size < 3) return segment_meets(a->x[0], a->x[a->size - 1], b);
  if (b->size < 3) return segment_meets(b->x[0], b->x[b->size - 1], a);
  int side_a[3], side_b[3];
  if (!find_sides(a, b, side_b) || !find_sides(b, a, side_a)) return false;
  for (int k = 0; k < 3; k++) {
    int l = (k + 1) % 3;
    if (segment_meets_triangle(b->x[k], b->x[l], a->x, side_b[k], side_b[l])) return true;
    if (segment_meets_triangle(a->x[k], a->x[l], b->x, side_a[k], side_a[l])) return true;
  }
  return false;
}

// ---- neighbours --------------------------------------------------------------------------------

// Does what of h is farthest from p, a corner of both, in any direction meet the other? The
// farthest is the edge opposite to p, or an end of a segment. Where two sets with the common point
// p have another, the way from p through it leaves one of them last on such a part, inside the
// other.
static bool far_part_meets(const hull *h, const double *p, const hull *other)
{
  if (h->size == 3) {
    int at = same_place(h->x[0], p) ? 0 : same_place(h->x[1], p) ? 1 : 2;
    return segment_meets(h->x[(at + 1) % 3], h->x[(at + 2) % 3], other);
  }
  for (int k = 0; k < h->size; k++)
    if (!same_place(h->x[k], p) && segment_meets(h->x[k], h->x[k], other)) return true;
  return false;
}

// Does an end of segment h off the segment p q lie in the other?
static bool far_end_meets(const hull *h, const double *p, const double *q, const hull *other)
{
  for (int k = 0; k < 2; k++)
    if (!segments_meet(h->x[k], h->x[k], p, q) && segment_meets(h->x[k], h->x[k], other))
      return true;
  return false;
}

// the corner of h that is neither p nor q
static const double *third(const hull *h, const double *p, const double *q)
{
  for (int k = 0; k < 2; k++)
    if (!same_place(h->x[k], p) && !same_place(h->x[k], q)) return h->x[k];
  return h->x[2];
}

// p and q are corners of both, at different places
static bool meet_off_edge(const hull *a, const hull *b, const double *p, const double *q)
{
  if (a->size == 3 && b->size == 3) {
    const double *c = third(a, p, q), *d = third(b, p, q);
    if (cloth_orient3d(p, q, c, d) != 0) return false;
    int axis = open_axis(p, q, c);
    return cloth_orient2d(p, q, c, axis) == cloth_orient2d(p, q, d, axis);
  }
  if (a->size == 3 || b->size == 3) return false; // the one without area lies along the edge
  return far_end_meets(a, p, q, b) || far_end_meets(b, p, q, a);
}

bool cloth_triangles_intersect(const cloth_corners *a, const cloth_corners *b, bool same_mesh)
{
  const double *common[3];
  int count = 0;
  for (int i = 0; i < 3 && same_mesh; i++) {
    // a vertex that a triangle names twice is one
    bool again = (i > 0 && a->vertex[i] == a->vertex[0]) || (i > 1 && a->vertex[i] == a->vertex[1]);
    bool in_b = false;
    for (int j = 0; j < 3; j++) in_b = in_b || a->vertex[i] == b->vertex[j];
    if (in_b && !again) common[count++] = a->x[i];
  }
  if (count == 3) return true;
  hull ha = hull_of(a->x), hb = hull_of(b->x);
  if (count == 0) return hulls_meet(&ha, &hb);
  if (count == 2 && !same_place(common[0], common[1]))
    return meet_off_edge(&ha, &hb, common[0], common[1]);
  return far_part_meets(&ha, common[0], &hb) || far_part_meets(&hb, common[0], &ha);
}
