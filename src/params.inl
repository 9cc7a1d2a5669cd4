// Every parameter of a scene, once.
//
//   CLOTH_PARAM(type, name, default, unit, least, most, meaning)      type: double, int
//   CLOTH_VECTOR(name, x, y, z, unit, most, meaning)                  [3], each |component| <= most
//   CLOTH_CHOICE(name, default, "a|b|c", meaning)                     int: index into the choices
//
// This list becomes the struct, the defaults, the range checks, the YAML reader (`params:`), the
// ROS loader (`~params/NAME`) and the table in README.md. Includers define what they need; the
// other macros default to nothing.
#ifndef CLOTH_PARAM
#define CLOTH_PARAM(type, name, value, unit, least, most, meaning)
#endif
#ifndef CLOTH_VECTOR
#define CLOTH_VECTOR(name, x, y, z, unit, most, meaning)
#endif
#ifndef CLOTH_CHOICE
#define CLOTH_CHOICE(name, value, choices, meaning)
#endif

// time
CLOTH_PARAM(double, time_step, 1.0 / 60, "s", 1e-5, 1e-1, "length of one step")
CLOTH_PARAM(int, substeps, 1, "1", 1, 100, "equal parts a step is always cut into")
CLOTH_PARAM(int, substeps_max, 16, "1", 1, 1000, "most parts a step is cut into when bodies move fast")
CLOTH_PARAM(double, body_motion_max, 8e-3, "m", 1e-5, 1, "in one substep a body moves at most this far against the cloth near it, and a hold jerks a vertex at most this far")
CLOTH_PARAM(int, step_halvings_max, 6, "1", 0, 20, "times a failed substep is halved before the step is refused")

// solver
CLOTH_PARAM(int, newton_iterations_max, 3, "1", 1, 100, "linear systems per substep; up to 4 more where the last still moves a vertex by 5 % of an edge")
CLOTH_PARAM(double, newton_tolerance, 0.1, "1", 1e-12, 1, "stop when the largest correction is below this share of the contact thickness")
CLOTH_PARAM(double, pcg_tolerance, 1e-2, "1", 1e-12, 1e-1, "stop the linear solver at this relative residual")
CLOTH_PARAM(int, pcg_iterations_max, 500, "1", 1, 100000, "the linear solver gives up after this many iterations; up to 500 more where that leaves a vertex a quarter of the thickness from its place")
CLOTH_PARAM(double, time_budget, 0, "ms", -1, 1e5, "wall time of a step, which steers tolerance and iterations within bounds (doc/budget.md); 0: none; real_time (-1): time_step")
CLOTH_PARAM(double, accuracy, 0, "1", 0, 0.5, "error that the steps of a second may add, as share of the cloth's size: 1 %; chooses substeps and tolerance within bounds (doc/budget.md); 0: none")
CLOTH_CHOICE(preconditioner, 1, "block_jacobi|two_level|multilevel", "3x3 block Jacobi (P-Cloth), with one coarse level of 96 pieces, with hat functions on ever coarser grids: fewest iterations, for large or mostly free cloth")
CLOTH_PARAM(int, threads, 0, "1", 0, 1024, "CPU threads; 0 takes what OpenMP finds")
CLOTH_CHOICE(exchange, 0, "halo|whole|launches", "several devices: parts send what others read, or all they have, from within one kernel; or the solve goes launch by launch with copies of whole vectors")
CLOTH_CHOICE(overlap, 1, "off|on", "several devices: rows that need no other part are multiplied while the others' numbers travel, or all wait")
CLOTH_PARAM(double, rebalance, 1.1, "1", 0, 1e3, "several devices: where a part has more than so many times the mean of all parts' work, they are cut anew before long (doc/multi_gpu.md); 0: never")
CLOTH_CHOICE(integrator, 0, "backward_euler|mass_spring|bdf2", "implicit, finite elements; explicit, particles and springs (doc/mass_spring.md); or implicit and of order 2 where nothing touches")
CLOTH_PARAM(double, spring_step, 1e-3, "s", 0, 1e-1, "mass_spring: longest sub-step; above the stable limit it is refused; 0 takes 0.9 of the limit")
CLOTH_CHOICE(spring_cut, 0, "equal|last_short", "mass_spring: a step's sub-steps are equal, or all but the last are spring_step long")
CLOTH_PARAM(double, particle_radius, 0, "m", 0, 1, "mass_spring: of the particles that collide; 0 takes 0.4 of the mean edge")
CLOTH_CHOICE(particle_search, 0, "bins|all_pairs", "mass_spring: how particles find each other; all_pairs tests every pair in every sub-step, for comparison")

