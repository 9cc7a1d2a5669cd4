#!/bin/bash
# What needs a GPU. BUILD is a build folder, or a folder with `cloth`, its libraries and the test programs side by
# side, so that a host without compilers or ROS can run it.
#
#   gpu.sh BUILD [RESULTS_FOLDER]      with a folder for results: the large scenes too, as CSV
#
# The node folds its towel on the GPU too: where ROS is installed, or with a ROS 1 runtime that was brought along
# ($ROSRT, see gpu_pack.sh).
set -u
build=$(cd "$1" && pwd) results=${2:-}
here=$(cd "$(dirname "$0")" && pwd)
export LD_LIBRARY_PATH=$build${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} OMP_WAIT_POLICY=passive
failed=0 limit=300 # s

program() { [ -x "$build/test/$1" ] && echo "$build/test/$1" || echo "$build/$1"; }

run() { # name, then the command; its output counts as failed if it fails, skips or finds an error
  echo "== $1"
  shift
  output=$(timeout $limit "$@" 2>&1)
  status=$?
  echo "$output" | grep -E "^(ok|FAIL|skip)|ERROR SUMMARY|RACECHECK SUMMARY|differs|\.\.\. (ok|FAIL|ERROR|skip)|RESULT: |check_meshes: " ||
    echo "$output" | tail -5
  if [ $status -ne 0 ] || echo "$output" | grep -qE "^(FAIL|skip)|SUMMARY: [1-9]|RESULT: FAIL"; then failed=$((failed + 1)); fi
}

for test in backend_cuda_f32 backend_cuda_f64 solve_recut_f32 solve_recut_f64 engine_determinism engine_mass_spring_bits; do run $test "$(program $test)"; done
limit=1200 # 10,000 steps of four parts that share a GPU
run engine_crumple "$(program engine_crumple)"
limit=300

if command -v compute-sanitizer >/dev/null; then
  scene=$here/../config/scenes/drape_sphere.yaml
  for tool in memcheck initcheck; do
    run $tool compute-sanitizer --error-exitcode 9 --tool $tool "$build/cloth" run "$scene" --steps 16 --backend cuda \
      --set preconditioner=multilevel
  done
  # A race detector takes minutes for a thousand vertices. It must see every kernel that runs as a cluster of blocks:
  # leaving one out ends in an exception of its own.
  limit=300
  race() { # name, then the arguments of cloth run
    name=$1
    shift
    run "racecheck, $name" compute-sanitizer --error-exitcode 9 --tool racecheck "$build/cloth" run "$@" --backend cuda
  }
  race "towels" "$here/scenes/two_small_towels.yaml" --steps 1
  race "two parts" "$here/scenes/two_small_towels.yaml" --steps 1 --set devices=0,0
  race "solve by a grid" "$here/../config/scenes/flag.yaml" --steps 1 --set newton_iterations_max=1 \
    --set pcg_iterations_max=2 --set preconditioner=multilevel
  springs=$here/../config/scenes/mass_spring.yaml
  race "springs, a cluster" "$springs" --steps 1 --set time_step=0.008 --variant side=20,size=0.38
  race "springs, a grid" "$springs" --steps 1 --set time_step=0.004 --variant side=48,size=0.94
else
  echo "skip compute-sanitizer: not found"
fi

# as a check of each step's meshes: CGAL, where it was there to build with
check=$(find "$build" -name check_meshes -type f -perm -u+x | head -n 1)
export CLOTH_CHECK_MESHES=$check ROS_HOME=${ROS_HOME:-$(mktemp -d)}
fold="test/demo/fold.test backend:=cuda"
if [ -n "${ROSRT:-}" ]; then
  export ROSRT_OVERLAY=$here/../install
  # shellcheck disable=SC2086
  run node "$ROSRT/rosrt" rostest --text "$ROSRT_OVERLAY/share/robot_cloth/"$fold
elif command -v rostest >/dev/null; then
  # shellcheck disable=SC2086
  run node "$here/../src/demo/with_ros.sh" "$build" rostest --text "$here/../"$fold
else
  echo "skip node: no ROS here, and no runtime in ROSRT"
fi

if [ -n "$results" ]; then
  mkdir -p "$results"
  python3 "$here/bench/scale.py" "$build/cloth" "$results/scale.csv" || failed=$((failed + 1))
fi

echo "$failed failed"
[ $failed -eq 0 ]
