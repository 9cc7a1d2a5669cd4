#include "outputs.h"

#include "cloth_messages.h"
#include "markers.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace robot_cloth {
namespace {

constexpr size_t queue_max = 16; // snapshots; a publisher that is farther behind is too slow

// A name of ours as part of a topic: letters, digits and underscores.
std::string topicName(const std::string &name)
{
  std::string out = name;
  for (char &c : out)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_') c = '_';
  if (out.empty() || !std::isalpha(static_cast<unsigned char>(out[0]))) out = "_" + out;
  return out[0] == '_' ? "x" + out : out;
}

std::shared_ptr<const std::vector<ClothShape>> readShapes(const cloth_scene *scene)
{
  auto shapes = std::make_shared<std::vector<ClothShape>>();
  for (int c = 0; c < cloth_count(scene); c++) {
    ClothShape s;
    s.name = cloth_name(scene, c);
    const int *t = cloth_triangles(scene, c);
    s.triangles.assign(t, t + 3 * cloth_triangle_count(scene, c));
    const double *x = cloth_rest_positions(scene, c);
    s.rest_positions.assign(x, x + 3 * cloth_vertex_count(scene, c));
    for (int g = 0; g < cloth_group_count(scene, c); g++) {
      const cloth_group_view v = cloth_group(scene, c, g);
      s.groups.emplace_back(v.name, std::vector<int>(v.vertex, v.vertex + v.count));
    }
    shapes->push_back(std::move(s));
  }
  return shapes;
}

} // namespace

Outputs::Outputs(const ros::NodeHandle &priv, const Settings &settings)
    : nh_(priv), settings_(settings)
{
  state_ = nh_.advertise<State>("state", 100);
  events_ = nh_.advertise<Event>("events", 100, true);
  grasps_ = nh_.advertise<Grasps>("grasps", 10, true);
  markers_ = nh_.advertise<visualization_msgs::MarkerArray>("markers", 2);
  collision_markers_ = nh_.advertise<visualization_msgs::MarkerArray>("collision_markers", 1, true);
  if (settings.contacts) contacts_ = nh_.advertise<Contacts>("contacts", 2);
  thread_ = std::thread([this] { run(); });
}

Outputs::~Outputs()
{
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void Outputs::follow(const World &world)
{
  auto shapes = readShapes(world.scene.get());
  std::vector<ClothTopics> cloths;
  std_msgs::Header header;
  header.frame_id = settings_.world_frame;
  for (const ClothShape &s : *shapes) {
    const std::string name = topicName(s.name);
    ClothTopics t;
    t.vertices = nh_.advertise<sensor_msgs::PointCloud2>(name + "/vertices", 2);
    t.mesh = nh_.advertise<ClothMesh>(name + "/mesh", 2);
    t.topology = nh_.advertise<Topology>(name + "/topology", 1, true);
    t.topology.publish(topologyMessage(header, s));
    cloths.push_back(t);
  }
  {
    std::lock_guard<std::mutex> lock(topics_mutex_);
    cloths_.swap(cloths);
    shapes_ = shapes;
  }
  publishBodies(world);
}

void Outputs::publishBodies(const World &world)
{
  collision_markers_.publish(bodyMarkers(world, settings_.world_frame));
}

Outputs::Wanted Outputs::wanted()
{
  std::lock_guard<std::mutex> lock(topics_mutex_);
  Wanted w = {};
  const ros::WallTime now = ros::WallTime::now();
  if (now >= next_stream_)
    w.stream = std::any_of(cloths_.begin(), cloths_.end(), [](const ClothTopics &t) {
      return t.vertices.getNumSubscribers() + t.mesh.getNumSubscribers() > 0;
    });
  if (w.stream && settings_.vertices_rate > 0)
    next_stream_ = now + ros::WallDuration(1 / settings_.vertices_rate);
  w.markers = now >= next_markers_ && markers_.getNumSubscribers() > 0;
  if (w.markers) next_markers_ = now + ros::WallDuration(1 / settings_.marker_rate);
  w.velocities = w.stream && settings_.velocities;
  w.contacts = settings_.contacts && contacts_.getNumSubscribers() > 0;
  w.wrenches = std::any_of(wrenches_.begin(), wrenches_.end(),
                           [](const auto &p) { return p.second.getNumSubscribers() > 0; });
  return w;
}

void Outputs::post(std::unique_ptr<Snapshot> snapshot, bool wait)
{
  {
    std::unique_lock<std::mutex> lock(mutex_);
    if (wait) room_.wait(lock, [this] { return queue_.size() < queue_max; });
    if (queue_.size() == queue_max) {
      // a changed list of grasps is never lost: the next snapshot tells it too
      if (queue_.front()->grasps_changed) queue_[1]->grasps_changed = true;
      queue_.pop_front();
      dropped_++;
    }
    queue_.push_back(std::move(snapshot));
  }
  wake_.notify_one();
}

void Outputs::event(const Event &event) { events_.publish(event); }

void Outputs::run()
{
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stop_ || !queue_.empty(); });
    if (queue_.empty()) return; // stopped, and everything is out
    const std::unique_ptr<Snapshot> next = std::move(queue_.front());
    queue_.pop_front();
    room_.notify_one();
    lock.unlock();
    publish(*next);
    lock.lock();
  }
}

