// cloth replay: play a recording against a scene and compare the state after every step.
#include "tool.h"

#include <inttypes.h>

static const tool_option options[] = {{NULL, NULL, NULL}};

static int replay_main(const tool_arguments *args, cloth_error *err)
{
  cloth_def *def = NULL;
  cloth_scene *scene = NULL;
  cloth_status status = tool_scene_load(args, args->operand[1], &def, err);
  if (status == CLOTH_OK) status = cloth_scene_new(def, &scene, err);
  int code = tool_exit_code(status);
  if (status == CLOTH_OK) {
    int64_t steps = 0;
    double start = tool_clock();
    status = cloth_replay(scene, args->operand[0], &steps, err);
    // a recording that can be read but does not fit is a finding, not bad input
    code = status == CLOTH_BAD_STATE ? TOOL_FAILED : tool_exit_code(status);
    double wall = tool_clock() - start;
    if (code != TOOL_BAD_INPUT)
      printf("%" PRId64 " steps match, %.6g s simulated in %.3f s\n", steps, cloth_time(scene),
             wall);
  }
  cloth_scene_free(scene);
  cloth_def_free(def);
  return code;
}

const tool_command tool_replay = {"replay",
                                  "RECORDING SCENE.yaml",
                                  2,
                                  2,
                                  true,
                                  options,
                                  "play a recording again and compare every step",
                                  replay_main};
