#include "cloth_node.h"

#include <ros/console.h>
#include <ros/init.h>
#include <ros/this_node.h>

namespace robot_cloth {
namespace {

// How long the simulation thread waits for a service call when no step is due.
const ros::WallDuration idle_wait(0.002);

} // namespace

ClothNode::ClothNode(const ros::NodeHandle &nh, const ros::NodeHandle &priv)
    : nh_(nh), priv_(priv), settings_(readSettings(priv)), tf_listener_(tf_)
{
  if (settings_.time_mode == "joint_states")
    throw StartError(
        "parameter " + priv.getNamespace() +
        "/time/mode is joint_states, which this version does not have "
        "yet: use clock for a live robot or a bag, step for lockstep, wall without ROS time");
  std::unique_ptr<World> world = loadWorld(settings_, priv_, priv_.getNamespace());
  outputs_ = std::make_unique<Outputs>(priv_, settings_);
  checker_ = std::make_unique<CrossChecker>(priv_, settings_);
  simulation_ = std::make_unique<Simulation>(settings_, priv_, &tf_, std::move(world),
                                             outputs_.get(), checker_.get());
}

ClothNode::~ClothNode() { stop(); }

void ClothNode::start()
{
  ros::NodeHandle control(priv_);
  control.setCallbackQueue(&control_queue_);
  services_ = std::make_unique<Services>(control, *simulation_, stop_);
  nh_.setCallbackQueue(&io_queue_);
  priv_.setCallbackQueue(&io_queue_);
  const auto no_delay = ros::TransportHints().tcpNoDelay();
  if (!simulation_->clock()
           .lockstep()) // in lockstep the request brings the joints: no topic may race with it
    joints_ = nh_.subscribe<sensor_msgs::JointState>(
        "joint_states", 1000,
        [this](const sensor_msgs::JointState::ConstPtr &m) { mailbox_.put(ReceivedJoints{m}); },
        ros::VoidConstPtr(), no_delay);
  commands_ = priv_.subscribe<GraspCommand>(
      "grasp_command", 1000, [this](const GraspCommand::ConstPtr &m) { mailbox_.put(m); },
      ros::VoidConstPtr(), no_delay);
  diagnostics_ = nh_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 2);
  diagnostics_timer_ =
      nh_.createWallTimer(ros::WallDuration(1), [this](const ros::WallTimerEvent &) {
        std::lock_guard<std::mutex> lock(health_mutex_);
        const double since = last_turn_.isZero() ? 0 : (ros::WallTime::now() - last_turn_).toSec();
        diagnostics_.publish(
            diagnose(health_, checker_->totals(), *outputs_, since, ros::this_node::getName()));
      });
  io_spinner_ = std::make_unique<ros::AsyncSpinner>(1, &io_queue_);
  io_spinner_->start();
  thread_ = std::thread([this] { run(); });
}

void ClothNode::stop()
{
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  if (io_spinner_) io_spinner_->stop();
  services_.reset();
}

void ClothNode::readMail()
{
  for (const Mail &mail : mailbox_.take()) {
    if (const auto *joints = std::get_if<ReceivedJoints>(&mail)) {
      Clock &clock = simulation_->clock();
      if (clock.now() > 0)
        simulation_->motion().joints.add(*joints->message, clock.now(),
                                         settings_.time_mode == "wall");
    } else
      services_->command(*std::get<GraspCommand::ConstPtr>(mail));
  }
}

void ClothNode::remember()
{
  Health h = simulation_->health();
  h.mailbox_lost = mailbox_.lost();
  std::lock_guard<std::mutex> lock(health_mutex_);
  health_ = std::move(h);
  last_turn_ = ros::WallTime::now();
}

void ClothNode::run()
{
  bool busy = false;
  while (!stop_ && ros::ok()) {
    control_queue_.callAvailable(busy ? ros::WallDuration() : idle_wait);
    readMail();
    busy = !simulation_->finished() && simulation_->turn();
    if (!simulation_->lost()) simulation_->tend();
    remember();
    if (simulation_->finished() && !finished_) {
      std::lock_guard<std::mutex> lock(health_mutex_);
      summary_ = simulation_->summary();
      failed_ = simulation_->lost();
      finished_ = true;
    }
  }
  std::lock_guard<std::mutex> lock(health_mutex_);
  summary_ = simulation_->summary();
}

std::string ClothNode::summary() const
{
  std::lock_guard<std::mutex> lock(health_mutex_);
  return summary_;
}

} // namespace robot_cloth
