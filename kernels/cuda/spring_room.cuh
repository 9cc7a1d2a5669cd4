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
  CANDIDATES = 4,                   // loaded and looked at as one
  HEADS = (27 + LANES - 1) / LANES, // of the cells around a particle, by each of its threads
  FOUND_LEAST = 15,                 // that a thread has room for in a search
  BODIES = 16,                      // in shared memory
  POSE_NUMBERS = 1536,              // in shared memory
  PROBES = 16                       // of the table of others
};

constexpr int NOBODY = -1, KEPT_ONE = 1 << 30;

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

// Its share of the springs and triangles of a particle. Particles are places in the tile.
struct kept_share {
  cloth_real law[CLOTH_SPRING_LAW * SPRINGS], drag[2];
  int to[SPRINGS], corner[3 * TRIANGLES];
  uint32_t spring, spring_end, triangle, triangle_end; // what is left in memory
};

struct kept_candidate {
  cloth_real apart; // m, see cloth_particle_apart()
  int place;
};

// What a thread keeps. Behind it is room for its share of the candidates: while they are searched
// for, HEADS lists and what is found; then `near`. A small net has room for more of them.
struct kept {
  kept_share share;
  uint32_t listed; // candidates of the particle

  __device__ __forceinline__ kept_candidate *near()
  {
    return reinterpret_cast<kept_candidate *>(this + 1);
  }
  __device__ __forceinline__ const kept_candidate *near() const
  {
    return reinterpret_cast<const kept_candidate *>(this + 1);
  }
  __device__ __forceinline__ int *search() { return reinterpret_cast<int *>(this + 1); }
};

// That room, in bytes: together an odd number of banks, so that neighbouring threads do not ask the
// same one.
constexpr int ROOM_MORE = 2 * (int)sizeof(cloth_real);
constexpr int ROOM_LEAST =
    ((HEADS + FOUND_LEAST) * (int)sizeof(int) + ROOM_MORE - 1) / ROOM_MORE * ROOM_MORE +
    (sizeof(kept) / sizeof(cloth_real) % 2 == 0 ? (int)sizeof(cloth_real) : 0);
constexpr int ROOM_MOST = ROOM_LEAST + 20 * ROOM_MORE;
static_assert(ROOM_LEAST >= CANDIDATES * (int)sizeof(kept_candidate), "room");

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

// What the launch chooses.
struct tile_size {
  int slots; // places for others
  int room;  // bytes behind each thread's `kept`
};

// States of the block's own particles, and of others that they feel, by a table from particle to
// place. Who finds no place there is read from memory; place -2 - i says so. A block that takes its
// particles in several goes has no tile. Those at the other ends of springs and triangles stay in
// the table (KEPT_ONE in `other`), candidates until the next search.
struct tile {
  cell *x, *v;            // [own + slots]
  cell *force;            // [particles of a go] N; contacts with particles
  kept_particle *kept_of; // [particles of a go]
  int *other;             // [slots] whose place it is
  int first, own;         // particles [first, first + own) are the block's
  int slots;              // a power of two
  int room;               // see tile_size
  const record *now;      // states of all

  // of the thread that is `by` behind the one of k
  __device__ __forceinline__ kept *kept_of_other(kept *k, int by) const
  {
    return reinterpret_cast<kept *>(reinterpret_cast<char *>(k) + by * ((int)sizeof(kept) + room));
  }

  __device__ __forceinline__ int candidates() const // that a thread keeps
  {
    return room / (int)sizeof(kept_candidate) / CANDIDATES * CANDIDATES;
  }

  __device__ __forceinline__ int found() const // for what a thread finds
  {
    return room / (int)sizeof(int) - HEADS;
  }

  __device__ __forceinline__ int place(int i) const
  {
    unsigned at = (unsigned)(i - first), slot = (unsigned)i * 2654435761u >> 16;
    int kept_one = i | KEPT_ONE;
    if (at < (unsigned)own) return (int)at;
#pragma unroll 1
    for (int n = 0; n < PROBES && slots > 0; n++, slot++) {
      slot &= (unsigned)slots - 1;
      int whose = atomicCAS(other + slot, NOBODY, i);
      if (whose == NOBODY || whose == i || whose == kept_one) return own + (int)slot;
    }
    return -2 - i;
  }

  __device__ __forceinline__ int particle(int place) const
  {
    return place < 0 ? -2 - place : place < own ? first + place : other[place - own] & ~KEPT_ONE;
  }

  // of any particle, in its place or not
  __device__ __forceinline__ cloth_v3 position_of(int i) const
  {
    unsigned at = (unsigned)(i - first);
    cell c = x[at < (unsigned)own ? at : 0];
    if (at >= (unsigned)own) c = now[i].x;
    return get(c);
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

  __device__ void forget_all()
  {
    for (int s = (int)threadIdx.x; s < slots; s += (int)blockDim.x) other[s] = NOBODY;
  }

  __device__ void keep_all()
  {
    for (int s = (int)threadIdx.x; s < slots; s += (int)blockDim.x)
      if (other[s] != NOBODY) other[s] |= KEPT_ONE;
  }

  // A chain of probes may break where one was forgotten: then a particle is in the table twice.
  __device__ void forget_candidates()
  {
    for (int s = (int)threadIdx.x; s < slots; s += (int)blockDim.x)
      if (other[s] != NOBODY && !(other[s] & KEPT_ONE)) other[s] = NOBODY;
  }

  // the others' states: all loads of a thread are under way before the first is waited for
  __device__ void fetch_others()
  {
    int threads = (int)blockDim.x;
    for (int s = (int)threadIdx.x; s < slots; s += 2 * threads) {
      int t = s + threads, i = other[s], j = t < slots ? other[t] : NOBODY;
      record a = now[i == NOBODY ? 0 : i & ~KEPT_ONE], b = now[j == NOBODY ? 0 : j & ~KEPT_ONE];
      if (i != NOBODY) x[own + s] = a.x, v[own + s] = a.v;
      if (j != NOBODY) x[own + t] = b.x, v[own + t] = b.v;
    }
  }
};

inline size_t tile_bytes(int threads, tile_size size)
{
  size_t own = (size_t)threads / LANES, others = (size_t)size.slots;
  return (size_t)threads * (sizeof(kept) + (size_t)size.room) +
         (3 * own + 2 * others) * sizeof(cell) + own * sizeof(kept_particle) + others * sizeof(int);
}

// behind what the threads keep
__device__ tile tile_of(void *threads, int particles, int rows, tile_size size, bool at_once)
{
  tile t;
  t.room = size.room;
  t.force = reinterpret_cast<cell *>(static_cast<char *>(threads) +
                                     (size_t)blockDim.x * (sizeof(kept) + (size_t)size.room));
  t.x = t.force + particles;
  t.v = t.x + particles + size.slots;
  t.kept_of = reinterpret_cast<kept_particle *>(t.v + particles + size.slots);
  t.other = reinterpret_cast<int *>(t.kept_of + particles);
  t.first = (int)blockIdx.x * particles;
  int left = rows > t.first ? rows - t.first : 0; // none for the last blocks of a cluster
  t.own = !at_once ? 0 : left < particles ? left : particles;
  t.slots = at_once ? size.slots : 0;
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
