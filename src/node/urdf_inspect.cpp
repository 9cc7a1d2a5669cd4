#include "urdf_inspect.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <set>
#include <urdf_model/pose.h>
#include <urdf_model/utils.h>

namespace robot_cloth {
namespace {

using tinyxml2::XMLElement;

std::string quoted(const char *text) { return text ? "\"" + std::string(text) + "\"" : "missing"; }

std::string attribute(const XMLElement *e, const char *name)
{
  const char *text = e ? e->Attribute(name) : nullptr;
  return text ? text : "";
}

void forEach(XMLElement *parent, const char *tag, const std::function<void(XMLElement *)> &visit)
{
  for (XMLElement *e = parent->FirstChildElement(tag), *next; e; e = next) {
    next = e->NextSiblingElement(tag);
    visit(e);
  }
}

// Numbers are read by urdfdom's own functions, so that this and urdfdom agree on what is a number.
bool readNumber(const char *text, double *out)
{
  try {
    *out = urdf::strToDouble(text);
  } catch (const std::exception &) {
    return false;
  }
  return std::isfinite(*out);
}

bool readVector(const char *text, urdf::Vector3 *out)
{
  try {
    out->init(text);
  } catch (const std::exception &) {
    return false;
  }
  return std::isfinite(out->x) && std::isfinite(out->y) && std::isfinite(out->z);
}

// What keeps urdfdom from reading <origin>; empty: nothing.
std::string unreadableOrigin(const XMLElement *parent)
{
  const XMLElement *origin = parent->FirstChildElement("origin");
  if (!origin) return "";
  urdf::Vector3 v;
  for (const char *name : {"xyz", "rpy"}) {
    const char *text = origin->Attribute(name);
    if (text && !readVector(text, &v))
      return std::string("origin ") + name + "=" + quoted(text) + " is not three finite numbers";
  }
  return "";
}

std::string unreadableLength(const XMLElement *shape, const char *name)
{
  double value = 0;
  const char *text = shape->Attribute(name);
  if (!text) return std::string(shape->Name()) + " has no " + name;
  if (!readNumber(text, &value))
    return std::string(shape->Name()) + " " + name + "=" + quoted(text) +
           " is not a finite number in m";
  return "";
}

// What keeps urdfdom from reading a <collision>; empty: nothing.
std::string unreadableCollision(const XMLElement *collision)
{
  const std::string origin = unreadableOrigin(collision);
  if (!origin.empty()) return origin;
  const XMLElement *geometry = collision->FirstChildElement("geometry");
  if (!geometry) return "it has no <geometry>";
  const XMLElement *shape = geometry->FirstChildElement();
  if (!shape) return "its <geometry> is empty";
  const std::string type = shape->Name();
  urdf::Vector3 v;
  if (type == "sphere") return unreadableLength(shape, "radius");
  if (type == "cylinder") {
    const std::string radius = unreadableLength(shape, "radius");
    return radius.empty() ? unreadableLength(shape, "length") : radius;
  }
  if (type == "box") {
    const char *size = shape->Attribute("size");
    if (!size || !readVector(size, &v))
      return "box size=" + quoted(size) + " is not three finite numbers in m";
    return "";
  }
  if (type == "mesh") {
    if (!shape->Attribute("filename")) return "mesh has no filename";
    const char *scale = shape->Attribute("scale");
    if (scale && !readVector(scale, &v))
      return "mesh scale=" + quoted(scale) + " is not three finite numbers";
    return "";
  }
  return "urdfdom knows no <" + type + ">; use box, cylinder, sphere or mesh";
}

class Inspector {
public:
  explicit Inspector(XMLElement *robot) : robot_(robot) {}

  UrdfInspection run()
  {
    forEach(robot_, "material", [&](XMLElement *e) { robot_->DeleteChild(e); });
    forEach(robot_, "link", [&](XMLElement *e) { link(e); });
    forEach(robot_, "joint", [&](XMLElement *e) { joint(e); });
    if (out_.links.empty()) {
      if (out_.errors.empty()) out_.errors.push_back("the robot has no <link>");
      return std::move(out_);
    }
    mimics();
    tree();
    return std::move(out_);
  }

private:
  void link(XMLElement *e)
  {
    const std::string name = attribute(e, "name");
    if (name.empty()) {
      error("a <link> in line " + std::to_string(e->GetLineNum()) + " has no name");
      return;
    }
    if (out_.links.count(name)) {
      error("two links are named '" + name + "'; rename one");
      return;
    }
    UrdfInspection::LinkTags &tags = out_.links[name];
    forEach(e, "inertial", [&](XMLElement *c) { e->DeleteChild(c); });
    forEach(e, "visual", [&](XMLElement *c) {
      tags.visuals++;
      e->DeleteChild(c);
    });
    forEach(e, "collision", [&](XMLElement *c) {
      tags.collisions++;
      const std::string why = unreadableCollision(c);
      if (why.empty()) {
        tags.readable++;
        return;
      }
      problem(ModelProblem::dropped_collision, name,
              "link '" + name + "': <collision> number " + std::to_string(tags.collisions) +
                  " (line " + std::to_string(c->GetLineNum()) + ") is left out: " + why);
      e->DeleteChild(c);
    });
  }

