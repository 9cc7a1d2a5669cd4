// The order of transfers, for every number of parts: complete, possible, and sparing with the root.
#include "check.h"
#include "links/links.h"

enum { MOST = 16 };

static cloth_transfer order[CLOTH_TRANSFERS_MAX];

// a lopsided tree: each switch joins one part to the rest
static cloth_links comb(int parts)
{
  cloth_links l = {.parts = parts, .nodes = parts};
  l.parent[0] = -1;
  int top = 0;
  for (int p = 1; p < parts; p++) {
    int node = l.nodes++;
    l.parent[top] = l.parent[p] = node, l.parent[node] = -1, top = node;
  }
  for (int i = 0; i < l.nodes; i++) l.bandwidth[i] = 1e10, l.latency[i] = 1e-5;
  return l;
}

// three switches of unequal size under one root
static cloth_links unequal(int parts)
{
  cloth_links l = {.parts = parts, .nodes = parts + 4};
  for (int p = 0; p < parts; p++) l.parent[p] = parts + (p == 0 ? 0 : p < parts / 2 ? 1 : 2);
  for (int s = 0; s < 3; s++) l.parent[parts + s] = parts + 3;
  l.parent[parts + 3] = -1;
  return l;
}

static cloth_links shape(int kind, int parts)
{
  return kind == 0   ? cloth_links_flat(parts, 1e10, 1e-5)
         : kind == 1 ? cloth_links_binary(parts, 1e10, 1e-5)
         : kind == 2 ? comb(parts)
                     : unequal(parts);
}

static int every_part_gets_every_vector_once(void)
{
  for (int kind = 0; kind < 4; kind++)
    for (int n = kind == 3 ? 4 : 1; n <= MOST; n++) {
      cloth_links l = shape(kind, n);
      int times[MOST][MOST] = {{0}};
      cloth_transfer_order(&l, order);
      for (int i = 0; i < n * (n - 1); i++) times[order[i].to][order[i].vector]++;
      for (int p = 0; p < n; p++)
        for (int v = 0; v < n; v++) CHECK(times[p][v] == (p != v));
    }
  return 0;
}

static int nothing_is_handed_on_before_it_came(void)
{
  for (int kind = 0; kind < 4; kind++)
    for (int n = kind == 3 ? 4 : 2; n <= MOST; n++) {
      cloth_links l = shape(kind, n);
      int came[MOST][MOST];
      for (int p = 0; p < n; p++)
        for (int v = 0; v < n; v++) came[p][v] = p == v ? -1 : 1000;
      cloth_transfer_order(&l, order);
      for (int i = 0; i < n * (n - 1); i++) {
        CHECK(i == 0 || order[i].stage >= order[i - 1].stage);
        CHECK(came[order[i].from][order[i].vector] < order[i].stage);
        came[order[i].to][order[i].vector] = order[i].stage;
      }
    }
  return 0;
}

static int no_port_is_used_twice_in_a_stage(void)
{
  for (int kind = 0; kind < 4; kind++)
    for (int n = kind == 3 ? 4 : 2; n <= MOST; n++) {
      cloth_links l = shape(kind, n);
      cloth_transfer_order(&l, order);
      int sends[MOST], receives[MOST];
      for (int p = 0; p < n; p++) sends[p] = receives[p] = -1;
      for (int i = 0; i < n * (n - 1); i++) {
        CHECK(sends[order[i].from] < order[i].stage && receives[order[i].to] < order[i].stage);
        sends[order[i].from] = receives[order[i].to] = order[i].stage;
      }
    }
  return 0;
}

// walks up from both ends by itself
static bool uses_link(const cloth_links *l, int from, int to, int node, bool up)
{
  bool mark[CLOTH_LINKS_NODES_MAX] = {false};
  for (int n = up ? to : from; n >= 0; n = l->parent[n]) mark[n] = true;
  for (int n = up ? from : to; !mark[n]; n = l->parent[n])
    if (n == node) return true;
  return false;
}

