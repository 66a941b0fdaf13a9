#!/bin/sh
# Draws the spectrograms of docs/use/audio.md and docs/use/accessibility.md: tools/audio-pictures.sh [BUILD], with sox. Writes docs/images/audio-*.png.
set -eu
build=${1:-build}
cd "$(dirname "$0")/.."
sparsha=$build/bin/sparsha
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

draw() { # sound, picture, title, seconds, sample rate in kHz
  sox "$1" -n remix 1 trim 0 "$4" rate "$5"k spectrogram -x 800 -y 300 -z 90 -t "$3" -c " " -o "docs/images/$2.png"
}

"$sparsha" build configs/relief.yaml --out "$work/relief" --quiet > "$work/log" 2>&1
"$sparsha" explore "$work/relief" --device simulated --headless --duration 10 --audio-out "$work/run.wav" >> "$work/log" 2>&1
draw "$work/run.wav" audio-demo "make run: a bell, three letters, a stroke across ring and petals" 10 12

"$sparsha" simulate configs/simulate-pillars.yaml --out data/pillars >> "$work/log" 2>&1
"$sparsha" build configs/pillars.yaml --out "$work/hall" --quiet >> "$work/log"
# A hand that taps the pillars from left to right, one every 1.1 s: 2 mm deep at 0.13 m/s. A window on the whole hall is
# 0.1 m wide at the hand, its middle on the wall; the pillars stand 0.5 m apart, their fronts 0.16 m (0.25 m) before it.
awk 'BEGIN { print "t_s,device_x_m,device_y_m,device_z_m"
  for (i = 0; i <= 9200; ++i) {
    t = i / 1000; k = int(t / 1.1); if (k > 7) k = 7
    u = t - 1.1 * k; front = 0.025 * (k == 4 ? 0.25 : 0.16)
    d = u - 0.5; if (d < 0) d = -d
    z = front - 0.002 + 0.13 * (d > 0.02 ? d - 0.02 : 0); if (z > 0.02) z = 0.02
    x = 0.025 * (0.25 + 0.5 * k - 2); if (k > 0 && u < 0.2) x -= 0.0125 * (1 - u / 0.2)
    printf "%.3f,%.6f,0,%.6f\n", t, x, z } }' > "$work/taps.csv"
"$sparsha" explore "$work/hall" --device "playback:$work/taps.csv" --headless --audio-out "$work/taps.wav" >> "$work/log" 2>&1
draw "$work/taps.wav" audio-pillars "a hand taps the eight pillars from left to right: sa re ga ma, the major one, pa dha ni" 9 4

# A hand that comes to parts and to the edge of a stone, is lost in the air beside it and finds back.
"$sparsha" build configs/relief.yaml --set "grid={spacing_mm: 2}" --set "cues=on" --set "audio={}" --out "$work/cues" --quiet >> "$work/log" 2>&1
awk 'BEGIN { print "t_s,device_x_m,device_y_m,device_z_m"
  for (i = 0; i <= 14000; ++i) {
    t = i / 1000; x = -0.02; z = 0.012
    if (t > 0.5) z = 0.012 - 0.05 * (t - 0.5)
    if (z < -0.003) z = -0.003
    if (t > 1) x = -0.02 + 0.012 * (t - 1)
    if (x > 0.055) x = 0.055
    if (t > 8) { z = -0.003 + 0.05 * (t - 8); if (z > 0.04) z = 0.04 }
    if (t > 10) { x = 0.055 - 0.015 * (t - 10); z = 0.04 - 0.009 * (t - 10) }
    printf "%.3f,%.6f,0,%.6f\n", t, x + 0.0005 * sin(9 * t), z } }' > "$work/cues.csv"
"$sparsha" explore "$work/cues" --device "playback:$work/cues.csv" --headless --audio-out "$work/cues.wav" >> "$work/log" 2>&1
draw "$work/cues.wav" audio-cues "parts entered and left, the edge, and a lost hand that comes back to the stone" 14 6
