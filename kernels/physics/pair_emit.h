// From two triangles whose regions are close to the pairs of features that may touch: 6 vertex-face
// and 9 edge-edge, of which each triangle answers only for the vertices and edges that it owns, so
// that every pair of features is reported once (representative triangles: Curtis et al. 2008).
#pragma once

#include "atomic.h"
#include "box.h"
#include "flat_patch.h"
#include "pair_key.h"

typedef struct cloth_pair_mesh {
  int cloth_vertices;           // vertices from here on belong to bodies
  int cloth_triangles;          // triangles likewise
  const int *triangle;          // [triangles x 3]
  const int *triangle_edge;     // [triangles x 3] edge k joins corners k and k + 1
  const int *owns;              // [triangles] bits 0..2 its corners, bits 3..5 its edges
  const int *edge;              // [edges x 2]
  const cloth_real *vertex_box; // [vertices x 6] m
  const cloth_real *box;        // [triangles x 6] m
  cloth_real gap;               // m, distance at which a pair of cloth counts
  cloth_real reach;             // m, that much farther where one of the two is a body's
  int self;                     // 1: cloth against cloth too
  int first, last;              // vertices of this part: pairs that touch none of them are left out
  int triangles_only;           // 1: report (cloth triangle, triangle) instead of features
  cloth_key_format format;
  cloth_flat_map flat; // what need not be looked at
  uint64_t *key;       // [capacity]
  uint32_t capacity;
  uint32_t *count; // [1] counts up, also past the capacity
} cloth_pair_mesh;

/// Distance [m] at which features of two triangles count.
CLOTH_FN cloth_real cloth_pair_gap(const cloth_pair_mesh *m, int ta, int tb)
{
  return ta < m->cloth_triangles && tb < m->cloth_triangles ? m->gap : m->gap + m->reach;
}

CLOTH_FN int cloth_pair_mine(const cloth_pair_mesh *m, int v)
{
  return v >= m->first && v < m->last;
}

// bits 0..2: which corners of ta may touch tb
CLOTH_FN uint32_t cloth_pair_vertices_face(const cloth_pair_mesh *m, int ta, int tb)
{
  const int *va = m->triangle + 3 * ta, *vb = m->triangle + 3 * tb;
  cloth_box face = cloth_box_load(m->box, tb);
  cloth_real gap = cloth_pair_gap(m, ta, tb);
  int mine = cloth_pair_mine(m, vb[0]) || cloth_pair_mine(m, vb[1]) || cloth_pair_mine(m, vb[2]);
  uint32_t bits = 0;
  for (int k = 0; k < 3; k++) {
    int v = va[k];
    if (!(m->owns[ta] >> k & 1) || v == vb[0] || v == vb[1] || v == vb[2]) continue;
    if (!mine && !cloth_pair_mine(m, v)) continue;
    if (cloth_box_near(cloth_box_load(m->vertex_box, v), face, gap)) bits |= 1u << k;
  }
  return bits;
}

// bit 3 i + k: edge i of ta may touch edge k of tb
CLOTH_FN uint32_t cloth_pair_edges(const cloth_pair_mesh *m, int ta, int tb)
{
  cloth_real gap = cloth_pair_gap(m, ta, tb);
  uint32_t bits = 0;
  for (int i = 0; i < 3; i++) {
    if (!(m->owns[ta] >> (3 + i) & 1)) continue;
    int ea = m->triangle_edge[3 * ta + i], a0 = m->edge[2 * ea], a1 = m->edge[2 * ea + 1];
    cloth_box box =
        cloth_box_union(cloth_box_load(m->vertex_box, a0), cloth_box_load(m->vertex_box, a1));
    for (int k = 0; k < 3; k++) {
      if (!(m->owns[tb] >> (3 + k) & 1)) continue;
      int eb = m->triangle_edge[3 * tb + k], b0 = m->edge[2 * eb], b1 = m->edge[2 * eb + 1];
      if (a0 == b0 || a0 == b1 || a1 == b0 || a1 == b1) continue;
      if (!cloth_pair_mine(m, a0) && !cloth_pair_mine(m, a1) && !cloth_pair_mine(m, b0) &&
          !cloth_pair_mine(m, b1))
        continue;
      cloth_box other =
          cloth_box_union(cloth_box_load(m->vertex_box, b0), cloth_box_load(m->vertex_box, b1));
      if (cloth_box_near(box, other, gap)) bits |= 1u << (3 * i + k);
    }
  }
  return bits;
}

