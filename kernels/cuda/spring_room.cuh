// What a block of threads of the mass-spring kernel keeps in its shared memory: what does not
// change within a block of sub-steps, and the states that a sub-step reads, each read once from
// memory however many threads want it.
#pragma once

#include "launch.h"
#include "spring_block.h"

namespace {

enum {
  LANES = CLOTH_SPRING_LANES,
  WARP = 32,
  SPRINGS = 3, // of a thread in shared memory, as many as a particle of a lattice has
  TRIANGLES = 2,
  CANDIDATES = 4,
  HEADS = (27 + LANES - 1) / LANES, // of the cells around a particle, by each of its threads
  BODIES = 16,                      // in shared memory
  POSE_NUMBERS = 1536,              // in shared memory
  PROBES = 16                       // of the table of others
};

constexpr int NOBODY = -1;

// three numbers as one load
struct __align__(16) cell { cloth_real x, y, z, more; };

struct record { // a particle's state
  cell x, v;
};

__device__ __forceinline__ cloth_v3 get(cell c) { return cloth_v3_make(c.x, c.y, c.z); }

__device__ __forceinline__ cell cell_of(cloth_v3 v, cloth_real more = 0)
{
  cell c = {v.x, v.y, v.z, more};
  return c;
}

// ---- of a thread --------------------------------------------------------------------------------

// Its share of a particle. Particles are places in the tile.
struct kept_share {
  cloth_real law[CLOTH_SPRING_LAW * SPRINGS], drag[2];
  cloth_real apart[CANDIDATES]; // m, see cloth_particle_apart()
  int to[SPRINGS], corner[3 * TRIANGLES], candidate[CANDIDATES];
  uint32_t spring, spring_end, triangle, triangle_end; // what is left in memory
  uint32_t listed;                                     // candidates of the particle
};

// An odd number of banks, so that neighbouring threads do not ask the same one.
constexpr int KEPT_NUMBERS = (int)(sizeof(kept_share) / sizeof(cloth_real)) | 1;

union kept {
  kept_share share;
  cloth_real number[KEPT_NUMBERS];
  int search[KEPT_NUMBERS * sizeof(cloth_real) / sizeof(int)]; // heads and what is found
};

constexpr int FOUND = sizeof(kept) / sizeof(int) - HEADS;

// Of a particle, for who moves it.
struct kept_particle {
  cloth_spring_particle p;
  cloth_real x_ref[3]; // m, when candidates were found
};

// ---- of a block ---------------------------------------------------------------------------------

struct shared_room {
  cloth_spring_inputs inputs[CLOTH_SPRING_BLOCK_MAX];
  cloth_real pose[POSE_NUMBERS], size[3 * BODIES], friction[BODIES];
  int kind[BODIES];
  unsigned heard[2];
};

// States of the block's own particles, and of others that they feel, by a table from particle to
// place. Who finds no place there is read from memory; place -2 - i says so. A block that takes its
// particles in several goes has no tile.
struct tile {
  cell *x, *v;            // [own + slots]
  cell *force;            // [particles of a go] N; contacts with particles
  kept_particle *kept_of; // [particles of a go]
  int *other;             // [slots] whose place it is
  int first, own;         // particles [first, first + own) are the block's
  int slots;              // a power of two
  const record *now;      // states of all

  __device__ __forceinline__ int place(int i) const
  {
    unsigned at = (unsigned)(i - first), slot = (unsigned)i * 2654435761u >> 16;
    if (at < (unsigned)own) return (int)at;
#pragma unroll 1
    for (int n = 0; n < PROBES && slots > 0; n++, slot++) {
      slot &= (unsigned)slots - 1;
      int whose = atomicCAS(other + slot, NOBODY, i);
      if (whose == NOBODY || whose == i) return own + (int)slot;
    }
    return -2 - i;
  }

  __device__ __forceinline__ int particle(int place) const
  {
    return place < 0 ? -2 - place : place < own ? first + place : other[place - own];
  }

  // Shared memory is read whoever it is, so that the load is known to be of it.
  __device__ __forceinline__ cloth_v3 position(int place) const
  {
    cell c = x[place >= 0 ? place : 0];
    if (place < 0) c = now[-2 - place].x;
    return get(c);
  }

  __device__ __forceinline__ cloth_v3 velocity(int place) const
  {
    cell c = v[place >= 0 ? place : 0];
    if (place < 0) c = now[-2 - place].v;
    return get(c);
  }

  __device__ void forget_others()
  {
    for (int s = (int)threadIdx.x; s < slots; s += (int)blockDim.x) other[s] = NOBODY;
  }

  // the others' states: all loads of a thread are under way before the first is waited for
  __device__ void fetch_others()
  {
    int threads = (int)blockDim.x;
    for (int s = (int)threadIdx.x; s < slots; s += 2 * threads) {
      int t = s + threads, i = other[s], j = t < slots ? other[t] : NOBODY;
      record a = now[i == NOBODY ? 0 : i], b = now[j == NOBODY ? 0 : j];
      if (i != NOBODY) x[own + s] = a.x, v[own + s] = a.v;
      if (j != NOBODY) x[own + t] = b.x, v[own + t] = b.v;
    }
  }
};

inline size_t tile_bytes(int threads, int slots)
{
  size_t own = (size_t)threads / LANES, others = (size_t)slots;
  return (size_t)threads * sizeof(kept) + (3 * own + 2 * others) * sizeof(cell) +
         own * sizeof(kept_particle) + others * sizeof(int);
}

// behind what the threads keep
__device__ tile tile_of(kept *threads, int particles, int rows, int slots, bool at_once)
{
  tile t;
  t.force = reinterpret_cast<cell *>(threads + blockDim.x);
  t.x = t.force + particles;
  t.v = t.x + particles + slots;
  t.kept_of = reinterpret_cast<kept_particle *>(t.v + particles + slots);
  t.other = reinterpret_cast<int *>(t.kept_of + particles);
  t.first = (int)blockIdx.x * particles;
  int left = rows > t.first ? rows - t.first : 0; // none for the last blocks of a cluster
  t.own = !at_once ? 0 : left < particles ? left : particles;
  t.slots = at_once ? slots : 0;
  t.now = nullptr;
  return t;
}

// what the host prescribes, where every thread has it at hand
__device__ void bring(cloth_spring_block_args &b, shared_room *room)
{
  cloth_shapes &s = b.step.shapes;
  int numbers = 12 * (b.body_rows > 0 ? b.body_rows * (b.count + 1) : s.count);
  bool fits = s.count <= BODIES, poses = numbers <= POSE_NUMBERS;
  int t = (int)threadIdx.x, threads = (int)blockDim.x;
  for (int k = t; k < b.count; k += threads) room->inputs[k] = cloth_spring_inputs_at(&b, k);
  for (int k = t; k < numbers && poses; k += threads) room->pose[k] = s.pose_t0[k];
  for (int k = t; k < s.count && fits; k += threads) {
    for (int c = 0; c < 3; c++) room->size[3 * k + c] = s.size[3 * k + c];
    room->friction[k] = s.friction[k], room->kind[k] = s.kind[k];
  }
  if (fits) s.size = room->size, s.friction = room->friction, s.kind = room->kind;
  if (poses) s.pose_t0 = room->pose;
}

} // namespace
