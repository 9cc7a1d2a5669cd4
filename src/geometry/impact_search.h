// toi.h in each precision, for impact.c. x [8 x 3]: four points at the start, then at the end.
#pragma once

int cloth_impact_search_f32(int split, const double x[8][3], double *toi);
int cloth_impact_search_f64(int split, const double x[8][3], double *toi);
/// Coordinates off by as much as toi.h allows for (4 epsilon of the largest) are no miss either.
int cloth_impact_search_rounded_f64(int split, const double x[8][3], double *toi);
