// The language of the element kernels: the part of C11 that CUDA C++ also accepts.
// No designated initialisers, compound literals, VLAs, _Generic or implicit void* casts.
#pragma once

#include <math.h>
#include <stdint.h>

#ifdef __CUDACC__
#define CLOTH_FN      static __host__ __device__ __forceinline__
#define CLOTH_FN_RARE static __host__ __device__ __noinline__
#else
#define CLOTH_FN      static inline
#define CLOTH_FN_RARE static inline
#endif
// RARE: long and seldom called. One copy of it, or kernels grow and take minutes to compile.

// a loop that a GPU's compiler leaves one, where its registers are needed for more threads
#ifdef __CUDACC__
#define CLOTH_ROLLED _Pragma("unroll 1")
#else
#define CLOTH_ROLLED
#endif

#ifdef CLOTH_SINGLE_PRECISION
typedef float cloth_real;
#define CLOTH_REAL_EPSILON 1.1920929e-07f // distance from 1 to the next number
#define cloth_sqrt         sqrtf
#define cloth_fabs         fabsf
#define cloth_fmin         fminf
#define cloth_fmax         fmaxf
#define cloth_atan2        atan2f
#define cloth_sin          sinf
#define cloth_cos          cosf
#else
typedef double cloth_real;
#define CLOTH_REAL_EPSILON 2.2204460492503131e-16
#define cloth_sqrt         sqrt
#define cloth_fabs         fabs
#define cloth_fmin         fmin
#define cloth_fmax         fmax
#define cloth_atan2        atan2
#define cloth_sin          sin
#define cloth_cos          cos
#endif

typedef struct cloth_v3 {
  cloth_real x, y, z;
} cloth_v3;

/// A symmetric 3x3 matrix.
typedef struct cloth_sym3 {
  cloth_real xx, yy, zz, yz, zx, xy;
} cloth_sym3;

CLOTH_FN cloth_v3 cloth_v3_make(cloth_real x, cloth_real y, cloth_real z)
{
  cloth_v3 v;
  v.x = x, v.y = y, v.z = z;
  return v;
}

// row i of an [n x 3] array
CLOTH_FN cloth_v3 cloth_v3_load(const cloth_real *a, int i)
{
  return cloth_v3_make(a[3 * i], a[3 * i + 1], a[3 * i + 2]);
}

// Two or four neighbours of an array, the first of which has an even place, or one that four
// divide. A GPU asks for them at once: where each thread reads elsewhere, what costs is how often
// it asks.
#ifdef __CUDA_ARCH__
#ifdef CLOTH_SINGLE_PRECISION
typedef float2 cloth_real2;
#else
typedef double2 cloth_real2;
#endif
CLOTH_FN void cloth_load2(const cloth_real *from, cloth_real *to)
{
  cloth_real2 v = *(const cloth_real2 *)from;
  to[0] = v.x, to[1] = v.y;
}

CLOTH_FN void cloth_load4(const cloth_real *from, cloth_real *to)
{
#ifdef CLOTH_SINGLE_PRECISION
  float4 v = *(const float4 *)from;
  to[0] = v.x, to[1] = v.y, to[2] = v.z, to[3] = v.w;
#else
  cloth_load2(from, to), cloth_load2(from + 2, to + 2);
#endif
}

CLOTH_FN void cloth_store4(cloth_real *to, const cloth_real *from)
{
#ifdef CLOTH_SINGLE_PRECISION
  *(float4 *)to = make_float4(from[0], from[1], from[2], from[3]);
#else
  *(double2 *)to = make_double2(from[0], from[1]);
  *(double2 *)(to + 2) = make_double2(from[2], from[3]);
#endif
}

CLOTH_FN void cloth_load2_int(const int *from, int *to)
{
  int2 v = *(const int2 *)from;
  to[0] = v.x, to[1] = v.y;
}

CLOTH_FN void cloth_load4_int(const int *from, int *to)
{
  int4 v = *(const int4 *)from;
  to[0] = v.x, to[1] = v.y, to[2] = v.z, to[3] = v.w;
}
#else
CLOTH_FN void cloth_load2(const cloth_real *from, cloth_real *to)
{
  for (int k = 0; k < 2; k++) to[k] = from[k];
}

CLOTH_FN void cloth_load4(const cloth_real *from, cloth_real *to)
{
  for (int k = 0; k < 4; k++) to[k] = from[k];
}

CLOTH_FN void cloth_store4(cloth_real *to, const cloth_real *from)
{
  for (int k = 0; k < 4; k++) to[k] = from[k];
}

CLOTH_FN void cloth_load2_int(const int *from, int *to)
{
  for (int k = 0; k < 2; k++) to[k] = from[k];
}

CLOTH_FN void cloth_load4_int(const int *from, int *to)
{
  for (int k = 0; k < 4; k++) to[k] = from[k];
}
#endif

CLOTH_FN void cloth_v3_store(cloth_real *a, int i, cloth_v3 v)
{
  a[3 * i] = v.x, a[3 * i + 1] = v.y, a[3 * i + 2] = v.z;
}

