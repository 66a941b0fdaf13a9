#!/usr/bin/env python3
"""Counts instructions of proxy update, projection and window load under valgrind and compares them with those kept.

instruction-guard.py PROGRAM KEPT.json [--keep]

The update is counted on the rounded surface (proxy), on the cells themselves (sharp) and on the c1 surface.

Counts do not depend on how busy the machine is. More than a tenth above what is kept fails, and so does more than a
tenth below: until the new counts are kept, that gain could be lost again without a failure. --keep writes new ones.
"""
import json
import re
import subprocess
import sys
import tempfile

PARTS = ("proxy", "sharp", "c1", "projection", "window")
LEAST, MOST = 0.90, 1.10


def count(program, part):
    with tempfile.NamedTemporaryFile() as out:
        run = subprocess.run(
            ["valgrind", "--tool=callgrind", f"--toggle-collect=measured_{part}", f"--callgrind-out-file={out.name}",
             program, part],
            capture_output=True, text=True, check=False)
    found = re.search(r"Collected : (\d+)", run.stderr)
    if run.returncode != 0 or not found or int(found.group(1)) == 0:
        sys.exit(f"valgrind counted nothing for '{part}':\n{run.stderr}")
    return int(found.group(1))


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    program, file = sys.argv[1], sys.argv[2]
    counts = {part: count(program, part) for part in PARTS}
    if "--keep" in sys.argv:
        with open(file, "w", encoding="utf-8") as out:
            out.write(json.dumps(counts, indent=2) + "\n")
        return
    with open(file, encoding="utf-8") as kept_file:
        kept = json.load(kept_file)
    ratios = {part: counts[part] / kept[part] for part in PARTS}
    for part, ratio in ratios.items():
        print(f"{part:10} {counts[part]:12} instructions, {ratio:.3f} of those kept")
    slower = ", ".join(part for part, ratio in ratios.items() if ratio > MOST)
    faster = ", ".join(part for part, ratio in ratios.items() if ratio < LEAST)
    if slower:
        sys.exit(f"error: {slower}: more than {MOST:.2f} of the instructions kept in {file}; make it faster, or say why not "
                 "and keep the new counts with --keep")
    if faster:
        sys.exit(f"error: {faster}: less than {LEAST:.2f} of the instructions kept in {file}; keep the new counts with --keep, "
                 "so that what was gained is guarded")


if __name__ == "__main__":
    main()