// Boxes say little of triangles that lie slanted in layers: those are told apart by the planes of
// their faces. Which corners of `other` stay on one side of all that `face` may reach, farther than
// the gap: bits 0..2 above, 3..5 below.
CLOTH_FN uint32_t cloth_pair_sides(const cloth_pair_mesh *m, int face, int other)
{
  const int *corner = m->triangle + 3 * face;
  cloth_box box[3];
  for (int k = 0; k < 3; k++) box[k] = cloth_box_load(m->vertex_box, corner[k]);
  cloth_v3 o = box[0].lo, at[3]; // relative to it: float keeps its digits
  for (int k = 0; k < 3; k++)
    at[k] = cloth_v3_add(cloth_v3_sub(box[k].lo, o), cloth_v3_sub(box[k].hi, o));
  cloth_v3 n = cloth_v3_cross(cloth_v3_sub(at[1], at[0]), cloth_v3_sub(at[2], at[0]));
  cloth_v3 wide = cloth_v3_make(cloth_fabs(n.x), cloth_fabs(n.y), cloth_fabs(n.z));
  cloth_real gap = cloth_pair_gap(m, face, other);
  cloth_real highest = 0, lowest = 0, size = gap; // all heights are doubled
  for (int k = 0; k < 3; k++) {
    cloth_v3 extent = cloth_v3_sub(box[k].hi, box[k].lo);
    cloth_real height = cloth_v3_dot(n, at[k]), reach = cloth_v3_dot(wide, extent);
    highest = k == 0 || height + reach > highest ? height + reach : highest;
    lowest = k == 0 || height - reach < lowest ? height - reach : lowest;
    size += cloth_v3_sum_abs(at[k]) + cloth_v3_sum_abs(extent);
  }
  cloth_real room = 2 * gap * cloth_v3_length(n);
  cloth_real rounding = 32 * CLOTH_REAL_EPSILON * (wide.x + wide.y + wide.z);
  uint32_t bits = 0;
  CLOTH_ROLLED for (int k = 0; k < 3; k++)
  {
    cloth_box b = cloth_box_load(m->vertex_box, m->triangle[3 * other + k]);
    cloth_v3 lo = cloth_v3_sub(b.lo, o), hi = cloth_v3_sub(b.hi, o);
    cloth_v3 sum = cloth_v3_add(lo, hi), extent = cloth_v3_sub(hi, lo);
    cloth_real height = cloth_v3_dot(n, sum), reach = cloth_v3_dot(wide, extent);
    reach += room + rounding * (size + cloth_v3_sum_abs(sum) + cloth_v3_sum_abs(extent));
    if (height - reach > highest) bits |= 1u << k;
    if (height + reach < lowest) bits |= 8u << k;
  }
  return bits;
}

// May a face's plane tell more than its box? Not where it lies along an axis, as on a table: then
// its box is hardly thicker than what one corner may reach.
CLOTH_FN int cloth_pair_slants(const cloth_pair_mesh *m, int face)
{
  cloth_box all = cloth_box_load(m->box, face);
  cloth_box corner = cloth_box_load(m->vertex_box, m->triangle[3 * face]);
  cloth_v3 extent = cloth_v3_sub(cloth_v3_sub(all.hi, corner.hi), cloth_v3_sub(all.lo, corner.lo));
  return extent.x > m->gap && extent.y > m->gap && extent.z > m->gap;
}

// is the corner, are both ends of the edge, on one side?
CLOTH_FN int cloth_pair_corner_apart(uint32_t sides, int k)
{
  return (sides | sides >> 3) >> k & 1;
}

