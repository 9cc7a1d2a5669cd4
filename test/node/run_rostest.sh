#!/bin/bash
# Runs one rostest so that its single tests can be counted:  run_rostest.sh BUILD PYTHON ROSTEST FILE [ARGUMENT...]
# With --text rostest shows every test but always exits 0; the summary in its output decides instead.
set -u
here=$(cd "$(dirname "$0")" && pwd)
build=$1 python=$2 rostest=$3
shift 3
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export ROS_HOME=$scratch
"${WITH_ROS:-$here/../../src/demo/with_ros.sh}" "$build" "$python" "$rostest" --text "$@" 2>&1 | tee "$scratch/output"
status=${PIPESTATUS[0]}
grep -q 'RESULT: SUCCESS' "$scratch/output" && ! grep -qE 'RESULT: FAIL' "$scratch/output" && exit "$status"
exit 1
