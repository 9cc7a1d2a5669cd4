#include "world.h"

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
      world->problems.push_back(p.link_or_joint + ": " + p.text);
      ROS_WARN_STREAM("robot model: " << world->problems.back());
    }
    ROS_INFO_STREAM("robot " << world->robot->name() << ": " << world->robot->links().size()
                             << " links, " << world->links.size() << " with collision geometry");
  }
  cloth_scene *scene = nullptr;
  if (cloth_scene_new(def.get(), &scene, &err) != CLOTH_OK)
    throw StartError("scene " + s.scene_file + ": " + err.text);
  world->scene.reset(scene);
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
