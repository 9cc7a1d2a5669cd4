// What is read along with the next read, for any backend that can: the same for the one that
// shuffles and for a GPU.
#pragma once

#include "solve/sim.h"

#include <string.h>

/// Runs of any size and number, one of them not of words and one of many, hold what the device has
/// when the next read reaches it; one that failed to come is still 0.
static int what_is_read_along_comes_with_the_next_read(const cloth_backend *be)
{
  enum { RUNS = 20, BYTES = 10000 };
  static unsigned char got[RUNS][BYTES];
  static const size_t size[] = {4, 8, 4, 7, 256, 8192, 4, BYTES};
  cloth_error err = {0};
  cloth_device *d;
  void *memory[RUNS], *own;
  int last;
  must(be->open(0, 1, &d, &err), &err);
  must(be->alloc(d, sizeof last, &own, &err), &err);
  for (int k = 0; k < RUNS; k++) must(be->alloc(d, BYTES, &memory[k], &err), &err);
  for (int runs = 0; runs <= RUNS; runs++) {
    memset(got, 0, sizeof got);
    for (int k = 0; k < runs; k++) must(be->fill(d, memory[k], 1, BYTES, &err), &err);
    for (int k = 0; k < runs; k++) // the later ones of a round may be read at once
      must(be->read_with(d, got[k], memory[k], size[k % 8], &err), &err);
    for (int k = 0; k < runs && runs <= 3; k++) must(be->fill(d, memory[k], 2, BYTES, &err), &err);
    must(be->fill(d, own, 3, sizeof last, &err), &err);
    must(be->read(d, &last, own, sizeof last, &err), &err);
    CHECK(last == 0x03030303);
    for (int k = 0; k < runs; k++) {
      size_t n = size[k % 8];
      CHECK(got[k][0] == (runs <= 3 ? 2 : 1) && got[k][n - 1] == got[k][0] &&
            got[k][n / 2] == got[k][0]);
    }
  }
  for (int k = 0; k < RUNS; k++) be->release(d, memory[k]);
  be->release(d, own), be->close(d);
  return 0;
}
