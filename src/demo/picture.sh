#!/bin/bash
# Renders the demo in RViz to PNGs and one sheet of them (fold.png), without a display: Xvfb and software GL.
#   picture.sh BUILD_OR_INSTALL_FOLDER OUT_FOLDER [NAME:SEGMENT:SHARE ...]
# The fold runs step by step and holds still at each moment, so the speed of the machine shows in nothing.
# Own X display and own ROS master; every process is ended by its own pid.
set -u
here=$(cd "$(dirname "$0")" && pwd)
build=$1
mkdir -p "$2"
out=$(cd "$2" && pwd)
shift 2
moments=("$@")
[ ${#moments[@]} -gt 0 ] || moments=(grasp:hold:0.9 lift:lift:1.0 swing:swing:0.34 over:swing:0.62 laid:rest:0.9 folded:return:1.0)

if [ -z "${PICTURE_INSIDE:-}" ]; then
  PICTURE_INSIDE=1 exec "$here/with_ros.sh" "$build" "$here/picture.sh" "$build" "$out" "${moments[@]}"
fi

log=$(mktemp -d)
pids=() shots=()
bg() { # name, command...
  local name=$1
  shift
  "$@" >"$log/$name.log" 2>&1 &
  pids+=($!)
}
finish() { # newest first, each waited for: RViz must end before the X server
  local code=$?
  trap - EXIT
  for ((i = ${#pids[@]} - 1; i >= 0; i--)); do
    kill -TERM "${pids[i]}" 2>/dev/null
    for ((n = 0; n < 100; n++)); do kill -0 "${pids[i]}" 2>/dev/null || break; sleep 0.1; done
    kill -KILL "${pids[i]}" 2>/dev/null
    wait "${pids[i]}" 2>/dev/null
  done
  if [ "$code" = 0 ]; then rm -rf "$log"; else echo "picture.sh: the logs are in $log" >&2; fi
  exit "$code"
}
trap finish EXIT
trap 'exit 130' INT TERM
fail() { echo "picture.sh: $1" >&2; tail -n 15 "$log/$2.log" >&2; exit 1; }
until_ok() { # tries, command...: every fifth of a second
  local tries=$1
  shift
  for ((k = 0; k < tries; k++)); do
    timeout 10 "$@" >/dev/null 2>&1 && return 0
    sleep 0.2
  done
  return 1
}

# X server: it picks a free display number itself
mkfifo "$log/number"
exec 3<>"$log/number"
bg xvfb Xvfb -displayfd 3 -screen 0 1920x1080x24 +extension GLX +render -noreset -nolisten tcp
read -r -t 20 number <&3 || fail "Xvfb did not start" xvfb
export DISPLAY=:$number
export LIBGL_ALWAYS_SOFTWARE=1 GALLIUM_DRIVER=llvmpipe __GLX_VENDOR_LIBRARY_NAME=mesa
export QT_X11_NO_MITSHM=1 QT_QPA_PLATFORM=xcb OGRE_RTT_MODE=Copy XDG_RUNTIME_DIR=$log/xdg
mkdir -p -m 700 "$XDG_RUNTIME_DIR"

# ROS master on a free port
port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
export ROS_MASTER_URI=http://127.0.0.1:$port ROS_IP=127.0.0.1 ROS_HOME=$log/ros
unset ROS_HOSTNAME
bg roscore roscore -p "$port"
until_ok 100 rosparam list || fail "roscore did not start" roscore

yaml=
for moment in "${moments[@]}"; do
  IFS=: read -r name segment share <<<"$moment"
  yaml+="$name: [$segment, $share], "
done
rosparam set /fold_motion/moments "{${yaml%, }}"
bg fold roslaunch robot_cloth fold.launch gui:=false lockstep:=true stay:=true ${PICTURE_ARGS:-}
# the view alone, without docks, drawn as large as the screen
python3 - "$here/../../config/rviz/fold.rviz" "$log/view.rviz" <<'PYTHON'
import sys
import yaml
with open(sys.argv[1]) as source:
    view = yaml.safe_load(source)
view['Panels'] = []
view['Window Geometry'] = dict(Width=1920, Height=1080, X=0, Y=0)
with open(sys.argv[2], 'w') as out:
    yaml.safe_dump(view, out)
PYTHON
bg rviz rviz -d "$log/view.rviz" --no-stereo
until_ok 150 bash -c 'rostopic info /cloth/markers | grep -q /rviz' || fail "RViz does not listen" rviz

moment_now() { timeout 5 rostopic echo -n 1 /fold_motion/moment/data 2>/dev/null | head -n 1 | tr -d '"'; }
for moment in "${moments[@]}"; do
  name=${moment%%:*}
  for ((k = 0; k < 120; k++)); do
    kill -0 "${pids[2]}" 2>/dev/null || fail "the demo ended early" fold
    [ "$(moment_now)" = "$name" ] && break
  done
  [ "$k" -lt 120 ] || fail "the fold did not come to \"$name\"" fold
  sleep "${SETTLE:-4}" # RViz draws what it has got
  kill -0 "${pids[3]}" 2>/dev/null || fail "RViz ended early" rviz
  import -window root "png:$log/shot.png" || fail "no screenshot" rviz
  convert "$log/shot.png" -crop "${CROP:-1720x940+100+80}" +repage -strip "$out/$name.png"
  echo "$out/$name.png"
  rosparam set /fold_motion/seen "$name"
  shots+=("$out/$name.png")
done
# all of them on one sheet, in three columns, in the order of the story
montage "${shots[@]}" -tile 3x -geometry 800x437+3+3 -background white miff:- |
  convert - -strip -dither FloydSteinberg -colors 256 "PNG8:$out/fold.png" && echo "$out/fold.png"
exit 0