static int each_vector_crosses_each_link_at_most_once(void)
{
  for (int kind = 1; kind < 4; kind++)
    for (int n = kind == 3 ? 4 : 2; n <= MOST; n++) {
      cloth_links l = shape(kind, n);
      cloth_transfer_order(&l, order);
      for (int node = 0; node < l.nodes; node++)
        for (int v = 0; v < n; v++) {
          int down = 0;
          for (int i = 0; i < n * (n - 1); i++)
            if (order[i].vector == v)
              down += uses_link(&l, order[i].from, order[i].to, node, false);
          // into the branch below the link: once if the vector is not from there
          bool inside = false, root = l.parent[node] < 0;
          for (int p = v; p >= 0; p = l.parent[p]) inside = inside || p == node;
          CHECK(down == (root || inside ? 0 : 1));
        }
    }
  return 0;
}

static int no_link_carries_two_transfers_of_a_stage(void)
{
  for (int kind = 1; kind < 4; kind++)
    for (int n = kind == 3 ? 4 : 2; n <= MOST; n++) {
      cloth_links l = shape(kind, n);
      cloth_transfer_order(&l, order);
      for (int node = 0; node < l.nodes; node++)
        for (int up = 0; up < 2; up++) {
          int last = -1;
          for (int i = 0; i < n * (n - 1); i++) {
            if (!uses_link(&l, order[i].from, order[i].to, node, up)) continue;
            CHECK(order[i].stage > last);
            last = order[i].stage;
          }
        }
    }
  return 0;
}

static int stages_are_as_few_as_ports_allow(void)
{
  for (int n = 2; n <= MOST; n++) {
    cloth_links flat = shape(0, n), tree = shape(1, n);
    CHECK(cloth_transfer_order(&flat, order) == n - 1);
    int stages = cloth_transfer_order(&tree, order);
    printf("  %d parts on a binary tree: %d stages\n", n, stages);
    CHECK(stages >= n - 1 && stages <= 2 * (n - 1));
  }
  return 0;
}

// two parts under one switch: one transfer each way, at the same time
static int times_of_two_parts_are_latency_and_bytes_over_bandwidth(void)
{
  cloth_links l = cloth_links_binary(2, 2e9, 3e-6);
  double time[4];
  CHECK(cloth_transfer_order(&l, order) == 1);
  cloth_transfer_times(&l, 2, order, 4e6, time);
  for (int i = 0; i < 2; i++) {
    CHECK_NEAR(time[2 * i], 0, 0);
    CHECK_NEAR(time[2 * i + 1], 3e-6 + 4e6 / 2e9, 1e-12);
  }
  return 0;
}

// four parts: each stage waits for the one before; a slow root is the bound
static int a_slow_root_bounds_the_exchange(void)
{
  cloth_links l = cloth_links_binary(4, 1e10, 0);
  for (int i = 4; i < l.nodes; i++) l.bandwidth[i] = 1e9;
  double time[24], last = 0;
  cloth_transfer_order(&l, order);
  cloth_transfer_times(&l, 12, order, 1e6, time);
  for (int i = 0; i < 12; i++) last = fmax(last, time[2 * i + 1]);
  CHECK(last >= 2e-3); // two vectors each way across the root at 1 ms
  CHECK(last <= 2e-3 + 3 * 1e-4 + 1e-12);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(every_part_gets_every_vector_once);
  RUN(nothing_is_handed_on_before_it_came);
  RUN(no_port_is_used_twice_in_a_stage);
  RUN(each_vector_crosses_each_link_at_most_once);
  RUN(no_link_carries_two_transfers_of_a_stage);
  RUN(stages_are_as_few_as_ports_allow);
  RUN(times_of_two_parts_are_latency_and_bytes_over_bandwidth);
  RUN(a_slow_root_bounds_the_exchange);
  return failures > 0;
}
