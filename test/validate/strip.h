// Strips of cloth for the validation, and bringing them to rest.
#pragma once

#include "engine/scene.h"

typedef enum strip_mesh {
  STRIP_LEFT,
  STRIP_ALTERNATING,
  STRIP_UNSTRUCTURED,
  STRIP_MESHES,
  STRIP_UNEVEN = STRIP_MESHES // the same, twice as uneven: where bending is measured most wrongly
} strip_mesh;
extern const char *const strip_mesh_name[STRIP_MESHES + 1];

enum { STRIP_MAX = 12000 };

/// A strip along x from 0 to `length` in z = 0, y centred, `cells` of size h along it. Beyond both
/// ends one more straight cell to be clamped by, so that the clamps are at 0 and `length`.
typedef struct strip {
  int vertices, triangles, columns;
  double length, width, h;
  double x[3 * STRIP_MAX];
  int triangle[6 * STRIP_MAX];
  int column_first[STRIP_MAX]; // vertices of column c: column_first[c] .. column_first[c + 1]
} strip;

/// `tail`: whether the far end has its extra cell.
void strip_make(strip *s, strip_mesh mesh, double length, int cells, int across, int tail);

/// A scene with the strip alone, ready for strict solving; free it with cloth_scene_free().
cloth_scene *strip_scene(const strip *s, cloth_material material, const char *gravity,
                         const char *model);

/// Hold columns [first, last] where they are.
cloth_grasp_id strip_hold(const strip *s, cloth_scene *scene, int first, int last,
                          const cloth_grasp_view *how);

/// Step until the kinetic energy has been below `rest` [J] for ten steps, at most `most` steps.
/// Returns the steps taken.
int strip_settle(cloth_scene *scene, double rest, int most);

/// Mean of coordinate k over column c.
double strip_mean(const strip *s, const double *x, int c, int k);

// ---- results ------------------------------------------------------------------------------------

/// Print and file one number; counts it as missed when |measured / expected - 1| > reach (or, where
/// expected is 0, |measured| > reach).
void result(const char *test, const char *mesh, const char *what, double parameter, double measured,
            double expected, double reach);
int results_missed(void);
int results_open(const char *path);
