// From cloth to springs. A cloth of axis-parallel rectangles, each cut into two triangles, is a
// lattice: stretch springs on the sides, shear springs on both diagonals, bend springs two away.
// Any other mesh has stretch springs on its edges and bend springs across them.
//
// Stiffnesses come from the material, so that a strip is as stiff as the fabric whatever the mesh
// (doc/mass_spring.md has the formulas).
#include "bend.h"
#include "effect/effect.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WARP, WEFT, SLANTED };

#define FOLD        1.0  // rad at which a bend spring stores what the plate would
#define LEAST_SHARE 0.1  // of a side's stiffness that is left beside bend springs
#define ALIGNED     1e-4 // sine of the angle to an axis below which an edge is parallel to it

/// What is known of each edge while the net is made.
typedef struct net {
  cloth_sim *sim;
  double *length;    // [edges] m, at rest in the material
  double *stiffness; // [edges] N/m
  double *width;     // [edges] m of cloth that a side carries
  int *axis;         // [edges] WARP or WEFT of sides, SLANTED
  int *diagonal;     // [triangles] the edge across the right angle, -1: no half rectangle
  int *side;         // [n x 4] sides at a vertex, two along the warp, two along the weft; -1
  bool *lattice;     // [cloths]
} net;

static void net_free(net *w)
{
  free(w->length), free(w->stiffness), free(w->width), free(w->axis), free(w->diagonal),
      free(w->side), free(w->lattice);
}

static cloth_status net_new(cloth_sim *sim, net *w, cloth_error *err)
{
  size_t e = (size_t)sim->edge_count + 1, n = (size_t)sim->vertex_count;
  *w = (net){.sim = sim,
             .length = calloc(e, sizeof(double)),
             .stiffness = calloc(e, sizeof(double)),
             .width = calloc(e, sizeof(double)),
             .axis = malloc(e * sizeof(int)),
             .diagonal = malloc(((size_t)sim->triangle_count + 1) * sizeof(int)),
             .side = malloc((4 * n + 1) * sizeof(int)),
             .lattice = calloc((size_t)sim->def->cloth_count + 1, sizeof(bool))};
  if (!w->length || !w->stiffness || !w->width || !w->axis || !w->diagonal || !w->side ||
      !w->lattice)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "springs of %d edges", sim->edge_count);
  memset(w->side, -1, sizeof(int) * 4 * n);
  return CLOTH_OK;
}

// ---- the mesh at rest ---------------------------------------------------------------------------

// material vectors of a triangle's edges [m], in the order of triangle_edge
static void material_edges(const cloth_sim *sim, int t, double u[3][2])
{
  double r[5]; // the inverse of [u0 -u2] as columns
  cloth_rest_triangle(sim, t, r);
  double det = r[0] * r[3] - r[1] * r[2];
  u[0][0] = r[3] / det, u[0][1] = -r[2] / det;
  u[2][0] = r[1] / det, u[2][1] = -r[0] / det;
  for (int k = 0; k < 2; k++) u[1][k] = -u[0][k] - u[2][k];
}

static int axis_of(const double u[2])
{
  double length = sqrt(u[0] * u[0] + u[1] * u[1]);
  if (fabs(u[1]) <= ALIGNED * length) return WARP;
  return fabs(u[0]) <= ALIGNED * length ? WEFT : SLANTED;
}

static const cloth_material *material_of(const cloth_sim *sim, int t)
{
  return &sim->def->cloth[cloth_of_triangle(sim, t)].material;
}

static double rest_distance(const cloth_sim *sim, int a, int b)
{
  double sum = 0;
  for (int k = 0; k < 3; k++) sum += pow(sim->rest[3 * a + k] - sim->rest[3 * b + k], 2);
  return sqrt(sum);
}

// corner of a triangle that is not on an edge
static int across(const cloth_sim *sim, int t, int edge)
{
  for (int k = 0; k < 3; k++)
    if (sim->triangle_edge[3 * t + k] == edge) return sim->triangle[3 * t + (k + 2) % 3];
  return -1;
}