CLOTH_PARAM(int, profile, 0, "1", 0, 2, "1: the times of stages are a GPU's own, which makes the host wait after each; 2: those of effects, too")

// models
CLOTH_CHOICE(bending_model, 2, "hinge|quadratic|shape", "one spring per edge; its constant matrix, the cheapest; or the curvature of each triangle, in which D is the same in every direction")

// world
CLOTH_VECTOR(gravity, 0, 0, -9.81, "m/s^2", 1e3, "acceleration of free fall, scene frame")
CLOTH_VECTOR(wind, 0, 0, 0, "m/s", 200, "mean velocity of the air, scene frame")
CLOTH_PARAM(double, gust, 0, "1", 0, 10, "amplitude of gusts as a share of the mean wind")
CLOTH_PARAM(double, gust_period, 1, "s", 1e-3, 1e3, "period of the gusts")
CLOTH_PARAM(double, air_density, 0, "kg/m^3", 0, 10, "0 is a vacuum: no wind, no drag; 1.2 is air")
CLOTH_PARAM(double, bounds, 100, "m", 1e-3, 1e6, "a vertex farther than this from the origin is an explosion")

// contact
CLOTH_PARAM(double, thickness, 3e-3, "m", 1e-5, 5e-2, "distance that contact keeps between layers, and between cloth and bodies")
CLOTH_PARAM(double, contact_stiffness, 8, "1", 1e-2, 1e6, "contact spring in units of vertex mass / step^2")
CLOTH_PARAM(double, friction, 0.3, "1", 0, 10, "Coulomb coefficient, cloth on cloth")
CLOTH_PARAM(double, friction_elastic_slip, 0.01, "1", 1e-5, 1, "share of the thickness that a contact gives way before it slides")
CLOTH_PARAM(double, pair_slack, 1e-3, "m", 0, 1e-1, "how far a vertex may stray from its prediction before pairs are searched again")
CLOTH_CHOICE(contact_detection, 0, "continuous|discrete", "stop what would pass through within a step, or only push apart what is close: cheaper, but fast cloth may go through")
CLOTH_PARAM(int, contact_rounds_max, 2, "1", 0, 100, "times that pairs which would pass through become contacts of a further linear system, before impact zones; and times that cloth is solved for again around what was held back")
CLOTH_PARAM(int, zone_iterations_max, 10, "1", 0, 1000, "rounds of impact zones before the failsafe holds back what still passes through")
CLOTH_PARAM(int, close_pairs_from, 65536, "1", 0, 2000000000, "from so many candidate pairs on, those that come near are listed, and looked at alone where that is all; 0: never. Changes no result")
CLOTH_CHOICE(flat_culling, 1, "off|on", "leave out pairs inside flat patches, which provably cannot touch; changes no result")
CLOTH_PARAM(int, failsafe_iterations_max, 20, "1", 1, 1000, "passes that hold back what would pass through, before all involved vertices are stopped")

// what is not as it should be
CLOTH_CHOICE(untangle, 0, "false|true", "work out cloth that intersects at the start, over the following steps; otherwise it is only kept from getting worse")
CLOTH_PARAM(double, teleport_distance, 0.5, "m", 1e-3, 1e6, "a body that is told to go farther in one step is placed there, not swept")

// input
CLOTH_CHOICE(mesh_defects, 0, "refuse|repair", "what to do with a mesh that has zero-area, duplicate or non-manifold parts")

#undef CLOTH_PARAM
#undef CLOTH_VECTOR
#undef CLOTH_CHOICE
