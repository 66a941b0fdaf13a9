#!/usr/bin/env bash
# The slow checks: heavy tests, soak, all tests under ASan+UBSan, threads under TSan, a Clang build, fuzzing, coverage.
# Each part prints its result; the first failure ends the run. SPARSHA_FUZZ_SECONDS (default 60) is per target.
set -euo pipefail
jobs=$(nproc)
fuzz_seconds=${SPARSHA_FUZZ_SECONDS:-60}
began=$SECONDS
section() { printf '\n== %s (%d s)\n' "$1" $((SECONDS - began)); }
tools/setup.sh packages-nightly.txt
if [ -d ../shared/data ]; then
  SPARSHA_SCANS_DIR=$(cd ../shared/data && pwd)
  export SPARSHA_SCANS_DIR
fi

section "Release: every test, the heavy ones too"
cmake --preset release -DSPARSHA_BUILD_BENCH=ON > /dev/null
cmake --build build -j"$jobs"
SPARSHA_NIGHTLY=1 ctest --test-dir build -j"$jobs" --output-on-failure --no-tests=error --timeout 3600

section "Soak: 10^8 moves of the proxy"
make soak

section "ASan and UBSan: all tests"
cmake --preset asan > /dev/null
cmake --build build-asan -j"$jobs"
ctest --test-dir build-asan -j"$jobs" --output-on-failure --no-tests=error --timeout 3600

section "TSan: servo, session, devices, audio, thread pool"
cmake --preset tsan > /dev/null
threaded=(pipeline_base_test haptics_shared_test haptics_device_test haptics_servo_test haptics_session_test audio_test)
cmake --build build-tsan -j"$jobs" --target "${threaded[@]}"
export TSAN_OPTIONS="suppressions=$PWD/tests/tsan.supp"
for program in "${threaded[@]}"; do build-tsan/tests/"$program" --gtest_brief=1; done

section "Clang"
cmake -S . -B build-clang -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=clang++ > /dev/null
cmake --build build-clang -j"$jobs"
ctest --test-dir build-clang -j"$jobs" --output-on-failure --no-tests=error --timeout 3600

section "Fuzzing, $fuzz_seconds s a target"
cmake -S . -B build-fuzz -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_COMPILER=clang++ -DSPARSHA_BUILD_FUZZ=ON \
  -DSPARSHA_BUILD_TESTS=OFF "-DSPARSHA_SANITIZE=fuzzer-no-link,address,undefined" > /dev/null
cmake --build build-fuzz -j"$jobs" --target fuzzers
for target in build-fuzz/fuzz/*_fuzz; do
  corpus=build-fuzz/corpus/$(basename "$target")
  mkdir -p "$corpus"
  if [ -n "${SPARSHA_SCANS_DIR:-}" ] && [ "$(basename "$target")" = scan_fuzz ]; then
    find "$SPARSHA_SCANS_DIR" -type f -size -64k -exec cp -n {} "$corpus" \;
  fi
  "$target" -max_total_time="$fuzz_seconds" -rss_limit_mb=2048 -timeout=10 -print_final_stats=1 "$corpus" 2>&1 | tail -12
done

section "Coverage of the pipeline, haptics and audio"
cmake -S . -B build-coverage -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_FLAGS=--coverage -fprofile-update=atomic" > /dev/null
cmake --build build-coverage -j"$jobs"
ctest --test-dir build-coverage -j"$jobs" --output-on-failure --no-tests=error --timeout 3600
gcovr --gcov-ignore-parse-errors --root . --filter '(pipeline|haptics|audio|viewer|app)/' --txt build-coverage/coverage.txt build-coverage
tail -3 build-coverage/coverage.txt

section "done"
