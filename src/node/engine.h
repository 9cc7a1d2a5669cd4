// Ownership of the engine's objects in C++; nothing else.
#pragma once

#include "cloth.h"

#include <memory>

namespace robot_cloth {

struct EngineDelete {
  void operator()(cloth_def *def) const { cloth_def_free(def); }
  void operator()(cloth_scene *scene) const { cloth_scene_free(scene); }
};
using DefPtr = std::unique_ptr<cloth_def, EngineDelete>;
using ScenePtr = std::unique_ptr<cloth_scene, EngineDelete>;

} // namespace robot_cloth
