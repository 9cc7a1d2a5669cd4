// Row i of the linear system A dx = b of one Newton iteration of backward Euler,
//   A = M / h^2 + K,   b = -M / h^2 (x - x*) + f(x),   M with 1 + h drag where mass is damped,
// gathered from the slots that the element kernels wrote. Each row adds in one fixed order; nothing
// is scattered. Also the inverse of the diagonal block, contacts included, for the preconditioner.
//
// Blocks are added line by line, so that three threads of a GPU can share a row: each number of a
// block is one thread's, with the same sum.
#pragma once

#include "bend_shape.h"
#include "block_rows.h"

// which elements meet at a row, and into which slots of the row their blocks go
typedef struct cloth_incidence {
  const int *first;  // [rows + 1]; NULL: the effect is not active
  const int *corner; // [first[rows]] corners * element + corner
  const int *slot;   // [first[rows] x corners] slot of the row for each corner of the element
} cloth_incidence;

typedef struct cloth_assemble_row_args {
  int first;                        // vertex of row 0
  cloth_real inverse_step;          // 1/s
  const cloth_real *mass;           // [vertices] kg
  const cloth_real *mass_drag;      // [vertices] 1/s, as in predict.h; NULL: none
  const cloth_real *x, *x_pred;     // [vertices x 3] m
  const cloth_real *hold_stiffness; // [vertices] N/m, compliant holds; NULL: none
  const cloth_real *target;         // [vertices x 3] m, of holds
  cloth_incidence membrane;         // 3 corners
  const cloth_real *membrane_force, *membrane_tangent;        // [n x 9] N, [n x 45] N/m: membrane.h
  cloth_incidence drag;                                       // 3 corners, slot not used
  const cloth_real *drag_force, *drag_tangent;                // [n x 3] N, [n x 6] N/m: drag.h
  cloth_incidence bend;                                       // 4 corners: bend.h
  const cloth_real *bend_force, *bend_gradient, *bend_weight; // [n x 12], [n x 12], [n]
  const cloth_real *bend_constant;                            // [n x 4] 1/m: bend_quadratic.h; NULL
  cloth_incidence shape;                                      // 6 corners: bend_shape.h
  const cloth_real *shape_force, *shape_gradient, *shape_weight; // [n x 18], [n x 36], [n x 6]
  const uint32_t *contact_first;     // [2 rows + 1] contact_row.h; NULL: no contacts
  const uint32_t *contact_entry;     // [entries] 4 contact + corner
  const int *contact_slot;           // [entries x 4] contact_place.h
  const cloth_real *contact_weight;  // [contacts x 4]
  const cloth_real *contact_force;   // [contacts x 3] N
  const cloth_real *contact_tangent; // [contacts x 6] N/m
  cloth_block_rows rows;             // written
  cloth_real *b;                     // [vertices x 3] N, written
  cloth_real *inverse_diagonal;      // [vertices x 6] m/N, written
} cloth_assemble_row_args;

// Lines of the force on a corner: f [lines.count] N.
CLOTH_FN void cloth_add_force(cloth_real *f, cloth_lines lines, const cloth_real *force)
{
  for (int l = 0; l < lines.count; l++) f[l] += force[lines.first + l];
}

CLOTH_FN void cloth_add_membrane(int i, const cloth_assemble_row_args *a, cloth_lines lines,
                                 cloth_real *f)
{
  for (int n = a->membrane.first[i]; n < a->membrane.first[i + 1]; n++) {
    int e = a->membrane.corner[n] / 3, c = a->membrane.corner[n] % 3;
    const cloth_real *tangent = a->membrane_tangent + 45 * e;
    int next = (c + 1) % 3, last = (c + 2) % 3; // stored: K(c, c + 1)
    int slot[3] = {a->membrane.slot[3 * n + c], a->membrane.slot[3 * n + next],
                   a->membrane.slot[3 * n + last]};
    cloth_sym3 own = cloth_sym3_load(tangent, c);
    cloth_v3 to_next[3], to_last[3];
    for (int l = 0; l < lines.count; l++) {
      int d = lines.first + l;
      const cloth_real *column = tangent + 18 + 9 * last + d;
      to_next[l] = cloth_v3_load(tangent + 18 + 9 * c, d);
      to_last[l] = cloth_v3_make(column[0], column[3], column[6]);
    }
    cloth_add_force(f, lines, a->membrane_force + 9 * e + 3 * c);
    cloth_block_add_sym(&a->rows, i, slot[0], lines, own);
    cloth_block_add(&a->rows, i, slot[1], lines, to_next);
    cloth_block_add(&a->rows, i, slot[2], lines, to_last);
  }
}

