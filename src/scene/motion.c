// Motions of bodies and pins over time. Also compiled into the engine libraries: needs nothing but
// def.h.
#include "scene/def.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

// The shorter arc between two unit quaternions at constant angular speed (Shoemake 1985).
static void rotation_between(const double a[4], const double b[4], double s, double out[4])
{
  double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  double sign = dot < 0 ? -1 : 1;
  dot = fabs(dot);
  double wa = 1 - s, wb = s; // nearly the same: the chord is the arc
  if (dot < 1 - 1e-9) {
    double angle = acos(dot);
    wa = sin((1 - s) * angle) / sin(angle);
    wb = sin(s * angle) / sin(angle);
  }
  double norm_sq = 0;
  for (int i = 0; i < 4; i++) {
    out[i] = wa * a[i] + sign * wb * b[i];
    norm_sq += out[i] * out[i];
  }
  for (int i = 0; i < 4; i++) out[i] /= sqrt(norm_sq);
}

static cloth_pose pose_between_keys(const cloth_motion *m, double time)
{
  int last = m->key_count - 1;
  if (!(time > m->time[0])) return m->pose[0];
  if (!(time < m->time[last])) return m->pose[last];

  int low = 0, high = last; // time[low] <= time < time[high]
  while (high - low > 1) {
    int middle = low + (high - low) / 2;
    if (m->time[middle] <= time)
      low = middle;
    else
      high = middle;
  }
  const cloth_pose *a = &m->pose[low], *b = &m->pose[high];
  double s = (time - m->time[low]) / (m->time[high] - m->time[low]);
  if (s <= 0) return *a; // exact at the keys
  cloth_pose out;
  for (int i = 0; i < 3; i++) out.position[i] = (1 - s) * a->position[i] + s * b->position[i];
  rotation_between(a->rotation, b->rotation, s, out.rotation);
  return out;
}

// out = a b: first b turns, then a
static void rotation_product(const double a[4], const double b[4], double out[4])
{
  out[0] = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
  out[1] = a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0];
  out[2] = a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3];
  out[3] = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
}

cloth_pose cloth_motion_at(const cloth_motion *m, cloth_pose start, double time)
{
  if (m->key_count > 0) return pose_between_keys(m, time);

  double elapsed = (time < m->end ? time : m->end) - m->start;
  if (!(elapsed > 0)) return start;
  cloth_pose out = start;
  double wave = m->period > 0 ? sin(2 * PI * elapsed / m->period) : 0, turn[3];
  for (int i = 0; i < 3; i++) {
    out.position[i] += elapsed * m->velocity[i] + wave * m->amplitude[i];
    turn[i] = elapsed * m->spin[i] + wave * m->swing[i];
  }
  double angle = sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]);
  if (angle > 0) {
    double q[4] = {0, 0, 0, cos(0.5 * angle)};
    for (int i = 0; i < 3; i++) q[i] = sin(0.5 * angle) * turn[i] / angle;
    rotation_product(q, start.rotation, out.rotation);
  }
  return out;
}

bool cloth_motion_moves(const cloth_motion *m)
{
  if (m->key_count > 0) return m->key_count > 1;
  bool moves = false;
  for (int i = 0; i < 3; i++) {
    moves |= m->velocity[i] != 0 || m->spin[i] != 0;
    moves |= m->period > 0 && (m->amplitude[i] != 0 || m->swing[i] != 0);
  }
  return moves && m->end > m->start;
}
