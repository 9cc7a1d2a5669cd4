// Every parameter of the node but those of the scene (~params/NAME, src/params.inl) and the grippers
// (~grippers): CLOTH_SETTING(type, member, "name", default, unit, least, most, meaning). type: double, int,
// bool, string; least and most are of numbers; a string with choices names them "a|b|c" in `unit`.
// The list becomes the struct, the defaults, the checks, the loader and the table of doc/ros.md.

// scene
CLOTH_SETTING(string, scene_file, "scene", "", "file", 0, 0, "scene file (YAML) with cloth, table, materials; required")
CLOTH_SETTING(string, world_frame, "world_frame", "world", "frame", 0, 0, "tf frame that is the scene's frame")
CLOTH_SETTING(string, state_folder, "state_folder", "", "folder", 0, 0, "where ~save_state writes; empty: $ROS_HOME/robot_cloth or ~/.ros/robot_cloth")
CLOTH_SETTING(double, keep_every, "keep_every", 1, "s", 0, 3600, "on a GPU chosen by `backend: auto`: wall time after which the state is kept again, to go on from it should the GPU be lost; 0: never")
CLOTH_SETTING(double, run_duration, "run_duration", 0, "s", 0, 1e9, "simulated time after which the node prints its summary and ends; 0: never")

// robot
CLOTH_SETTING(bool, use_robot, "use_robot", true, "", 0, 0, "links of robot_description become bodies")
CLOTH_SETTING(string, robot_description, "description_name", "robot_description", "parameter", 0, 0, "name of the URDF parameter, searched upwards from the node")
CLOTH_SETTING(double, robot_timeout, "robot_timeout", 30, "s", 0, 3600, "wall time to wait for robot_description at start")
CLOTH_SETTING(bool, wait_for_robot, "wait_for_robot", false, "", 0, 0, "do not simulate before every joint of the robot is known")
CLOTH_SETTING(double, robot_friction, "robot_friction", 0.4, "1", 0, 10, "Coulomb coefficient of the links against cloth")
CLOTH_SETTING(bool, collada_units, "collada_units", true, "", 0, 0, "honour the unit of Collada meshes, as RViz does (MoveIt does not)")
CLOTH_SETTING(bool, tolerate_bad_collisions, "tolerate_bad_collisions", false, "", 0, 0, "leave out collision geometry that cannot be used, and warn, instead of refusing the robot")
CLOTH_SETTING(double, speed_limit_linear, "speed_limit/linear", 10, "m/s", 1e-3, 1e6, "a link that is faster was teleported: placed, not swept through the cloth")
CLOTH_SETTING(double, speed_limit_angular, "speed_limit/angular", 50, "rad/s", 1e-3, 1e6, "likewise")

// time
CLOTH_SETTING(string, time_mode, "time/mode", "clock", "clock|step|wall|joint_states", 0, 0, "who drives the time (doc/ros.md)")
CLOTH_SETTING(double, input_wait, "time/input_wait", 0.1, "s", 0, 10, "how long a step waits for the joint states of its end; then the robot is held")
CLOTH_SETTING(double, catch_up_max, "time/catch_up_max", 0.25, "s", 1e-3, 60, "most time that is made up for when slower than the clock; the rest is skipped and reported")
CLOTH_SETTING(double, forward_jump_max, "time/forward_jump_max", 2, "s", 1e-2, 1e6, "a clock that leaps farther has jumped: bodies are placed anew")
CLOTH_SETTING(double, back_step_max, "time/back_step_max", 0.01, "s", 0, 10, "a clock that runs back less is jitter, not a jump")
CLOTH_SETTING(string, on_backward_jump, "time/on_backward_jump", "reset", "reset|checkpoint|continue|pause", 0, 0, "what a backward jump of the clock does; checkpoint: load what ~save_state saved last")
CLOTH_SETTING(bool, publish_clock, "time/publish_clock", false, "", 0, 0, "publish /clock (modes step and wall); refused if somebody else does")
CLOTH_SETTING(int, failures_max, "failures_max", 10, "1", 1, 1000000, "refused steps in a row before the node pauses itself")

// output
CLOTH_SETTING(double, vertices_rate, "publish/vertices_rate", 0, "1/s", 0, 1e4, "most ~<cloth>/vertices and mesh messages per wall second; 0: every step")
CLOTH_SETTING(double, marker_rate, "publish/marker_rate", 20, "1/s", 0.1, 1e3, "most ~markers messages per wall second")
CLOTH_SETTING(bool, normals, "publish/normals", false, "", 0, 0, "normals in ~<cloth>/vertices")
CLOTH_SETTING(bool, velocities, "publish/velocities", false, "", 0, 0, "velocities in ~<cloth>/vertices")
CLOTH_SETTING(bool, pinned, "publish/pinned", false, "", 0, 0, "which vertices are held in ~<cloth>/vertices")
CLOTH_SETTING(bool, contacts, "publish/contacts", false, "", 0, 0, "publish ~contacts")
CLOTH_SETTING(int, contacts_max, "publish/contacts_max", 10000, "1", 1, 10000000, "most contacts in one message; the total is always told")
CLOTH_SETTING(bool, hash_steps, "publish/state_hash", false, "", 0, 0, "state hash in every ~state (reads the state back every step)")

// cross-check
CLOTH_SETTING(int, crosscheck_every, "crosscheck/every", 0, "steps", 0, 1000000000, "compare the broad phase with FCL every so many steps; 0: on demand only")
CLOTH_SETTING(double, crosscheck_margin, "crosscheck/margin", 0.005, "m", 1e-5, 0.1, "pairs closer than this must be found")
#undef CLOTH_SETTING
