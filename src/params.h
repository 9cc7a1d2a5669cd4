// Parameters and materials as structs; the lists are params.inl and material.inl.
#pragma once

#include "status.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Every parameter of a scene; units and ranges: params.inl.
typedef struct cloth_params {
#define CLOTH_PARAM(type, name, value, unit, least, most, meaning) type name;
#define CLOTH_VECTOR(name, x, y, z, unit, most, meaning) double name[3];
#define CLOTH_CHOICE(name, value, choices, meaning) int name;
#include "params.inl"
} cloth_params;

/// Every property of a fabric; units and ranges: material.inl.
typedef struct cloth_material {
#define CLOTH_MATERIAL(name, value, unit, least, most, meaning) double name;
#include "material.inl"
  // Measured tables (Wang, O'Brien, Ramamoorthi 2011; doc/materials.md); all 0: none, the numbers above act.
  double measured_stretching[24]; // [6 x 4] N/m: c11 c12 c22 c33, half the stiffness
  double measured_bending[15];    // [3 x 5] N m: four times the rigidity of a plate
} cloth_material;

/// The defaults of params.inl, of material.inl.
cloth_params cloth_params_default(void);
cloth_material cloth_material_default(void);

/// Check every value against its range. NaN is out of every range.
/// CLOTH_BAD_ARGUMENT, naming the parameter, its value, its unit and its range.
cloth_status cloth_params_check(const cloth_params *p, cloth_error *err);
cloth_status cloth_material_check(const cloth_material *m, cloth_error *err);

/// What a parameter is, for readers (YAML, ROS) and tables.
typedef struct cloth_param_info {
  const char *name, *unit, *meaning;
  const char *choices; // "a|b|c" for a choice, else NULL
  enum { CLOTH_IS_DOUBLE, CLOTH_IS_INT, CLOTH_IS_VECTOR, CLOTH_IS_CHOICE } kind;
  double least, most;  // of each component
  double value[3];     // default
  size_t offset;       // in cloth_params or cloth_material
} cloth_param_info;

/// Choice `index` of a parameter that is a choice, and how long the word is: it ends at a '|' or at the
/// end of the list.
const char *cloth_param_choice(const cloth_param_info *info, int index, int *length);

/// The lists as tables, ended by name == NULL.
const cloth_param_info *cloth_param_table(void);
const cloth_param_info *cloth_material_table(void);

/// Set one parameter by name from text ("0.01", "0 0 -9.81", "repair"); `base` is the struct that the
/// table describes. CLOTH_BAD_ARGUMENT: unknown name (nearest named), not a number, out of range.
cloth_status cloth_param_set(const cloth_param_info *table, void *base, const char *name,
                             const char *value, cloth_error *err);

#ifdef __cplusplus
}
#endif
