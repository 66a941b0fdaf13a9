#!/bin/sh
# Makes the recordings of the eight pillars of configs/pillars.yaml beside this script with sox: each the first five
# bending modes of a slender stone bar held at both ends, and a knock. FLAC, 22 050 Hz, one channel.
set -eu
cd "$(dirname "$0")"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# name, fundamental in Hz, seconds until it has faded
while read -r name frequency fade; do
  parts=""
  while read -r ratio share length; do
    high=$(awk "BEGIN {print $frequency * $ratio}")
    seconds=$(awk "BEGIN {print $fade * $length}")
    # Exponential: 60 dB by the end.
    sox -D -R -n -r 22050 -c 1 -b 24 "$work/$ratio.wav" synth "$seconds" sine "$high" fade l 0 "$seconds" "$seconds" \
      vol "$share"
    parts="$parts -v 1 $work/$ratio.wav"
  done <<MODES
1.000 0.40 1.00
2.597 0.22 0.42
4.754 0.12 0.24
7.240 0.06 0.16
9.940 0.03 0.12
MODES
  sox -D -R -n -r 22050 -c 1 -b 24 "$work/knock.wav" synth 0.012 pinknoise fade l 0 0.012 0.012 vol 0.15
  # shellcheck disable=SC2086  # one argument per word
  sox -D -R -m $parts -v 1 "$work/knock.wav" -b 16 "pillar-$name.flac" norm -6
done <<PILLARS
major 120 2.0
sa 240 1.4
re 270 1.4
ga 300 1.3
ma 320 1.3
pa 360 1.2
dha 400 1.2
ni 450 1.1
PILLARS