  void joint(XMLElement *e)
  {
    const std::string name = attribute(e, "name");
    if (name.empty()) {
      error("a <joint> in line " + std::to_string(e->GetLineNum()) + " has no name");
      return;
    }
    if (joints_.count(name)) {
      error("two joints are named '" + name + "'; rename one");
      return;
    }
    joints_[name] = e;
    const std::string here = "joint '" + name + "': ";
    static const std::set<std::string> types = {"fixed",     "revolute", "continuous",
                                                "prismatic", "planar",   "floating"};
    const std::string type = attribute(e, "type");
    if (!types.count(type))
      error(here + "type " + quoted(e->Attribute("type")) +
            " is none of fixed, revolute, continuous, prismatic, planar, floating");
    const std::string origin = unreadableOrigin(e);
    if (!origin.empty()) error(here + origin);
    if (type == "planar" || type == "floating")
      problem(ModelProblem::unusual_joint, name,
              here + "is " + type + ": it stays at its origin until tf says otherwise");
    ends(e, name, here);
    if (type != "fixed" && type != "floating") axis(e, here);
    limits(e, name, type, here);
  }

  void ends(XMLElement *e, const std::string &name, const std::string &here)
  {
    for (const char *end : {"parent", "child"}) {
      const std::string link = attribute(e->FirstChildElement(end), "link");
      if (link.empty()) {
        error(here + "no <" + end + " link=...>");
        return;
      }
      if (!out_.links.count(link)) {
        error(here + end + " link '" + link + "' does not exist");
        return;
      }
    }
    const std::string child = attribute(e->FirstChildElement("child"), "link");
    const auto added = parent_joint_.emplace(child, name);
    if (!added.second)
      error("link '" + child + "' hangs on two joints, '" + added.first->second + "' and '" + name +
            "'; a robot is a tree");
  }

  void axis(XMLElement *e, const std::string &here)
  {
    const XMLElement *axis = e->FirstChildElement("axis");
    const char *text = axis ? axis->Attribute("xyz") : nullptr;
    if (!text) return; // urdfdom: x
    urdf::Vector3 v;
    if (!readVector(text, &v))
      error(here + "axis xyz=" + quoted(text) + " is not three finite numbers");
    else if (!(v.x * v.x + v.y * v.y + v.z * v.z > 1e-12))
      error(here + "axis xyz=" + quoted(text) + " has no direction; e.g. \"0 0 1\"");
  }

  void limits(XMLElement *e, const std::string &name, const std::string &type,
              const std::string &here)
  {
    const XMLElement *limit = e->FirstChildElement("limit");
    if (!limit) {
      if (type == "revolute" || type == "prismatic")
        error(here + "a " + type + " joint needs <limit lower= upper= effort= velocity=>" +
              (type == "revolute" ? "; or make it continuous" : ""));
      return;
    }
    double lower = 0, upper = 0;
    for (const char *bound : {"lower", "upper", "effort", "velocity"}) {
      const char *text = limit->Attribute(bound);
      double value = 0;
      const bool needed = bound[0] == 'e' || bound[0] == 'v'; // by urdfdom, for every type
      if (text ? !readNumber(text, &value) : needed)
        error(here + "limit " + bound + " is " + quoted(text) + ", not a finite number");
      if (!std::strcmp(bound, "lower")) lower = value;
      if (!std::strcmp(bound, "upper")) upper = value;
    }
    if ((type == "revolute" || type == "prismatic") && !(lower <= upper))
      problem(ModelProblem::unusual_joint, name,
              here + "limit lower " + quoted(limit->Attribute("lower")) + " is above upper " +
                  quoted(limit->Attribute("upper")) + "; limits not used");
  }

