// The linear system of a sim as one dense matrix: the mesh's block rows, assembled as if there were
// no contacts, and all contacts written out, wherever the solver keeps them. The CPU backend's
// memory is plain memory, so it is read as it is.
#pragma once

#include "block_rows.h"
#include "solve/sim.h"

static inline void dense_rows(const cloth_part *p, double *A, int dofs)
{
  cloth_block_rows rows = {p->row_first, p->row_col, p->row_val, p->row_widest};
  for (int i = 0; i < p->v1 - p->v0; i++) {
    int g = i / CLOTH_ROW_GROUP, lane = i % CLOTH_ROW_GROUP;
    for (int s = 0; s < rows.first[g + 1] - rows.first[g]; s++) {
      int j = rows.col[(rows.first[g] + s) * CLOTH_ROW_GROUP + lane];
      const cloth_real *val = cloth_block_at(&rows, i, s);
      for (int e = 0; e < 9; e++)
        A[(3 * (p->v0 + i) + e / 3) * dofs + 3 * j + e % 3] += (double)val[e * CLOTH_ROW_GROUP];
    }
  }
}

// contacts of a part, for the rows that it owns
static inline void dense_contacts(const cloth_part *p, double *A, int dofs)
{
  for (int c = 0; c < p->contact_count; c++) {
    cloth_sym3 t = cloth_sym3_load(p->contact_tangent, c);
    double m[3][3] = {{(double)t.xx, (double)t.xy, (double)t.zx},
                      {(double)t.xy, (double)t.yy, (double)t.yz},
                      {(double)t.zx, (double)t.yz, (double)t.zz}};
    for (int i = 0; i < 4; i++)
      for (int j = 0; j < 4; j++) {
        int vi = p->contact_vertex[4 * c + i], vj = p->contact_vertex[4 * c + j];
        if (vi < p->v0 || vi >= p->v1 || 3 * vj >= dofs) continue;
        double w = (double)p->contact_weight[4 * c + i] * (double)p->contact_weight[4 * c + j];
        for (int e = 0; e < 9; e++)
          A[(3 * vi + e / 3) * dofs + 3 * vj + e % 3] += w * m[e / 3][e % 3];
      }
  }
}

/// A [dofs x dofs] and, where it is not NULL, the right-hand side b [dofs]. Returns the number of
/// contacts.
static inline int dense_system(cloth_sim *sim, double *A, double *b)
{
  int contacts = 0, dofs = 3 * sim->vertex_count, count[CLOTH_DEVICES_MAX];
  double *kept = malloc(sizeof *kept * (size_t)dofs); // assembly writes b for where x is by now
  cloth_error err = {0};
  for (int n = 0; n < sim->part_count; n++) {
    cloth_part *p = &sim->part[n];
    contacts += count[n] = p->contact_count, p->contact_count = 0;
    for (int i = 3 * p->v0; i < 3 * p->v1; i++) kept[i] = (double)p->b[i];
  }
  must(cloth_assemble(sim, &err), &err);
  memset(A, 0, sizeof *A * (size_t)dofs * (size_t)dofs);
  for (int n = 0; n < sim->part_count; n++) {
    cloth_part *p = &sim->part[n];
    p->contact_count = count[n];
    dense_rows(p, A, dofs);
    dense_contacts(p, A, dofs);
  }
  must(cloth_assemble(sim, &err), &err);
  for (int n = 0; n < sim->part_count; n++)
    for (int i = 3 * sim->part[n].v0; i < 3 * sim->part[n].v1; i++)
      sim->part[n].b[i] = (cloth_real)kept[i];
  if (b) memcpy(b, kept, sizeof *b * (size_t)dofs);
  free(kept);
  return contacts;
}

/// Up to the system of the first Newton iteration of the next substep, solved; the matrix, dx and
/// b stay behind.
static inline void solve_one(cloth_sim *sim, cloth_step_report *report)
{
  cloth_error err = {0};
  *report = (cloth_step_report){0};
  sim->report = report;
  sim->h = 1.0 / 60, sim->time_t0 = sim->time, sim->iteration = sim->iteration_first = 0;
  double correction;
  must(cloth_damping_set(sim, sim->h, &err), &err);
  must(cloth_predict_stage(sim, 0, 1, &err), &err);
  must(cloth_pairs_find(sim, &err), &err);
  must(cloth_contact_build_stage(sim, &err), &err);
  must(cloth_effects_apply(sim, 0, &err), &err);
  must(cloth_assemble(sim, &err), &err);
  must(cloth_pcg(sim, &correction, &err), &err);
}