static void measure(net *w)
{
  const cloth_sim *sim = w->sim;
  for (int e = 0; e < sim->edge_count; e++) w->axis[e] = SLANTED;
  for (int t = 0; t < sim->triangle_count; t++) {
    double u[3][2];
    int axis[3];
    material_edges(sim, t, u);
    w->diagonal[t] = -1;
    for (int k = 0; k < 3; k++) {
      int e = sim->triangle_edge[3 * t + k];
      axis[k] = axis_of(u[k]);
      w->length[e] +=
          sqrt(u[k][0] * u[k][0] + u[k][1] * u[k][1]) / (sim->edge_side[2 * e + 1] < 0 ? 1 : 2);
    }
    for (int k = 0; k < 3; k++) {
      bool right = axis[k] == SLANTED && axis[(k + 1) % 3] + axis[(k + 2) % 3] == WARP + WEFT &&
                   axis[(k + 1) % 3] != SLANTED;
      if (right) w->diagonal[t] = sim->triangle_edge[3 * t + k];
    }
  }
}

// is every triangle of a cloth half of a rectangle?
static bool is_lattice(const net *w, int cloth)
{
  const cloth_sim *sim = w->sim;
  for (int t = sim->triangle_first[cloth]; t < sim->triangle_first[cloth + 1]; t++) {
    int e = w->diagonal[t];
    if (e < 0 || sim->edge_side[2 * e + 1] < 0) return false;
    const int *both = sim->edge_side + 2 * e;
    if (w->diagonal[both[0]] != e || w->diagonal[both[1]] != e) return false;
    // the halves are turned against each other, not mirrored: opposite sides are as long
    double d[2][2] = {{0, 0}, {0, 0}};
    for (int s = 0; s < 2; s++) {
      double u[3][2];
      material_edges(sim, both[s], u);
      for (int k = 0; k < 3; k++)
        if (axis_of(u[k]) != SLANTED) d[s][axis_of(u[k])] = hypot(u[k][0], u[k][1]);
    }
    if (!(fabs(d[0][0] - d[1][0]) <= ALIGNED * d[0][0]) ||
        !(fabs(d[0][1] - d[1][1]) <= ALIGNED * d[0][1]))
      return false;
  }
  return true;
}

// A lattice's particles have a quarter of each rectangle around them. (A third of each triangle
// would make every other particle of alternating diagonals half as heavy, and the step shorter.)
static void weigh_lattice(net *w, int cloth)
{
  cloth_sim *sim = w->sim;
  double density = sim->def->cloth[cloth].material.density;
  for (int v = sim->cloth_first[cloth]; v < sim->cloth_first[cloth + 1]; v++) sim->mass[v] = 0;
  for (int t = sim->triangle_first[cloth]; t < sim->triangle_first[cloth + 1]; t++) {
    int e = w->diagonal[t], other = sim->edge_side[2 * e] + sim->edge_side[2 * e + 1] - t;
    double rest[5];
    cloth_rest_triangle(sim, t, rest);
    for (int k = 0; k < 3; k++) sim->mass[sim->triangle[3 * t + k]] += density * rest[4] / 4;
    sim->mass[across(sim, other, e)] += density * rest[4] / 4;
  }
}

// ---- stiffness ----------------------------------------------------------------------------------

// tensile stiffness of the net [N/m] along each axis, such that a free strip has that of the fabric
// although its diagonals tie the axes together: c_warp - G^2 / c_weft = E_warp, and likewise
static void strip_stiffness(const cloth_material *m, double c[2])
{
  double e[2] = {m->stretch_warp, m->stretch_weft};
  c[WARP] = e[WARP], c[WEFT] = e[WEFT];
  if (!(e[WARP] > 0 && e[WEFT] > 0)) return;
  c[WARP] = (e[WARP] + sqrt(e[WARP] * e[WARP] + 4 * m->shear * m->shear * e[WARP] / e[WEFT])) / 2;
  c[WEFT] = c[WARP] * e[WEFT] / e[WARP];
}

// a triangle of a lattice: what its two sides carry
static void stretch_lattice(net *w, int t)
{
  const cloth_sim *sim = w->sim;
  const cloth_material *m = material_of(sim, t);
  double u[3][2], c[2], length[2] = {0, 0};
  int edge[2] = {-1, -1};
  material_edges(sim, t, u);
  strip_stiffness(m, c);
  for (int k = 0; k < 3; k++) {
    int axis = axis_of(u[k]);
    if (axis == SLANTED) continue;
    edge[axis] = sim->triangle_edge[3 * t + k], length[axis] = hypot(u[k][0], u[k][1]);
  }
  for (int axis = 0; axis < 2; axis++) {
    double l = length[axis], other = length[1 - axis];
    double diagonals = m->shear * l * l / (other * other); // what they carry along this axis
    w->axis[edge[axis]] = axis;
    w->width[edge[axis]] += other / 2;
    w->stiffness[edge[axis]] += fmax(0, c[axis] - diagonals) * other / (2 * l);
  }
}

