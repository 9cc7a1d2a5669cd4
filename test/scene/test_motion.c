// Tests of src/scene/motion.c.
#include "check.h"
#include "scene/def.h"

static const double PI = 3.14159265358979323846;

static cloth_pose about_z(double x, double angle)
{
  cloth_pose p = {{x, 0, 0}, {0, 0, sin(angle / 2), cos(angle / 2)}};
  return p;
}

static double angle_about_z(const cloth_pose *p)
{
  return 2 * atan2(p->rotation[2], p->rotation[3]);
}

static double norm(const cloth_pose *p)
{
  const double *q = p->rotation;
  return sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
}

static int keys_are_met_exactly_and_held_outside(void)
{
  double time[3] = {1, 2, 4};
  cloth_pose pose[3] = {about_z(0.1, 0), about_z(0.7, 1), about_z(-3, 2)};
  cloth_motion m = {.key_count = 3, .time = time, .pose = pose};
  for (int i = 0; i < 3; i++) {
    cloth_pose p = cloth_motion_at(&m, about_z(9, 9), time[i]);
    CHECK(memcmp(&p, &pose[i], sizeof p) == 0);
  }
  cloth_pose before = cloth_motion_at(&m, about_z(9, 9), 0),
             after = cloth_motion_at(&m, about_z(9, 9), 99);
  CHECK(memcmp(&before, &pose[0], sizeof before) == 0);
  CHECK(memcmp(&after, &pose[2], sizeof after) == 0);
  return 0;
}

static int between_keys_position_and_angle_are_linear_in_time(void)
{
  double time[2] = {1, 3};
  cloth_pose pose[2] = {about_z(2, 0.2), about_z(4, 1.4)};
  cloth_motion m = {.key_count = 2, .time = time, .pose = pose};
  for (int i = 0; i <= 10; i++) {
    double s = i / 10.0;
    cloth_pose p = cloth_motion_at(&m, cloth_pose_identity(), 1 + 2 * s);
    CHECK_NEAR(p.position[0], 2 + 2 * s, 1e-15);         // rounding
    CHECK_NEAR(angle_about_z(&p), 0.2 + 1.2 * s, 1e-14); // rounding of sin and acos
    CHECK_NEAR(norm(&p), 1, 1e-15);
  }
  return 0;
}

// from 170 to -170 degrees the way is 20 degrees over 180, not 340 over 0
static int rotation_takes_the_shorter_arc(void)
{
  double time[2] = {0, 1};
  cloth_pose pose[2] = {about_z(0, 170 * PI / 180), about_z(0, -170 * PI / 180)};
  cloth_motion m = {.key_count = 2, .time = time, .pose = pose};
  cloth_pose p = cloth_motion_at(&m, cloth_pose_identity(), 0.25);
  CHECK_NEAR(fabs(angle_about_z(&p)) * 180 / PI, 175, 1e-9);
  // the same rotation written with the other sign does not turn at all
  for (int i = 0; i < 4; i++) pose[1].rotation[i] = -pose[0].rotation[i];
  p = cloth_motion_at(&m, cloth_pose_identity(), 0.5);
  CHECK_NEAR(fabs(angle_about_z(&p)) * 180 / PI, 170, 1e-6);
  return 0;
}

static int nearly_equal_rotations_do_not_divide_by_zero(void)
{
  double time[2] = {0, 1};
  for (double angle = 1; angle > 1e-18; angle *= 0.1) {
    cloth_pose pose[2] = {about_z(0, 0.3), about_z(0, 0.3 + angle)};
    cloth_motion m = {.key_count = 2, .time = time, .pose = pose};
    cloth_pose p = cloth_motion_at(&m, cloth_pose_identity(), 0.5);
    CHECK_NEAR(angle_about_z(&p), 0.3 + angle / 2, 1e-9); // where the chord stands for the arc
    CHECK_NEAR(norm(&p), 1, 1e-15);
  }
  return 0;
}

