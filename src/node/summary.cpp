#include "summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace robot_cloth {

void Summary::add(const cloth_step_report &r, double wall)
{
  wall = std::max(wall, 1e-9);
  const double factor = r.step_size / wall;
  const double bin = std::floor(100 * (std::log10(std::max(factor, 1e-4)) + 4));
  bins_[static_cast<size_t>(std::min(std::max(bin, 0.0), 999.0))]++;
  factor_min_ = steps_ == 0 ? factor : std::min(factor_min_, factor);
  steps_++;
  simulated_ += r.step_size, wall_ += wall;
  contacts_max_ = std::max(contacts_max_, static_cast<uint64_t>(r.contacts_self + r.contacts_body));
  stretch_max_ = std::max(stretch_max_, r.stretch_max);
  unconverged_ += static_cast<uint64_t>(r.pcg_unconverged);
  impacts_left_ += static_cast<uint64_t>(r.impacts_left);
  const double keep = std::exp(-wall); // forgets over a second
  recent_sim_ = keep * recent_sim_ + r.step_size;
  recent_wall_ = keep * recent_wall_ + wall;
}

double Summary::quantile(double share) const
{
  uint64_t below = 0;
  for (size_t i = 0; i < bins_.size(); i++) {
    below += bins_[i];
    if (static_cast<double>(below) >= share * static_cast<double>(steps_))
      return std::pow(10, (static_cast<double>(i) + 0.5) / 100 - 4);
  }
  return 0;
}

std::string Summary::text(const CrossChecker::Totals &checks, double skipped) const
{
  char out[1024];
  int n = std::snprintf(out, sizeof out,
                        "steps                 %llu (%.2f s simulated in %.2f s of computing)\n"
                        "real-time factor      median %.2f, 1%% of steps below %.2f, least %.2f\n"
                        "worst stretch         %.2f %%\n"
                        "contacts              at most %llu in a step\n"
                        "solves that gave up   %llu\n"
                        "pairs left in contact %llu that pass through at the end of a step\n"
                        "skipped               %.2f s of the clock\n",
                        static_cast<unsigned long long>(steps_), simulated_, wall_, quantile(0.5),
                        quantile(0.01), factor_min_, 100 * stretch_max_,
                        static_cast<unsigned long long>(contacts_max_),
                        static_cast<unsigned long long>(unconverged_),
                        static_cast<unsigned long long>(impacts_left_), skipped);
  std::string text(out, static_cast<size_t>(n));
  if (checks.checks == 0) return text + "intersections         not checked (crosscheck/every)";
  std::snprintf(out, sizeof out,
                "intersections         cloth-cloth %llu, cloth-body %llu in %llu checks by FCL\n"
                "broad phase           %llu pairs missed",
                static_cast<unsigned long long>(checks.intersecting_self),
                static_cast<unsigned long long>(checks.intersecting_body),
                static_cast<unsigned long long>(checks.checks),
                static_cast<unsigned long long>(checks.missed));
  return text + out;
}

} // namespace robot_cloth
