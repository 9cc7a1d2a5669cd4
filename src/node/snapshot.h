// What the simulation thread hands to the publisher thread after a step.
#pragma once

#include <cstdint>
#include <geometry_msgs/WrenchStamped.h>
#include <memory>
#include <robot_cloth/Contacts.h>
#include <robot_cloth/Event.h>
#include <robot_cloth/Grasps.h>
#include <robot_cloth/State.h>
#include <string>
#include <vector>

namespace robot_cloth {

/// What does not change while a world runs.
struct ClothShape {
  std::string name;
  std::vector<int> triangles;         // [triangles x 3]
  std::vector<double> rest_positions; // [vertices x 3] m
  std::vector<std::pair<std::string, std::vector<int>>> groups;
};

/// One cloth after a step; empty vectors: nobody asked.
struct ClothFrame {
  std::vector<double> positions, velocities; // [vertices x 3] m, m/s, world frame
  std::vector<uint8_t> held;                 // [vertices]
};

struct Snapshot {
  State state;
  std::shared_ptr<const std::vector<ClothShape>> shapes;
  std::vector<ClothFrame> cloths;
  Grasps grasps;
  bool grasps_changed = false;
  bool stream = false;                                // vertices and mesh are due
  bool markers = false;                               // markers are due
  std::vector<geometry_msgs::WrenchStamped> wrenches; // in the order of grasps
  std::unique_ptr<Contacts> contacts;
};

} // namespace robot_cloth