bool Outputs::finite(const ClothFrame &f)
{
  // a sum is finite only if every number is (and none is huge): one pass, no branches
  double sum = 0;
  for (double x : f.positions) sum += x;
  for (double v : f.velocities) sum += v;
  if (std::isfinite(sum)) return true;
  not_finite_++;
  return false;
}

void Outputs::publish(const Snapshot &s)
{
  std::vector<ClothTopics> topics;
  {
    std::lock_guard<std::mutex> lock(topics_mutex_);
    topics = cloths_;
  }
  for (const ClothFrame &f : s.cloths)
    if (!finite(f)) return; // RViz and planners die of NaN; /diagnostics tells
  state_.publish(s.state);
  for (size_t c = 0; c < s.cloths.size() && c < topics.size(); c++)
    if (s.stream) publishCloth(s, c, topics[c]);
  if (s.markers) {
    visualization_msgs::MarkerArray m = clothMarkers(s);
    if (marked_cloths_ > s.cloths.size())
      m.markers.emplace(m.markers.begin())->action = visualization_msgs::Marker::DELETEALL;
    marked_cloths_ = s.cloths.size();
    markers_.publish(m);
  }
  publishGrasps(s);
  if (s.contacts) contacts_.publish(*s.contacts);
}

void Outputs::publishCloth(const Snapshot &s, size_t c, const ClothTopics &topics)
{
  const ClothShape &shape = (*s.shapes)[c];
  if (topics.vertices.getNumSubscribers() > 0)
    topics.vertices.publish(cloudMessage(s.state.header, shape, s.cloths[c], settings_));
  if (topics.mesh.getNumSubscribers() > 0)
    topics.mesh.publish(meshMessage(s.state.header, shape, s.cloths[c]));
}

void Outputs::publishGrasps(const Snapshot &s)
{
  std::lock_guard<std::mutex> lock(topics_mutex_);
  if (s.grasps_changed) {
    grasps_.publish(s.grasps);
    std::map<std::string, ros::Publisher> keep;
    for (const GraspState &g : s.grasps.grasps) {
      ros::Publisher &p = keep[g.id];
      auto old = wrenches_.find(g.id);
      if (old != wrenches_.end())
        p = old->second;
      else
        p = nh_.advertise<geometry_msgs::WrenchStamped>("grasps/" + topicName(g.id) + "/wrench",
                                                        10);
    }
    wrenches_.swap(keep);
  }
  for (size_t i = 0; i < s.wrenches.size() && i < s.grasps.grasps.size(); i++) {
    auto p = wrenches_.find(s.grasps.grasps[i].id);
    if (p == wrenches_.end()) continue;
    geometry_msgs::WrenchStamped w = s.wrenches[i];
    w.header.stamp = s.state.header.stamp;
    w.header.seq = 0;
    p->second.publish(w);
  }
}

} // namespace robot_cloth
