// How parts are joined, and in which order their sub-vectors travel, so that each part gets every
// other part's rows. Used by the engine (solve/exchange.c) and by `cloth links`, which predicts the
// time that an exchange takes on a machine that is not at hand.
#pragma once

#include "status.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
  CLOTH_LINKS_PARTS_MAX = 64,
  CLOTH_LINKS_NODES_MAX = 2 * CLOTH_LINKS_PARTS_MAX,
  CLOTH_TRANSFERS_MAX = CLOTH_LINKS_PARTS_MAX * (CLOTH_LINKS_PARTS_MAX - 1)
};

/// A tree of switches, or every part joined to every other (NVSwitch, one host's memory). Nodes
/// [0, parts) are the parts, the rest are switches; each has one link, up to its parent, that
/// carries one transfer each way at a time. Flat: each part has one port out and one in.
typedef struct cloth_links {
  int parts, nodes;
  bool flat;
  int parent[CLOTH_LINKS_NODES_MAX];       // -1: the root
  double bandwidth[CLOTH_LINKS_NODES_MAX]; // B/s each way, of the link to the parent (flat: port)
  double latency[CLOTH_LINKS_NODES_MAX];   // s, likewise
} cloth_links;

/// Part `to` gets part `vector`'s rows from part `from`, which owns them or got them earlier.
typedef struct cloth_transfer {
  int stage; // transfers of one stage use no port and no link twice
  int vector, from, to;
} cloth_transfer;

/// All parts joined to all.
cloth_links cloth_links_flat(int parts, double bandwidth, double latency);

/// A binary tree over the parts in order, as even as can be: the motherboards of P-Cloth.
cloth_links cloth_links_binary(int parts, double bandwidth, double latency);

/// The nearest switch above two different nodes; -1 where there is none (flat).
int cloth_links_meeting(const cloth_links *links, int a, int b);

/// The order of all transfers, by stage; out: [parts (parts - 1)]. Returns the number of stages.
/// Flat: a rotation, every port busy in every stage. Tree: a sub-vector enters each branch once and
/// is handed on inside it (P-Cloth section 3.1.2, for any tree and any number of parts).
int cloth_transfer_order(const cloth_links *links, cloth_transfer *out);

/// When each transfer starts and ends [s] if every one moves `bytes`: out, [parts (parts - 1) x 2].
/// A part sends, and receives, in the order given, one transfer at a time.
void cloth_transfer_times(const cloth_links *links, int count, const cloth_transfer *order,
                          double bytes, double *out);

#ifdef __cplusplus
}
#endif
