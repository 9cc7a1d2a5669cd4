// Tests of src/budget.c, against scripted times: no clock is read.
#include "budget.h"
#include "check.h"

#include <stdbool.h>

static cloth_params asked(void)
{
  cloth_params p = cloth_params_default();
  p.pcg_tolerance = 1e-4;
  p.newton_iterations_max = 5;
  p.contact_rounds_max = 3;
  return p;
}

// the time of a step grows with what was chosen: a base, and so much per Newton iteration and
// decade
static double cost(const cloth_tuning *t, double scale)
{
  return scale * (2 + t->newton_iterations * (1 - log10(t->pcg_tolerance)));
}

static void took(cloth_budget *b, double allowed, double ms)
{
  cloth_budget_time t = {ms, 0, 0, 0};
  cloth_budget_measured(b, allowed, &t);
}

static int a_fast_scene_gets_all_that_was_asked_for(void)
{
  cloth_params p = asked();
  cloth_budget b;
  cloth_budget_reset(&b);
  for (int i = 0; i < 1000; i++) {
    cloth_tuning t = cloth_budget_choose(&b, &p, 10);
    CHECK(t.pcg_tolerance == 1e-4 && t.newton_iterations == 5 && t.contact_rounds == 3);
    CHECK(t.pcg_iterations == 500 && t.pair_slack == p.pair_slack);
    took(&b, 10, 4);
  }
  CHECK(b.missed == 0);
  return 0;
}

static int a_slow_scene_ends_at_the_stated_bounds(void)
{
  cloth_params p = asked();
  cloth_budget b;
  cloth_budget_reset(&b);
  for (int i = 0; i < 20; i++) took(&b, 10, 100);
  cloth_tuning t = cloth_budget_choose(&b, &p, 10);
  CHECK_NEAR(t.pcg_tolerance, 0.1, 1e-12);
  CHECK(t.newton_iterations == 1 && t.contact_rounds == 1);
  CHECK_NEAR(t.pair_slack, 0.25 * p.pair_slack, 1e-15);
  CHECK(b.missed == 20);
  p.contact_rounds_max = 0, p.newton_iterations_max = 1, p.pcg_tolerance = 0.1; // nothing to give
  t = cloth_budget_choose(&b, &p, 10);
  CHECK(t.pcg_tolerance == 0.1 && t.newton_iterations == 1 && t.contact_rounds == 0);
  return 0;
}

// each system would take 400 iterations of 0.05 ms: 5 systems of that are 100 ms
static int solves_end_in_time_for_the_deadline(void)
{
  cloth_params p = asked();
  cloth_budget b;
  cloth_budget_reset(&b);
  for (int i = 0; i < 200; i++) {
    cloth_tuning t = cloth_budget_choose(&b, &p, 16);
    bool hard = i >= 20; // before, systems are easy
    int n = t.newton_iterations * (hard ? t.pcg_iterations < 400 ? t.pcg_iterations : 400 : 10);
    cloth_budget_time time = {6 + 0.05 * n, 0.05 * n, n, t.newton_iterations};
    cloth_budget_measured(&b, 16, &time);
    CHECK(time.ms <= 16);
    CHECK(t.pcg_iterations >= 20);
  }
  CHECK(b.missed == 0);
  // what is left for solves is nothing: 20 iterations they have all the same
  cloth_budget_time long_ = {40, 1, 10, 1};
  cloth_budget_measured(&b, 16, &long_);
  CHECK(cloth_budget_choose(&b, &p, 16).pcg_iterations == 20);
  // a step that took more systems than chosen may be followed by such another
  cloth_budget_reset(&b);
  cloth_budget_time more = {6 + 3, 3, 60, 10};
  cloth_budget_measured(&b, 16, &more);
  cloth_tuning t = cloth_budget_choose(&b, &p, 16);
  CHECK(6 + 0.05 * 10 * t.pcg_iterations <= 0.9 * 16 + 0.05 * 200);
  more.systems = 5;
  cloth_budget_measured(&b, 16, &more);
  CHECK(cloth_budget_choose(&b, &p, 16).pcg_iterations > t.pcg_iterations);
  p.pcg_iterations_max = 7; // of those who ask for less
  CHECK(cloth_budget_choose(&b, &p, 16).pcg_iterations == 7);
  return 0;
}

