// A particle of the mass-spring kernel: what LANES threads gather for it, and the thread that moves
// it. What they add up is the physics headers'; sums go along the same trees.
#pragma once

#include "spring_room.cuh"

namespace {

// ---- one of the threads that gather -------------------------------------------------------------

struct gatherer {
  int i, lane, own; // own: place of the particle
  bool there;       // threads behind the last particle go along with nothing
  cloth_real mass;  // kg
  cloth_v3 x, v;

  __device__ __forceinline__ void load(const cloth_spring_block_args &b, const tile &here, int row,
                                       kept_share *keep)
  {
    const cloth_spring_step_args &a = b.step;
    there = row < b.rows, i = there ? row : here.own > 0 ? here.first : 0;
    lane = (int)threadIdx.x % LANES;
    own = here.place(i);
    mass = a.mass[i];
    load_springs(a.springs, here, keep);
    load_triangles(a.air, here, keep);
  }

  // Whom the particle may touch; nobody touches himself.
  __device__ __forceinline__ void load_near(const cloth_particles &a, const tile &here, kept *keep)
  {
    uint32_t listed = !there ? 0 : a.listed ? a.listed[i] : (uint32_t)a.count;
    keep->listed = listed;
    int k = 0;
    do load_some(a, here, listed, k, keep->near() + k);
    while (k += CANDIDATES, k < here.candidates() && (uint32_t)(LANES * k) < listed);
  }

  // CANDIDATES of them, from the thread's k-th on. Here and below all loads are under way before
  // the first is used.
  __device__ __forceinline__ void load_some(const cloth_particles &a, const tile &here,
                                            uint32_t listed, int k, kept_candidate *near)
  {
    int j[CANDIDATES];
    cloth_real apart[CANDIDATES];
#pragma unroll
    for (int n = 0; n < CANDIDATES; n++) j[n] = candidate(a, k + n, listed);
#pragma unroll
    for (int n = 0; n < CANDIDATES; n++)
      apart[n] = a.count > 0 ? cloth_particle_apart(&a, i, j[n] == NOBODY ? i : j[n]) : 0;
#pragma unroll
    for (int n = 0; n < CANDIDATES; n++) {
      near[n].apart = apart[n];
      near[n].place = j[n] == NOBODY ? own : here.place(j[n]);
    }
  }

  // A spring to itself pulls with zero, a triangle of one corner has no drag.
  __device__ __forceinline__ void load_springs(const cloth_spring_rows &r, const tile &here,
                                               kept_share *keep)
  {
    uint32_t spring = 0, spring_end = 0;
    if (r.first && there) spring = r.first[i] + (uint32_t)lane, spring_end = r.first[i + 1];
    int to[SPRINGS];
    cloth_real law[CLOTH_SPRING_LAW * SPRINGS];
#pragma unroll
    for (int k = 0; k < SPRINGS; k++, spring += LANES) {
      bool is = spring < spring_end;
      to[k] = is ? r.to[spring] : NOBODY;
      for (int c = 0; c < CLOTH_SPRING_LAW; c++)
        law[CLOTH_SPRING_LAW * k + c] = is ? r.law[CLOTH_SPRING_LAW * spring + c] : 0;
    }
#pragma unroll
    for (int n = 0; n < CLOTH_SPRING_LAW * SPRINGS; n++) keep->law[n] = law[n];
#pragma unroll
    for (int k = 0; k < SPRINGS; k++) keep->to[k] = to[k] == NOBODY ? own : here.place(to[k]);
    keep->spring = spring, keep->spring_end = spring_end;
  }

  __device__ __forceinline__ void load_triangles(const cloth_spring_air &a, const tile &here,
                                                 kept_share *keep)
  {
    bool any = a.first && there;
    uint32_t triangle = any ? a.first[i] + (uint32_t)lane : 0;
    uint32_t triangle_end = any ? a.first[i + 1] : 0;
    int corner[3 * TRIANGLES];
    for (int c = 0; c < 2; c++) keep->drag[c] = any ? a.drag[2 * i + c] : 0;
#pragma unroll
    for (int k = 0; k < TRIANGLES; k++, triangle += LANES)
      for (int c = 0; c < 3; c++)
        corner[3 * k + c] = triangle < triangle_end ? a.triangle[3 * triangle + c] : NOBODY;
#pragma unroll
    for (int n = 0; n < 3 * TRIANGLES; n++)
      keep->corner[n] = corner[n] == NOBODY ? own : here.place(corner[n]);
    keep->triangle = triangle, keep->triangle_end = triangle_end;
  }

