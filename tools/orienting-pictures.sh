#!/usr/bin/env bash
# Makes the picture of docs/use/orienting.md.
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build}
SPARSHA_PICTURES=docs/images "$build/tests/viewer_test" --gtest_brief=1 --gtest_filter=CloudPicture.TheDocumentationsPictureIsDrawn
