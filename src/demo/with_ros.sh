#!/bin/bash
# Runs a command where ROS finds robot_cloth:  with_ros.sh BUILD_OR_INSTALL_FOLDER COMMAND [ARGUMENT...]
# Keeps a pyenv or conda python out of the way: ROS's tools need the system's.
set -eu
folder=$(cd "$1" && pwd)
shift
export PATH=/usr/bin:/bin:$PATH
setup=
for candidate in "$folder/devel/setup.bash" "$folder/setup.bash"; do
  if [ -f "$candidate" ]; then setup=$candidate; break; fi
done
if [ -z "$setup" ]; then
  echo "with_ros.sh: no setup.bash in $folder; build with ROS first (make build)" >&2
  exit 2
fi
# Debian's ROS lives in /usr and has no setup file of its own that sets these
export ROS_ROOT=${ROS_ROOT:-/usr/share} ROS_ETC_DIR=${ROS_ETC_DIR:-/etc/ros} ROS_DISTRO=${ROS_DISTRO:-debian}
export ROS_VERSION=${ROS_VERSION:-1}
export ROS_MASTER_URI=${ROS_MASTER_URI:-http://localhost:11311}
case ":${ROS_PACKAGE_PATH:-}:" in *:/usr/share:*) ;; *) export ROS_PACKAGE_PATH=${ROS_PACKAGE_PATH:+$ROS_PACKAGE_PATH:}/usr/share ;; esac
set +eu # the setup files of catkin use unset variables
# shellcheck disable=SC1090
source "$setup" --extend
set -eu
case ":$ROS_PACKAGE_PATH:" in *:/usr/share:*) ;; *) export ROS_PACKAGE_PATH=$ROS_PACKAGE_PATH:/usr/share ;; esac
exec "$@"