CLOTH_FN int cloth_pair_edge_apart(uint32_t sides, int k)
{
  uint32_t ends = 1u << k | 1u << (k + 1) % 3;
  return (sides & ends) == ends || (sides >> 3 & ends) == ends;
}

// `bits` of cloth_pair_bits() without what the planes of the two faces tell apart
CLOTH_FN uint32_t cloth_pair_by_planes(const cloth_pair_mesh *m, int ta, int tb, uint32_t bits)
{
  uint32_t sides_a = cloth_pair_slants(m, tb) ? cloth_pair_sides(m, tb, ta) : 0;
  uint32_t sides_b = cloth_pair_slants(m, ta) ? cloth_pair_sides(m, ta, tb) : 0;
  for (int k = 0; k < 3; k++) {
    if (cloth_pair_corner_apart(sides_a, k)) bits &= ~(1u << k);
    if (cloth_pair_corner_apart(sides_b, k)) bits &= ~(8u << k);
    if (cloth_pair_edge_apart(sides_a, k)) bits &= ~(7u << (6 + 3 * k));
    if (cloth_pair_edge_apart(sides_b, k)) bits &= ~(0x49u << (6 + k));
  }
  return bits;
}

/// Which pairs of features of two triangles may touch: bits 0..2 corners of ta and tb's face, 3..5
/// the other way round, 6..14 edges; with triangles_only bit 0. ta is a cloth triangle; tb is
/// another or one of a body.
CLOTH_FN uint32_t cloth_pair_bits(const cloth_pair_mesh *m, int ta, int tb)
{
  if (!cloth_box_near(cloth_box_load(m->box, ta), cloth_box_load(m->box, tb),
                      cloth_pair_gap(m, ta, tb)))
    return 0;
  if (m->triangles_only) // counted by the part of the lower one's first corner
    return (uint32_t)cloth_pair_mine(m, m->triangle[3 * (ta < tb ? ta : tb)]);
  uint32_t bits = cloth_pair_vertices_face(m, ta, tb) | cloth_pair_vertices_face(m, tb, ta) << 3 |
                  cloth_pair_edges(m, ta, tb) << 6;
  return bits ? cloth_pair_by_planes(m, ta, tb, bits) : 0;
}

/// The pair that a bit stands for.
CLOTH_FN uint64_t cloth_pair_of_bit(const cloth_pair_mesh *m, int ta, int tb, int bit)
{
  if (m->triangles_only)
    return cloth_pair_pack(m->format, CLOTH_VERTEX_FACE, ta < tb ? ta : tb, ta < tb ? tb : ta);
  if (bit < 3) return cloth_pair_pack(m->format, CLOTH_VERTEX_FACE, m->triangle[3 * ta + bit], tb);
  if (bit < 6)
    return cloth_pair_pack(m->format, CLOTH_VERTEX_FACE, m->triangle[3 * tb + bit - 3], ta);
  int ea = m->triangle_edge[3 * ta + (bit - 6) / 3], eb = m->triangle_edge[3 * tb + (bit - 6) % 3];
  return cloth_pair_pack(m->format, CLOTH_EDGE_EDGE, ea < eb ? ea : eb, ea < eb ? eb : ea);
}

CLOTH_FN int cloth_count_bits(uint32_t bits)
{
  int n = 0;
  for (; bits; bits &= bits - 1) n++;
  return n;
}

/// Write the pairs of `bits` to places [at, at + their number) of the list, as far as it reaches.
CLOTH_FN void cloth_pair_write(const cloth_pair_mesh *m, int ta, int tb, uint32_t bits, uint32_t at)
{
  for (int bit = 0; bits >> bit; bit++)
    if (bits >> bit & 1) {
      if (at < m->capacity) m->key[at] = cloth_pair_of_bit(m, ta, tb, bit);
      at++;
    }
}

/// Append what may touch of two triangles.
CLOTH_FN void cloth_pair_emit(const cloth_pair_mesh *m, int ta, int tb)
{
  uint32_t bits = cloth_pair_bits(m, ta, tb);
  if (bits == 0) return;
  cloth_pair_write(m, ta, tb, bits, cloth_atomic_add(m->count, (uint32_t)cloth_count_bits(bits)));
}
