// toi.h in float.
#define CLOTH_SINGLE_PRECISION
#include "geometry/impact_precision.h"

int cloth_impact_search_f32(int split, const double x[8][3], double *toi)
{
  return cloth_impact_in_precision(split, x, toi);
}
