#!/bin/bash
# Installs into a scratch prefix and runs a rostest from there; nothing of the source tree or the build folder is on
# any path.  install_space.sh BUILD PYTHON ROSTEST
set -eu
build=$(cd "$1" && pwd) python=$2 rostest=$3
scratch=$(mktemp -d)
trap 'chmod -R u+w "$scratch"; rm -rf "$scratch"' EXIT
source=$(cd "$(dirname "$0")/../.." && pwd)

# catkin fixes the prefix when it is configured and ignores --prefix for its setup files: stage it
DESTDIR=$scratch/stage cmake --install "$build" >"$scratch/install.log" || { cat "$scratch/install.log"; exit 1; }
prefix=$scratch/stage$(sed -n 's/^CMAKE_INSTALL_PREFIX:PATH=//p' "$build/CMakeCache.txt")

fail() { echo "FAIL $1"; exit 1; }
cd /
share=$prefix/share/robot_cloth
for file in "$prefix/lib/robot_cloth/cloth_node" "$prefix/lib/librobot_cloth_nodelet.so" \
            "$prefix/include/robot_cloth/cloth.h" "$prefix/include/robot_cloth/State.h" \
            "$share/package.xml" "$share/launch/node.launch" "$share/config/params/node.yaml" \
            "$share/config/nodelet_plugins.xml" "$share/test/node/towel.test"; do
  [ -e "$file" ] || fail "missing after install: ${file#"$prefix"/}"
done
echo "ok   everything_is_installed"

# the public header stands alone
echo '#include <robot_cloth/cloth.h>
int main(void) { return cloth_effect_count() < 0; }' >"$scratch/use.c"
cc -I"$prefix/include" "$scratch/use.c" -L"$prefix/lib" -lcloth -Wl,-rpath,"$prefix/lib" \
   -Wl,-rpath-link,"$prefix/lib" -o "$scratch/use" && "$scratch/use" || fail "a program against the installed library"
echo "ok   a_c_program_builds_and_runs_against_the_installed_library"

if ldd "$prefix/lib/robot_cloth/cloth_node" | grep -E "not found|$build"; then fail "libraries of the build folder"; fi
echo "ok   no_library_of_the_build_folder_is_used"

# a read-only installation is enough
chmod -R a-w "$prefix"
export WITH_ROS=$source/src/demo/with_ros.sh
"$source/test/node/run_rostest.sh" "$prefix" "$python" "$rostest" "$share/test/node/lockstep.test"
