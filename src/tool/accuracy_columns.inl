// Columns of accuracy.csv, once: ACCURACY_TEXT(name, size), ACCURACY_NUMBER(name). doc/accuracy.md
// says what they mean.
ACCURACY_TEXT(scene, 64)
ACCURACY_TEXT(digest, 24)  // of the scene file and of what the command line changed
ACCURACY_TEXT(varied, 32)
ACCURACY_TEXT(setting, 96)
ACCURACY_TEXT(status, 16)  // ok, unstable, refused
ACCURACY_NUMBER(time_step)
ACCURACY_NUMBER(substeps)
ACCURACY_NUMBER(resolution)
ACCURACY_NUMBER(vertices)
ACCURACY_NUMBER(pcg_tolerance)
ACCURACY_NUMBER(newton_iterations_max)
ACCURACY_NUMBER(newton_tolerance)
ACCURACY_TEXT(precision, 8)
ACCURACY_TEXT(contact, 16)
ACCURACY_TEXT(preconditioner, 24)
ACCURACY_TEXT(integrator, 24)
ACCURACY_TEXT(bending_model, 24)
ACCURACY_NUMBER(error_rms) // share of the cloth's size, against the reference
ACCURACY_NUMBER(error_max)
ACCURACY_NUMBER(error_rms_same_mesh) // against the reference on the mesh of the file
ACCURACY_NUMBER(error_max_same_mesh)
ACCURACY_NUMBER(stretch_max)
ACCURACY_NUMBER(energy_kinetic)
ACCURACY_NUMBER(impacts_left)
ACCURACY_NUMBER(unconverged)
ACCURACY_NUMBER(simulated)
ACCURACY_NUMBER(steps)
ACCURACY_NUMBER(substeps_done)
ACCURACY_NUMBER(linear_systems)
ACCURACY_NUMBER(pcg_iterations)
ACCURACY_NUMBER(pairs)    // mean of a step
ACCURACY_NUMBER(contacts) // mean of a step
ACCURACY_NUMBER(launches)
ACCURACY_NUMBER(work)     // iterations x vertices per simulated second: the machine is not in it
ACCURACY_NUMBER(ms_per_step)
ACCURACY_NUMBER(wall_per_second)
ACCURACY_NUMBER(cpu_per_second) // of all threads: hardly changes when the machine is shared
#undef ACCURACY_TEXT
#undef ACCURACY_NUMBER
