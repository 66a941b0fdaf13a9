#!/usr/bin/env bash
# The slow checks: heavy tests, soak, all tests built by Clang under ASan and UBSan with coverage, threads under TSan,
# fuzzing, the core for arm64, packages built twice, the documents in a browser.
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

# One of ALSA's plug-ins loads libraries that lose memory and that bear no second loading, and unloads them, so that no
# sanitizer's list can name them.
without_alsa_plugins() {
  sed '/^@hooks \[/,/^\]/d' /usr/share/alsa/alsa.conf > "$1/alsa.conf"
  export ALSA_CONFIG_PATH=$PWD/$1/alsa.conf
}

# Release: every test, the heavy ones too, and the figures of the Python module.
release() {
  cmake --preset release -DSPARSHA_BUILD_TESTS=ON -DSPARSHA_BUILD_BENCH=ON -DSPARSHA_LIBRARY_ASSERTIONS=OFF > /dev/null
  cmake --build build -j"$jobs"
  cmake --build build -j"$jobs" --target sparsha_packaged  # which a test packs, installs and removes
  SPARSHA_NIGHTLY=1 all_tests build
  PYTHONPATH=build/python /usr/bin/python3 tools/python-figures.py build/bin/sparsha
}

# 10^8 moves of the proxy.
soak() { make soak; }

# Clang with ASan, UBSan, the library's own assertions (cmake/options.cmake) and coverage counters: all tests; one build and one run serve all three. GCC's sanitizers see
# readers and contact at every change (.ci/run). -O2, since below it Clang inlines nothing: with -O1 the tests took ten
# times as long as those of the release. UBSan and counters leave out the headers of Eigen, PCL and the like: a file that
# registers scans compiles in half the time and is a third of the size.
clang() {
  local build=build-clang program objects=() watched
  watched="-fsanitize-ignorelist=$PWD/tools/clang-foreign.txt -fprofile-list=$PWD/tools/clang-counted.txt"
  cmake -S . -B $build -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_COMPILER=clang++ -DSPARSHA_BUILD_BENCH=ON \
    "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O2 -gline-tables-only -DNDEBUG" -DSPARSHA_SANITIZE=address,undefined \
    "-DCMAKE_CXX_FLAGS=-fprofile-instr-generate -fcoverage-mapping $watched" > /dev/null
  cmake --build $build -j"$jobs"
  rm -rf $build/profiles
  without_alsa_plugins $build
  # Processes of one program merge their counts into the same four files.
  LLVM_PROFILE_FILE="$PWD/$build/profiles/%4m.profraw" all_tests $build
  for program in $build/tests/*_test; do objects+=(-object "$program"); done
  llvm-profdata merge -sparse --failure-mode=all $build/profiles/*.profraw -o $build/tests.profdata
  llvm-cov report "$build"/lib*/sparsha/sparsha "${objects[@]}" -instr-profile=$build/tests.profdata \
    "-ignore-filename-regex=(^|/)(usr|bench|examples|tests)/" 2> /dev/null > $build/coverage.txt
  tail -1 $build/coverage.txt
}

# TSan: servo, session, devices, audio, thread pool.
tsan() {
  local threaded=(base_test haptics_state_test haptics_device_test haptics_device_falcon_test haptics_device_haply_test haptics_servo_test
    haptics_replay_test haptics_session_test audio_test)
  local program
  cmake --preset tsan > /dev/null
  cmake --build build-tsan -j"$jobs" --target "${threaded[@]}"
  without_alsa_plugins build-tsan
  for program in "${threaded[@]}"; do
    TSAN_OPTIONS="suppressions=$PWD/tests/tsan.supp" build-tsan/tests/"$program" --gtest_brief=1
  done
}

fuzz() {
  local target corpus timeout
  cmake -S . -B build-fuzz -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_COMPILER=clang++ -DSPARSHA_BUILD_FUZZ=ON \
    -DSPARSHA_BUILD_TESTS=OFF "-DSPARSHA_SANITIZE=fuzzer-no-link,address,undefined" > /dev/null
  cmake --build build-fuzz -j"$jobs" --target fuzzers
  for target in build-fuzz/fuzz/*_fuzz; do
    corpus=build-fuzz/corpus/$(basename "$target")
    mkdir -p "$corpus"
    if [ "$(basename "$target")" = scan_fuzz ]; then
      local scans=()
      if [ -n "${SPARSHA_SCANS_DIR:-}" ]; then mapfile -t scans < <(find "$SPARSHA_SCANS_DIR" -type f -size -64k); fi
      build-fuzz/fuzz/make_seeds "$corpus" "${scans[@]}"
    fi
    timeout=10
    # A whole build, its report and all that is done with the scene; its recipes are short.
    if [ "$(basename "$target")" = whole_way_fuzz ]; then timeout=60; fi
    "$target" -max_total_time="$fuzz_seconds" -rss_limit_mb=2048 -timeout=$timeout -print_final_stats=1 "$corpus" 2>&1 |
      tail -12
  done
}

# The core for another processor: a cross compiler builds it, an emulator runs its tests.
arm64() {
  cmake -S tests/arm64 -B build-arm64 -DCMAKE_TOOLCHAIN_FILE="$PWD/cmake/arm64.cmake" -DCMAKE_BUILD_TYPE=Release > /dev/null
  cmake --build build-arm64 -j"$jobs"
  all_tests build-arm64
}

# The packages, built twice in two folders: the same bytes.
reproducible() { python3 tests/tools/reproducible_test.py "$(command -v cmake)" . whole; }

# The documents as a browser shows them, by axe-core (MPL 2.0), which no package of Debian holds: SPARSHA_AXE names its
# axe.min.js, or npm brings it.
wcag() {
  local axe=${SPARSHA_AXE:-}
  if [ -z "$axe" ]; then
    command -v npm > /dev/null || { echo "wcag needs npm, or SPARSHA_AXE naming axe.min.js" >&2; return 1; }
    npm install --silent --no-audit --no-fund --prefix build-axe axe-core@4
    axe=build-axe/node_modules/axe-core/axe.min.js
  fi
  tools/docs.sh build
  tools/check-wcag.py build/docs "$axe"
}

every=(release soak clang tsan fuzz arm64 reproducible wcag)
parts=("$@")
[ $# -gt 0 ] || parts=("${every[@]}")
for part in "${parts[@]}"; do
  case " ${every[*]} " in
    *" $part "*) ;;
    *) echo "tools/nightly.sh: no part '$part' (${every[*]})" >&2; exit 2 ;;
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
  results+=("$(printf '%-12s %-18s %5d s' "$part" "$result" $((SECONDS - began)))")
done
printf '\n== result\n'
printf '%s\n' "${results[@]}"
exit $failed
