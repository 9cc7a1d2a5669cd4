#!/bin/bash
# Installs the Debian packages of .ci/packages.txt that are missing, through apt-get.
#   install_packages.sh [--check]     --check: only say what is missing; exit code 1 if anything is
set -eu
here=$(cd "$(dirname "$0")" && pwd)
list=$here/../../.ci/packages.txt

if ! command -v dpkg-query >/dev/null; then
  echo "robot_cloth: no dpkg here, so packages cannot be checked; what is needed stands in .ci/packages.txt" >&2
  exit 0
fi
missing=()
while read -r package; do
  state=$(dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null) || state=
  [ "${state:0:2}" = ii ] || missing+=("$package")
done < <(sed 's/#.*//; s/[[:space:]]*$//; /^$/d' "$list")

[ ${#missing[@]} -gt 0 ] || exit 0
echo "robot_cloth: missing packages: ${missing[*]}"
[ "${1:-}" != --check ] || exit 1

become=()
if [ "$(id -u)" != 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "robot_cloth: neither root nor sudo; ask an administrator to run" >&2
    echo "  apt-get install ${missing[*]}" >&2
    exit 2
  fi
  become=(sudo)
fi
export DEBIAN_FRONTEND=noninteractive
# an old package list is common on a fresh machine: update only if the install does not work without
install=(apt-get install -y --no-install-recommends "${missing[@]}")
"${become[@]}" "${install[@]}" </dev/null >/dev/null 2>&1 || {
  "${become[@]}" apt-get update
  "${become[@]}" "${install[@]}" </dev/null
}
