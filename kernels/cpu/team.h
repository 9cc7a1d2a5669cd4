// Threads that do several loops in one parallel region, and wait for each other in between.
#pragma once

#include <omp.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

// A loop of a small solve takes some ten microseconds, less than it takes to wake a thread that
// sleeps. So who waits keeps looking for a while and then goes to sleep: a busy machine loses
// little time to waiting. OpenMP's own barrier does one or the other.
#define CLOTH_TEAM_PATIENCE 50e-6 // s
enum { CLOTH_TEAM_LOOKS = 32 };   // between looks at the clock

typedef struct cloth_team {
  _Alignas(64) atomic_int arrived;
  _Alignas(64) atomic_int round;
  atomic_int asleep;
  pthread_mutex_t lock; // of going to sleep
  pthread_cond_t next;
} cloth_team;

#define CLOTH_TEAM_INIT                                                                            \
  {                                                                                                \
    .lock = PTHREAD_MUTEX_INITIALIZER, .next = PTHREAD_COND_INITIALIZER                            \
  }

static inline void cloth_team_pause(void)
{
#if defined(__x86_64__)
  _mm_pause();
#elif defined(__aarch64__)
  __asm__ volatile("yield");
#endif
}

/// Whether the round ended before patience did.
static inline bool cloth_team_look(cloth_team *t, int round)
{
  double start = omp_get_wtime();
  do
    for (int look = 0; look < CLOTH_TEAM_LOOKS; look++) {
      if (atomic_load(&t->round) != round) return true;
      cloth_team_pause();
    }
  while (omp_get_wtime() - start < CLOTH_TEAM_PATIENCE);
  return false;
}

static inline void cloth_team_sleep(cloth_team *t, int round)
{
  pthread_mutex_lock(&t->lock);
  atomic_fetch_add(&t->asleep, 1); // before the look: who ends the round sees it, or is seen
  while (atomic_load(&t->round) == round) pthread_cond_wait(&t->next, &t->lock);
  atomic_fetch_sub(&t->asleep, 1);
  pthread_mutex_unlock(&t->lock);
}

/// Returns when all `threads` are here; what each wrote before is seen by all after.
static inline void cloth_team_wait(cloth_team *t, int threads)
{
  int round = atomic_load(&t->round);
  if (atomic_fetch_add(&t->arrived, 1) == threads - 1) {
    atomic_store(&t->arrived, 0);
    atomic_store(&t->round, round + 1);
    if (atomic_load(&t->asleep) > 0) {
      pthread_mutex_lock(&t->lock);
      pthread_cond_broadcast(&t->next);
      pthread_mutex_unlock(&t->lock);
    }
    return;
  }
  if (!cloth_team_look(t, round)) cloth_team_sleep(t, round);
}
