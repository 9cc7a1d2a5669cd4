#include "world.h"

#include "nearest.h"

#include <algorithm>
#include <iomanip>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/time.h>
#include <sstream>

namespace robot_cloth {
namespace {

std::string readDescription(const Settings &s, const ros::NodeHandle &nh, const std::string &ns)
{
  const ros::WallTime start = ros::WallTime::now();
  std::string key, xml;
  while (true) {
    if (nh.searchParam(s.robot_description, key) && nh.hasParam(key)) {
      if (!nh.getParam(key, xml))
        throw StartError("parameter " + key + " must be a string with the URDF");
      if (!xml.empty()) return xml;
    }
    if (!ros::ok())
      throw StartError("shut down while waiting for parameter " + s.robot_description);
    const double waited = (ros::WallTime::now() - start).toSec();
    if (!(waited < s.robot_timeout)) break;
    ROS_INFO_STREAM_THROTTLE(5, "waiting for parameter " << s.robot_description << " (the URDF)");
    ros::WallDuration(0.05).sleep();
  }
  throw StartError("parameter " + s.robot_description + " is " +
                   (key.empty() ? "not set" : "empty") + " after " +
                   std::to_string(s.robot_timeout) + " s: load the robot's URDF into it, or set " +
                   ns + "/use_robot" + " to false");
}

std::shared_ptr<const RobotModel> readRobot(const Settings &s, const ros::NodeHandle &nh,
                                            const std::string &ns)
{
  ModelOptions options;
  options.mesh.collada_unit = s.collada_units;
  options.tolerate_bad_collisions = s.tolerate_bad_collisions;
  try {
    return RobotModel::fromUrdf(readDescription(s, nh, ns), options);
  } catch (const ModelError &e) {
    throw StartError("parameter " + s.robot_description + ": " + e.what());
  }
}

void addLinks(const Settings &s, cloth_def *def, World *world)
{
  for (const Link &link : world->robot->links()) {
    if (link.mesh.empty()) continue;
    cloth_error err = {};
    LinkBody body = {link.index, -1};
    cloth_body_view view = {};
    view.name = link.name.c_str();
    view.mesh = link.mesh.view();
    view.pose = parkedPose(link.index);
    view.friction = s.robot_friction;
    if (cloth_def_add_body(def, &view, &body.body, &err) != CLOTH_OK)
      throw StartError("link " + link.name + " of " + s.robot_description + ": " + err.text);
    world->links.push_back(body);
  }
}

void warn(World *world, const std::string &text)
{
  world->problems.push_back(text);
  ROS_WARN_STREAM("robot model: " << text);
}

// What tf puts right later is told by RobotMotion::warnings() for as long as it lasts.
bool untilTfSpeaks(const RobotModel &robot, const ModelProblem &p)
{
  const int joint = robot.findJoint(p.link_or_joint);
  return p.kind == ModelProblem::unusual_joint && joint >= 0 &&
         robot.joints()[static_cast<size_t>(joint)].placed();
}

template <class Named>
[[noreturn]] void noSuch(const std::string &param, const char *what, const std::string &name,
                         const std::vector<Named> &known)
{
  const char *best = nullptr;
  for (const Named &k : known) cloth_nearest(name.c_str(), k.name.c_str(), &best);
  throw StartError("parameter " + param + ": the robot has no " + what + " '" + name + "'" +
                   (best ? std::string("; did you mean ") + best + "?" : ""));
}

// A threshold that the joint cannot cross is most often one in another unit.
void checkThresholds(const GripperSettings &g, const std::string &param, const Joint &joint,
                     World *world)
{
  double ends[2] = {joint.lower, joint.upper};
  if (joint.mimic()) {
    const Joint &source = world->robot->joints()[static_cast<size_t>(joint.mimic_source)];
    ends[0] = joint.mimic_multiplier * source.lower + joint.mimic_offset;
    ends[1] = joint.mimic_multiplier * source.upper + joint.mimic_offset;
  }
  const double least = std::min(g.sign * ends[0], g.sign * ends[1]);
  const double most = std::max(g.sign * ends[0], g.sign * ends[1]);
  const bool never_closes = g.close_below <= least, never_opens = g.open_above >= most;
  if (!never_closes && !never_opens) return;
  std::ostringstream text;
  text << "parameter " << param << ": joint " << joint.name << " goes from "
       << std::min(ends[0], ends[1]) << " to " << std::max(ends[0], ends[1])
       << (joint.kind == JointKind::prismatic ? " m" : " rad")
       << ", so that a gripper that closes at " << g.sign * g.close_below << " and opens at "
       << g.sign * g.open_above << " never " << (never_closes ? "closes" : "opens");
  warn(world, text.str());
}

// A gripper that names nothing of this robot or scene would silently never grasp.
void checkGrippers(const Settings &s, const std::string &ns, World *world)
{
  for (size_t i = 0; i < s.grippers.size(); i++) {
    const GripperSettings &g = s.grippers[i];
    const std::string param = ns + "/grippers[" + std::to_string(i) + "]";
    std::string why;
    if (!g.cloth.empty() && world->findCloth(g.cloth, &why) < 0)
      throw StartError("parameter " + param + "/cloth: " + why);
    if (!world->robot) {
      warn(world, "gripper " + g.name + " never moves: " + ns + "/use_robot is false");
      continue;
    }
    const RobotModel &robot = *world->robot;
    const int index = robot.findJoint(g.joint);
    if (index < 0) noSuch(param + "/joint", "joint", g.joint, robot.joints());
    const Joint &joint = robot.joints()[static_cast<size_t>(index)];
    if (!joint.movable())
      throw StartError("parameter " + param + "/joint: joint '" + g.joint + "' is " +
                       jointKindName(joint.kind) +
                       ", but must be revolute, continuous or prismatic");
    for (const std::string &link : g.links)
      if (robot.findLink(link) < 0 && cloth_body_find(world->scene.get(), link.c_str()) < 0)
        noSuch(param + "/links", "link", link, robot.links());
    checkThresholds(g, param, joint, world);
  }
}

} // namespace

cloth_pose parkedPose(int link)
{
  cloth_pose p = cloth_pose_identity();
  // apart from each other, so that no broad phase ever sees a crowd
  p.position[0] = 20.0 * link;
  p.position[2] = -1000;
  return p;
}

int World::linkOfBody(int body) const
{
  for (const LinkBody &l : links)
    if (l.body == body) return l.link;
  return -1;
}

int World::bodyOfLink(int link) const
{
  for (const LinkBody &l : links)
    if (l.link == link) return l.body;
  return -1;
}

std::vector<std::string> World::clothNames() const
{
  std::vector<std::string> names;
  for (int i = 0; i < cloth_count(scene.get()); i++) names.push_back(cloth_name(scene.get(), i));
  return names;
}

int World::findCloth(const std::string &name, std::string *why) const
{
  if (name.empty() && cloth_count(scene.get()) == 1) return 0;
  const int index = name.empty() ? -1 : cloth_find(scene.get(), name.c_str());
  if (index < 0) {
    *why = name.empty() ? "name a cloth, there are several:"
                        : "there is no cloth '" + name + "'; there is:";
    for (const std::string &n : clothNames()) *why += " " + n;
  }
  return index;
}

std::unique_ptr<World> loadWorld(const Settings &s, const ros::NodeHandle &nh,
                                 const std::string &ns, bool on_cpu)
{
  auto world = std::make_unique<World>();
  cloth_error err = {};
  cloth_def *loaded = nullptr;
  if (cloth_def_load(s.scene_file.c_str(), &loaded, &err) != CLOTH_OK)
    throw StartError("parameter " + ns + "/scene: " + err.text);
  const DefPtr def(loaded);
  world->parameters = applyParams(s, ns, def.get());
  if (on_cpu && (cloth_def_set(def.get(), "backend", "cpu", &err) != CLOTH_OK ||
                 cloth_def_set(def.get(), "devices", "cpu", &err) != CLOTH_OK))
    throw StartError(err.text);
  world->time_step = cloth_def_params(def.get())->time_step;
  if (s.use_robot) {
    world->robot = readRobot(s, nh, ns);
    addLinks(s, def.get(), world.get());
    for (const ModelProblem &p : world->robot->problems()) {
      if (untilTfSpeaks(*world->robot, p))
        ROS_WARN_STREAM("robot model: " << p.text);
      else
        warn(world.get(), p.text);
    }
    ROS_INFO_STREAM("robot " << world->robot->name() << ": " << world->robot->links().size()
                             << " links, " << world->links.size() << " with collision geometry");
  }
  cloth_scene *scene = nullptr;
  if (cloth_scene_new(def.get(), &scene, &err) != CLOTH_OK)
    throw StartError("scene " + s.scene_file + ": " + err.text);
  world->scene.reset(scene);
  checkGrippers(s, ns, world.get());
  world->may_be_lost = std::string(cloth_backend_of(scene)) != "cpu" &&
                       std::string(cloth_backend_why(scene)) != "asked for"; // by backend: auto
  cloth_scene_hash_steps(scene, s.hash_steps);
  ROS_INFO_STREAM("backend " << cloth_backend_of(scene) << " (" << cloth_backend_why(scene) << ")");
  for (int i = 0; i < cloth_count(scene); i++)
    ROS_INFO_STREAM("cloth " << cloth_name(scene, i) << ": " << cloth_vertex_count(scene, i)
                             << " vertices, " << cloth_triangle_count(scene, i) << " triangles");
  for (int i = 0; i < cloth_effect_count(); i++) {
    cloth_effect_info info = {};
    if (cloth_effect_describe(scene, i, &info, &err) == CLOTH_OK)
      ROS_INFO_STREAM("effect " << effectText(info, 0));
  }
  return world;
}

std::string effectText(const cloth_effect_info &e, uint64_t steps)
{
  std::ostringstream line;
  line << e.name << ": " << (e.active ? "on" : "off") << ", " << e.why;
  if (!e.active) return line.str();
  line << ", " << e.memory_bytes << " B";
  if (steps > 0 && e.ms > 0)
    line << ", " << std::setprecision(3) << e.ms / static_cast<double>(steps) << " ms a step";
  return line.str();
}

} // namespace robot_cloth
