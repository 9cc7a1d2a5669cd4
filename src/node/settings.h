// The parameters of the node: read once at start, checked, logged, then never looked at again.
#pragma once

#include "engine.h"

#include <ros/node_handle.h>
#include <stdexcept>
#include <string>
#include <vector>

namespace robot_cloth {

/// Something that keeps the node from starting or a model from loading. The text names the
/// parameter, topic or file to fix; the node exits with code 2.
struct StartError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

using std::string;

/// A gripper whose joint grasps and releases (an entry of ~grippers).
struct GripperSettings {
  string name;
  string joint;
  double sign = 1;              // -1: the joint grows as the gripper closes
  double close_below = 0;       // m or rad: sign * joint closing below this grasps
  double open_above = 0;        // m or rad: sign * joint opening above this releases
  string frame;                 // the held vertices follow it: a link or a tf frame
  double region_center[3] = {}; // [3] m, in `frame`
  double region_size[3] = {};   // [3] m, full edge lengths
  std::vector<string> links;    // finger links whose contacts with held vertices are off
  string cloth;                 // empty: every cloth
  bool release = true;          // opening releases
  int limit = 0;                // most vertices; 0: no limit
  double compliance = 0;        // m/N per vertex
  double break_force = 0;       // N
};

struct Settings {
#define CLOTH_SETTING(type, member, name, value, unit, least, most, meaning) type member = value;
#include "settings.inl"
  std::vector<GripperSettings> grippers;
  std::vector<std::pair<string, string>> scene; // (name, value as text) of ~params
};

/// Read everything below the private namespace. Unknown keys, wrong types and values out of range
/// throw StartError with the parameter's full name, its value and what it may be.
Settings readSettings(const ros::NodeHandle &priv);

/// Set ~params on a description and log value, unit and whether it is the default, of each
/// parameter. Returns one line per parameter, for ~get_info.
std::vector<string> applyParams(const Settings &settings, const string &ns, cloth_def *def);

} // namespace robot_cloth
