// Bending over every inner edge; kernels/physics/bend.h holds the model.
#include "bend.h"
#include "effect/effect.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static bool wanted(const cloth_sim *sim, char why[160])
{
  if (cloth_is_mass_spring(sim)) {
    snprintf(why, 160, "integrator mass_spring has springs instead");
    return false;
  }
  for (int c = 0; c < sim->def->cloth_count && sim->hinge_count > 0; c++) {
    const cloth_material *m = &sim->def->cloth[c].material;
    if (!(m->bend_warp > 0 || m->bend_weft > 0)) continue;
    snprintf(why, 160, "cloth %s: bend_warp = %g, bend_weft = %g N m", sim->def->cloth[c].name,
             m->bend_warp, m->bend_weft);
    return true;
  }
  snprintf(why, 160,
           sim->hinge_count > 0 ? "no material resists bending" : "no two triangles share an edge");
  return false;
}

// rigidity for bending over an edge: the warp is curved by an edge that runs along the weft
double cloth_hinge_rigidity(const cloth_sim *sim, int hinge, const cloth_material *m)
{
  double warp[3], along = 0, length = 0;
  const int *h = sim->hinge + 4 * hinge;
  cloth_warp_direction(sim, hinge, warp);
  for (int k = 0; k < 3; k++) {
    double e = sim->rest[3 * h[1] + k] - sim->rest[3 * h[0] + k];
    along += e * warp[k];
    length += e * e;
  }
  double cos_sq = length > 0 ? along * along / length : 0; // of the angle between edge and warp
  return m->bend_weft * cos_sq + m->bend_warp * (1 - cos_sq);
}

static double area(const double *x, const int a, const int b, const int c)
{
  double u[3], v[3];
  for (int k = 0; k < 3; k++)
    u[k] = x[3 * b + k] - x[3 * a + k], v[k] = x[3 * c + k] - x[3 * a + k];
  double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
}

static void rest_hinge(const cloth_sim *sim, int hinge, double *stiffness, double *angle)
{
  const int *h = sim->hinge + 4 * hinge;
  cloth_v3 x[4];
  double l_sq = 0;
  for (int k = 0; k < 4; k++)
    x[k] = cloth_v3_make((cloth_real)(sim->rest[3 * h[k]] - sim->rest[3 * h[0]]),
                         (cloth_real)(sim->rest[3 * h[k] + 1] - sim->rest[3 * h[0] + 1]),
                         (cloth_real)(sim->rest[3 * h[k] + 2] - sim->rest[3 * h[0] + 2]));
  for (int k = 0; k < 3; k++) {
    double e = sim->rest[3 * h[1] + k] - sim->rest[3 * h[0] + k];
    l_sq += e * e;
  }
  const cloth_material *m = &sim->def->cloth[cloth_of_vertex(sim, h[0])].material;
  *stiffness = (double)cloth_bend_stiffness(
      (cloth_real)cloth_hinge_rigidity(sim, hinge, m), (cloth_real)sqrt(l_sq),
      (cloth_real)area(sim->rest, h[0], h[1], h[2]), (cloth_real)area(sim->rest, h[0], h[1], h[3]));
  *angle = (double)cloth_bend_angle(x[0], x[1], x[2], x[3]);
}

static cloth_status prepare(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  CLOTH_TRY(cloth_elements_select(part, sim->hinge_count, 4, sim->hinge, true, &part->bend, err));
  part->bend.owner = CLOTH_EFFECT_bending;
  size_t n = (size_t)part->bend.count;
  double *stiffness = malloc(sizeof *stiffness * (n + 1)), *angle = malloc(sizeof *angle * (n + 1));
  cloth_status status = CLOTH_NO_MEMORY;
  if (stiffness == NULL || angle == NULL) {
    cloth_fail(err, status, __FILE__, __LINE__, "bending of %zu hinges", n);
    goto done;
  }
  for (size_t i = 0; i < n; i++) rest_hinge(sim, part->bend.which[i], stiffness + i, angle + i);
  CLOTH_TRY_GOTO(
      cloth_upload_real(sim, part, "stiffness", stiffness, (int)n, &part->bend_stiffness, err),
      status, done);
  CLOTH_TRY_GOTO(cloth_upload_real(sim, part, "rest_angle", angle, (int)n, &part->bend_rest, err),
                 status, done);
done:
  free(stiffness), free(angle);
  return status;
}

static cloth_status upload(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  size_t n = (size_t)part->bend.count;
  CLOTH_TRY(cloth_take(sim, part, "damping", sizeof(cloth_real) * n, &part->bend_damping, err));
  CLOTH_TRY(cloth_take(sim, part, "force", sizeof(cloth_real) * 12 * n, &part->bend_force, err));
  CLOTH_TRY(
      cloth_take(sim, part, "gradient", sizeof(cloth_real) * 12 * n, &part->bend_gradient, err));
  return cloth_take(sim, part, "weight", sizeof(cloth_real) * n, &part->bend_weight, err);
}

static cloth_status apply(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  cloth_bend_args a = {p->bend.vertex, p->bend_stiffness, p->bend_rest,     p->bend_damping, p->x,
                       p->x_t0,        p->bend_force,     p->bend_gradient, p->bend_weight};
  return cloth_launch(sim, p, CLOTH_KERNEL_bend, p->bend.count, &a, err);
}

const cloth_effect cloth_effect_bending = {
    .name = "bending",
    .source = "Grinspun et al. 2003, Discrete shells; Gauss-Newton tangent",
    .wanted = wanted,
    .prepare = prepare,
    .upload = upload,
    .apply = apply,
};
