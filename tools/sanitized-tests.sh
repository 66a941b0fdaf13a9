#!/usr/bin/env bash
# A ctest name pattern of the cases in the test programs that a sanitizer build has.
set -euo pipefail
build=$1
pattern=""
for program in "$build"/tests/*_test; do
  while read -r line; do
    case $line in
      [A-Za-z]*.) pattern+="${pattern:+|}^${line%.}\\." ;;
    esac
  done < <("$program" --gtest_list_tests | sed 's/ *#.*//' | grep -E '^[A-Za-z0-9_/]+\.$' || true)
done
printf '%s' "$pattern"
