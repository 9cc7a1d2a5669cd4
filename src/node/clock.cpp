#include "clock.h"

#include <algorithm>
#include <ros/console.h>
#include <ros/time.h>

namespace robot_cloth {

Clock::Clock(const Settings &settings)
    : settings_(settings), lockstep_(settings.time_mode == "step"),
      wall_(settings.time_mode == "wall")
{
  // The header stamps of lockstep begin at the start of the node; the inputs do not depend on them.
  if (lockstep_) origin_ = 0;
}

double Clock::now() const
{
  return wall_ ? ros::WallTime::now().toSec() : ros::Time::now().toSec();
}

Clock::Turn Clock::look(double sim_time, double h)
{
  if (lockstep_) return wait;
  double now = this->now();
  const double wall = ros::SteadyTime::now().toSec();
  waiting_for_clock_ = now == 0;
  if (waiting_for_clock_) return wait;
  if (!started_) {
    origin_ = now - sim_time;
    now_ = now, last_wall_ = wall;
    started_ = true;
  }
  // what passed on the wall is no leap, however long a step took
  const double ahead = (now - now_) - (wall - last_wall_), back = now_ - now;
  last_wall_ = wall;
  if (back > settings_.back_step_max) {
    started_ = false;
    return jumped_back;
  }
  now = std::max(now, now_); // jitter: a stopped clock
  now_ = now;
  if (ahead > settings_.forward_jump_max) {
    started_ = false;
    return jumped_ahead;
  }
  end_ = origin_ + sim_time + h;
  lag_ = now - end_;
  if (lag_ < -1e-9) return wait;
  // Too slow. A little is skipped with each step, so that the robot never sweeps far in one of
  // them.
  const double excess = lag_ - settings_.input_wait - settings_.catch_up_max;
  if (excess > 0) {
    const double skip = std::min(excess, excess > settings_.forward_jump_max ? excess : 3 * h);
    origin_ += skip, end_ += skip, skipped_ += skip, lag_ -= skip;
    ROS_WARN_STREAM_THROTTLE(5, "slower than the clock: " << skipped_
                                                          << " s were not simulated so far");
  }
  return step;
}

} // namespace robot_cloth
