#!/usr/bin/env bash
# Builds and runs the benchmarks; CSV, plots and report.html in BUILD/bench. MODE: quick | full.
set -euo pipefail
build=$1
mode=$2
jobs=$(nproc)
programs=(bench_race bench_effects bench_haptics bench_pipeline bench_audio bench_realtime)
cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DSPARSHA_BUILD_BENCH=ON
cmake --build "$build" -j"$jobs" --target sparsha "${programs[@]}" bench_report
out=$build/bench
mkdir -p "$out"
rm -f "$out"/*.csv "$out"/*.svg "$out"/*.html  # what an earlier run left would be taken for this run's
began=$SECONDS
for program in "${programs[@]}"; do
  echo "== $program"
  start=$SECONDS
  "$build/bin/$program" --mode "$mode" --out "$out"
  echo "== $program took $((SECONDS - start)) s"
done
"$build/bin/bench_report" --mode "$mode" --out "$out" --seconds $((SECONDS - began))
echo "bench: measured in $((SECONDS - began)) s, $out/report.html"
