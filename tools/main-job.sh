#!/usr/bin/env bash
# The main job of `make run`: the sandstone relief from raw scans to touch, picture and sound.
set -euo pipefail
build=$1
sparsha=$build/bin/sparsha
out=$build/run
mkdir -p "$out"

echo
echo "== the relief, from its raw scans"
"$sparsha" build configs/relief.yaml --out "$out/scene" --plain --quiet
explore=("$sparsha" explore "$out/scene" --record "$out/run.csv" --screenshot "$out/view.png"
         --audio-out "$out/run.wav" --plain)
echo
if [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
  echo "== explore it: the mouse is your hand (F1 for help, Esc to end)"
  "${explore[@]}" --device pointer
else
  echo "== explore it: 10 s with the simulated hand (bell, three letters, lotus, one zoom), since there is no display"
  "${explore[@]}" --device simulated --headless --duration 10
fi

echo
echo "== what is in $out"
rows=$(($(wc -l < "$out/run.csv") - 1))
printf 'scene/    %s, report.html is for reading\n' "$(du -sh "$out/scene" | cut -f1)"
printf 'view.png  %s bytes\n' "$(wc -c < "$out/view.png")"
printf 'run.csv   %s ticks\n' "$rows"
printf 'run.wav   %s bytes\n' "$(wc -c < "$out/run.wav")"