static int it_settles_below_the_deadline_and_spends_most_of_it(void)
{
  cloth_params p = asked();
  cloth_budget b;
  cloth_budget_reset(&b);
  double sum = 0;
  int64_t missed_early = 0;
  for (int i = 0; i < 600; i++) {
    cloth_tuning t = cloth_budget_choose(&b, &p, 16);
    double ms = cost(&t, 1); // 27 ms at full accuracy, 4 ms at the least
    took(&b, 16, ms);
    if (i == 99) missed_early = b.missed;
    if (i >= 100) sum += ms;
  }
  CHECK(missed_early <= 5);
  CHECK(b.missed == missed_early);
  CHECK(sum / 500 > 0.5 * 16 && sum / 500 < 16);
  return 0;
}

static int it_gives_way_in_a_burst_and_comes_back_after_it(void)
{
  cloth_params p = asked();
  cloth_budget b;
  cloth_budget_reset(&b);
  for (int i = 0; i < 400; i++) {
    cloth_tuning t = cloth_budget_choose(&b, &p, 40);
    bool burst = i >= 100 && i < 150;
    if (i == 149) CHECK(b.level < 0.5);
    took(&b, 40, cost(&t, burst ? 4 : 1));
  }
  CHECK(b.level == 1);
  CHECK(b.missed < 10);
  return 0;
}

static int percentiles_are_those_of_a_sorted_window(void)
{
  cloth_budget b;
  cloth_step_report r = {0};
  cloth_tuning t = {0.01, 3, 2, 77, 1e-3};
  cloth_budget_reset(&b);
  // 5000 in front are pushed out; then 1 to 500 in a scrambled order
  for (int i = 0; i < 300; i++) took(&b, 490, 5000);
  for (int i = 0; i < CLOTH_BUDGET_WINDOW; i++)
    took(&b, 490, 1 + (i * 273 + 11) % CLOTH_BUDGET_WINDOW);
  cloth_budget_report(&b, 490, &t, &r);
  CHECK(r.wall_p50 == 250 && r.wall_p99 == 495 && r.wall_worst == 500);
  CHECK(r.deadlines_missed == 300 + 10);
  CHECK_NEAR(r.deadline_miss_share, 10.0 / 500, 1e-15); // 490 itself was met
  CHECK(r.chosen_pcg_tolerance == 0.01 && r.chosen_newton_iterations == 3);
  CHECK(r.chosen_pcg_iterations == 77);
  CHECK(r.chosen_contact_rounds == 2 && r.budget_ms == 490);
  return 0;
}

static int times_that_are_no_times_change_nothing(void)
{
  cloth_budget b, before;
  cloth_budget_reset(&b);
  took(&b, 10, 12);
  before = b;
  took(&b, 10, NAN);
  took(&b, NAN, 10);
  took(&b, 0, 10);
  CHECK(memcmp(&b, &before, sizeof b) == 0);
  return 0;
}

static int real_time_is_the_length_of_the_step(void)
{
  cloth_params p = cloth_params_default();
  cloth_error err = {0};
  CHECK(cloth_budget_allowed(&p, 0.02) == 0);
  CHECK_OK(cloth_param_set(cloth_param_table(), &p, "time_budget", "12.5", &err), err);
  CHECK(cloth_budget_allowed(&p, 0.02) == 12.5);
  CHECK_OK(cloth_param_set(cloth_param_table(), &p, "time_budget", "real_time", &err), err);
  CHECK_NEAR(cloth_budget_allowed(&p, 0.02), 20, 1e-12);
  CHECK(cloth_param_set(cloth_param_table(), &p, "newton_tolerance", "real_time", &err) ==
        CLOTH_BAD_ARGUMENT);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(a_fast_scene_gets_all_that_was_asked_for);
  RUN(a_slow_scene_ends_at_the_stated_bounds);
  RUN(solves_end_in_time_for_the_deadline);
  RUN(it_settles_below_the_deadline_and_spends_most_of_it);
  RUN(it_gives_way_in_a_burst_and_comes_back_after_it);
  RUN(percentiles_are_those_of_a_sorted_window);
  RUN(times_that_are_no_times_change_nothing);
  RUN(real_time_is_the_length_of_the_step);
  return failures != 0;
}
