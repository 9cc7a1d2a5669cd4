// What the readers of scene files share; doc/scene_file.md is the format.
#pragma once

#include "scene/def.h"
#include "scene/mesh.h"
#include "scene/yaml.h"

typedef struct cloth_named_material {
  const char *name; // borrowed from the file
  cloth_material material;
} cloth_named_material;

typedef struct cloth_materials {
  int count;
  cloth_named_material *item;
} cloth_materials;

/// Put the values of `variables:` where a plain $NAME stands. `variant` (nullable): names of
/// `variants:` and NAME=VALUE, with commas between; the later one wins. CLOTH_BAD_SCENE.
cloth_status cloth_resolve_variables(cloth_yaml *file, const char *variant, cloth_error *err);

/// Set the entry of a table that the value's key names.
cloth_status cloth_read_setting(cloth_value at, const cloth_param_info *table, void *base,
                                cloth_error *err);

/// The tables of a material, into it; numbers that stand beside them are read later and win.
cloth_status cloth_read_material_tables(cloth_value at, cloth_material *out, cloth_error *err);

/// `params:`.
cloth_status cloth_read_params(cloth_value at, cloth_def *def, cloth_error *err);

/// Settings of a preset: precision and parameters. `name` is one of config/presets, or a file, seen
/// from the folder of the file `beside` ("": from here). CLOTH_BAD_ARGUMENT: there is none of that
/// name; CLOTH_BAD_SCENE: the file is wrong.
cloth_status cloth_preset_apply(const char *name, const char *beside, cloth_def *def,
                                cloth_error *err);

/// `materials:`; free(out->item) after use, also after a failure.
cloth_status cloth_read_materials(cloth_value at, cloth_materials *out, cloth_error *err);

/// The keys position and rotation or rpy of a mapping, where it has them; the rest of *pose stays.
cloth_status cloth_read_pose(cloth_value mapping, cloth_pose *pose, cloth_error *err);

/// `motion:`; keys leave out what they share with the key before, the first with `start`.
/// out is to be freed (cloth_motion_free), also after a failure.
cloth_status cloth_read_motion(cloth_value at, const cloth_pose *start, cloth_motion *out,
                               cloth_error *err);

/// a b: first b, then a.
cloth_pose cloth_pose_product(const cloth_pose *a, const cloth_pose *b);

/// The mesh of `mesh: FILE`.
cloth_status cloth_read_mesh_file(cloth_value at, cloth_mesh_file *out, cloth_error *err);

/// `scale:` applied to the positions; a mirrored mesh is turned over, so that outside stays
/// outside.
cloth_status cloth_read_scale(cloth_value mapping, cloth_mesh *mesh, cloth_error *err);

/// Shape and size of a body whose mesh has been read: it has at most one of box, sphere, cylinder,
/// plane; others are meshes.
cloth_status cloth_read_size(cloth_value body, cloth_body_view *view, cloth_error *err);

/// `groups:` of a cloth: add to what the mesh file brought.
/// sides  the axis (x, y, z) of the sides left, right, bottom and top of the shape; -: it has none
cloth_status cloth_read_groups(cloth_value at, const char *sides, cloth_mesh_file *file,
                               cloth_error *err);

/// One item of `bodies:`, of `cloths:` with its pins (the bodies are there by then).
cloth_status cloth_read_body(cloth_value at, cloth_def *def, cloth_error *err);
cloth_status cloth_read_cloth(cloth_value at, const cloth_materials *materials, cloth_def *def,
                              cloth_error *err);
