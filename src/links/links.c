#include "links/links.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

// ---- shapes -------------------------------------------------------------------------------------

cloth_links cloth_links_flat(int parts, double bandwidth, double latency)
{
  cloth_links l = {.parts = parts, .nodes = parts, .flat = true};
  for (int i = 0; i < parts; i++)
    l.parent[i] = -1, l.bandwidth[i] = bandwidth, l.latency[i] = latency;
  return l;
}

// the subtree over parts [first, last); its top
static int grow_binary(cloth_links *l, int first, int last)
{
  if (last - first == 1) return first;
  int top = l->nodes++, middle = first + (last - first + 1) / 2;
  l->parent[top] = -1;
  l->parent[grow_binary(l, first, middle)] = top;
  l->parent[grow_binary(l, middle, last)] = top;
  return top;
}

cloth_links cloth_links_binary(int parts, double bandwidth, double latency)
{
  cloth_links l = {.parts = parts, .nodes = parts};
  l.parent[0] = -1;
  grow_binary(&l, 0, parts);
  for (int i = 0; i < l.nodes; i++) l.bandwidth[i] = bandwidth, l.latency[i] = latency;
  return l;
}

static bool is_above(const cloth_links *l, int switch_node, int node)
{
  while (node >= 0 && node != switch_node) node = l->parent[node];
  return node == switch_node;
}

int cloth_links_meeting(const cloth_links *l, int a, int b)
{
  if (l->flat) return -1;
  while (a >= 0 && !is_above(l, a, b)) a = l->parent[a];
  return a;
}

static int depth(const cloth_links *l, int node)
{
  int d = 0;
  while ((node = l->parent[node]) >= 0) d++;
  return d;
}

// ---- the order ----------------------------------------------------------------------------------

enum { TRIES = 200, PARTS = CLOTH_LINKS_PARTS_MAX, NODES = CLOTH_LINKS_NODES_MAX };

typedef struct tree_view {
  const cloth_links *links;
  int meeting[PARTS][PARTS];
  uint64_t below[NODES]; // parts under a node, as bits
  int depth[NODES], deepest;
} tree_view;

typedef struct scheduler {
  const tree_view *shape;
  uint64_t has[PARTS];  // [vector] parts that have it, before this stage
  uint64_t gets[PARTS]; // [vector] parts that get it in this stage
  uint64_t sends, receives;
  bool up[NODES], down[NODES]; // link of the node is in use
  unsigned seed;               // 0: no dice
} scheduler;

static void look_at(const cloth_links *l, tree_view *out)
{
  memset(out, 0, sizeof *out);
  out->links = l;
  for (int n = 0; n < l->nodes; n++) {
    out->depth[n] = depth(l, n);
    if (n >= l->parts && out->depth[n] > out->deepest) out->deepest = out->depth[n];
  }
  for (int p = 0; p < l->parts; p++) {
    for (int n = p; n >= 0; n = l->parent[n]) out->below[n] |= (uint64_t)1 << p;
    for (int q = 0; q < l->parts; q++)
      if (p != q) out->meeting[p][q] = cloth_links_meeting(l, p, q);
  }
}

static int roll(scheduler *s, int n)
{
  if (s->seed == 0) return 0;
  s->seed = s->seed * 1664525u + 1013904223u; // Knuth's constants
  return (int)((s->seed >> 8) % (unsigned)n);
}

// The branch below `top` that holds `part` must get a vector only once: is it there, or on its way?
static bool branch_has(const scheduler *s, int top, int part, int vector)
{
  int branch = part;
  while (s->shape->links->parent[branch] != top) branch = s->shape->links->parent[branch];
  return ((s->has[vector] | s->gets[vector]) & s->shape->below[branch]) != 0;
}

static bool path_is_free(const scheduler *s, int from, int to, int top)
{
  const int *parent = s->shape->links->parent;
  if ((s->sends >> from & 1) || (s->receives >> to & 1)) return false;
  for (int n = from; n != top; n = parent[n])
    if (s->up[n]) return false;
  for (int n = to; n != top; n = parent[n])
    if (s->down[n]) return false;
  return true;
}

static void take_path(scheduler *s, int from, int to, int top)
{
  const int *parent = s->shape->links->parent;
  s->sends |= (uint64_t)1 << from, s->receives |= (uint64_t)1 << to;
  for (int n = from; n != top; n = parent[n]) s->up[n] = true;
  for (int n = to; n != top; n = parent[n]) s->down[n] = true;
}

// One transfer across switch `top` to part `to`, if there is one.
static bool pick(scheduler *s, int top, int to, cloth_transfer *out)
{
  int n = s->shape->links->parts, turn = roll(s, n);
  if (s->receives >> to & 1) return false;
  for (int k = 1; k <= n; k++) {
    int vector = (to + turn + k) % n; // different parts begin with different vectors
    if ((s->has[vector] | s->gets[vector]) >> to & 1) continue;
    if (branch_has(s, top, to, vector)) continue;
    for (int j = 0; j < n; j++) {
      int from = (vector + j) % n; // the owner first
      if (!(s->has[vector] >> from & 1) || s->shape->meeting[from][to] != top) continue;
      if (!path_is_free(s, from, to, top)) continue;
      take_path(s, from, to, top);
      s->gets[vector] |= (uint64_t)1 << to;
      *out = (cloth_transfer){0, vector, from, to};
      return true;
    }
  }
  return false;
}

