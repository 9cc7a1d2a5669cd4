// toi.h in double.
#include "geometry/impact_precision.h"

int cloth_impact_search_f64(int split, const double x[8][3], double *toi)
{
  return cloth_impact_in_precision(split, x, toi);
}
