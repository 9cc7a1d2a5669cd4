// The services of the node: they look at the request, ask the simulation, and say what came of it.
// Served by the simulation thread between steps, so they answer while paused and never race with a
// step.
#pragma once

#include "simulation.h"

#include <atomic>
#include <robot_cloth/GetInfo.h>
#include <robot_cloth/GetState.h>
#include <robot_cloth/Grasp.h>
#include <robot_cloth/GraspCommand.h>
#include <robot_cloth/LoadState.h>
#include <robot_cloth/Release.h>
#include <robot_cloth/SaveState.h>
#include <robot_cloth/SetObstacle.h>
#include <robot_cloth/SetState.h>
#include <robot_cloth/Step.h>
#include <ros/service_server.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <vector>

namespace robot_cloth {

class Services {
public:
  /// `nh` is private and has the callback queue that the simulation thread serves; `stop` ends a
  /// long ~step.
  Services(ros::NodeHandle nh, Simulation &simulation, const std::atomic<bool> &stop);

  /// The same as ~grasp and ~release, from a topic.
  void command(const GraspCommand &command);

private:
  bool pause(std_srvs::SetBoolRequest &request, std_srvs::SetBoolResponse &response);
  bool reset(std_srvs::TriggerRequest &request, std_srvs::TriggerResponse &response);
  bool step(StepRequest &request, StepResponse &response);
  bool grasp(GraspRequest &request, GraspResponse &response);
  bool release(ReleaseRequest &request, ReleaseResponse &response);
  bool saveState(SaveStateRequest &request, SaveStateResponse &response);
  bool loadState(LoadStateRequest &request, LoadStateResponse &response);
  bool getState(GetStateRequest &request, GetStateResponse &response);
  bool setState(SetStateRequest &request, SetStateResponse &response);
  bool reloadModel(std_srvs::TriggerRequest &request, std_srvs::TriggerResponse &response);
  bool setObstacle(SetObstacleRequest &request, SetObstacleResponse &response);
  bool getInfo(GetInfoRequest &request, GetInfoResponse &response);

  bool takeStepInputs(const StepRequest &request, std::string *why);

  Simulation &simulation_;
  const std::atomic<bool> &stop_;
  std::vector<ros::ServiceServer> servers_;
};

} // namespace robot_cloth