// the transfers of one stage: far ones first, because others wait to hand them on; when dice are
// thrown, at times the near ones
static int fill_stage(scheduler *s, int stage, cloth_transfer *out)
{
  const cloth_links *l = s->shape->links;
  int count = 0;
  memset(s->gets, 0, sizeof s->gets);
  memset(s->up, 0, sizeof s->up), memset(s->down, 0, sizeof s->down);
  s->sends = s->receives = 0;
  bool near_first = roll(s, 3) == 1;
  for (int k = 0; k <= s->shape->deepest; k++)
    for (int top = l->parts; top < l->nodes; top++) {
      if (s->shape->depth[top] != (near_first ? s->shape->deepest - k : k)) continue;
      int turn = roll(s, l->parts);
      for (int i = 0; i < l->parts; i++) {
        int to = (i + stage + turn) % l->parts;
        if (!(s->shape->below[top] >> to & 1) || !pick(s, top, to, &out[count])) continue;
        out[count++].stage = stage;
      }
    }
  for (int v = 0; v < l->parts; v++) s->has[v] |= s->gets[v];
  return count;
}

static int rotate(int parts, cloth_transfer *out)
{
  int count = 0;
  for (int stage = 0; stage + 1 < parts; stage++)
    for (int to = 0; to < parts; to++) {
      int from = (to + stage + 1) % parts;
      out[count++] = (cloth_transfer){stage, from, from, to};
    }
  return parts - 1;
}

// a whole order; gives up when it takes `most` stages or more
static int schedule(const tree_view *shape, unsigned seed, int most, cloth_transfer *out)
{
  scheduler s;
  memset(&s, 0, sizeof s);
  s.shape = shape, s.seed = seed;
  int parts = shape->links->parts, count = 0, stage = 0;
  for (int p = 0; p < parts; p++) s.has[p] = (uint64_t)1 << p;
  while (count < parts * (parts - 1) && stage < most) count += fill_stage(&s, stage++, out + count);
  return count < parts * (parts - 1) ? most : stage;
}

int cloth_transfer_order(const cloth_links *l, cloth_transfer *out)
{
  if (l->flat || l->parts < 2) return rotate(l->parts, out);
  // The greedy choice depends on who chooses first, so some orders are thrown and the shortest is
  // kept: always the same dice.
  tree_view view;
  look_at(l, &view);
  int tries = l->parts <= 16 ? TRIES : 1, best = 0, most = l->parts * l->parts;
  for (int k = 0; k < tries; k++) {
    int stages = schedule(&view, (unsigned)k, most, out);
    if (stages < most) best = k, most = stages;
    if (most == l->parts - 1) break; // no order is shorter
  }
  return schedule(&view, (unsigned)best, most + 1, out);
}

// ---- the model ----------------------------------------------------------------------------------

static double path_time(const cloth_links *l, int from, int to, int top, double bytes)
{
  double slowest = INFINITY, latency = 0;
  const int ends[2] = {from, to};
  for (int e = 0; e < 2; e++) {
    int n = ends[e];
    do {
      slowest = fmin(slowest, l->bandwidth[n]);
      latency = fmax(latency, l->latency[n]);
      n = l->parent[n];
    } while (!l->flat && n != top);
  }
  return latency + bytes / slowest;
}

void cloth_transfer_times(const cloth_links *l, int count, const cloth_transfer *order,
                          double bytes, double *out)
{
  double sent[CLOTH_LINKS_PARTS_MAX] = {0}, received[CLOTH_LINKS_PARTS_MAX] = {0};
  double up[CLOTH_LINKS_NODES_MAX] = {0}, down[CLOTH_LINKS_NODES_MAX] = {0};
  double arrived[CLOTH_LINKS_PARTS_MAX * CLOTH_LINKS_PARTS_MAX];
  for (int i = 0; i < l->parts * l->parts; i++) arrived[i] = 0;
  for (int i = 0; i < count; i++) {
    const cloth_transfer *t = &order[i];
    int top = cloth_links_meeting(l, t->from, t->to);
    double start = fmax(sent[t->from], received[t->to]);
    start = fmax(start, arrived[t->from * l->parts + t->vector]);
    for (int n = t->from; !l->flat && n != top; n = l->parent[n]) start = fmax(start, up[n]);
    for (int n = t->to; !l->flat && n != top; n = l->parent[n]) start = fmax(start, down[n]);
    double end = start + path_time(l, t->from, t->to, top, bytes);
    sent[t->from] = received[t->to] = arrived[t->to * l->parts + t->vector] = end;
    for (int n = t->from; !l->flat && n != top; n = l->parent[n]) up[n] = end;
    for (int n = t->to; !l->flat && n != top; n = l->parent[n]) down[n] = end;
    out[2 * i] = start, out[2 * i + 1] = end;
  }
}