static int velocity_and_spin_act_between_start_and_end(void)
{
  cloth_motion m = {.velocity = {1, -2, 0}, .spin = {0, 0, 0.5}, .start = 1, .end = 3};
  cloth_pose start = about_z(5, 0.1);
  const double rows[][2] = {{0, 0}, {1, 0}, {1.5, 0.5}, {3, 2}, {7, 2}}; // time, elapsed
  for (int i = 0; i < 5; i++) {
    cloth_pose p = cloth_motion_at(&m, start, rows[i][0]);
    CHECK_NEAR(p.position[0], 5 + rows[i][1], 1e-15);
    CHECK_NEAR(p.position[1], -2 * rows[i][1], 1e-15);
    CHECK_NEAR(angle_about_z(&p), 0.1 + 0.5 * rows[i][1], 1e-14);
  }
  return 0;
}

// spin is about the axes of the scene, whatever way the body stands: turned over about x, spinning
// about z takes the body's x axis to the scene's y axis
static int spin_is_about_scene_axes(void)
{
  cloth_motion m = {.spin = {0, 0, PI / 2}, .end = INFINITY};
  cloth_pose start = {{0, 0, 0}, {1, 0, 0, 0}};
  cloth_pose p = cloth_motion_at(&m, start, 1);
  const double *q = p.rotation;
  CHECK_NEAR(1 - 2 * (q[1] * q[1] + q[2] * q[2]), 0, 1e-15); // rotated x axis
  CHECK_NEAR(2 * (q[0] * q[1] + q[3] * q[2]), 1, 1e-15);
  CHECK_NEAR(2 * (q[0] * q[2] - q[3] * q[1]), 0, 1e-15);
  return 0;
}

// on top of velocity and spin; it begins in the middle, and stays where it is at the end
static int oscillation_is_a_sine_between_start_and_end(void)
{
  cloth_motion m = {.velocity = {1, 0, 0},
                    .amplitude = {0.2, 0.5, 0},
                    .swing = {0, 0, 0.4},
                    .period = 4,
                    .start = 1,
                    .end = 6};
  cloth_pose start = about_z(5, 0.1);
  const double rows[][3] = {
      {0, 0, 0},  {1, 0, 0}, {2, 1, 1}, {3, 2, 0}, {3.5, 2.5, -0.70710678118654752},
      {4, 3, -1}, {6, 5, 1}, {9, 5, 1}}; // time, elapsed, wave
  for (int i = 0; i < 8; i++) {
    cloth_pose p = cloth_motion_at(&m, start, rows[i][0]);
    CHECK_NEAR(p.position[0], 5 + rows[i][1] + 0.2 * rows[i][2], 1e-14); // rounding
    CHECK_NEAR(p.position[1], 0.5 * rows[i][2], 1e-14);
    CHECK_NEAR(angle_about_z(&p), 0.1 + 0.4 * rows[i][2], 1e-14);
  }
  return 0;
}

static int what_moves_is_told_from_what_stays(void)
{
  double time[2] = {0, 1};
  cloth_pose pose[2] = {about_z(0, 0), about_z(1, 0)};
  cloth_motion none = {0}, keys = {.key_count = 2, .time = time, .pose = pose};
  cloth_motion one = {.key_count = 1, .time = time, .pose = pose};
  cloth_motion spin = {.spin = {0, 1, 0}, .end = 1},
               never = {.velocity = {1, 0, 0}, .start = 2, .end = 2};
  CHECK(!cloth_motion_moves(&none));
  CHECK(cloth_motion_moves(&keys));
  CHECK(!cloth_motion_moves(&one));
  CHECK(cloth_motion_moves(&spin));
  CHECK(!cloth_motion_moves(&never));
  cloth_motion wave = {.amplitude = {0, 0, 1}, .period = 1, .end = 1},
               flat = {.amplitude = {0, 0, 1}, .end = 1};
  CHECK(cloth_motion_moves(&wave));
  CHECK(!cloth_motion_moves(&flat));
  cloth_pose start = about_z(1, 1), p = cloth_motion_at(&none, start, 10);
  CHECK(memcmp(&p, &start, sizeof p) == 0);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(keys_are_met_exactly_and_held_outside);
  RUN(between_keys_position_and_angle_are_linear_in_time);
  RUN(rotation_takes_the_shorter_arc);
  RUN(nearly_equal_rotations_do_not_divide_by_zero);
  RUN(velocity_and_spin_act_between_start_and_end);
  RUN(spin_is_about_scene_axes);
  RUN(oscillation_is_a_sine_between_start_and_end);
  RUN(what_moves_is_told_from_what_stays);
  return failures != 0;
}
