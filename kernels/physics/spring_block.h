// A run of sub-steps of the mass-spring cloth: what changes from one to the next, so that a GPU can
// take all of them in one kernel. Same sub-steps, same bits as spring_step.h one by one.
#pragma once

#include "bin_search.h"
#include "spring_step.h"

enum { CLOTH_SPRING_BLOCK_MAX = 128 }; // sub-steps

/// What a block and its searches count.
enum {
  CLOTH_SPRING_CANDIDATES, // of all rows
  CLOTH_SPRING_FULL,       // rows without room for them
  CLOTH_SPRING_STRAYED,    // 1: a particle strayed too far, and the block is to be done again
  CLOTH_SPRING_NEARLY,     // 1: a particle strayed half as far
  CLOTH_SPRING_AGAIN,      // searches that the block made for itself after the first
  CLOTH_SPRING_HEAD = 6    // what follows is aligned
};

typedef struct cloth_spring_block_args {
  cloth_spring_step_args step; // of the first: x_next, v_next and `first` are not used
  int rows;                    // particles
  int begin, count;            // sub-steps of the step that are taken here
  // the whole step
  double h, sub_step; // s; the last sub-step ends with the step
  int sub_steps;
  double mean[3], mean_change[3]; // m/s, m/s^2: how all particles move on average
  const cloth_real *wind;         // [count x 3] m/s; NULL: it stays
  int body_rows, held_rows; // bodies and held particles in a row of pose and aim; 0: one row is for
                            // all
  int last;                 // touch is wanted
  cloth_real *x, *v;        // [n x 3] m, m/s: from the start to the end
  cloth_real *x_ref, *v_ref;     // [n x 3] the start is kept there; NULL: not watched
  cloth_real *x_saved, *v_saved; // [n x 3] as well; NULL: the step began earlier
  // Candidates are found first, from lists that begin with head[place] and go on with
  // next[particle]. Where a particle strays too far, they are found again before the next sub-step,
  // or CLOTH_SPRING_STRAYED says that the block is to be done again.
  cloth_bin_search_args find; // start and particle are not used
  uint32_t *head, *next;      // [places], [n] scratch; NULL: nobody asks
} cloth_spring_block_args;

/// What differs from sub-step to sub-step.
typedef struct cloth_spring_inputs {
  cloth_real h;        // s
  cloth_real wind[3];  // m/s
  cloth_real drift[3]; // m, how far all went on average
} cloth_spring_inputs;

/// Seconds from the start of the step to that of a sub-step.
CLOTH_FN double cloth_spring_block_time(const cloth_spring_block_args *b, int sub_step)
{
  return sub_step < b->sub_steps ? sub_step * b->sub_step : b->h;
}

/// Of sub-step k of the block.
CLOTH_FN cloth_spring_inputs cloth_spring_inputs_at(const cloth_spring_block_args *b, int k)
{
  cloth_spring_inputs t;
  int n = b->begin + k;
  double time = cloth_spring_block_time(b, n), since = time - cloth_spring_block_time(b, b->begin);
  t.h = (cloth_real)(n + 1 < b->sub_steps ? b->sub_step : b->h - time);
  for (int c = 0; c < 3; c++) {
    t.wind[c] = b->wind ? b->wind[3 * k + c] : b->step.air.wind[c];
    t.drift[c] = (cloth_real)(since * (b->mean[c] + since / 2 * b->mean_change[c]));
  }
  return t;
}

/// Arguments of sub-step k, but for the buffers.
CLOTH_FN void cloth_spring_inputs_set(const cloth_spring_block_args *b, int k,
                                      const cloth_spring_inputs *t, cloth_spring_step_args *a)
{
  a->h = t->h;
  for (int c = 0; c < 3; c++) a->air.wind[c] = t->wind[c], a->drift[c] = t->drift[c];
  if (a->shapes.count > 0) {
    a->shapes.pose_t0 = b->step.shapes.pose_t0 + 12 * (int64_t)b->body_rows * k;
    a->shapes.pose_t1 = a->shapes.pose_t0 + 12 * (int64_t)b->body_rows;
  }
  if (a->holds.slot) a->holds.aim = b->step.holds.aim + 3 * (int64_t)b->held_rows * k;
  a->x_ref = k > 0 ? b->x_ref : 0; // at first nobody has moved yet
  a->touch = b->last && k + 1 == b->count ? b->step.touch : 0;
}
