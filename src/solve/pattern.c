// Which blocks a part's rows have, and where each element's blocks go. The mesh never changes, so
// this is done once.
#include "block_rows.h"
#include "sort.h"
#include "state/sim.h"

#include <stdlib.h>
#include <string.h>

cloth_status cloth_elements_select(const cloth_part *part, int count, int corners,
                                   const int *vertex, bool coupled, cloth_elements *out,
                                   cloth_error *err)
{
  *out = (cloth_elements){.corners = corners, .coupled = coupled};
  out->host_vertex = malloc(sizeof(int) * ((size_t)(count * corners) + 1));
  out->which = malloc(sizeof(int) * ((size_t)count + 1));
  if (!out->host_vertex || !out->which) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "elements: %d", count);
  for (int e = 0; e < count; e++) {
    bool mine = false;
    for (int c = 0; c < corners; c++)
      mine |= vertex[corners * e + c] >= part->v0 && vertex[corners * e + c] < part->v1;
    if (!mine) continue;
    memcpy(out->host_vertex + corners * out->count, vertex + corners * e,
           sizeof(int) * (size_t)corners);
    out->which[out->count++] = e;
  }
  return CLOTH_OK;
}

// All elements that write slots: those of a new effect go here. Where `coupled`, their corners are
// coupled in the matrix.
enum { KINDS = 3 };
static void kinds_of(cloth_part *part, cloth_elements *kind[KINDS])
{
  kind[0] = &part->membrane, kind[1] = &part->bend, kind[2] = &part->drag;
}

// the columns of each row, ascending, the row itself first
typedef struct row_columns {
  int rows;
  int *first; // [rows + 1]
  int *col;
} row_columns;

static void row_columns_free(row_columns *r) { free(r->first), free(r->col); }

static size_t count_blocks(const cloth_elements *e)
{
  return e->coupled ? (size_t)e->count * (size_t)(e->corners * e->corners) : 0;
}

static size_t list_blocks(const cloth_part *part, const cloth_elements *e, uint64_t *key)
{
  size_t n = 0;
  for (int i = 0; e->coupled && i < e->count; i++)
    for (int a = 0; a < e->corners; a++)
      for (int b = 0; b < e->corners; b++) {
        int row = e->host_vertex[e->corners * i + a], col = e->host_vertex[e->corners * i + b];
        if (row >= part->v0 && row < part->v1 && row != col)
          key[n++] = (uint64_t)(row - part->v0) << 32 | (uint64_t)col;
      }
  return n;
}

static cloth_status find_columns(cloth_part *part, row_columns *r, cloth_error *err)
{
  cloth_elements *kind[KINDS];
  size_t n = 0;
  kinds_of(part, kind);
  r->rows = part->v1 - part->v0;
  for (int k = 0; k < KINDS; k++) n += count_blocks(kind[k]);
  uint64_t *key = malloc(sizeof *key * (n + 1)), *spare = malloc(sizeof *key * (n + 1));
  r->first = malloc(sizeof(int) * ((size_t)r->rows + 1));
  r->col = malloc(sizeof(int) * (n + (size_t)r->rows + 1));
  if (!key || !spare || !r->first || !r->col) {
    free(key), free(spare);
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "matrix pattern: %zu blocks", n);
  }
  n = 0;
  for (int k = 0; k < KINDS; k++) n += list_blocks(part, kind[k], key + n);
  cloth_cpu_sort((int)n, 64, key, NULL, spare, NULL, 1);
  int filled = 0;
  size_t i = 0;
  for (int row = 0; row < r->rows; row++) {
    r->first[row] = filled;
    r->col[filled++] = part->v0 + row;
    for (; i < n && (int)(key[i] >> 32) == row; i++)
      if (i == 0 || key[i] != key[i - 1]) r->col[filled++] = (int)(key[i] & 0xffffffffu);
  }
  r->first[r->rows] = filled;
  free(key), free(spare);
  return CLOTH_OK;
}

static int slot_of(const row_columns *r, int row, int col)
{
  for (int s = r->first[row]; s < r->first[row + 1]; s++)
    if (r->col[s] == col) return s - r->first[row];
  return 0;
}

