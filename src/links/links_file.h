// Model files of `cloth links`: how the parts of a machine are joined, and what they multiply.
#pragma once

#include "links/links.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cloth_links_model {
  char name[128];
  cloth_links links;
  double rows;             // block rows of the whole matrix
  double blocks;           // 3x3 blocks a row
  double real_bytes;       // 4 or 8
  double memory_bandwidth; // B/s that a product reaches on one part
  double own;              // share of the blocks whose column is the part's own
  double halo;             // share of a sub-vector that travels
} cloth_links_model;

/// Read a model file; see doc/multi_gpu.md. CLOTH_BAD_SCENE: `FILE:LINE: key 'KEY': ...`.
cloth_status cloth_links_load(const char *path, cloth_links_model *out, cloth_error *err);

/// What the model says of one product y = A x over all parts, in seconds.
typedef struct cloth_links_forecast {
  int stages, count;
  cloth_transfer order[CLOTH_TRANSFERS_MAX];
  double time[2 * CLOTH_TRANSFERS_MAX]; // start and end of each transfer
  double single;                        // the whole product on one part
  double own, other;                    // on a part: its own block; each other block
  double exchange;                      // the last arrival
  double straight;                      // all arrive, then all is multiplied
  double pipelined;                     // own block at once, others as they arrive
  double end[CLOTH_LINKS_PARTS_MAX];    // pipelined, by part
} cloth_links_forecast;

void cloth_links_predict(const cloth_links_model *model, cloth_links_forecast *out);

#ifdef __cplusplus
}
#endif
