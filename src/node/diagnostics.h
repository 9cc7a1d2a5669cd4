// /diagnostics, once a second of wall time, whatever the simulation does.
#pragma once

#include "simulation.h"

#include <diagnostic_msgs/DiagnosticArray.h>

namespace robot_cloth {

/// What an operator should know: time, engine, robot, inputs, outputs, cross-check.
diagnostic_msgs::DiagnosticArray diagnose(const Health &health, const CrossChecker::Totals &checks,
                                          const Outputs &outputs, double seconds_since_turn,
                                          const std::string &node);

} // namespace robot_cloth