// groups of rows share the width of their longest row; shorter rows name themselves
static cloth_status upload_rows(cloth_sim *sim, cloth_part *part, const row_columns *r,
                                cloth_error *err)
{
  int group = sim->backend->row_group, groups = (r->rows + group - 1) / group;
  int *first = malloc(sizeof(int) * ((size_t)groups + 1));
  if (first == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "rows");
  first[0] = 0;
  for (int g = 0; g < groups; g++) {
    int width = 0;
    for (int row = g * group; row < (g + 1) * group && row < r->rows; row++)
      if (r->first[row + 1] - r->first[row] > width) width = r->first[row + 1] - r->first[row];
    first[g + 1] = first[g] + width;
  }
  part->row_slots = first[groups];
  part->row_widest = 0;
  for (int g = 0; g < groups; g++)
    if (first[g + 1] - first[g] > part->row_widest) part->row_widest = first[g + 1] - first[g];
  int *col = malloc(sizeof(int) * ((size_t)part->row_slots * (size_t)group + 1));
  if (col == NULL) {
    free(first);
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "rows");
  }
  for (int g = 0; g < groups; g++)
    for (int s = 0; s < first[g + 1] - first[g]; s++)
      for (int lane = 0; lane < group; lane++) {
        int row = g * group + lane, at = (first[g] + s) * group + lane;
        bool used = row < r->rows && s < r->first[row + 1] - r->first[row];
        col[at] = used ? r->col[r->first[row] + s] : part->v0 + (row < r->rows ? row : 0);
      }
  cloth_status status = cloth_upload(sim, part, "row_first", first,
                                     sizeof(int) * ((size_t)groups + 1), &part->row_first, err);
  if (status == CLOTH_OK)
    status =
        cloth_upload(sim, part, "row_col", col,
                     sizeof(int) * (size_t)part->row_slots * (size_t)group, &part->row_col, err);
  if (status == CLOTH_OK)
    status = cloth_take(sim, part, "row_val",
                        sizeof(cloth_real) * 9 * (size_t)group * (size_t)part->row_slots,
                        &part->row_val, err);
  free(first), free(col);
  return status;
}

// for each row the corners of elements that lie on it, in element order
static cloth_status upload_incidence(cloth_sim *sim, cloth_part *part, const row_columns *r,
                                     cloth_elements *e, cloth_error *err)
{
  if (e->count == 0) return CLOTH_OK;
  int rows = r->rows, n = e->count * e->corners;
  int *first = calloc((size_t)rows + 2, sizeof(int)),
      *corner = malloc(sizeof(int) * (size_t)(n + 1));
  int *slot = malloc(sizeof(int) * ((size_t)n * (size_t)e->corners + 1));
  cloth_status status = CLOTH_OK;
  if (!first || !corner || !slot) {
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "incidence");
    goto done;
  }
  for (int i = 0; i < n; i++) {
    int row = e->host_vertex[i] - part->v0;
    if (row >= 0 && row < rows) first[row + 2]++;
  }
  for (int row = 0; row <= rows; row++) first[row + 1] += first[row];
  for (int i = 0; i < n; i++) { // first[row + 1] walks from the row's begin to its end
    int row = e->host_vertex[i] - part->v0;
    if (row < 0 || row >= rows) continue;
    int at = first[row + 1]++;
    corner[at] = i;
    for (int c = 0; c < e->corners; c++)
      slot[e->corners * at + c] =
          e->coupled ? slot_of(r, row, e->host_vertex[e->corners * (i / e->corners) + c]) : 0;
  }
  CLOTH_TRY_GOTO(
      cloth_upload(sim, part, "incidence", first, sizeof(int) * (size_t)(rows + 1), &e->first, err),
      status, done);
  CLOTH_TRY_GOTO(
      cloth_upload(sim, part, "incidence", corner, sizeof(int) * (size_t)n, &e->corner, err),
      status, done);
  CLOTH_TRY_GOTO(cloth_upload(sim, part, "incidence", slot, sizeof(int) * (size_t)(n * e->corners),
                              &e->slot, err),
                 status, done);
  CLOTH_TRY_GOTO(
      cloth_upload(sim, part, "element", e->host_vertex, sizeof(int) * (size_t)n, &e->vertex, err),
      status, done);
done:
  free(first), free(corner), free(slot);
  return status;
}

cloth_status cloth_pattern_build(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  row_columns r = {0};
  cloth_status status = find_columns(part, &r, err);
  if (status == CLOTH_OK) status = upload_rows(sim, part, &r, err);
  if (status == CLOTH_OK) status = cloth_halo_build(sim, part, r.first, r.col, err);
  cloth_elements *kind[KINDS];
  kinds_of(part, kind);
  for (int k = 0; k < KINDS; k++) {
    cloth_elements *e = kind[k];
    sim->owner = e->owner;
    if (status == CLOTH_OK) status = upload_incidence(sim, part, &r, e, err);
    free(e->host_vertex), free(e->which);
    e->host_vertex = e->which = NULL;
  }
  sim->owner = CLOTH_CORE;
  row_columns_free(&r);
  return status;
}
