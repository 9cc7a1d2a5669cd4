// Holds that let go: a pin of the scene file whose break force is exceeded breaks once, for good.
#include "check.h"
#include "cloth.h"

#include <unistd.h>

// a 0.3 m sheet of 0.3 kg/m^2, so 0.26 N, that swings down from one corner held with at most 0.2 N
static const char *const SCENE = "name: corner\n"
                                 "materials: {sheet: {density: 0.3}}\n"
                                 "cloths:\n"
                                 "  - name: sheet\n"
                                 "    grid: {size: [0.3, 0.3], resolution: [13, 13]}\n"
                                 "    material: sheet\n"
                                 "    pose: {position: [0, 0, 1]}\n"
                                 "    groups: {corner: [{nearest: [-0.15, 0.15, 0]}]}\n"
                                 "    pins: [{group: corner, break_force: 0.2}]\n";

static cloth_status load(cloth_def **def, cloth_error *err)
{
  char path[] = "/tmp/cloth_test_holds_XXXXXX";
  int file = mkstemp(path);
  if (file < 0) return CLOTH_IO;
  size_t n = strlen(SCENE);
  cloth_status status =
      write(file, SCENE, n) == (ssize_t)n ? cloth_def_load(path, def, err) : CLOTH_IO;
  close(file);
  unlink(path);
  return status;
}

static int a_pin_that_is_pulled_too_hard_breaks_once_and_comes_back_with_a_reset(void)
{
  cloth_error err = {0};
  cloth_def *def;
  cloth_scene *scene;
  cloth_step_report r;
  CHECK_OK(load(&def, &err), err);
  CHECK_OK(cloth_scene_new(def, &scene, &err), err);
  int broken = 0, held_after = 0;
  for (int i = 0; i < 60; i++) {
    CHECK_OK(cloth_step(scene, 0, &r, &err), err);
    if (i == 0) CHECK(r.grasps == 1);
    held_after += broken > 0 ? r.grasps : 0;
    broken += r.grasps_broken;
  }
  CHECK(broken == 1 && held_after == 0);
  CHECK(r.speed_max > 3); // it falls
  CHECK_OK(cloth_reset(scene, &err), err);
  CHECK_OK(cloth_step(scene, 0, &r, &err), err);
  CHECK(r.grasps == 1);
  cloth_scene_free(scene);
  cloth_def_free(def);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(a_pin_that_is_pulled_too_hard_breaks_once_and_comes_back_with_a_reset);
  return failures != 0;
}
