#!/usr/bin/env bash
# The .cpp files of some folders that checks with a budget look at, one a line: those that the last day changed and a tenth
# of the rest; with --users also those that include a header of that day. Tenth and order rotate by day, so that a budget
# cuts other files tomorrow. tools/recent-sources.sh [--users] FOLDER...
set -euo pipefail
users=
if [ "$1" = --users ]; then users=1; shift; fi
rooms=$(IFS='|'; echo "$*")
base=$(git rev-list -1 --before='1 day ago' HEAD || true)
sources() { grep -E "^($rooms)/.*\.cpp$" || true; }
touched=$(if [ -n "$base" ]; then git diff --name-only --diff-filter=AMR "$base" HEAD; else git ls-files; fi)
if [ -n "$users" ]; then
  headers=$(grep -E '\.(h|hpp)$' <<< "$touched" | sed 's/.*/#include "&"/' || true)
  users=$(if [ -n "$headers" ]; then git grep -lF "$headers" -- '*.cpp' || true; fi)
fi
day=$(($(date +%s) / 86400))
tenth=$(git ls-files | sources | awk -v day="$day" 'NR % 10 == day % 10')
printf '%s\n%s\n%s\n' "$(sources <<< "$touched")" "$tenth" "$(sources <<< "$users")" |
  awk -v day="$day" 'NF && !seen[$0]++ {f[n++]=$0} END {for (i=0;i<n;i++) print f[(i+day*37)%n]}'
