// The stages of one step, in order: CLOTH_STAGE(name, file, meaning).
// Becomes the timers and the skipped flags of cloth_step_report and the pipeline table of README.md.
CLOTH_STAGE(predict, "src/state/predict.c", "bodies and grasps move, inertia target x* = x + h v + h^2 g")
CLOTH_STAGE(pairs, "src/contact/pairs.c", "spatial hash: which features may touch in this step")
CLOTH_STAGE(contact, "src/contact/contact.c", "which pairs touch now: distance, normal, weights, friction")
CLOTH_STAGE(effects, "src/effect/effect.c", "forces and tangents of every active effect")
CLOTH_STAGE(assemble, "src/solve/assemble.c", "element slots to block rows, diagonal, right-hand side")
CLOTH_STAGE(solve, "src/solve/pcg.c", "A dx = b over n parts")
CLOTH_STAGE(ccd, "src/ccd/ccd.c", "what would pass through: time of impact, impact zones, failsafe")
CLOTH_STAGE(commit, "src/state/commit.c", "v = (x - x0) / h, checks, report")
#undef CLOTH_STAGE