CLOTH_FN void cloth_add_bend(int i, const cloth_assemble_row_args *a, cloth_lines lines,
                             cloth_real *f)
{
  for (int n = a->bend.first[i]; n < a->bend.first[i + 1]; n++) {
    int e = a->bend.corner[n] / 4, c = a->bend.corner[n] % 4, slot[4];
    cloth_real gradient[12];
    for (int k = 0; k < 3; k++) cloth_load4(a->bend_gradient + 12 * e + 4 * k, gradient + 4 * k);
    cloth_load4_int(a->bend.slot + 4 * n, slot);
    cloth_v3 g = cloth_v3_scale(a->bend_weight[e], cloth_v3_load(a->bend_gradient, 4 * e + c));
    cloth_add_force(f, lines, a->bend_force + 12 * e + 3 * c);
    for (int k = 0; k < 4; k++)
      cloth_block_add_outer(&a->rows, i, slot[k], lines, g, cloth_v3_load(gradient, k));
  }
}

// a constant matrix: one number per block
CLOTH_FN void cloth_add_bend_quadratic(int i, const cloth_assemble_row_args *a, cloth_lines lines,
                                       cloth_real *f)
{
  for (int n = a->bend.first[i]; n < a->bend.first[i + 1]; n++) {
    int e = a->bend.corner[n] / 4, c = a->bend.corner[n] % 4;
    cloth_add_force(f, lines, a->bend_force + 12 * e + 3 * c);
    cloth_real w = a->bend_weight[e] * a->bend_constant[4 * e + c];
    for (int k = 0; k < 4; k++) {
      cloth_real *v = cloth_block_at(&a->rows, i, a->bend.slot[4 * n + k]);
      cloth_real m = w * a->bend_constant[4 * e + k];
      for (int l = 0; l < lines.count; l++) v[4 * (lines.first + l) * CLOTH_ROW_GROUP] += m;
    }
  }
}

// K_cb = sum_j p_j g_jb' with p_j = sum_i W_ij g_ic over the edges i that corner c moves
CLOTH_FN void cloth_add_bend_shape(int i, const cloth_assemble_row_args *a, cloth_lines lines,
                                   cloth_real *f)
{
  const int at[9] = {0, 5, 4, 5, 1, 3, 4, 3, 2}; // full index of W -> stored index
  for (int n = a->shape.first[i]; n < a->shape.first[i + 1]; n++) {
    int e = a->shape.corner[n] / 6, c = a->shape.corner[n] % 6, slot[6];
    const cloth_real *gradient = a->shape_gradient + 36 * e;
    cloth_real w[6], g[36], p[3][3] = {{0}}; // p [edge][line]
    for (int k = 0; k < 9; k++) cloth_load4(gradient + 4 * k, g + 4 * k);
    for (int k = 0; k < 3; k++) {
      cloth_load2(a->shape_weight + 6 * e + 2 * k, w + 2 * k);
      cloth_load2_int(a->shape.slot + 6 * n + 2 * k, slot + 2 * k);
    }
    cloth_add_force(f, lines, a->shape_force + 18 * e + 3 * c);
    for (int k = 0; k < 3; k++) {
      if (c > 2 && c != 3 + k) continue; // corner c is no vertex of hinge k
      const cloth_real *own = gradient + 3 * (4 * k + (c > 2 ? 3 : (c + 2 - k) % 3)) + lines.first;
      for (int j = 0; j < 3; j++)
        for (int l = 0; l < lines.count; l++) p[j][l] += w[at[3 * j + k]] * own[l];
    }
    for (int b = 0; b < 3; b++) {
      int j = (b + 1) % 3, k = (b + 2) % 3;
      cloth_v3 gj = cloth_v3_load(g, 4 * j + 1), gk = cloth_v3_load(g, 4 * k),
               gb = cloth_v3_load(g, 4 * b + 2), far = cloth_v3_load(g, 4 * b + 3);
      cloth_v3 near_line[3], far_line[3];
      for (int l = 0; l < lines.count; l++) {
        cloth_real u = p[j][l], v = p[k][l], t = p[b][l];
        near_line[l] = cloth_v3_make(u * gj.x + v * gk.x + t * gb.x, u * gj.y + v * gk.y + t * gb.y,
                                     u * gj.z + v * gk.z + t * gb.z);
        far_line[l] = cloth_v3_scale(t, far);
      }
      cloth_block_add(&a->rows, i, slot[b], lines, near_line);
      cloth_block_add(&a->rows, i, slot[3 + b], lines, far_line);
    }
  }
}

