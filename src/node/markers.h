// What RViz shows: shaded cloth, grasps, and the collision geometry exactly as it is simulated.
#pragma once

#include "snapshot.h"
#include "world.h"

#include <visualization_msgs/MarkerArray.h>

namespace robot_cloth {

/// Cloth and grasps. RViz does not light triangles that have colours of their own, so the shading
/// is in the colours; the two sides of a cloth have different ones, which makes folds visible.
visualization_msgs::MarkerArray clothMarkers(const Snapshot &snapshot);

/// One marker per body: links in their own frame with frame_locked, the others in the world frame.
visualization_msgs::MarkerArray bodyMarkers(const World &world, const std::string &world_frame);

} // namespace robot_cloth