  // the thread's k-th candidate
  __device__ __forceinline__ int candidate(const cloth_particles &a, int k, uint32_t listed) const
  {
    uint32_t e = (uint32_t)(LANES * k + lane);
    if (e >= listed) return NOBODY;
    int j = a.listed ? (int)a.candidate[(uint64_t)i * a.room + e] : (int)e;
    return j == i ? NOBODY : j;
  }

  __device__ __forceinline__ cloth_v3 pull(const tile &here, int to, const cloth_real *law) const
  {
    return cloth_spring_force(cloth_v3_sub(here.position(to), x),
                              cloth_v3_sub(here.velocity(to), v), law);
  }

  __device__ __forceinline__ static cloth_v3 wind(const cloth_spring_air &a, const cloth_real *drag,
                                                  const tile &here, const int *t)
  {
    return cloth_spring_air_force(&a, drag, here.position(t[0]), here.position(t[1]),
                                  here.position(t[2]), here.velocity(t[0]), here.velocity(t[1]),
                                  here.velocity(t[2]));
  }

  // the thread's springs and triangles
  __device__ __forceinline__ cloth_v3 share(const cloth_spring_step_args &a, const tile &here,
                                            const kept_share *keep) const
  {
    cloth_v3 f = cloth_v3_make(0, 0, 0);
    if (a.springs.first) {
#pragma unroll
      for (int k = 0; k < SPRINGS; k++)
        f = cloth_v3_add(f, pull(here, keep->to[k], keep->law + CLOTH_SPRING_LAW * k));
      for (uint32_t e = keep->spring; e < keep->spring_end; e += LANES)
        f = cloth_v3_add(
            f, pull(here, -2 - a.springs.to[e], a.springs.law + (uint64_t)CLOTH_SPRING_LAW * e));
    }
    if (!a.air.first) return f;
    cloth_v3 air = cloth_v3_make(0, 0, 0);
#pragma unroll
    for (int k = 0; k < TRIANGLES; k++)
      air = cloth_v3_add(air, wind(a.air, keep->drag, here, keep->corner + 3 * k));
    for (uint32_t e = keep->triangle; e < keep->triangle_end; e += LANES) {
      const int *t = a.air.triangle + 3 * (uint64_t)e;
      int corner[3] = {-2 - t[0], -2 - t[1], -2 - t[2]};
      air = cloth_v3_add(air, wind(a.air, keep->drag, here, corner));
    }
    return cloth_v3_add(f, air);
  }

  // LANES particles side by side, d from theirs to this one; those nearer than `most` are added in
  // their order
  __device__ __forceinline__ void meet(const cloth_particles &a, const tile &here, int place,
                                       cloth_v3 d, cloth_real most, cloth_v3 *f, int *touch) const
  {
    unsigned hits = __ballot_sync(0xffffffffu, most > 0);
    if (hits == 0) return;
    cloth_v3 g = cloth_v3_make(0, 0, 0);
    if (most > 0)
      g = cloth_particle_force(&a, i, here.particle(place), most, d,
                               cloth_v3_sub(v, here.velocity(place)));
    for (int l = 0; l < LANES; l++)
      *f = cloth_v3_add(*f, cloth_v3_make(__shfl_sync(0xffffffffu, g.x, l, LANES),
                                          __shfl_sync(0xffffffffu, g.y, l, LANES),
                                          __shfl_sync(0xffffffffu, g.z, l, LANES)));
    int group = (int)threadIdx.x % WARP - lane;
    *touch += __popc(hits >> group & ((1u << LANES) - 1));
  }

  // one that the thread keeps
  __device__ __forceinline__ void meet_kept(const cloth_particles &a, const tile &here, int place,
                                            cloth_real apart, cloth_v3 *f, int *touch) const
  {
    cloth_v3 d = cloth_v3_sub(x, here.position(place));
    meet(a, here, place, d, cloth_particle_nearer(d, apart) ? apart : 0, f, touch);
  }

