#!/usr/bin/env bash
# clang-tidy on the files of the latest changes and on a rotating tenth of the rest, within a budget of seconds.
set -euo pipefail
build=$1
budget=$2
base=$(git rev-list -1 --before='1 day ago' HEAD || true)
sources() { grep -E '^(base|scene|pipeline|haptics|sparsha|audio|viewer|app)/.*\.cpp$' || true; }
changed=$(if [ -n "$base" ]; then git diff --name-only --diff-filter=AMR "$base" HEAD; else git ls-files; fi | sources)
day=$(($(date +%s) / 86400))
tenth=$(git ls-files | sources | awk -v day="$day" 'NR % 10 == day % 10')
# Rotated by day too, so that a budget cuts other files tomorrow.
list=$(printf '%s\n%s\n' "$changed" "$tenth" | awk -v day="$day" 'NF && !seen[$0]++ {f[n++]=$0} END {for (i=0;i<n;i++) print f[(i+day*37)%n]}')
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