  // Follow each mimic to its end: a joint that mimics nothing.
  void mimics()
  {
    for (const auto &[name, e] : joints_) {
      const XMLElement *mimic = e->FirstChildElement("mimic");
      if (!mimic) continue;
      const std::string here = "joint '" + name + "': ";
      const std::string type = attribute(e, "type");
      for (const char *number : {"multiplier", "offset"}) {
        const char *text = mimic->Attribute(number);
        double value = 0;
        if (text && !readNumber(text, &value))
          error(here + "mimic " + number + "=" + quoted(text) + " is not a finite number");
        else if (text && number[0] == 'm' && value == 0)
          problem(ModelProblem::unusual_joint, name,
                  here + "mimic multiplier is 0: it never moves");
      }
      if (type == "fixed" || type == "planar" || type == "floating")
        problem(ModelProblem::unusual_joint, name,
                here + "is " + type + "; its <mimic> is ignored");
      follow(name, here, *mimic);
    }
  }

  void follow(const std::string &name, const std::string &here, const XMLElement &first)
  {
    std::set<std::string> passed = {name};
    const XMLElement *mimic = &first;
    std::string chain = name;
    while (mimic) {
      const std::string target = attribute(mimic, "joint");
      const auto found = joints_.find(target);
      chain += " -> " + target;
      if (found == joints_.end()) {
        // Told once, by the joint that names it.
        if (mimic == &first) error(here + "mimics joint '" + target + "', which does not exist");
        return;
      }
      if (!passed.insert(target).second) {
        // A cycle is told by its first joint in the alphabet, not by all of them.
        if (target == name && *passed.begin() == name)
          error(here + "mimics itself in a cycle: " + chain + "; one of them must not mimic");
        return;
      }
      mimic = found->second->FirstChildElement("mimic");
      const std::string type = attribute(found->second, "type");
      if (!mimic && (type == "fixed" || type == "planar" || type == "floating"))
        problem(ModelProblem::unusual_joint, name,
                here + "mimics '" + target + "', which is " + type +
                    " and has no value: never moves");
    }
  }

  void tree()
  {
    std::vector<std::string> roots;
    for (const auto &[name, tags] : out_.links)
      if (!parent_joint_.count(name)) roots.push_back(name);
    if (roots.empty())
      error("no root: every link is the child of some joint, so they form a cycle");
    if (roots.size() > 1) {
      std::string text = "the robot has " + std::to_string(roots.size()) + " roots (";
      for (size_t i = 0; i < roots.size() && i < 8; i++) text += (i ? ", " : "") + roots[i];
      if (roots.size() > 8) text += ", ...";
      error(text + "); join them by a joint, or remove one");
    }
    if (roots.size() != 1 || !out_.errors.empty()) return;
    for (const auto &[name, tags] : out_.links) {
      std::string at = name;
      for (size_t step = 0; parent_joint_.count(at); step++) {
        if (step > out_.links.size()) {
          error("link '" + name + "' is on a cycle of joints and not connected to the root '" +
                roots[0] + "'");
          return;
        }
        at = attribute(joints_[parent_joint_[at]]->FirstChildElement("parent"), "link");
      }
    }
  }

  void error(const std::string &text) { out_.errors.push_back(text); }
  void problem(ModelProblem::Kind kind, const std::string &what, const std::string &text)
  {
    out_.problems.push_back({kind, what, text});
  }

  XMLElement *robot_;
  UrdfInspection out_;
  std::map<std::string, XMLElement *> joints_;
  std::map<std::string, std::string> parent_joint_; // of a child link
};

bool mentionsXacro(const XMLElement *e)
{
  for (const XMLElement *c = e->FirstChildElement(); c; c = c->NextSiblingElement())
    if (!std::strncmp(c->Name(), "xacro:", 6) || mentionsXacro(c)) return true;
  return false;
}

} // namespace

UrdfInspection inspectUrdf(tinyxml2::XMLDocument *document)
{
  UrdfInspection out;
  XMLElement *robot = document->RootElement();
  if (!robot || std::strcmp(robot->Name(), "robot") != 0) {
    out.errors.push_back("the document element is " +
                         (robot ? "<" + std::string(robot->Name()) + ">" : "missing") +
                         ", not <robot>");
    return out;
  }
  if (mentionsXacro(robot)) {
    out.errors.push_back("it holds xacro elements: run xacro first and set its output");
    return out;
  }
  return Inspector(robot).run();
}

} // namespace robot_cloth