CLOTH_FN cloth_v3 cloth_v3_add(cloth_v3 a, cloth_v3 b)
{
  return cloth_v3_make(a.x + b.x, a.y + b.y, a.z + b.z);
}

CLOTH_FN cloth_v3 cloth_v3_sub(cloth_v3 a, cloth_v3 b)
{
  return cloth_v3_make(a.x - b.x, a.y - b.y, a.z - b.z);
}

CLOTH_FN cloth_v3 cloth_v3_scale(cloth_real s, cloth_v3 a)
{
  return cloth_v3_make(s * a.x, s * a.y, s * a.z);
}

// a + s b
CLOTH_FN cloth_v3 cloth_v3_add_scaled(cloth_v3 a, cloth_real s, cloth_v3 b)
{
  return cloth_v3_make(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}

CLOTH_FN cloth_real cloth_v3_dot(cloth_v3 a, cloth_v3 b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

CLOTH_FN cloth_v3 cloth_v3_cross(cloth_v3 a, cloth_v3 b)
{
  return cloth_v3_make(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

CLOTH_FN cloth_real cloth_v3_length(cloth_v3 a) { return cloth_sqrt(cloth_v3_dot(a, a)); }

CLOTH_FN cloth_sym3 cloth_sym3_load(const cloth_real *a, int i)
{
  cloth_sym3 s;
  s.xx = a[6 * i], s.yy = a[6 * i + 1], s.zz = a[6 * i + 2];
  s.yz = a[6 * i + 3], s.zx = a[6 * i + 4], s.xy = a[6 * i + 5];
  return s;
}

CLOTH_FN void cloth_sym3_store(cloth_real *a, int i, cloth_sym3 s)
{
  a[6 * i] = s.xx, a[6 * i + 1] = s.yy, a[6 * i + 2] = s.zz;
  a[6 * i + 3] = s.yz, a[6 * i + 4] = s.zx, a[6 * i + 5] = s.xy;
}

CLOTH_FN cloth_v3 cloth_sym3_mul(cloth_sym3 s, cloth_v3 v)
{
  return cloth_v3_make(s.xx * v.x + s.xy * v.y + s.zx * v.z, s.xy * v.x + s.yy * v.y + s.yz * v.z,
                       s.zx * v.x + s.yz * v.y + s.zz * v.z);
}

// a I + b n n'
CLOTH_FN cloth_sym3 cloth_sym3_axis(cloth_real a, cloth_real b, cloth_v3 n)
{
  cloth_sym3 s;
  s.xx = a + b * n.x * n.x, s.yy = a + b * n.y * n.y, s.zz = a + b * n.z * n.z;
  s.yz = b * n.y * n.z, s.zx = b * n.z * n.x, s.xy = b * n.x * n.y;
  return s;
}

CLOTH_FN cloth_real cloth_v3_sum_abs(cloth_v3 a)
{
  return cloth_fabs(a.x) + cloth_fabs(a.y) + cloth_fabs(a.z);
}

// component d, line d: chosen, not indexed, so that they stay in registers
CLOTH_FN cloth_real cloth_v3_component(cloth_v3 a, int d)
{
  return d == 0 ? a.x : d == 1 ? a.y : a.z;
}

CLOTH_FN cloth_v3 cloth_sym3_line(cloth_sym3 s, int d)
{
  return cloth_v3_make(d == 0   ? s.xx
                       : d == 1 ? s.xy
                                : s.zx,
                       d == 0   ? s.xy
                       : d == 1 ? s.yy
                                : s.yz,
                       d == 0   ? s.zx
                       : d == 1 ? s.yz
                                : s.zz);
}

CLOTH_FN cloth_sym3 cloth_sym3_scale(cloth_real s, cloth_sym3 a)
{
  a.xx *= s, a.yy *= s, a.zz *= s;
  a.yz *= s, a.zx *= s, a.xy *= s;
  return a;
}

CLOTH_FN cloth_sym3 cloth_sym3_add(cloth_sym3 a, cloth_sym3 b)
{
  a.xx += b.xx, a.yy += b.yy, a.zz += b.zz;
  a.yz += b.yz, a.zx += b.zx, a.xy += b.xy;
  return a;
}

CLOTH_FN cloth_sym3 cloth_sym3_inverse(cloth_sym3 m)
{
  cloth_sym3 c; // cofactors
  c.xx = m.yy * m.zz - m.yz * m.yz, c.yy = m.zz * m.xx - m.zx * m.zx,
  c.zz = m.xx * m.yy - m.xy * m.xy;
  c.yz = m.zx * m.xy - m.yz * m.xx, c.zx = m.xy * m.yz - m.zx * m.yy,
  c.xy = m.yz * m.zx - m.xy * m.zz;
  cloth_real det = m.xx * c.xx + m.xy * c.xy + m.zx * c.zx;
  if (!(det > 0)) { // lost to rounding: the diagonal alone
    c.xx = 1 / m.xx, c.yy = 1 / m.yy, c.zz = 1 / m.zz, c.yz = c.zx = c.xy = 0;
    return c;
  }
  cloth_real s = 1 / det;
  c.xx *= s, c.yy *= s, c.zz *= s, c.yz *= s, c.zx *= s, c.xy *= s;
  return c;
}