CLOTH_FN void cloth_add_drag(int i, const cloth_assemble_row_args *a, cloth_lines lines,
                             cloth_real *f)
{
  for (int n = a->drag.first[i]; n < a->drag.first[i + 1]; n++) {
    int e = a->drag.corner[n] / 3;
    cloth_add_force(f, lines, a->drag_force + 3 * e);
    cloth_block_add_sym(&a->rows, i, 0, lines, cloth_sym3_load(a->drag_tangent, e));
  }
}

// a contact with a body as one of its rows sees it
typedef struct cloth_row_contact {
  int slot[4];
  cloth_real own, weight[4];
  cloth_v3 force;
  cloth_sym3 tangent;
} cloth_row_contact;

// entry n of the list, which is corner e of some contact
CLOTH_FN cloth_row_contact cloth_row_contact_load(const cloth_assemble_row_args *a, uint32_t n,
                                                  int e)
{
  cloth_row_contact c;
  cloth_real tangent[6];
  c.own = a->contact_weight[e];
  cloth_load4_int(a->contact_slot + 4 * n, c.slot);
  cloth_load4(a->contact_weight + e / 4 * 4, c.weight);
  for (int k = 0; k < 6; k += 2) cloth_load2(a->contact_tangent + 6 * (e / 4) + k, tangent + k);
  c.force = cloth_v3_load(a->contact_force, e / 4);
  c.tangent = cloth_sym3_load(tangent, 0);
  return c;
}

enum { CLOTH_CONTACTS_AHEAD = 2 }; // loaded before the first of them is added

// the entry, or any where the list is at its end
CLOTH_FN int cloth_row_entry(const cloth_assemble_row_args *a, uint32_t n, uint32_t end)
{
  return (int)a->contact_entry[n < end ? n : end - 1];
}

// Contacts with bodies: their blocks couple vertices that the mesh couples too. At the pole of a
// ball a row may have a hundred, so which the next ones are is asked before these are added.
CLOTH_FN void cloth_add_body_contacts(int i, const cloth_assemble_row_args *a, cloth_lines lines,
                                      cloth_real *f)
{
  uint32_t begin = a->contact_first[2 * i], end = a->contact_first[2 * i + 1];
  int next[CLOTH_CONTACTS_AHEAD] = {0};
  for (uint32_t k = 0; k < CLOTH_CONTACTS_AHEAD && begin < end; k++)
    next[k] = cloth_row_entry(a, begin + k, end);
  for (uint32_t n = begin; n < end; n += CLOTH_CONTACTS_AHEAD) {
    cloth_row_contact contact[CLOTH_CONTACTS_AHEAD];
    for (uint32_t k = 0; k < CLOTH_CONTACTS_AHEAD; k++) {
      contact[k] = cloth_row_contact_load(a, n + k < end ? n + k : end - 1, next[k]);
      next[k] = cloth_row_entry(a, n + CLOTH_CONTACTS_AHEAD + k, end);
    }
    for (uint32_t k = 0; k < CLOTH_CONTACTS_AHEAD && n + k < end; k++) {
      const cloth_row_contact *c = contact + k;
      for (int l = 0; l < lines.count; l++)
        f[l] += c->own * cloth_v3_component(c->force, lines.first + l);
      for (int b = 0; b < 4; b++)
        if (c->slot[b] >= 0)
          cloth_block_add_sym(&a->rows, i, c->slot[b], lines,
                              cloth_sym3_scale(c->own * c->weight[b], c->tangent));
    }
  }
}

