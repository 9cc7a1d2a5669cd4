// toi.h in double.
#include "geometry/impact_precision.h"

int cloth_impact_search_f64(int split, const double x[8][3], double *toi)
{
  return cloth_impact_in_precision(split, x, toi);
}

// A share of the distance in place of 0 keeps toi.h from taking what is close as exact
// (toi_close.h). It is too small a share to matter otherwise; where the start is as near as
// rounding, which is the one case that would still be taken so, it is an impact.
int cloth_impact_search_rounded_f64(int split, const double x[8][3], double *toi)
{
  const cloth_real share = 0x1p-60;
  cloth_v3 point[8], n[2];
  cloth_real kept[2], skip;
  for (int k = 0; k < 8; k++) point[k] = cloth_v3_make(x[k][0], x[k][1], x[k][2]);
  cloth_toi_motion m = cloth_toi_motion_make(point, point + 4, split);
  cloth_toi_normals(m.start, split, n);
  for (int c = 0; c < 2; c++) kept[c] = cloth_toi_separation(&m, m.start, n[c], 0, &skip);
  if (!(kept[0] > 2 * m.error || kept[1] > 2 * m.error)) return *toi = 0, 1;
  return cloth_toi_search(point, point + 4, split, INFINITY, share, toi);
}
