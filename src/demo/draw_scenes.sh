#!/bin/sh
# Draws doc/figures/scenes.png: six of the hard scenes at their small size. Wants ImageMagick.
#
#   src/demo/draw_scenes.sh [CLOTH [OUT.png]]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
cloth=${1:-$root/build/cloth}
out=${2:-$root/doc/figures/scenes.png}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# draw SCENE STEP OPTIONS...
n=0
draw() {
  scene=$1
  step=$2
  shift 2
  n=$((n + 1))
  "$cloth" run "$root/config/scenes/$scene.yaml" --variant small --steps "$step" --mesh-every "$step" \
    --out "$scratch/$scene" --quiet >/dev/null
  "$here/draw_scene.py" "$scratch/$scene" "$step" "$scratch/$n.png" --size 270 190 "$@"
}

draw rotating_sphere 95 --eye -0.8 -1.0 0.7 --at 0 0 0.1 --without floor
draw funnel 18 --eye -1.1 -1.4 1.4 --at 0 0 0.05
draw hand_on_crumpled_towel 155 --eye -0.45 -0.4 0.25 --at 0 0 0.09 --without floor
draw sphere_sheets 34 --eye -0.6 -1.5 0.9 --at -0.1 0 0.55
draw needles 40 --eye -0.6 -1.5 0.7 --at 0.05 0 0 --without floor
draw towel_rolled 110 --eye -0.4 -0.6 0.3 --at 0 0 0.18
montage "$scratch"/[1-6].png -tile 3x2 -geometry +2+2 +dither -colors 40 -strip PNG8:"$out"
ls -l "$out"
