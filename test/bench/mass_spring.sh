#!/bin/sh
# The ladder of the mass-spring cloth: 25 to 25,600 particles, a frame of 34 sub-steps, bins against
# all pairs. The scene is config/scenes/mass_spring.yaml with nets of the same spacing.
#
#   test/bench/mass_spring.sh [BUILD_DIR] [FILE.csv]
#
# Environment: BACKEND (cpu), THREADS (2), PRECISION (float), SIDES ("5 10 20 40 80 120 160": particles
# along a side), ALL_PAIRS_MOST (6400: larger nets are timed with bins alone), REPEATS (5), STEPS (20),
# WARMUP (15: the net lies on the ball by then).
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
build=${1:-$root/build}
out=${2:-$here/results/mass_spring.csv}
backend=${BACKEND:-cpu}
threads=${THREADS:-2}
precision=${PRECISION:-float}
most=${ALL_PAIRS_MOST:-6400}
repeats=${REPEATS:-5}

cloth=$build/cloth
if [ ! -x "$cloth" ]; then
  echo "mass_spring.sh: no $cloth; build first, or name the build directory" >&2
  exit 2
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$(dirname "$out")"
echo "particles,search,backend,precision,threads,frames,median_ms,min_ms,max_ms,pairs,contacts_particles,contacts_bodies" >"$out.part"

# one SIDE SEARCH STEPS REPEATS
one() {
  side=$1
  size=$(awk "BEGIN { print 0.02 * ($side - 1) }")
  "$cloth" bench "$root/config/scenes/mass_spring.yaml" --variant "side=$side,size=$size" \
    --backend "$backend" --precision "$precision" --threads "$threads" \
    --warmup "$5" --steps "$3" --repeat "$4" --set particle_search="$2" --csv "$work/net.csv" >"$work/log" || {
    cat "$work/log" >&2
    exit 1
  }
  awk -F, -v n=$((side * side)) -v search="$2" '
    NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
    $at["row"] == "step" {
      printf "%d,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s\n", n, search, $at["backend"], $at["precision"],
        $at["threads"], $at["steps"], $at["median_ms"], $at["min_ms"], $at["max_ms"], $at["pairs"],
        $at["contacts_self"], $at["contacts_body"]
    }' "$work/net.csv" | tee -a "$out.part"
}

for side in ${SIDES:-5 10 20 40 80 120 160}; do
  one "$side" bins "${STEPS:-20}" "$repeats" "${WARMUP:-15}"
  [ $((side * side)) -le "$most" ] || continue
  if [ "$side" -ge 40 ] && [ "$backend" = cpu ]; then
    one "$side" all_pairs 1 1 1 # a frame takes seconds, and the work does not depend on the state
  else
    one "$side" all_pairs "${STEPS:-20}" "$repeats" "${WARMUP:-15}"
  fi
done
mv "$out.part" "$out"
echo "written to $out"
