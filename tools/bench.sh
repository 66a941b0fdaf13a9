#!/usr/bin/env bash
# Builds and runs the benchmarks; CSV, plots and report.html in BUILD/bench. MODE: quick | full. A program that fails
# leaves its part of the page out; the exit code is then 1.
set -euo pipefail
build=$1
mode=$2
jobs=$(nproc)
began=$SECONDS
programs=(bench_race bench_effects bench_haptics bench_pipeline bench_audio bench_realtime)
if [ -z "${SPARSHA_SCANS_DIR:-}" ] && [ -d ../shared/data ]; then
  SPARSHA_SCANS_DIR=$(cd ../shared/data && pwd)
  export SPARSHA_SCANS_DIR
fi
cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DSPARSHA_BUILD_BENCH=ON -DSPARSHA_LIBRARY_ASSERTIONS=OFF
cmake --build "$build" -j"$jobs" --target sparsha_runnable "${programs[@]}" bench_report
out=$build/bench
mkdir -p "$out"
rm -f "$out"/*.csv "$out"/*.svg "$out"/*.html  # what an earlier run left would be taken for this run's
failed=()
measuring=$SECONDS
for program in "${programs[@]}"; do
  echo "== $program"
  start=$SECONDS
  "$build/bin/$program" --mode "$mode" --out "$out" || failed+=("$program")
  echo "== $program took $((SECONDS - start)) s"
done
measured=$((SECONDS - measuring))
"$build/bin/bench_report" --mode "$mode" --out "$out" --seconds "$measured" || failed+=(bench_report)
echo "bench: $((SECONDS - began)) s in all, $measured s of them measuring; $out/report.html"
if [ ${#failed[@]} -gt 0 ]; then
  echo "bench: failed: ${failed[*]}" >&2
  exit 1
fi
