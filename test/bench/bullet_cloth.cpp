// Bullet's soft body on the scenes of our bench, for orientation: a sheet of 51 x 51 vertices, 0.5
// m wide, 0.3 kg/m^2, steps of 1/60 s; hanging by two corners, or falling on a box; with and
// without self-collision. Bullet uses one thread. Its springs have no unit that compares with a
// fabric's stiffness; the worst stretch says how stiff the sheet was in the end.
//
//   bullet_cloth [--steps N] [--warmup N] [--repeat R] [--iterations N] [--clusters N]
//                [--stiffness N] [--csv FILE]
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <algorithm>
#include <btBulletDynamicsCommon.h>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

namespace {

constexpr int kSide = 51;          // vertices along an edge
constexpr double kLength = 0.5;    // m
constexpr double kDensity = 0.3;   // kg/m^2
constexpr double kMargin = 3e-3;   // m, the thickness of our contact
constexpr double kStep = 1.0 / 60; // s

struct Options {
  int steps = 120, warmup = 60, repeat = 5;
  int iterations = 20; // position iterations; with Bullet's default of 1 the sheet flows away
  int clusters = 0;    // what Bullet's self-collision works on; 0: every triangle is one
  const char *csv = nullptr;
};

enum class Scene { kHanging, kTable };

/// A world with its sheet.
class World {
public:
  World(Scene scene, bool self_collision, const Options &options)
      : dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &constraint_solver_, &configuration_),
        info_(&world_.getWorldInfo())
  {
    world_.setGravity(btVector3(0, 0, btScalar(-9.81)));
    info_->m_gravity = world_.getGravity();
    info_->air_density = 0;
    info_->m_broadphase = &broadphase_;
    info_->m_dispatcher = &dispatcher_;
    info_->m_sparsesdf.Initialize();
    if (scene == Scene::kTable) add_table();
    add_sheet(scene, self_collision, options);
  }

  ~World()
  {
    world_.removeSoftBody(sheet_.get());
    if (table_) world_.removeRigidBody(table_.get());
  }

  void step() { world_.stepSimulation(btScalar(kStep), 0); }

  // larger principal stretch of the triangles, minus 1: the worst, which our report calls
  // stretch_max, and the mean
  void stretch(double *worst, double *mean) const
  {
    *worst = *mean = 0;
    for (int t = 0; t < sheet_->m_faces.size(); t++) {
      const btSoftBody::Face &f = sheet_->m_faces[t];
      long i0 = f.m_n[0] - &sheet_->m_nodes[0], i1 = f.m_n[1] - &sheet_->m_nodes[0],
           i2 = f.m_n[2] - &sheet_->m_nodes[0];
      double one = stretch_of(rest_[size_t(i0)], rest_[size_t(i1)], rest_[size_t(i2)],
                              f.m_n[0]->m_x, f.m_n[1]->m_x, f.m_n[2]->m_x);
      *worst = std::max(*worst, one);
      *mean += one / sheet_->m_faces.size();
    }
  }

private:
  // columns of F = [x1-x0, x2-x0] [X1-X0, X2-X0]^-1 in the plane; its larger singular value
  static double stretch_of(const btVector3 &r0, const btVector3 &r1, const btVector3 &r2,
                           const btVector3 &x0, const btVector3 &x1, const btVector3 &x2)
  {
    btVector3 a = r1 - r0, b = r2 - r0, u = x1 - x0, v = x2 - x0;
    double det = double(a.x()) * b.y() - double(a.y()) * b.x();
    double c[2][3];
    for (int k = 0; k < 3; k++) {
      c[0][k] = (u[k] * b.y() - v[k] * a.y()) / det;
      c[1][k] = (v[k] * a.x() - u[k] * b.x()) / det;
    }
    double xx = 0, xy = 0, yy = 0;
    for (int k = 0; k < 3; k++)
      xx += c[0][k] * c[0][k], xy += c[0][k] * c[1][k], yy += c[1][k] * c[1][k];
    return std::sqrt((xx + yy) / 2 + std::sqrt((xx - yy) * (xx - yy) / 4 + xy * xy)) - 1;
  }

  void add_table()
  {
    box_ = std::make_unique<btBoxShape>(btVector3(btScalar(.15), btScalar(.15), btScalar(.05)));
    table_ = std::make_unique<btRigidBody>(0, nullptr, box_.get());
    table_->getWorldTransform().setOrigin(btVector3(0, 0, btScalar(-.05)));
    table_->setFriction(btScalar(.3));
    world_.addRigidBody(table_.get());
  }

