// On which side? Signs that are right for the coordinates exactly as given, for every finite
// double.
//
// A floating-point filter answers most calls (error bounds after J. Shewchuk, Adaptive Precision
// Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997, section 4); what it cannot
// tell is computed in whole numbers (exact_integer.h), which unlike his expansions need no care
// for underflow.
#pragma once

/// Sign of (b - a) x (c - a) . (d - a): 1 where d lies on the side to which the normal of the
/// counter-clockwise triangle a b c points, -1 on the other, 0 in its plane.
int cloth_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);

/// Sign of the area of a b c seen along `axis` (0 x, 1 y, 2 z): of its coordinates (axis + 1,
/// axis + 2) mod 3. 1 counter-clockwise, 0 on one line.
int cloth_orient2d(const double a[3], const double b[3], const double c[3], int axis);