  __device__ __forceinline__ cloth_v3 meet_all(const cloth_particles &a, const tile &here,
                                               const kept *keep, int *touch) const
  {
    cloth_v3 f = cloth_v3_make(0, 0, 0);
    const kept_candidate *near = keep->near();
    uint32_t listed = keep->listed;
    int k = CANDIDATES, last = here.candidates();
#pragma unroll
    for (int n = 0; n < CANDIDATES; n++)
      meet_kept(a, here, near[n].place, near[n].apart, &f, touch);
    for (; k < last && __any_sync(0xffffffffu, (uint32_t)(LANES * k) < listed); k++) {
      bool is = (uint32_t)(LANES * k) < listed; // loaded, be it with nobody
      meet_kept(a, here, is ? near[k].place : own, is ? near[k].apart : 0, &f, touch);
    }
    for (; __any_sync(0xffffffffu, (uint32_t)(LANES * k) < listed); k++) {
      int j = candidate(a, k, listed), place = j == NOBODY ? own : -2 - j;
      cloth_v3 d = cloth_v3_sub(x, here.position(place));
      meet(a, here, place, d, j == NOBODY ? 0 : cloth_particle_touch(&a, i, j, d), &f, touch);
    }
    return f;
  }

  // The force on the particle but for its hold, and how many it touches, for who moves it.
  __device__ __forceinline__ void gather(const cloth_spring_step_args &a, const tile &here,
                                         const kept *keep)
  {
    int touch = 0;
    x = here.position(own), v = here.velocity(own);
    cloth_v3 sum = share(a, here, &keep->share);
    for (int width = LANES / 2; width > 0; width /= 2) {
      sum.x += __shfl_xor_sync(0xffffffffu, sum.x, width);
      sum.y += __shfl_xor_sync(0xffffffffu, sum.y, width);
      sum.z += __shfl_xor_sync(0xffffffffu, sum.z, width);
    }
    cloth_v3 g = cloth_v3_make(a.gravity[0], a.gravity[1], a.gravity[2]);
    cloth_v3 f = cloth_v3_add(cloth_v3_scale(mass, g), sum);
    if (a.particles.count > 0) f = cloth_v3_add(f, meet_all(a.particles, here, keep, &touch));
    if (lane == 0) here.force[threadIdx.x / LANES] = cell_of(f, (cloth_real)touch);
  }
};

// ---- the thread that moves ----------------------------------------------------------------------

struct mover {
  int row;       // the particle
  bool there;    // has the thread one?
  cloth_v3 x, v; // where it went

  __device__ __forceinline__ void take(const cloth_spring_block_args &b, int particle)
  {
    row = particle, there = (int)threadIdx.x < (int)blockDim.x / LANES && row < b.rows;
  }

  __device__ __forceinline__ void load(const cloth_spring_block_args &b, const tile &here) const
  {
    if (there) here.kept_of[threadIdx.x].p = cloth_spring_particle_of(&b.step, row);
  }

  // candidates are those of where the particle is now
  __device__ __forceinline__ void look(const tile &here, cloth_v3 from) const
  {
    if (there) cloth_v3_store(here.kept_of[threadIdx.x].x_ref, 0, from);
  }

  // a sub-step, from what was gathered
  __device__ __forceinline__ void move(const cloth_spring_step_args &a, const tile &here, int place)
  {
    int with_bodies = 0;
    cell force = here.force[threadIdx.x];
    cloth_spring_particle p = here.kept_of[threadIdx.x].p;
    cloth_v3 impulse = cloth_v3_make(0, 0, 0);
    x = here.position(place), v = here.velocity(place);
    if (cloth_spring_push(&a, &p, get(force), &x, &v, &impulse))
      x = cloth_shapes_move(&a.shapes, a.h, x, &v, &with_bodies);
    if (p.slot >= 0) cloth_spring_impulse_add(&a, p.slot, impulse);
    if (a.touch)
      a.touch[2 * row] = (uint32_t)force.more, a.touch[2 * row + 1] = (uint32_t)with_bodies;
  }
};

} // namespace
