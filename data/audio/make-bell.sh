#!/bin/sh
# Makes bell.wav beside this script with sox: seven decaying partials of a small temple bell.
set -eu
cd "$(dirname "$0")"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# frequency in Hz, share of the loudness, seconds until it has faded
while read -r frequency share fade; do
  sox -D -R -n -r 22050 -c 1 -b 16 "$work/$frequency.wav" synth "$fade" sine "$frequency" fade l 0 "$fade" "$fade" vol "$share"
done <<PARTIALS
480  0.30 1.10
723  0.16 1.00
960  0.24 0.90
1158 0.10 0.80
1435 0.12 0.60
1968 0.08 0.45
2610 0.05 0.30
PARTIALS
sox -D -R -m -v 1 "$work"/480.wav -v 1 "$work"/723.wav -v 1 "$work"/960.wav -v 1 "$work"/1158.wav -v 1 "$work"/1435.wav \
  -v 1 "$work"/1968.wav -v 1 "$work"/2610.wav -b 16 bell.wav norm -6
