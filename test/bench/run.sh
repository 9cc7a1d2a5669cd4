#!/bin/sh
# Time the standard scenes on two cores, and Bullet's soft body beside them; called by `make bench`.
#
#   test/bench/run.sh [BUILD_DIR] [RESULTS_DIR]
#
# HARD=small or HARD=full times the hard scenes (doc/scenes.md) instead, at that size, in the thick of it.
#
# Writes one CSV per scene under RESULTS_DIR/<processor>-<cores used>-cores (default: results/ beside
# this script).
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
build=${1:-$root/build}
results=${2:-$here/results}
cores=2
[ "$(nproc)" -ge $cores ] || cores=1

cloth=$build/cloth
if [ ! -x "$cloth" ]; then
  echo "run.sh: no $cloth; build first, or name the build directory" >&2
  exit 2
fi
bullet=$(find "$build" -name bullet_cloth -type f -perm -u+x 2>/dev/null | head -n 1)

# the processor's model, as a file name
model=$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo 2>/dev/null | head -n 1)
[ -n "$model" ] || model=$(uname -m)
kind=$(printf '%s' "$model" | sed 's/([^)]*)//g' | tr 'A-Z' 'a-z' | tr -cs 'a-z0-9.\n' '-' | sed 's/^-//; s/-$//')
out=$results/$kind-$cores-cores
mkdir -p "$out"

pin=""
if command -v taskset >/dev/null 2>&1 && taskset -c 0-$((cores - 1)) true 2>/dev/null; then
  pin="taskset -c 0-$((cores - 1))"
fi

echo "processor: $model, $cores cores used"
echo

# bench NAME SCENE OPTIONS...
bench() {
  name=$1
  scene=$2
  shift 2
  echo "== $name"
  $pin "$cloth" bench "$root/config/scenes/$scene.yaml" --threads $cores --csv "$out/$name.csv" "$@"
}

# what share of a step is collision: pairs, contact, ccd
share() {
  awk -F, '
    NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
    $column["row"] == "step" { step = $column["median_ms"] }
    $column["row"] ~ /^(pairs|contact|ccd)$/ { collision += $column["median_ms"] }
    END { if (step > 0) printf "collision: %.0f %% of the step\n\n", 100 * collision / step }' "$out/$1.csv"
}

# SCENE[:VARIANT]=steps before the timing, at the small size's time step
hard="twisted_cylinder=60 five_turns=150 rotating_sphere=50 funnel=15 tablecloth_pull=30 tablecloth_pull:pull_8=22
  needles=35 mat_on_knives=30 sphere_sheets=25 flag_two_corners=60 towel_rolled=90 hand_on_crumpled_towel=120
  towel_whipped=20 link_sweep=20 towel_on_towel=10 pinched=40 towels_clash=5"
if [ -n "${HARD:-}" ]; then
  failed=0
  size=$HARD
  [ "$size" = full ] && size=""
  for entry in $hard; do
    scene=${entry%%=*}
    more=""
    case $scene in *:*) more=${scene#*:} ;; esac
    variant=$size${size:+${more:+,}}$more
    name=${scene%%:*}${more:+_$more}_$HARD
    bench "$name" "${scene%%:*}" ${variant:+--variant "$variant"} --precision float \
      --warmup "${entry#*=}" --steps 10 --repeat 3 && share "$name" || failed=1
  done
  echo "written to $out"
  exit $failed
fi

failed=0
bench fold fold || failed=1
# in float, as Bullet is
for scene in towel_on_table hanging_towel; do
  bench "$scene" "$scene" --precision float || failed=1
  bench "${scene}_no_self" "$scene" --precision float --set effects.self_contact=off || failed=1
done

if [ -n "$bullet" ]; then
  echo "== Bullet"
  $pin "$bullet" --csv "$out/bullet.csv" || failed=1
  echo
else
  echo "Bullet: not built (Debian: libbullet-dev)"
fi

# side by side: median ms of a whole step, worst stretch
echo "== side by side: ms a step (median), worst stretch of a triangle"
for name in fold towel_on_table towel_on_table_no_self hanging_towel hanging_towel_no_self; do
  [ -f "$out/$name.csv" ] || continue
  awk -F, -v name="$name" '
    NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
    $column["row"] == "step" {
      printf "  %-28s %8.3f ms %8.1f %%\n", name, $column["median_ms"], 100 * $column["stretch_max"]
    }' "$out/$name.csv"
done
if [ -f "$out/bullet.csv" ] && [ -n "$bullet" ]; then
  awk -F, '
    NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
    { printf "  %-28s %8.3f ms %8.1f %%\n", $1, $column["median_ms"], 100 * $column["stretch_max"] }
  ' "$out/bullet.csv"
fi
echo "written to $out"
exit $failed
