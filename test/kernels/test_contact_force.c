// Tests of kernels/physics/contact_force.h on contacts that contact_build.h makes: friction against
// what a vertex can do by its inertia alone.
#include "check.h"
#include "contact_build.h"
#include "contact_force.h"
#include "derivative.h"

enum { IMPACTS_MOST = 4 };

static const double step = 0.003, mass = 1e-3, thickness = 1e-3, mu = 0.8;

// What friction turns a slip of `slip` [m] into, as a share of it, on a vertex that alone slides
// over a face of a body and whose pair has come to an impact so many times; and the share that it
// would turn it into without a tangent.
static double left_of(double slip, int impacts, double *explicitly)
{
  cloth_real x_t0[12] = {0, 0, 0, -1, -1, 0, 1, -1, 0, 0, 1, 0}, x[12];
  x_t0[2] = (cloth_real)(0.8 * thickness);
  memcpy(x, x_t0, sizeof x);
  x[0] += (cloth_real)slip, x[2] -= (cloth_real)(0.6 * thickness);
  const int triangle[3] = {1, 2, 3}, body_of[3] = {0, 0, 0}, cloth_of[1] = {0};
  const cloth_real one = 1, m = (cloth_real)mass, friction = (cloth_real)mu;
  uint64_t contact[IMPACTS_MOST];
  uint32_t toi[IMPACTS_MOST];
  cloth_contact_scene scene = {.cloth_vertices = 1,
                               .triangle = triangle,
                               .x_t0 = x_t0,
                               .x = x,
                               .free = &one,
                               .mass = &m,
                               .cloth_of = cloth_of,
                               .body_of = body_of,
                               .body_friction = &friction,
                               .bodies = 1,
                               .thickness = (cloth_real)thickness,
                               .format = {4, 4}};
  for (int i = 0; i < impacts; i++)
    contact[i] = cloth_pair_pack(scene.format, CLOTH_VERTEX_FACE, 0, 0), toi[i] = 1;
  int vertex[4 * IMPACTS_MOST];
  cloth_real weight[4 * IMPACTS_MOST], normal[3 * IMPACTS_MOST], of[6][IMPACTS_MOST];
  cloth_contact_build_args b = {.scene = scene,
                                .count = impacts,
                                .stiffness = 1,
                                .share = 1,
                                .stiffer = 10,
                                .inverse_step = (cloth_real)(1 / step),
                                .contact = contact,
                                .toi = toi,
                                .vertex = vertex,
                                .weight = weight,
                                .normal = normal,
                                .distance = of[0],
                                .thickness = of[1],
                                .k = of[2],
                                .inertia = of[3],
                                .relief = of[4],
                                .mu = of[5]};
  for (int i = 0; i < impacts; i++) cloth_contact_build(i, &b);

  cloth_real elastic[3 * IMPACTS_MOST] = {0}, trial[3 * IMPACTS_MOST], force[3 * IMPACTS_MOST],
                         tangent[6 * IMPACTS_MOST], more[3][IMPACTS_MOST];
  unsigned char state[IMPACTS_MOST] = {0};
  cloth_contact_force_args a = {.vertex = vertex,
                                .weight = weight,
                                .normal = normal,
                                .distance = b.distance,
                                .thickness = b.thickness,
                                .k = b.k,
                                .inertia = b.inertia,
                                .relief = b.relief,
                                .mu = b.mu,
                                .x_t0 = x_t0,
                                .x = x,
                                .elastic = elastic,
                                .trial = trial,
                                .state = state,
                                .bound = more[0],
                                .secant = more[1],
                                .limit = (cloth_real)(0.01 * thickness),
                                .force = force,
                                .tangent = tangent,
                                .pressure = more[2]};
  int last = impacts - 1; // the plane that counts
  cloth_contact_force(last, &a);
  double pull = -(double)force[3 * last], inertia = mass / (step * step);
  *explicitly = 1 - pull / inertia / slip;
  return 1 - pull / (inertia + (double)tangent[6 * last]) / slip;
}

// A pair that was stopped several times has a spring of a thousand times the inertia, and a normal
// force to match. Friction may stop the slip in an iterate, not throw it back.
static int friction_does_not_throw_back(void)
{
  int wild = 0;
  for (int impacts = 1; impacts <= IMPACTS_MOST; impacts++)
    for (int n = 0; n < 100; n++) {
      double explicitly,
          left = left_of(thickness * pow(10, 1 + test_random()), impacts, &explicitly);
      CHECK(left >= -1e-5 && left < 1);
      wild += explicitly < -10;
    }
  CHECK(wild > 100); // else there was nothing to prove
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(friction_does_not_throw_back);
  return failures > 0;
}
