#include "state/cut.h"

#include "chunk.h"
#include "pcg.h"

int cloth_cut_units(const cloth_sim *sim)
{
  return sim->aggregates > 0 ? sim->aggregates : cloth_chunk_groups(sim->chunks);
}

int cloth_cut_vertex(const cloth_sim *sim, int unit)
{
  int chunk = sim->aggregates > 0 ? cloth_aggregate_begin(unit, sim->chunks, sim->aggregates)
                                  : unit * cloth_chunk_group(sim->chunks);
  int vertex = chunk * CLOTH_CHUNK;
  return vertex < sim->vertex_count ? vertex : sim->vertex_count;
}

void cloth_cut_equally(int units, int parts, int *first)
{
  for (int j = 0; j <= parts; j++) first[j] = (int)((int64_t)units * j / parts);
}

// each part takes units up to `most`, and leaves one for each part behind it; what it got at most
static double take_up_to(double most, int units, const double *work, int parts, int *first)
{
  double largest = 0;
  int u = 0;
  for (int j = 0; j < parts; j++) {
    double sum = 0;
    int last = j + 1 == parts ? units : units - (parts - j - 1);
    first[j] = u;
    do sum += work[u++];
    while (u < last && (j + 1 == parts || sum + work[u] <= most));
    if (sum > largest) largest = sum;
  }
  first[parts] = units;
  return largest;
}

// Bisection over the largest part (chains on chains: Pinar and Aykanat 2004). What greedy parts get
// at most is never below the best, so the best of all tries is kept.
double cloth_cut_by_work(int units, const double *work, int parts, int *first)
{
  double low = 0, high = 0;
  for (int u = 0; u < units; u++) high += work[u];
  low = high / parts;
  double best = take_up_to(high, units, work, parts, first);
  for (int k = 0; k < 60; k++) {
    double middle = (low + high) / 2, got = take_up_to(middle, units, work, parts, first);
    if (got <= middle)
      high = middle;
    else
      low = middle;
    if (got < best) best = got;
  }
  return take_up_to(best, units, work, parts, first);
}
