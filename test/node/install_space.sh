#!/bin/bash
# Installs into a scratch prefix and runs a rostest from there; nothing of the source tree or the build folder is on
# any path.  install_space.sh BUILD PYTHON ROSTEST
set -eu
build=$(cd "$1" && pwd) python=$2 rostest=$3
prefix=$(mktemp -d)
trap 'chmod -R u+w "$prefix"; rm -rf "$prefix"' EXIT
source=$(cd "$(dirname "$0")/../.." && pwd)

# the install rules of a catkin package ask for DESTDIR-free prefixes
cmake --install "$build" --prefix "$prefix/install" >"$prefix/install.log" || { cat "$prefix/install.log"; exit 1; }

fail() { echo "FAIL $1"; exit 1; }
cd /
share=$prefix/install/share/robot_cloth
for file in "$prefix/install/lib/robot_cloth/cloth_node" "$prefix/install/lib/librobot_cloth_nodelet.so" \
            "$prefix/install/include/robot_cloth/cloth.h" "$prefix/install/include/robot_cloth/State.h" \
            "$share/package.xml" "$share/launch/node.launch" "$share/config/params/node.yaml" \
            "$share/config/nodelet_plugins.xml" "$share/test/node/towel.test"; do
  [ -e "$file" ] || fail "missing after install: ${file#"$prefix"/}"
done
echo "ok   everything_is_installed"

# the public header stands alone
echo '#include <robot_cloth/cloth.h>
int main(void) { return cloth_effect_count() < 0; }' >"$prefix/use.c"
cc -I"$prefix/install/include" "$prefix/use.c" -L"$prefix/install/lib" -lcloth -Wl,-rpath,"$prefix/install/lib" \
   -Wl,-rpath-link,"$prefix/install/lib" -o "$prefix/use" && "$prefix/use" || fail "a program against the installed library"
echo "ok   a_c_program_builds_and_runs_against_the_installed_library"

if ldd "$prefix/install/lib/robot_cloth/cloth_node" | grep -E "not found|$build"; then fail "libraries of the build folder"; fi
echo "ok   no_library_of_the_build_folder_is_used"

# a read-only installation is enough
chmod -R a-w "$prefix/install"
export WITH_ROS=$source/src/demo/with_ros.sh
"$source/test/node/run_rostest.sh" "$prefix/install" "$python" "$rostest" "$share/test/node/lockstep.test"