// a triangle of a mesh: A. Van Gelder, Approximate simulation of elastic membranes by triangulated
// spring meshes, 1998: stiffness times area over length squared
static void stretch_mesh(net *w, int t)
{
  const cloth_sim *sim = w->sim;
  const cloth_material *m = material_of(sim, t);
  double u[3][2];
  material_edges(sim, t, u);
  double area = fabs(u[0][0] * u[1][1] - u[0][1] * u[1][0]) / 2;
  for (int k = 0; k < 3; k++) {
    double l_sq = u[k][0] * u[k][0] + u[k][1] * u[k][1], cos_sq = u[k][0] * u[k][0] / l_sq;
    double e = m->stretch_warp * cos_sq + m->stretch_weft * (1 - cos_sq);
    w->stiffness[sim->triangle_edge[3 * t + k]] += e * area / l_sq;
  }
}

// spring between the ends of two arms [m] that stores at a fold of FOLD what a hinge of stiffness
// `hinge` [N m] does; apart: how far the arms' feet are from each other along the hinge [m]
static double fold_spring(double hinge, double a, double b, double apart)
{
  double flat = sqrt((a + b) * (a + b) + apart * apart);
  double less = flat - sqrt(a * a + b * b + 2 * a * b * cos(FOLD) + apart * apart);
  return less > 0 ? hinge * FOLD * FOLD / (less * less) : 0;
}

// ---- springs ------------------------------------------------------------------------------------

static cloth_status add(net *w, int a, int b, cloth_spring_kind kind, double rest, double stiffness,
                        const cloth_material *m, cloth_error *err)
{
  cloth_sim *sim = w->sim;
  double time = kind == CLOTH_SPRING_BEND ? m->damping_bend : m->damping_stretch;
  cloth_spring s = {a, b, kind, rest, stiffness, 0};
  s.damping = sim->active[CLOTH_EFFECT_damping] ? time * stiffness : 0;
  return cloth_spring_add(&sim->springs, &s, err);
}

static cloth_status add_stretch(net *w, cloth_error *err)
{
  const cloth_sim *sim = w->sim;
  for (int e = 0; e < sim->edge_count; e++) {
    const int *v = sim->edge + 2 * e;
    CLOTH_TRY(add(w, v[0], v[1], CLOTH_SPRING_STRETCH, w->length[e], w->stiffness[e],
                  material_of(sim, sim->edge_side[2 * e]), err));
  }
  return CLOTH_OK;
}

// both diagonals of each cell
static cloth_status add_shear(net *w, cloth_error *err)
{
  const cloth_sim *sim = w->sim;
  for (int t = 0; t < sim->triangle_count; t++) {
    int e = w->diagonal[t];
    if (!w->lattice[cloth_of_triangle(sim, t)] || sim->edge_side[2 * e] != t) continue;
    double u[3][2], rectangle = 1, d = w->length[e];
    const cloth_material *m = material_of(sim, t);
    material_edges(sim, t, u);
    for (int k = 0; k < 3; k++)
      if (sim->triangle_edge[3 * t + k] != e) rectangle *= hypot(u[k][0], u[k][1]);
    double k = m->shear * d * d / (2 * rectangle);
    const int *v = sim->edge + 2 * e;
    CLOTH_TRY(add(w, v[0], v[1], CLOTH_SPRING_SHEAR, d, k, m, err));
    CLOTH_TRY(add(w, across(sim, t, e), across(sim, sim->edge_side[2 * e + 1], e),
                  CLOTH_SPRING_SHEAR, d, k, m, err));
  }
  return CLOTH_OK;
}

static void collect_sides(net *w)
{
  const cloth_sim *sim = w->sim;
  for (int e = 0; e < sim->edge_count; e++)
    for (int k = 0; k < 2 && w->axis[e] != SLANTED; k++) {
      int *place = w->side + 4 * sim->edge[2 * e + k] + 2 * w->axis[e];
      place[place[0] >= 0] = e;
    }
}

