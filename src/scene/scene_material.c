// `stretching`, `bending` and `isotropic` of a material: what is more than one number.
#include "scene/scene_file.h"

#include <math.h>

// Rows of (c11, c12, c22, c33), half the stiffness: at zero strain, then for a principal stretch of
// 7/6 at 0, 22.5, 45, 67.5 and 90 degrees to the warp
static cloth_status read_stretching(cloth_value at, cloth_material *out, cloth_error *err)
{
  CLOTH_TRY(cloth_yaml_list(at, 6, 6, err));
  for (int i = 0; i < 6; i++) {
    cloth_value row = cloth_yaml_item(at, i);
    double *c = out->measured_stretching + 4 * i;
    CLOTH_TRY(cloth_yaml_numbers(row, 4, "N/m", 1e7, c, err));
    if (!(c[0] > 0 && c[2] > 0 && (i > 0 || c[3] > 0)))
      CLOTH_YAML_FAIL(
          err, row,
          "c11 = %g, c22 = %g, c33 = %g [N/m]: c11, c22, and in the first row c33, must "
          "be above 0",
          c[0], c[2], c[3]);
  }
  // the linear membrane that it is near zero strain: what is printed, and what others ask
  const double *c = out->measured_stretching;
  double c12 = fmin(fabs(c[1]), 0.95 * sqrt(c[0] * c[2])); // the bound of membrane.h
  out->stretch_warp = 2 * (c[0] - c12 * c12 / c[2]);
  out->stretch_weft = 2 * (c[2] - c12 * c12 / c[0]);
  out->poisson = c[1] > 0 ? fmin(0.99, c12 / c[2]) : 0;
  out->shear = 2 * c[3];
  return CLOTH_OK;
}

// Rows for an edge at 0, 45 and 90 degrees to the warp, columns for a curvature of 0, 5, 10, 15 and
// 20 1/m; four times the rigidity of a plate
static cloth_status read_bending(cloth_value at, cloth_material *out, cloth_error *err)
{
  CLOTH_TRY(cloth_yaml_list(at, 3, 3, err));
  for (int i = 0; i < 3; i++) {
    cloth_value row = cloth_yaml_item(at, i);
    double *c = out->measured_bending + 5 * i;
    CLOTH_TRY(cloth_yaml_numbers(row, 5, "N m", 1e3, c, err));
    for (int k = 0; k < 5; k++)
      if (!(c[k] > 0)) CLOTH_YAML_FAIL(err, row, "%g N m is not above 0", c[k]);
  }
  out->bend_weft = out->measured_bending[0] / 4;
  out->bend_warp = out->measured_bending[10] / 4;
  return CLOTH_OK;
}

// a sheet of one stuff: Young's modulus, Poisson number, thickness
static cloth_status read_isotropic(cloth_value at, cloth_material *out, cloth_error *err)
{
  static const char *const known[] = {"young", "poisson", "thickness", NULL};
  double young, nu, h;
  cloth_value value;
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  CLOTH_TRY(cloth_yaml_need(at, "young", &value, err));
  CLOTH_TRY(cloth_yaml_number(value, "Pa", 1, 1e13, &young, err));
  CLOTH_TRY(cloth_yaml_need(at, "poisson", &value, err));
  CLOTH_TRY(cloth_yaml_number(value, "1", 0, 0.99, &nu, err));
  CLOTH_TRY(cloth_yaml_need(at, "thickness", &value, err));
  CLOTH_TRY(cloth_yaml_number(value, "m", 1e-6, 1e-1, &h, err));
  out->stretch_warp = out->stretch_weft = young * h;
  out->shear = young * h / (2 * (1 + nu));
  out->poisson = nu;
  out->bend_warp = out->bend_weft = young * h * h * h / (12 * (1 - nu * nu));
  return CLOTH_OK;
}

cloth_status cloth_read_material_tables(cloth_value at, cloth_material *out, cloth_error *err)
{
  cloth_value value;
  if (cloth_yaml_find(at, "isotropic", &value)) CLOTH_TRY(read_isotropic(value, out, err));
  if (cloth_yaml_find(at, "stretching", &value)) CLOTH_TRY(read_stretching(value, out, err));
  if (cloth_yaml_find(at, "bending", &value)) CLOTH_TRY(read_bending(value, out, err));
  return CLOTH_OK;
}
