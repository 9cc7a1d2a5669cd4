#!/bin/bash
# Packs what test/gpu.sh needs on a host that has a GPU but neither compilers nor ROS: an install of this package with
# the libraries that neither the host nor the ROS runtime has, the programs of the GPU tests, and the scenes.
#
#   gpu_pack.sh BUILD RUNTIME OUT
#
# RUNTIME is a relocatable ROS 1 runtime: a folder with `rosrt` and env.sh that reads $ROSRT_OVERLAY. It is not copied.
# On the other host:   ROSRT=/where/the/runtime/is OUT/test/gpu.sh OUT/programs
set -eu
build=$(cd "$1" && pwd) runtime=$(cd "$2" && pwd) root=$(cd "$(dirname "$0")/.." && pwd)
out=$3
mkdir -p "$out/programs/test"
out=$(cd "$out" && pwd)

# a devel space holds absolute paths: install
stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
DESTDIR=$stage cmake --install "$build" >"$stage/install.log" || { cat "$stage/install.log"; exit 1; }
rm -rf "$out/install"
mv "$stage$(sed -n 's/^CMAKE_INSTALL_PREFIX:PATH=//p' "$build/CMakeCache.txt")" "$out/install"
: >"$out/install/.catkin" # marks it as a workspace
grep -rlI '^#!/usr/bin/python3' "$out/install" | xargs -r sed -i '1s,^#!/usr/bin/python3,#!/usr/bin/env python3,'

for program in cloth libcloth.so libcloth_f32.so libcloth_f64.so; do cp "$build/$program" "$out/programs/"; done
for program in backend_cuda_f32 backend_cuda_f64 solve_recut_f32 solve_recut_f64 engine_determinism engine_mass_spring_bits engine_crumple check_meshes; do
  found=$(find "$build" -name "$program" -type f -perm -u+x | head -n 1)
  [ -z "$found" ] || cp "$found" "$out/programs/test/"
done
mkdir -p "$out/test/bench" "$out/config"
cp "$root/test/gpu.sh" "$out/test/" && cp -r "$root/test/bench/scale.py" "$root/test/bench/scenes" "$out/test/bench/"
cp -r "$root/config/scenes" "$root/config/materials" "$root/config/meshes" "$out/config/"
mkdir -p "$out/test/scenes" && cp "$root/test/scenes/two_small_towels.yaml" "$out/test/scenes/"

# libraries that are nowhere else over there; those of the C and C++ compiler are any host's
any_host() {
  case $1 in libc.so* | libm.so* | libdl.so* | librt.so* | libpthread.so* | libresolv.so* | libstdc++.so* | libgcc_s.so* | ld-linux*) return 0 ;; esac
  return 1
}
have=" $(cd "$runtime" && find . -name '*.so*' -printf '%f ') $(cd "$out/install/lib" && find . -name '*.so*' -printf '%f ') "
for file in "$out"/install/lib/robot_cloth/cloth_node "$out"/install/lib/*.so "$out"/programs/test/*; do
  ldd "$file" | awk '$3 ~ "^/" { print $1, $3 }'
done | sort -u | while read -r name path; do
  any_host "$name" || case $have in *" $name "*) ;; *) cp -L "$path" "$out/install/lib/$name" ;; esac
done
# the command and the tests run without the runtime's environment
for file in "$out"/programs/cloth "$out"/programs/libcloth*.so "$out"/programs/test/*; do ldd "$file" | awk '$3 ~ "^/" { print $1, $3 }'; done | sort -u |
  while read -r name path; do
    any_host "$name" || [ -e "$out/programs/$name" ] || cp -L "$path" "$out/programs/$name"
  done
du -sh "$out"
