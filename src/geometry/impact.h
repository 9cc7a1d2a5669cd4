// The engine's time of impact (kernels/physics/toi.h) for whoever has coordinates in double: the
// `cloth ccd` commands and tests.
#pragma once

#include <stdbool.h>

/// Which points are the first feature of a pair.
typedef enum cloth_impact_kind {
  CLOTH_IMPACT_VERTEX_FACE = 1, // point 0, then the corners of the face
  CLOTH_IMPACT_EDGE_EDGE = 2,   // points 0 and 1, then 2 and 3
} cloth_impact_kind;

/// How it is computed. FLOAT searches in float, and where that does not prove the pair apart (a
/// contact, or too close for float to tell) asks again in double; FLOAT_ALONE takes what float
/// cannot prove apart for a contact. In all three a pair said to be apart is apart for the
/// coordinates as given in double: the rounding to float is covered.
typedef enum cloth_impact_precision {
  CLOTH_IMPACT_DOUBLE,
  CLOTH_IMPACT_FLOAT,
  CLOTH_IMPACT_FLOAT_ALONE,
} cloth_impact_precision;

typedef struct cloth_impact_result {
  bool hit;
  bool asked_again; // CLOTH_IMPACT_FLOAT: float could not prove it apart
  double toi;       // [0, 1] if hit, never later than the first contact
} cloth_impact_result;

/// Do two features whose points move in straight lines from x[0..3] to x[4..7] [m] touch?
cloth_impact_result cloth_impact_test(cloth_impact_kind kind, cloth_impact_precision precision,
                                      const double x[8][3]);

/// The same for coordinates that are not exact: each may be off by two of its last digits (a
/// fraction such as 1/3, read as a double). What is said to be apart is apart for every choice of
/// them; what comes as near as that is an impact.
cloth_impact_result cloth_impact_test_rounded(cloth_impact_kind kind,
                                              cloth_impact_precision precision,
                                              const double x[8][3]);
