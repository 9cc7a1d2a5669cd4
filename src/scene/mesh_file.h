// What the mesh readers share. The public side is scene/mesh.h.
#pragma once

#include "scene/file.h"
#include "scene/list.h"
#include "scene/mesh.h"

enum { CLOTH_MESH_FILE_MAX = 100 * 1000 * 1000 }; // vertices, and triangles

/// Parse what a file holds; `path` is for messages. out is zeroed and filled also on failure, for
/// the caller to free.
cloth_status cloth_obj_parse(const char *path, const cloth_text *text, cloth_mesh_file *out,
                             cloth_error *err);
cloth_status cloth_ply_parse(const char *path, const cloth_text *text, cloth_mesh_file *out,
                             cloth_error *err);
