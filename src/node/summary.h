// What a run was like, in a few numbers that take no memory as it grows.
#pragma once

#include "cloth.h"
#include "crosscheck.h"

#include <array>
#include <string>

namespace robot_cloth {

class Summary {
public:
  /// Take a step that took `wall` seconds altogether.
  void add(const cloth_step_report &report, double wall);

  /// Simulated over wall time of the last second of computing.
  double realTimeFactor() const { return recent_wall_ > 0 ? recent_sim_ / recent_wall_ : 0; }

  /// Several lines: steps, real-time factor, worst stretch, contacts, intersections (if checked).
  uint64_t steps() const { return steps_; }
  std::string text(const CrossChecker::Totals &checks, double skipped) const;

private:
  double quantile(double share) const;

  // steps by real-time factor: bin i holds factors in [10^(i/100 - 4), 10^((i+1)/100 - 4))
  std::array<uint64_t, 1000> bins_{};
  uint64_t steps_ = 0, contacts_max_ = 0, unconverged_ = 0, impacts_left_ = 0;
  double simulated_ = 0, wall_ = 0, factor_min_ = 0, stretch_max_ = 0, recent_sim_ = 0,
         recent_wall_ = 0;
};

} // namespace robot_cloth
