// What urdfdom does not say: a look at the XML of a robot description before urdfdom sees it.
//
// urdfdom (3.0) leaves a link at its first <collision>, <visual> or <inertial> that it cannot read,
// silently drops every <collision> after it, and still returns a model; it accepts negative sizes,
// links with two parents and mimics of nothing. Here each of those gets a sentence, and what cannot
// be read is taken out of the document, so that the elements around it survive.
#pragma once

#include "robot_model.h"

#include <map>
#include <string>
#include <tinyxml2.h>
#include <vector>

namespace robot_cloth {

struct UrdfInspection {
  struct LinkTags {
    int collisions = 0; // in the XML
    int readable = 0;   // of which urdfdom should read
    int visuals = 0;
  };
  std::vector<std::string> errors; // why the model cannot be used; empty: it can
  std::vector<ModelProblem> problems;
  std::map<std::string, LinkTags> links;
};

/// Inspect a parsed document and take out what would make urdfdom drop collision geometry:
/// unreadable <collision> elements (each reported), and all <visual>, <inertial> and <material>
/// elements, which are not needed here.
UrdfInspection inspectUrdf(tinyxml2::XMLDocument *document);

} // namespace robot_cloth
