#include "services.h"

#include "nearest.h"

#include <cmath>
#include <ros/init.h>

namespace robot_cloth {
namespace {

constexpr uint32_t steps_max = 1000000; // of one request; hours

template <class Response> bool answer(const Answer &a, Response &response)
{
  response.success = a.success;
  response.message = a.message;
  return true; // a false would hide the message from the caller
}

} // namespace

Services::Services(ros::NodeHandle nh, Simulation &simulation, const std::atomic<bool> &stop)
    : simulation_(simulation), stop_(stop)
{
  servers_.push_back(nh.advertiseService("pause", &Services::pause, this));
  servers_.push_back(nh.advertiseService("reset", &Services::reset, this));
  servers_.push_back(nh.advertiseService("step", &Services::step, this));
  servers_.push_back(nh.advertiseService("grasp", &Services::grasp, this));
  servers_.push_back(nh.advertiseService("release", &Services::release, this));
  servers_.push_back(nh.advertiseService("save_state", &Services::saveState, this));
  servers_.push_back(nh.advertiseService("load_state", &Services::loadState, this));
  servers_.push_back(nh.advertiseService("get_state", &Services::getState, this));
  servers_.push_back(nh.advertiseService("set_state", &Services::setState, this));
  servers_.push_back(nh.advertiseService("reload_model", &Services::reloadModel, this));
  servers_.push_back(nh.advertiseService("set_obstacle", &Services::setObstacle, this));
  servers_.push_back(nh.advertiseService("get_info", &Services::getInfo, this));
}

bool Services::pause(std_srvs::SetBoolRequest &request, std_srvs::SetBoolResponse &response)
{
  return answer(simulation_.pause(request.data, "asked to"), response);
}

bool Services::reset(std_srvs::TriggerRequest &, std_srvs::TriggerResponse &response)
{
  return answer(simulation_.reset("asked to"), response);
}

// ---- lockstep
// -------------------------------------------------------------------------------------

// The joints of a request are where the robot is at the end of the steps; it starts where it is.
bool Services::takeStepInputs(const StepRequest &r, std::string *why)
{
  JointHistory &joints = simulation_.motion().joints;
  const sensor_msgs::JointState &js = r.joints;
  const RobotModel *robot = simulation_.world().robot.get();
  if (js.name.size() != js.position.size()) {
    *why = "joints: " + std::to_string(js.name.size()) + " names but " +
           std::to_string(js.position.size()) + " positions";
    return false;
  }
  if (!js.name.empty() && r.steps == 0) {
    *why = "joints are reached at the end of the steps, but steps is 0";
    return false;
  }
  for (size_t i = 0; i < js.name.size(); i++) {
    if (!std::isfinite(js.position[i])) {
      *why = "joints: " + js.name[i] + " is not finite";
      return false;
    }
    if (robot && robot->findJoint(js.name[i]) >= 0) continue;
    const char *best = nullptr;
    if (robot)
      for (const Joint &j : robot->joints())
        cloth_nearest(js.name[i].c_str(), j.name.c_str(), &best);
    *why = "joints: the robot has no joint '" + js.name[i] + "'" +
           (best ? string("; did you mean ") + best + "?" : "");
    return false;
  }
  if (!simulation_.motion().setFrames(r.frames, why)) return false;
  const double now = simulation_.time();
  const double end = now + r.steps * simulation_.world().time_step;
  for (size_t i = 0; i < js.name.size(); i++) {
    double at = 0;
    if (joints.at(js.name[i], now, &at)) joints.set(js.name[i], now, at);
    joints.set(js.name[i], end, js.position[i]);
  }
  return true;
}

bool Services::step(StepRequest &request, StepResponse &response)
{
  Simulation &s = simulation_;
  response.success = true;
  std::string why;
  if (!s.clock().lockstep())
    why = "time/mode is " + s.settings().time_mode + ", ~step needs step: set " +
          "~time/mode to step and restart";
  else if (s.finished())
    why = "the run is over";
  else if (request.steps > steps_max)
    why = "steps is " + std::to_string(request.steps) + ", at most 1000000 at once";
  else if (s.paused())
    why = "paused: call ~pause with false first";
  response.success = why.empty() && takeStepInputs(request, &why);
  for (uint32_t i = 0; response.success && i < request.steps; i++) {
    if (stop_ || !ros::ok()) why = "shutting down";
    response.success = why.empty() && s.step(s.time() + s.world().time_step, true, &why);
    if (response.success) response.steps_done++;
    s.tend();
  }
  cloth_error err = {};
  uint64_t hash = 0;
  if (!s.lost() && cloth_state_hash(s.scene(), &hash, &err) == CLOTH_OK) response.state_hash = hash;
  response.step = s.health().report.step;
  response.time = s.time();
  response.message = !response.success ? why
                     : s.world().robot && !s.motion().robotKnown()
                         ? "done, but the robot is not in the scene: " + s.motion().waitingFor()
                     : !s.motion().heldWhy().empty()
                         ? "done, but the robot is held: " + s.motion().heldWhy()
                         : "done";
  return true;
}

// ---- grasps
// ---------------------------------------------------------------------------------------

bool Services::grasp(GraspRequest &request, GraspResponse &response)
{
  response = simulation_.grasping().grasp(request);
  simulation_.touch();
  return true;
}

bool Services::release(ReleaseRequest &request, ReleaseResponse &response)
{
  response = simulation_.grasping().release(request.id, request.frame_id);
  simulation_.touch();
  return true;
}

void Services::command(const GraspCommand &c)
{
  simulation_.touch();
  if (c.command == GraspCommand::RELEASE) {
    simulation_.grasping().release(c.id, c.frame_id);
    return;
  }
  if (c.command != GraspCommand::GRASP) {
    simulation_.event("grasp_failed", c.id,
                      "command is " + std::to_string(c.command) + ", but must be GRASP or RELEASE");
    return;
  }
  GraspRequest r;
  r.id = c.id, r.cloth = c.cloth, r.frame_id = c.frame_id, r.how = c.how,
  r.region_frame = c.region_frame;
  r.region = c.region, r.size = c.size, r.radius = c.radius, r.ids = c.ids, r.group = c.group,
  r.limit = c.limit;
  r.compliance = c.compliance, r.break_force = c.break_force, r.ignore_links = c.ignore_links;
  simulation_.grasping().grasp(r);
}

// ---- states
// ---------------------------------------------------------------------------------------

bool Services::saveState(SaveStateRequest &request, SaveStateResponse &response)
{
  return answer(simulation_.saveState(request.name, &response.path), response);
}

bool Services::loadState(LoadStateRequest &request, LoadStateResponse &response)
{
  return answer(simulation_.loadState(request.name), response);
}

bool Services::getState(GetStateRequest &request, GetStateResponse &response)
{
  Simulation &s = simulation_;
  const int c = s.world().findCloth(request.cloth, &response.message);
  if (c < 0) return true;
  const int n = cloth_vertex_count(s.scene(), c);
  cloth_error err = {};
  response.cloth = cloth_name(s.scene(), c);
  response.header.stamp = s.stamp();
  response.header.frame_id = s.settings().world_frame;
  response.positions.resize(3 * static_cast<size_t>(n));
  response.held.resize(static_cast<size_t>(n));
  if (request.velocities) response.velocities.resize(3 * static_cast<size_t>(n));
  response.success =
      cloth_positions(s.scene(), c, response.positions.data(), n, &err) == CLOTH_OK &&
      cloth_held(s.scene(), c, response.held.data(), n, &err) == CLOTH_OK &&
      (!request.velocities ||
       cloth_velocities(s.scene(), c, response.velocities.data(), n, &err) == CLOTH_OK) &&
      cloth_state_hash(s.scene(), &response.state_hash, &err) == CLOTH_OK;
  response.message = response.success ? std::to_string(n) + " vertices" : err.text;
  return true;
}

bool Services::setState(SetStateRequest &request, SetStateResponse &response)
{
  Simulation &s = simulation_;
  const int c = s.world().findCloth(request.cloth, &response.message);
  if (c < 0) return true;
  const int n = cloth_vertex_count(s.scene(), c);
  const size_t needed = 3 * static_cast<size_t>(n);
  for (const std::vector<double> *v : {&request.positions, &request.velocities})
    if (!v->empty() && v->size() != needed) {
      response.message = std::string(v == &request.positions ? "positions" : "velocities") +
                         " has " + std::to_string(v->size()) + " numbers, but must have 3 x " +
                         std::to_string(n);
      return true;
    }
  cloth_error err = {};
  response.success =
      cloth_state_set(s.scene(), c, request.positions.empty() ? nullptr : request.positions.data(),
                      request.velocities.empty() ? nullptr : request.velocities.data(), n,
                      &err) == CLOTH_OK;
  response.message = response.success ? "set" : err.text;
  if (response.success) s.changed("set", std::string("vertices of ") + cloth_name(s.scene(), c));
  return true;
}

bool Services::reloadModel(std_srvs::TriggerRequest &, std_srvs::TriggerResponse &response)
{
  return answer(simulation_.reload(), response);
}

bool Services::setObstacle(SetObstacleRequest &r, SetObstacleResponse &response)
{
  return answer(simulation_.setObstacle(r.body, r.frame_id, r.pose, r.place), response);
}

bool Services::getInfo(GetInfoRequest &, GetInfoResponse &response)
{
  const World &world = simulation_.world();
  const cloth_scene *scene = world.scene.get();
  response.scene_file = simulation_.settings().scene_file;
  response.world_frame = simulation_.settings().world_frame;
  response.mode = simulation_.settings().time_mode;
  response.cloths = world.clothNames();
  for (int c = 0; c < cloth_count(scene); c++) {
    response.vertex_counts.push_back(static_cast<uint32_t>(cloth_vertex_count(scene, c)));
    response.triangle_counts.push_back(static_cast<uint32_t>(cloth_triangle_count(scene, c)));
  }
  for (int b = 0; b < cloth_body_count(scene); b++) {
    response.bodies.push_back(cloth_body_name(scene, b));
    if (world.linkOfBody(b) >= 0) response.links.push_back(cloth_body_name(scene, b));
  }
  for (int e = 0; e < cloth_effect_count(); e++) {
    cloth_effect_info info = {};
    if (cloth_effect_describe(scene, e, &info, nullptr) != CLOTH_OK) continue;
    response.effects.push_back(effectText(info, simulation_.stepsTaken()));
  }
  response.parameters = world.parameters;
  if (world.robot)
    for (const Link &l : world.robot->links()) response.frames.push_back(l.name);
  response.success = true;
  response.message = std::to_string(response.cloths.size()) + " cloths, " +
                     std::to_string(response.bodies.size()) + " bodies";
  return true;
}

} // namespace robot_cloth
