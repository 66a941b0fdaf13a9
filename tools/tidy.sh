#!/usr/bin/env bash
# clang-tidy on the files of the latest changes and on a rotating tenth of the rest (tools/recent-sources.sh), within a budget of seconds.
set -euo pipefail
build=$1
budget=$2
# shellcheck disable=SC2046
list=$(tools/recent-sources.sh $(python3 tools/rooms.py --top | grep -v -x bench))
total=$(wc -l <<< "$list")
state=$(mktemp -d)
trap 'rm -rf "$state"' EXIT
# Clang cannot read the precompiled headers of another compiler (cmake/precompiled.cmake).
sed -E 's/-Winvalid-pch -include [^ ]+//' "$build/compile_commands.json" > "$state/compile_commands.json"
export state
start=$(date +%s)
export end=$((start + budget))
check() {
  [ "$(date +%s)" -lt "$end" ] || exit 0
  if ! clang-tidy -p "$state" --quiet --extra-arg=-Wno-unknown-warning-option \
    --extra-arg=-Wno-sign-conversion "$1" > "$state/out.$$" 2> "$state/err.$$"; then
    cat "$state/out.$$"
    grep -E 'error:' "$state/err.$$" || true
    touch "$state/failed"
  fi
  echo "$1" >> "$state/done"
}
export -f check
printf '%s\n' "$list" | xargs -P "$(nproc)" -I{} bash -c 'check {}'
echo "clang-tidy: $(wc -l < "$state/done" 2>/dev/null || echo 0) of $total files"
[ ! -e "$state/failed" ]
