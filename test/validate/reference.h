// Answers that no simulator made: elastic strips as boundary value problems, solved here by
// shooting.
#pragma once

/// A strip clamped level, under its own weight gamma = density g L^3 / D and a load at its end
/// load = P L^2 / D (both per width): drop and reach of the free end over L.
/// (L - s) is the arc length to the free end: d2 eps / d(L - s)^2 = (load + gamma (L - s)) sin eps,
/// eps the angle to the vertical.
void reference_cantilever(double gamma, double load, double *drop, double *reach);

/// A strip whose ends are held together, pointing up; gamma = density g L^3 / D, L its whole
/// length. Depth of the lowest point below the grip, half width, height of the highest point above
/// the grip, over L. x and z (nullable): the right half from the lowest point, at n + 1 even
/// places, grip at the origin.
void reference_heart_loop(double gamma, double *depth, double *half_width, double *top, int n,
                          double *x, double *z);