static int other_end(const cloth_sim *sim, int edge, int v)
{
  return sim->edge[2 * edge] == v ? sim->edge[2 * edge + 1] : sim->edge[2 * edge];
}

// over vertex v along one axis; the sides it spans give up what it carries of a pull
static cloth_status add_bend_over(net *w, int v, int axis, double *given, cloth_error *err)
{
  const cloth_sim *sim = w->sim;
  const int *e = w->side + 4 * v + 2 * axis;
  if (e[0] < 0 || e[1] < 0) return CLOTH_OK;
  int a = other_end(sim, e[0], v), b = other_end(sim, e[1], v);
  double arm[2] = {w->length[e[0]], w->length[e[1]]}, both = arm[0] + arm[1];
  const cloth_material *m = &sim->def->cloth[cloth_of_vertex(sim, v)].material;
  double rigidity = axis == WARP ? m->bend_warp : m->bend_weft;
  double k = fold_spring(rigidity * (w->width[e[0]] + w->width[e[1]]) / both, arm[0], arm[1], 0);
  for (int i = 0; i < 2; i++) given[e[i]] += k * both / arm[i];
  // at rest the cloth may be curved
  double bent = rest_distance(sim, a, b) / (rest_distance(sim, a, v) + rest_distance(sim, v, b));
  return add(w, a, b, CLOTH_SPRING_BEND, bent * both, k, m, err);
}

static cloth_status add_bend_lattice(net *w, cloth_error *err)
{
  const cloth_sim *sim = w->sim;
  double *given = calloc((size_t)sim->edge_count + 1, sizeof *given);
  if (given == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "springs of %d edges", sim->edge_count);
  cloth_status status = CLOTH_OK;
  collect_sides(w);
  for (int v = 0; v < sim->vertex_count && status == CLOTH_OK; v++)
    for (int axis = 0; axis < 2 && status == CLOTH_OK; axis++)
      status = add_bend_over(w, v, axis, given, err);
  for (int e = 0; e < sim->edge_count; e++)
    w->stiffness[e] = fmax(LEAST_SHARE * w->stiffness[e], w->stiffness[e] - given[e]);
  free(given);
  return status;
}

static cloth_status add_bend_mesh(net *w, cloth_error *err)
{
  const cloth_sim *sim = w->sim;
  for (int i = 0; i < sim->hinge_count; i++) {
    const int *h = sim->hinge + 4 * i;
    int cloth = cloth_of_vertex(sim, h[0]);
    if (w->lattice[cloth]) continue;
    double l = rest_distance(sim, h[0], h[1]), foot[2], height[2];
    for (int s = 0; s < 2; s++) { // arms in the frame of the hinge
      double side = rest_distance(sim, h[0], h[2 + s]), far = rest_distance(sim, h[1], h[2 + s]);
      foot[s] = (side * side - far * far + l * l) / (2 * l);
      height[s] = sqrt(fmax(0, side * side - foot[s] * foot[s]));
    }
    const cloth_material *m = &sim->def->cloth[cloth].material;
    double hinge = cloth_hinge_rigidity(sim, i, m) * 2 * l / (height[0] + height[1]);
    double k = fold_spring(hinge, height[0], height[1], foot[0] - foot[1]);
    CLOTH_TRY(add(w, h[2], h[3], CLOTH_SPRING_BEND, rest_distance(sim, h[2], h[3]), k, m, err));
  }
  return CLOTH_OK;
}

cloth_status cloth_springs_net(cloth_sim *sim, cloth_error *err)
{
  net w;
  cloth_status status;
  CLOTH_TRY_GOTO(net_new(sim, &w, err), status, done);
  measure(&w);
  for (int c = 0; c < sim->def->cloth_count; c++) {
    w.lattice[c] = is_lattice(&w, c);
    if (w.lattice[c]) weigh_lattice(&w, c);
  }
  for (int t = 0; t < sim->triangle_count; t++) {
    if (w.lattice[cloth_of_triangle(sim, t)])
      stretch_lattice(&w, t);
    else
      stretch_mesh(&w, t);
  }
  CLOTH_TRY_GOTO(add_bend_lattice(&w, err), status, done);
  CLOTH_TRY_GOTO(add_bend_mesh(&w, err), status, done);
  CLOTH_TRY_GOTO(add_stretch(&w, err), status, done);
  CLOTH_TRY_GOTO(add_shear(&w, err), status, done);
done:
  net_free(&w);
  return status;
}