  void add_sheet(Scene scene, bool self_collision, const Options &options)
  {
    btScalar r = btScalar(kLength / 2), z = btScalar(.05);
    int pins = scene == Scene::kHanging ? 1 + 2 : 0; // corner00 and corner10
    sheet_.reset(btSoftBodyHelpers::CreatePatch(*info_, btVector3(-r, -r, z), btVector3(r, -r, z),
                                                btVector3(-r, r, z), btVector3(r, r, z), kSide,
                                                kSide, pins, true));
    for (int i = 0; i < sheet_->m_nodes.size(); i++) rest_.push_back(sheet_->m_nodes[i].m_x);
    sheet_->m_materials[0]->m_kLST = 1; // as stiff as it gets
    sheet_->generateBendingConstraints(2, sheet_->m_materials[0]);
    sheet_->getCollisionShape()->setMargin(btScalar(kMargin));
    sheet_->setTotalMass(btScalar(kDensity * kLength * kLength), false);
    if (scene == Scene::kHanging) { // setTotalMass gave the pinned corners a mass
      sheet_->setMass(0, 0);
      sheet_->setMass(kSide - 1, 0);
    }
    sheet_->m_cfg.kDF = btScalar(.3);
    sheet_->m_cfg.piterations = options.iterations;
    if (self_collision) {
      sheet_->generateClusters(options.clusters);
      sheet_->m_cfg.collisions = btSoftBody::fCollision::SDF_RS | btSoftBody::fCollision::CL_SS |
                                 btSoftBody::fCollision::CL_SELF;
    }
    world_.addSoftBody(sheet_.get());
  }

  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver constraint_solver_;
  btSoftRigidDynamicsWorld world_;
  btSoftBodyWorldInfo *info_;
  std::unique_ptr<btBoxShape> box_;
  std::unique_ptr<btRigidBody> table_;
  std::unique_ptr<btSoftBody> sheet_;
  std::vector<btVector3> rest_;
};

// Every repeat builds the same world and steps it the same way; Bullet cannot save a state.
void time_case(const char *name, Scene scene, bool self_collision, const Options &o, FILE *csv)
{
  std::vector<double> ms;
  double stretch = 0, stretch_mean = 0;
  for (int repeat = 0; repeat < o.repeat; repeat++) {
    World world(scene, self_collision, o);
    for (int i = 0; i < o.warmup; i++) world.step();
    double sum = 0;
    for (int i = 0; i < o.steps; i++) {
      auto start = std::chrono::steady_clock::now();
      world.step();
      sum += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
                 .count();
      if (repeat == 0) {
        double worst, mean;
        world.stretch(&worst, &mean);
        stretch = std::max(stretch, worst);
        stretch_mean = std::max(stretch_mean, mean);
      }
    }
    ms.push_back(sum / o.steps);
  }
  std::sort(ms.begin(), ms.end());
  double median = (ms[(ms.size() - 1) / 2] + ms[ms.size() / 2]) / 2;
  std::printf(
      "  %-14s median %7.3f ms a step, min %7.3f, max %7.3f; stretch: worst triangle %.1f %%, "
      "mean %.1f %%\n",
      name, median, ms.front(), ms.back(), 100 * stretch, 100 * stretch_mean);
  if (csv)
    std::fprintf(csv, "bullet_%s,%d,%d,%d,%.4f,%.4f,%.4f,%d,%.5f,%.5f\n", name, o.warmup, o.steps,
                 o.repeat, median, ms.front(), ms.back(), kSide * kSide, stretch, stretch_mean);
}

bool parse(int argc, char **argv, Options *o)
{
  struct {
    const char *name;
    int *value;
  } numbers[] = {{"--steps", &o->steps},
                 {"--warmup", &o->warmup},
                 {"--repeat", &o->repeat},
                 {"--iterations", &o->iterations},
                 {"--clusters", &o->clusters}};
  for (int i = 1; i < argc; i += 2) {
    if (i + 1 == argc) return false;
    bool known = false;
    for (const auto &n : numbers)
      if (std::strcmp(argv[i], n.name) == 0) {
        char *end;
        long value = std::strtol(argv[i + 1], &end, 10);
        if (*end != '\0' || value < (n.value == &o->iterations || n.value == &o->repeat ? 1 : 0) ||
            value > 1000000)
          return false;
        *n.value = int(value);
        known = true;
      }
    if (std::strcmp(argv[i], "--csv") == 0) o->csv = argv[i + 1], known = true;
    if (!known) return false;
  }
  return true;
}

} // namespace

int main(int argc, char **argv)
{
  Options o;
  if (!parse(argc, argv, &o)) {
    std::fprintf(stderr, "usage: bullet_cloth [--steps N] [--warmup N] [--repeat R] "
                         "[--iterations N] [--clusters N] [--csv FILE]\n");
    return 2;
  }
  FILE *csv = o.csv ? std::fopen(o.csv, "w") : nullptr;
  if (o.csv && !csv) {
    std::fprintf(stderr, "bullet_cloth: cannot write %s\n", o.csv);
    return 2;
  }
  if (csv)
    std::fprintf(csv, "scene,warmup,steps,repeats,median_ms,min_ms,max_ms,vertices,"
                      "stretch_max,stretch_mean\n");
  std::printf("Bullet %d.%02d soft body, %d vertices, one thread, %d iterations, %d steps of "
              "1/60 s x %d after %d\n",
              BT_BULLET_VERSION / 100, BT_BULLET_VERSION % 100, kSide * kSide, o.iterations,
              o.steps, o.repeat, o.warmup);
  time_case("hanging", Scene::kHanging, false, o, csv);
  time_case("hanging_self", Scene::kHanging, true, o, csv);
  time_case("table", Scene::kTable, false, o, csv);
  time_case("table_self", Scene::kTable, true, o, csv);
  if (csv && std::fclose(csv) != 0) return 1;
  return 0;
}
