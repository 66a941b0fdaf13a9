#!/usr/bin/env bash
# Makes the pictures of docs/use/pipeline.md from a made-up scan and the configuration that stands on that page.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${1:-build}/bin/sparsha
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

python3 tools/pipeline-scan.py "$work/statue.ply"
awk '/^```yaml/ {on = 1; next} /^```/ {on = 0} on' docs/use/pipeline.md > "$work/statue.yaml"
show() { "$program" build "$work/statue.yaml" --out "$work/scene" --quiet "${@:3}" && cp "$work/scene/$1.png" "docs/images/pipeline-$2.png"; }
show relief raw --set 'filters=[]' --set grid.spacing_mm=6 --force
show relief clean --set 'filters.4={thin: {points_per_node: 1000}}'
show filters filters
cp "$work/scene/relief.png" docs/images/pipeline-smooth.png
