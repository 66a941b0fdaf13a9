#!/usr/bin/env bash
# The slow checks: heavy tests, soak, all tests under ASan+UBSan, threads under TSan, a Clang build, fuzzing, coverage.
# Each part runs, also after one that failed; the end lists what each came to, and the exit code is 1 if any failed.
# SPARSHA_FUZZ_SECONDS (default 60) is per target. Names of parts as arguments run only those.
set -uo pipefail
jobs=$(nproc)
fuzz_seconds=${SPARSHA_FUZZ_SECONDS:-60}
if [ -d ../shared/data ]; then
  SPARSHA_SCANS_DIR=$(cd ../shared/data && pwd)
  export SPARSHA_SCANS_DIR
fi
all_tests() { ctest --test-dir "$1" -j"$jobs" --output-on-failure --no-tests=error --timeout 3600; }

# Release: every test, the heavy ones too.
release() {
  cmake --preset release -DSPARSHA_BUILD_TESTS=ON -DSPARSHA_BUILD_BENCH=ON > /dev/null
  cmake --build build -j"$jobs"
  SPARSHA_NIGHTLY=1 all_tests build
}

# 10^8 moves of the proxy.
soak() { make soak; }

# ASan and UBSan: all tests.
asan() {
  cmake --preset asan > /dev/null
  cmake --build build-asan -j"$jobs"
  all_tests build-asan
}

# TSan: servo, session, devices, audio, thread pool.
tsan() {
  local threaded=(base_test haptics_state_test haptics_device_test haptics_servo_test haptics_replay_test haptics_session_test
    audio_test)
  local program
  cmake --preset tsan > /dev/null
  cmake --build build-tsan -j"$jobs" --target "${threaded[@]}"
  for program in "${threaded[@]}"; do
    TSAN_OPTIONS="suppressions=$PWD/tests/tsan.supp" build-tsan/tests/"$program" --gtest_brief=1
  done
}

clang() {
  cmake -S . -B build-clang -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=clang++ > /dev/null
  cmake --build build-clang -j"$jobs"
  all_tests build-clang
}

fuzz() {
  local target corpus
  cmake -S . -B build-fuzz -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_COMPILER=clang++ -DSPARSHA_BUILD_FUZZ=ON \
    -DSPARSHA_BUILD_TESTS=OFF "-DSPARSHA_SANITIZE=fuzzer-no-link,address,undefined" > /dev/null
  cmake --build build-fuzz -j"$jobs" --target fuzzers
  for target in build-fuzz/fuzz/*_fuzz; do
    corpus=build-fuzz/corpus/$(basename "$target")
    mkdir -p "$corpus"
    if [ -n "${SPARSHA_SCANS_DIR:-}" ] && [ "$(basename "$target")" = scan_fuzz ]; then
      find "$SPARSHA_SCANS_DIR" -type f -size -64k -exec cp -n {} "$corpus" \;
    fi
    "$target" -max_total_time="$fuzz_seconds" -rss_limit_mb=2048 -timeout=10 -print_final_stats=1 "$corpus" 2>&1 |
      tail -12
  done
}

# Coverage of the pipeline, haptics, audio, viewer and program.
coverage() {
  cmake -S . -B build-coverage -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_FLAGS=--coverage -fprofile-update=atomic" \
    > /dev/null
  cmake --build build-coverage -j"$jobs"
  all_tests build-coverage
  gcovr --gcov-ignore-parse-errors --root . --filter '(pipeline|haptics|audio|viewer|app)/' \
    --txt build-coverage/coverage.txt build-coverage
  tail -3 build-coverage/coverage.txt
}

parts=("$@")
[ $# -gt 0 ] || parts=(release soak asan tsan clang fuzz coverage)
for part in "${parts[@]}"; do
  case $part in
    release | soak | asan | tsan | clang | fuzz | coverage) ;;
    *) echo "tools/nightly.sh: no part '$part' (release, soak, asan, tsan, clang, fuzz, coverage)" >&2; exit 2 ;;
  esac
done
tools/setup.sh packages-nightly.txt || exit 1

results=()
failed=0
for part in "${parts[@]}"; do
  began=$SECONDS
  printf '\n== %s\n' "$part"
  # A shell of its own: `set -e` has no effect in a function that is a condition.
  (set -e; "$part")
  code=$?
  if [ $code -eq 0 ]; then result=passed; else result="FAILED (exit $code)"; failed=1; fi
  results+=("$(printf '%-9s %-18s %5d s' "$part" "$result" $((SECONDS - began)))")
done
printf '\n== result\n'
printf '%s\n' "${results[@]}"
exit $failed
