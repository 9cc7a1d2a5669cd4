// What is varied: one line a run. To sweep a new parameter, add lines.
#include "accuracy.h"

// spelled out, so that a change of a default changes no reference; of order 2 where nothing touches
#define TIGHT                                                                                      \
  {                                                                                                \
    "precision=double", "substeps=1", "newton_iterations_max=10", "newton_tolerance=1e-4",         \
        "pcg_tolerance=1e-8", "pcg_iterations_max=5000", "preconditioner=two_level",               \
        "integrator=bdf2"                                                                          \
  }
// the least that a budget chooses
#define LOOSE                                                                                      \
  {                                                                                                \
    "precision=float", "newton_iterations_max=2", "pcg_tolerance=0.1"                              \
  }
#define FIRM                                                                                       \
  {                                                                                                \
    "precision=double", "newton_iterations_max=6", "newton_tolerance=1e-2", "pcg_tolerance=1e-4"   \
  }

// clang-format off
const sweep_setting accuracy_sweep[] = {
    {"standard", "as in the file", .quick = true},

    {"time_step", "x 4", .step = 4},
    {"time_step", "x 2", .step = 2, .quick = true},
    {"time_step", "/ 2", .step = 1.0 / 2, .quick = true},
    {"time_step", "/ 4", .step = 1.0 / 4, .quick = true},
    {"time_step", "/ 8", .step = 1.0 / 8},

    {"resolution", "/ 2", .resolution = 0.5, .quick = true},
    {"resolution", "x 1.5", .resolution = 1.5},
    {"resolution", "x 2", .resolution = 2},

    {"pcg_tolerance", "1e-1", .set = {"pcg_tolerance=0.1"}, .quick = true},
    {"pcg_tolerance", "3e-2", .set = {"pcg_tolerance=3e-2"}},
    {"pcg_tolerance", "1e-3", .set = {"pcg_tolerance=1e-3"}},
    {"pcg_tolerance", "1e-5", .set = {"pcg_tolerance=1e-5"}},

    {"newton", "1 system", .set = {"newton_iterations_max=1"}},
    {"newton", "2 systems", .set = {"newton_iterations_max=2"}},
    {"newton", "10 systems; tolerance 1e-3", .set = {"newton_iterations_max=10", "newton_tolerance=1e-3"}},

    {"precision", "float", .set = {"precision=float"}, .quick = true},
    {"precision", "double", .set = {"precision=double"}},

    {"contact", "off", .set = {"effects.self_contact=off", "effects.body_contact=off"}, .quick = true},
    {"contact", "no self-contact", .set = {"effects.self_contact=off"}},
    {"contact", "discrete", .set = {"contact_detection=discrete"}},

    {"preconditioner", "block_jacobi", .set = {"preconditioner=block_jacobi"}},
    {"preconditioner", "multilevel", .set = {"preconditioner=multilevel"}},

    {"bending_model", "hinge", .set = {"bending_model=hinge"}},
    {"bending_model", "quadratic", .set = {"bending_model=quadratic"}},

    {"bdf2", "as in the file", .set = {"integrator=bdf2"}, .quick = true},
    {"bdf2", "pcg 1e-3", .set = {"integrator=bdf2", "pcg_tolerance=1e-3"}},
    {"bdf2", "step / 2; pcg 1e-3", .step = 1.0 / 2, .set = {"integrator=bdf2", "pcg_tolerance=1e-3"}},
    {"bdf2", "step / 4; pcg 1e-3", .step = 1.0 / 4, .set = {"integrator=bdf2", "pcg_tolerance=1e-3"}},
    {"bdf2", "step / 8; pcg 1e-3", .step = 1.0 / 8, .set = {"integrator=bdf2", "pcg_tolerance=1e-3"}},

    {"accuracy", "5 %", .set = {"accuracy=5 %", "precision=double"}, .quick = true},
    {"accuracy", "1 %", .set = {"accuracy=1 %", "precision=double"}},
    {"accuracy", "0.2 %", .set = {"accuracy=0.2 %", "precision=double"}},
    {"accuracy", "5 %; bdf2", .set = {"accuracy=5 %", "precision=double", "integrator=bdf2"}},
    {"accuracy", "1 %; bdf2", .set = {"accuracy=1 %", "precision=double", "integrator=bdf2"}},
    {"accuracy", "0.2 %; bdf2", .set = {"accuracy=0.2 %", "precision=double", "integrator=bdf2"}},

    {"combined", "step x 2; mesh / 2; loose", .step = 2, .resolution = 0.5, .set = LOOSE, .quick = true},
    {"combined", "mesh / 2; loose", .resolution = 0.5, .set = LOOSE},
    {"combined", "loose", .set = LOOSE},
    {"combined", "2 systems; pcg 3e-2; float", .set = {"precision=float", "newton_iterations_max=2", "pcg_tolerance=3e-2"}},
    {"combined", "step / 2; loose", .step = 1.0 / 2, .set = LOOSE},
    {"combined", "step / 4; loose", .step = 1.0 / 4, .set = LOOSE},
    {"combined", "step / 2; pcg 1e-3", .step = 1.0 / 2, .set = {"pcg_tolerance=1e-3"}},
    {"combined", "step / 4; pcg 1e-3", .step = 1.0 / 4, .set = {"pcg_tolerance=1e-3"}},
    {"combined", "step / 8; pcg 1e-3", .step = 1.0 / 8, .set = {"pcg_tolerance=1e-3"}},
    {"combined", "step / 8; pcg 1e-3; float", .step = 1.0 / 8, .set = {"pcg_tolerance=1e-3", "precision=float"}},
    {"combined", "step / 4; mesh x 1.5; loose", .step = 1.0 / 4, .resolution = 1.5, .set = LOOSE},
    {"combined", "step / 4; firm", .step = 1.0 / 4, .set = FIRM},
    {"combined", "step / 8; mesh x 2; loose", .step = 1.0 / 8, .resolution = 2, .set = LOOSE},
    {"combined", "step / 8; mesh x 2; firm", .step = 1.0 / 8, .resolution = 2, .set = FIRM},

    {"preset", "fast", .preset = "fast", .quick = true},
    {"preset", "balanced", .preset = "balanced"},
    {"preset", "accurate", .preset = "accurate"},
    {"preset", "reference", .preset = "reference"},

    // last, because its stable step takes the longest
    {"mass_spring", "stable step", .set = {"integrator=mass_spring", "spring_step=0"}},
    {.varied = NULL},
};

static const sweep_setting convergence[] = {
    {"reference", "step / 8; mesh x 2", .step = 1.0 / 8, .resolution = 2, .set = TIGHT},
    {"reference", "step / 8", .step = 1.0 / 8, .set = TIGHT},
    {.varied = NULL},
};

static const sweep_setting quick_convergence[] = {
    {"reference", "step / 4", .step = 1.0 / 4, .set = TIGHT},
    {.varied = NULL},
};
// clang-format on

const sweep_references *accuracy_references(bool quick)
{
  static const sweep_references usual = {{"reference", "step / 16; mesh x 2", .step = 1.0 / 16,
                                          .resolution = 2, .set = TIGHT},
                                         {"reference", "step / 16", .step = 1.0 / 16, .set = TIGHT},
                                         convergence},
                                little = {
                                    {"reference", "step / 16; mesh x 1.5", .step = 1.0 / 16,
                                     .resolution = 1.5, .set = TIGHT},
                                    {"reference", "step / 16", .step = 1.0 / 16, .set = TIGHT},
                                    quick_convergence};
  return quick ? &little : &usual;
}