// contacts of cloth with cloth: of their blocks the preconditioner knows the diagonal alone
CLOTH_FN void cloth_add_factored_contacts(int i, const cloth_assemble_row_args *a, cloth_v3 *f,
                                          cloth_sym3 *d)
{
  for (uint32_t n = a->contact_first[2 * i + 1]; n < a->contact_first[2 * i + 2]; n++) {
    int e = (int)a->contact_entry[n];
    cloth_real w = a->contact_weight[e];
    *f = cloth_v3_add_scaled(*f, w, cloth_v3_load(a->contact_force, e / 4));
    *d = cloth_sym3_add(*d, cloth_sym3_scale(w * w, cloth_sym3_load(a->contact_tangent, e / 4)));
  }
}

/// Lines of the blocks of row i and of its force, all but what contacts of cloth with cloth add.
CLOTH_FN void cloth_assemble_lines(int i, const cloth_assemble_row_args *a, cloth_lines lines)
{
  int v = a->first + i;
  cloth_block_clear(&a->rows, i, lines);

  // inertia and compliant holds
  cloth_real m = a->mass[v] * a->inverse_step * a->inverse_step, f[3];
  if (a->mass_drag) m *= 1 + a->mass_drag[v] / a->inverse_step; // x* is the rest of M (1 + h drag)
  cloth_real k = a->hold_stiffness && a->hold_stiffness[v] > 0 ? a->hold_stiffness[v] : 0;
  for (int l = 0; l < lines.count; l++) {
    int d = 3 * v + lines.first + l;
    f[l] = m * (a->x_pred[d] - a->x[d]);
    if (k > 0) f[l] += k * (a->target[d] - a->x[d]);
  }
  m += k;
  cloth_block_add_sym(&a->rows, i, 0, lines, cloth_sym3_axis(m, 0, cloth_v3_make(0, 0, 0)));

  if (a->membrane.first) cloth_add_membrane(i, a, lines, f);
  if (a->bend.first && a->bend_constant)
    cloth_add_bend_quadratic(i, a, lines, f);
  else if (a->bend.first)
    cloth_add_bend(i, a, lines, f);
  if (a->shape.first) cloth_add_bend_shape(i, a, lines, f);
  if (a->drag.first) cloth_add_drag(i, a, lines, f);
  if (a->contact_first) cloth_add_body_contacts(i, a, lines, f);
  for (int l = 0; l < lines.count; l++) a->b[3 * v + lines.first + l] = f[l];
}

/// What is left when all its lines are there.
CLOTH_FN void cloth_assemble_rest(int i, const cloth_assemble_row_args *a)
{
  int v = a->first + i;
  cloth_v3 f = cloth_v3_load(a->b, v);
  cloth_sym3 d = cloth_block_diagonal(&a->rows, i);
  if (a->contact_first) cloth_add_factored_contacts(i, a, &f, &d);
  cloth_v3_store(a->b, v, f);
  cloth_sym3_store(a->inverse_diagonal, v, cloth_sym3_inverse(d));
}

CLOTH_FN void cloth_assemble_row(int i, const cloth_assemble_row_args *a)
{
  const cloth_lines all = {0, 3};
  cloth_assemble_lines(i, a, all);
  cloth_assemble_rest(i, a);
}
