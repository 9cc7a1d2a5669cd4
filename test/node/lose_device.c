// For LD_PRELOAD: the node's first scene runs "on a GPU", which is lost in step LOSE_AT. From then
// on nothing is to be had of that scene, unless LOSE_STEPS_ONLY is set: then its state can still be
// saved, as when another device holds it. LOSE_ASKED is set: the GPU was asked for by name. All
// other calls, and all of other scenes, are the engine's.
#define _GNU_SOURCE // RTLD_NEXT
#include "cloth.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const cloth_scene *first; // scene that was made
static int steps;                // of it
static bool lost;

static void find(const char *name, void *function)
{
  void *found = dlsym(RTLD_NEXT, name);
  if (found == NULL) abort();
  memcpy(function, &found, sizeof found);
}

static bool is_first(const cloth_scene *scene)
{
  if (first == NULL) first = scene;
  return scene == first;
}

static cloth_status gone(cloth_error *err)
{
  if (err == NULL) return CLOTH_DEVICE_LOST;
  *err = (cloth_error){.status = CLOTH_DEVICE_LOST, .line = __LINE__, .file = __FILE__};
  snprintf(err->text, sizeof err->text, "the device fell off");
  return CLOTH_DEVICE_LOST;
}

const char *cloth_backend_of(const cloth_scene *scene)
{
  const char *(*engine)(const cloth_scene *);
  find(__func__, &engine);
  return is_first(scene) ? "cuda" : engine(scene);
}

const char *cloth_backend_why(const cloth_scene *scene)
{
  const char *(*engine)(const cloth_scene *);
  find(__func__, &engine);
  if (!is_first(scene)) return engine(scene);
  return getenv("LOSE_ASKED") ? "asked for" : "a GPU is there";
}

cloth_status cloth_step(cloth_scene *scene, double h, cloth_step_report *report, cloth_error *err)
{
  cloth_status (*engine)(cloth_scene *, double, cloth_step_report *, cloth_error *);
  find(__func__, &engine);
  lost = lost || (is_first(scene) && ++steps >= atoi(getenv("LOSE_AT")));
  return lost && is_first(scene) ? gone(err) : engine(scene, h, report, err);
}

cloth_status cloth_state_save(cloth_scene *scene, const char *path, cloth_error *err)
{
  cloth_status (*engine)(cloth_scene *, const char *, cloth_error *);
  find(__func__, &engine);
  bool unknown = lost && is_first(scene) && getenv("LOSE_STEPS_ONLY") == NULL;
  return unknown ? gone(err) : engine(scene, path, err);
}

void cloth_scene_free(cloth_scene *scene)
{
  void (*engine)(cloth_scene *);
  find(__func__, &engine);
  if (scene != NULL && scene == first) first = (const cloth_scene *)&first; // no scene any more
  engine(scene);
}
