#!/usr/bin/env bash
# Builds and runs the benchmarks; results as CSV and report.html in BUILD/bench. MODE: quick | full.
set -euo pipefail
build=$1
mode=$2
jobs=$(nproc)
cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DSPARSHA_BUILD_BENCH=ON
cmake --build "$build" -j"$jobs"
out=$build/bench
mkdir -p "$out"
for program in "$build"/bin/bench_*; do
  [ -x "$program" ] || continue
  echo "== $(basename "$program")"
  "$program" --mode "$mode" --out "$out"
done
