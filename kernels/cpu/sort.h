// Sort and scan on a CPU, for the cpu and shuffle backends.
#pragma once

#include <stdint.h>

/// Stable least-significant-digit radix sort of n pairs by the low `bits` of the key. `value` and
/// `value_spare` may both be NULL. Any number of threads gives the same result: there is only one.
void cloth_cpu_sort(int n, int bits, uint64_t *key, uint32_t *value, uint64_t *key_spare,
                    uint32_t *value_spare, int threads);

/// Exclusive prefix sum of array[0..n) in place; array[n] becomes the total.
void cloth_cpu_scan(int n, uint32_t *array);
