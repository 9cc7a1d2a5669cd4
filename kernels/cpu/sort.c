#include "sort.h"

#include <omp.h>
#include <string.h>

enum { DIGIT_BITS = 8, DIGITS = 1 << DIGIT_BITS, THREADS_MAX = 16, SERIAL_BELOW = 4096 };

typedef struct radix_pass {
  int n, shift;
  const uint64_t *key_in;
  const uint32_t *value_in;
  uint64_t *key_out;
  uint32_t *value_out;
  uint32_t (*count)[DIGITS]; // [threads][DIGITS]
} radix_pass;

static int digit(uint64_t key, int shift) { return (int)((key >> shift) & (DIGITS - 1)); }

static int share_begin(int n, int t, int threads) { return (int)((int64_t)n * t / threads); }

static void count_share(const radix_pass *p, int t, int threads)
{
  memset(p->count[t], 0, sizeof p->count[t]);
  for (int i = share_begin(p->n, t, threads); i < share_begin(p->n, t + 1, threads); i++)
    p->count[t][digit(p->key_in[i], p->shift)]++;
}

// counts become first positions: digit by digit, within a digit thread by thread, which keeps order
static void place_shares(const radix_pass *p, int threads)
{
  uint32_t sum = 0;
  for (int d = 0; d < DIGITS; d++)
    for (int t = 0; t < threads; t++) {
      uint32_t here = p->count[t][d];
      p->count[t][d] = sum;
      sum += here;
    }
}

static void move_share(const radix_pass *p, int t, int threads)
{
  for (int i = share_begin(p->n, t, threads); i < share_begin(p->n, t + 1, threads); i++) {
    uint32_t to = p->count[t][digit(p->key_in[i], p->shift)]++;
    p->key_out[to] = p->key_in[i];
    if (p->value_in != NULL) p->value_out[to] = p->value_in[i];
  }
}

void cloth_cpu_sort(int n, int bits, uint64_t *key, uint32_t *value, uint64_t *key_spare,
                    uint32_t *value_spare, int threads)
{
  uint32_t count[THREADS_MAX][DIGITS];
  threads = threads > THREADS_MAX ? THREADS_MAX : threads < 1 ? 1 : threads;
  if (n < SERIAL_BELOW) threads = 1;

  int flips = 0;
  for (int shift = 0; shift < bits; shift += DIGIT_BITS, flips++) {
    radix_pass p = {n,
                    shift,
                    flips % 2 ? key_spare : key,
                    flips % 2 ? value_spare : value,
                    flips % 2 ? key : key_spare,
                    flips % 2 ? value : value_spare,
                    count};
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
    for (int t = 0; t < threads; t++) count_share(&p, t, threads);
    place_shares(&p, threads);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
    for (int t = 0; t < threads; t++) move_share(&p, t, threads);
  }
  if (flips % 2 == 0 || n == 0) return;
  memcpy(key, key_spare, sizeof *key * (size_t)n);
  if (value != NULL) memcpy(value, value_spare, sizeof *value * (size_t)n);
}

void cloth_cpu_scan(int n, uint32_t *array)
{
  uint32_t sum = 0;
  for (int i = 0; i < n; i++) {
    uint32_t here = array[i];
    array[i] = sum;
    sum += here;
  }
  array[n] = sum;
}
