// Where cloth is flat it cannot touch itself, and its pairs need not be looked at. Not the cone of
// normals with a contour test (Volino and Magnenat-Thalmann 1994; Provot 1997), which forbids
// passing through but not coming close, but a bound on the deformation gradient, which does both:
//
// Let a patch of cloth be at rest a convex region of a plane, and let F (3x2) be the deformation
// gradient of each triangle that reaches into it. If one matrix A has |F - A| <= d for all of them
// (2-norm), then for two points a, b of the patch, along the straight line between them at rest,
//   x(a) - x(b) = integral of F over the line = A (a - b) + e,  |e| <= d |a - b|,
// so with s the smaller singular value of A
//   |x(a) - x(b)| >= (s - d) |a - b|.
// The matrices within d of A are convex: if F is within d of A at the start and at the end of a
// straight motion, then also between. And with y the same vector at the end of the motion,
//   y . n >= (sqrt(s^2 - d^2) - d) |a - b|,  n the direction of x(a) - x(b),
// because n is within asin(d / s) of A (a - b); this is the distance "ahead" of contact_find.h.
//
// Two features without a common vertex are at rest at least h apart, h the least height of a
// triangle: the line from a vertex leaves its star. A pair keeps min(thickness, 0.7 x its distance
// at rest) where h is not far below the thickness (contact_geometry.h). So if
//   s^2 >= (k + d)^2 + d^2,  k = min(0.7, thickness / h),
// for start, first guess and free flight, no pair of the patch is a contact, and its distance on
// the way stays above that at which impact_find.h acts.
//
// Patches are squares of CLOTH_FLAT_SPAN x CLOTH_FLAT_SPAN tiles of the rest plane, at every tile
// and on levels of tiles that double in size, so that any two near triangles lie in a square not
// much larger than both. A square is a node of its first tile. src/contact/flat.c says which
// squares are convex regions of one sheet.
#pragma once

#include "real.h"

enum {
  CLOTH_FLAT_SPAN = 3,   // tiles along a square
  CLOTH_FLAT_LEVELS = 5, // each doubles the tile
  CLOTH_FLAT_RANGE = 12  // least and largest of the six entries of F: warp x y z, weft x y z
};

// Which squares are flat on this substep's way. flat is NULL: not known, nothing is culled.
typedef struct cloth_flat_map {
  const int
      *place; // [cloth triangles x 5] sheet (-1: not flat at rest), least tile x y, largest x y
  const int *level; // [sheets x CLOTH_FLAT_LEVELS x 2] node of the level's first tile (-1: no such
                    // level), tiles in a row
  const unsigned char *flat; // [nodes]
} cloth_flat_map;

/// The tiles over which triangles extend, all of one sheet.
typedef struct cloth_flat_place {
  int sheet, x0, y0, x1, y1;
} cloth_flat_place;

CLOTH_FN cloth_flat_place cloth_flat_place_of(const cloth_flat_map *m, int triangle)
{
  const int *p = m->place + 5 * triangle;
  cloth_flat_place place;
  place.sheet = p[0], place.x0 = p[1], place.y0 = p[2], place.x1 = p[3], place.y1 = p[4];
  return place;
}

CLOTH_FN cloth_flat_place cloth_flat_union(cloth_flat_place a, cloth_flat_place b)
{
  if (a.sheet != b.sheet) a.sheet = -1;
  a.x0 = b.x0 < a.x0 ? b.x0 : a.x0, a.y0 = b.y0 < a.y0 ? b.y0 : a.y0;
  a.x1 = b.x1 > a.x1 ? b.x1 : a.x1, a.y1 = b.y1 > a.y1 ? b.y1 : a.y1;
  return a;
}

/// Does a flat square hold them all?
CLOTH_FN int cloth_flat_holds(const cloth_flat_map *m, cloth_flat_place p)
{
  if (p.sheet < 0) return 0;
  for (int l = 0; l < CLOTH_FLAT_LEVELS; l++) {
    int x = p.x0 >> l, y = p.y0 >> l;
    if ((p.x1 >> l) - x >= CLOTH_FLAT_SPAN || (p.y1 >> l) - y >= CLOTH_FLAT_SPAN) continue;
    const int *level = m->level + 2 * (CLOTH_FLAT_LEVELS * p.sheet + l);
    return level[0] >= 0 && m->flat[level[0] + y * level[1] + x];
  }
  return 0;
}

// r becomes the range of both; a range without triangles has its least above its largest
CLOTH_FN void cloth_flat_range_add(cloth_real *r, const cloth_real *stored)
{
  cloth_real other[CLOTH_FLAT_RANGE];
  for (int k = 0; k < 12; k += 4) cloth_load4(stored + k, other + k);
  for (int k = 0; k < 6; k++) r[k] = other[k] < r[k] ? other[k] : r[k];
  for (int k = 6; k < 12; k++) r[k] = other[k] > r[k] ? other[k] : r[k];
}

CLOTH_FN void cloth_flat_range_store(cloth_real *to, const cloth_real *range)
{
  for (int k = 0; k < 12; k += 4) cloth_store4(to + k, range + k);
}

CLOTH_FN void cloth_flat_range_clear(cloth_real *r)
{
  for (int k = 0; k < 6; k++) r[k] = (cloth_real)1e30, r[6 + k] = (cloth_real)-1e30;
}

#define CLOTH_FLAT_KEPT ((cloth_real)0.7) // of its distance at rest: cloth_contact_thickness()
#define CLOTH_FLAT_FINEST                                                                          \
  ((cloth_real)0.08) // of the thickness; meshes of less height are not culled
#define CLOTH_FLAT_NEVER                                                                           \
  ((cloth_real)10) // a share that no patch keeps: it would be stretched tenfold

/// k: the share of its distance at rest that every pair must keep.
CLOTH_FN cloth_real cloth_flat_share(cloth_real thickness, cloth_real height)
{
  if (!(height > CLOTH_FLAT_FINEST * thickness)) return CLOTH_FLAT_NEVER;
  cloth_real k = thickness / height;
  return k < CLOTH_FLAT_KEPT ? k : CLOTH_FLAT_KEPT;
}

/// s^2 >= (k + d)^2 + d^2 with A the middle of the range; d is bounded by the Frobenius norm.
CLOTH_FN int cloth_flat_test(const cloth_real *range, cloth_real k)
{
  cloth_real a[6], d_sq = 0;
  for (int e = 0; e < 6; e++) {
    cloth_real half = (range[6 + e] - range[e]) / 2;
    a[e] = (range[6 + e] + range[e]) / 2;
    d_sq += half * half;
  }
  cloth_real ww = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
  cloth_real ff = a[3] * a[3] + a[4] * a[4] + a[5] * a[5];
  cloth_real wf = a[0] * a[3] + a[1] * a[4] + a[2] * a[5], half = (ww - ff) / 2;
  cloth_real least_sq = (ww + ff) / 2 - cloth_sqrt(half * half + wf * wf);
  cloth_real reach = k + cloth_sqrt(d_sq);
  return least_sq >= reach * reach + d_sq;
}
