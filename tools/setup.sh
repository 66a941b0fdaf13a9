#!/usr/bin/env bash
# Installs the Debian packages that a list names and the machine lacks; says which first. Nothing missing: no apt at all.
# setup.sh LIST [run|package]: with `run` the list ends at the line that begins with "# below:", with `package` at the one
# that begins with "# below that:".
set -euo pipefail
list=$1
until=${2:-all}

if ! command -v dpkg-query >/dev/null 2>&1; then
  echo "setup: this is not Debian; install what $list names by your system's own means" >&2
  exit 0
fi
missing=()
while read -r name; do
  if [ "$until" = run ] && [[ $name == '# below:'* ]]; then break; fi
  if [ "$until" = package ] && [[ $name == '# below that:'* ]]; then break; fi
  case $name in ''|'#'*) continue ;; esac
  status=$(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null || true)
  [ "$status" = installed ] || missing+=("$name")
done < "$list"
[ ${#missing[@]} -gt 0 ] || exit 0

echo "setup: installing ${#missing[@]} packages and what they depend on: ${missing[*]}"
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null 2>&1 || { echo "setup: needs root or sudo to install packages" >&2; exit 1; }
  as_root=(sudo)
fi
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
