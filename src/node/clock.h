// Who drives the time: ROS time (clock), the wall (wall), or only requests (step). Says when the
// next step is due and notices when the clock jumps. Never sleeps.
#pragma once

#include "settings.h"

namespace robot_cloth {

class Clock {
public:
  explicit Clock(const Settings &settings);

  /// What the simulation thread should do now.
  enum Turn {
    wait,         // nothing is due, or nothing is known yet
    step,         // a step that ends at end() is due
    jumped_back,  // the clock ran back: policy on_backward_jump
    jumped_ahead, // the clock leapt: place bodies, go on from there
  };

  /// Look at the clock. `sim_time` [s] simulated so far, `h` [s] the next step's length, `known`
  /// whether the inputs of a step that ends at the asked time are there.
  template <class Known> Turn turn(double sim_time, double h, Known known)
  {
    const Turn t = look(sim_time, h);
    if (t != step || now_ - end_ >= settings_.input_wait || known(end_)) return t;
    return wait;
  }

  /// End of the step that is due, on the clock's scale [s].
  double end() const { return end_; }
  /// Clock time of a simulated time [s]. Before the first look at the clock, and after a jump or a
  /// pause, that is now: the next step goes on from there, and the old origin is of another time.
  double stamp(double sim_time) const { return started_ || lockstep_ ? origin_ + sim_time : now(); }
  /// The clock itself, now [s]; 0 while nobody publishes it.
  double now() const;

  /// Go on from here: what passed while paused or before a reset is not made up for.
  void restart() { started_ = false; }

  bool lockstep() const { return lockstep_; }
  bool waitingForClock() const { return waiting_for_clock_; }
  double skipped() const { return skipped_; } // s that were not simulated because we were too slow
  double lag() const { return lag_; }         // s that the simulation is behind the clock

private:
  Turn look(double sim_time, double h);

  const Settings &settings_;
  const bool lockstep_, wall_;
  bool started_ = false, waiting_for_clock_ = false;
  double origin_ = 0, end_ = 0, now_ = 0, last_wall_ = 0;
  double skipped_ = 0, lag_ = 0;
};

} // namespace robot_cloth
