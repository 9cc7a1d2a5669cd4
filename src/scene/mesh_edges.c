// Edges too short for the precision of a scene: where the cloth lies, coordinates are rounded to
// steps that leave nothing of them.
#include "scene/mesh.h"

#include <float.h>
#include <math.h>

// What an edge must keep of its length. In float rounding alone decides: four steps to an edge. In
// double lengths enter by their squares and those of cross products before it does.
static double least_share(bool is_float)
{
  return is_float ? 4 * (double)FLT_EPSILON : sqrt(DBL_EPSILON) / 2;
}

static double shortest_edge(const cloth_mesh *m, const double *x, int ends[2])
{
  double least = INFINITY;
  for (size_t side = 0; side < 3 * (size_t)m->triangle_count; side++) {
    int a = m->triangle[side], b = m->triangle[side % 3 == 2 ? side - 2 : side + 1];
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += pow(x[3 * a + k] - x[3 * b + k], 2);
    if (!(sum < least)) continue;
    least = sum;
    ends[0] = a, ends[1] = b;
  }
  return sqrt(least);
}

cloth_status cloth_mesh_check_edges(const char *name, bool is_float, const cloth_mesh *mesh,
                                    const double *position, cloth_error *err)
{
  double far = 0;
  int ends[2] = {0, 0};
  for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++) far = fmax(far, fabs(position[i]));
  double shortest = shortest_edge(mesh, position, ends), least = least_share(is_float) * far;
  if (shortest >= least) return CLOTH_OK;
  CLOTH_FAIL(err, CLOTH_BAD_SCENE,
             "'%s': the edge of vertices %d and %d is %.3g m long; precision %s needs edges of "
             "%.3g m at least in a cloth that lies up to %.3g m from the origin; %s",
             name, ends[0], ends[1], shortest, is_float ? "float" : "double", least, far,
             is_float && shortest >= least_share(false) * far
                 ? "precision: double holds it"
                 : "merge vertices that lie together, or check the mesh's scale");
}
