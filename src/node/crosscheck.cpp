#include "crosscheck.h"

#include "pose.h"

#include <algorithm>
#include <chrono>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/node_handle.h>
#include <sstream>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace robot_cloth {

cloth_status freezeScene(cloth_scene *scene, double margin, FrozenScene *out, cloth_error *err)
{
  out->margin = margin;
  double size = 1; // m, of the coordinates involved: float carries 7 digits of them
  for (int c = 0; c < cloth_count(scene); c++) {
    std::vector<double> x(3 * static_cast<size_t>(cloth_vertex_count(scene, c)));
    CLOTH_TRY(cloth_positions(scene, c, x.data(), cloth_vertex_count(scene, c), err));
    for (double v : x) size = std::max(size, std::fabs(v));
    out->positions.push_back(std::move(x));
    out->cloth_names.push_back(cloth_name(scene, c));
  }
  out->epsilon = 1e-6 * size;
  for (int b = 0; b < cloth_body_count(scene); b++) {
    out->bodies.push_back(cloth_body_pose(scene, b));
    out->body_names.push_back(cloth_body_name(scene, b));
  }
  int count = 4096;
  do {
    out->pairs.resize(static_cast<size_t>(count));
    CLOTH_TRY(cloth_body_pairs(scene, margin, out->pairs.data(),
                               static_cast<int>(out->pairs.size()), &count, err));
  } while (count > static_cast<int>(out->pairs.size()));
  out->pairs.resize(static_cast<size_t>(count));
  return CLOTH_OK;
}

CrossChecker::CrossChecker(const ros::NodeHandle &priv, const Settings &settings)
    : settings_(settings)
{
  ros::NodeHandle nh(priv);
  nh.setCallbackQueue(&queue_);
  publisher_ = nh.advertise<CrossCheck>("crosscheck", 10, true);
  service_ = nh.advertiseService("crosscheck", &CrossChecker::onRequest, this);
  thread_ = std::thread([this] { run(); });
}

CrossChecker::~CrossChecker()
{
  stop_ = true;
  arrived_.notify_all();
  thread_.join();
}

void CrossChecker::submit(std::unique_ptr<FrozenScene> scene)
{
  {
    std::lock_guard<std::mutex> lock(mutex_);
    scene_ = std::move(scene);
    idle_ = false;
    requested_ = 0;
  }
  arrived_.notify_all();
}

void CrossChecker::refuse(const std::string &why)
{
  {
    std::lock_guard<std::mutex> lock(mutex_);
    refused_ = why;
    requested_ = 0;
  }
  arrived_.notify_all();
}

CrossChecker::Totals CrossChecker::totals() const
{
  std::lock_guard<std::mutex> lock(mutex_);
  return totals_;
}

void CrossChecker::run()
{
  // the simulation must never wait for this thread
  setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), 10);
  while (!stop_) {
    queue_.callAvailable(ros::WallDuration(0.02));
    std::unique_ptr<FrozenScene> scene;
    {
      std::lock_guard<std::mutex> lock(mutex_);
      scene.swap(scene_);
    }
    if (scene) check(*scene);
    idle_ = true;
  }
}

CrossCheck CrossChecker::check(FrozenScene &s)
{
  const auto start = std::chrono::steady_clock::now();
  CrossCheck m;
  m.header = s.header;
  m.step = s.step;
  m.margin = s.margin;
  for (size_t b = 0; b < s.bodies.size(); b++)
    s.fcl->moveBody(static_cast<int>(b), toPose(s.bodies[b]));
  for (size_t c = 0; c < s.positions.size(); c++)
    s.fcl->moveCloth(static_cast<int>(c), s.positions[c].data(),
                     static_cast<int>(s.positions[c].size() / 3));
  const auto result =
      s.fcl->compare(s.margin, s.epsilon, s.pairs.data(), static_cast<int>(s.pairs.size()));
  const Intersections crossing = s.fcl->intersections();
  m.truth = static_cast<uint64_t>(result.truth);
  m.ours = static_cast<uint64_t>(result.candidates);
  m.missed = static_cast<uint64_t>(result.missed_count);
  m.degenerate = static_cast<uint64_t>(result.degenerate);
  m.ratio = result.ratio;
  m.intersecting_body = static_cast<uint64_t>(crossing.cloth_body);
  m.intersecting_self = static_cast<uint64_t>(crossing.cloth_cloth);
  for (const MissedPair &p : result.missed) {
    std::ostringstream text;
    text << s.body_names[static_cast<size_t>(p.pair.body)] << ":" << p.pair.body_triangle << " "
         << s.cloth_names[static_cast<size_t>(p.pair.cloth)] << ":" << p.pair.cloth_triangle << " "
         << p.distance << " m";
    m.missed_pairs.push_back(text.str());
  }
  m.wall_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  if (m.missed > 0)
    ROS_ERROR_STREAM("cross-check at step " << m.step << ": the broad phase missed " << m.missed
                                            << " pairs, first " << m.missed_pairs.front());
  {
    std::lock_guard<std::mutex> lock(mutex_);
    totals_.checks++;
    totals_.missed += m.missed;
    totals_.intersecting_body += m.intersecting_body;
    totals_.intersecting_self += m.intersecting_self;
    totals_.ratio = m.ratio;
  }
  publisher_.publish(m);
  return m;
}

bool CrossChecker::onRequest(RunCrossCheckRequest &request, RunCrossCheckResponse &response)
{
  const double margin = request.margin == 0 ? settings_.crosscheck_margin : request.margin;
  if (!(margin > 0 && margin <= 0.1)) {
    response.message =
        "margin is " + std::to_string(request.margin) + " m, but must be in [0, 0.1] m";
    return true;
  }
  std::unique_ptr<FrozenScene> scene;
  {
    std::unique_lock<std::mutex> lock(mutex_);
    refused_.clear();
    scene_.reset(); // a periodic one that is waiting is older than what is asked for
    requested_ = margin;
    const auto there = [&] { return scene_ || !refused_.empty() || stop_ || !ros::ok(); };
    for (int i = 0; i < 600 && !there(); i++)
      arrived_.wait_for(lock, std::chrono::milliseconds(50), there);
    requested_ = 0;
    scene.swap(scene_);
    if (!scene)
      response.message = refused_.empty() ? "the simulation did not answer within 30 s" : refused_;
  }
  if (!scene) return true;
  response.result = check(*scene);
  response.success = response.result.missed == 0;
  response.message =
      std::to_string(response.result.truth) + " pairs within " + std::to_string(margin) + " m, " +
      std::to_string(response.result.missed) + " missed, " +
      std::to_string(response.result.intersecting_body + response.result.intersecting_self) +
      " intersecting";
  return true;
}

} // namespace robot_cloth
