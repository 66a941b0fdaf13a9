#!/usr/bin/env bash
# Builds and runs the benchmarks; CSV, plots and report.html in BUILD/bench. MODE: quick | full.
set -euo pipefail
build=$1
mode=$2
jobs=$(nproc)
# The race comes last: its report.html names the files that the others left.
programs=(bench_haptics bench_pipeline bench_audio bench_race)
cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DSPARSHA_BUILD_BENCH=ON
cmake --build "$build" -j"$jobs" --target "${programs[@]}"
out=$build/bench
mkdir -p "$out"
rm -f "$out/report.html"
for program in "${programs[@]}"; do
  echo "== $program"
  start=$SECONDS
  "$build/bin/$program" --mode "$mode" --out "$out"
  echo "== $program took $((SECONDS - start)) s"
done
echo "bench: $out/report.html"
