"""tools/instruction-guard.py passes counts near those kept, and fails on more and on far less, with what to do."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

GUARD = pathlib.Path(__file__).resolve().parents[2] / "tools" / "instruction-guard.py"
PARTS = ("proxy", "sharp", "c1", "projection", "window")
# In valgrind's place: its last argument is the part that is measured.
VALGRIND = '#!/bin/sh\nfor part; do :; done\neval "count=\\$COUNT_$part"\necho "Collected : $count" >&2\n'
# Instructions of `proxy` where 1000 are kept, and what the guard says of them: exit code, words.
CASES = [
    (1000, 0, ""),
    (1090, 0, ""),
    (910, 0, ""),
    (1110, 1, "more than 1.10"),
    (890, 1, "keep the new counts"),
]


def guard(folder, proxy):
    counts = {f"COUNT_{part}": "1000" for part in PARTS} | {"COUNT_proxy": str(proxy)}
    environment = {**os.environ, **counts, "PATH": f"{folder}:{os.environ['PATH']}"}
    done = subprocess.run([sys.executable, str(GUARD), "program", str(folder / "kept.json")], capture_output=True, text=True,
                          env=environment, check=False)
    return done.returncode, done.stdout + done.stderr


def main():
    failures = 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "valgrind").write_text(VALGRIND, encoding="utf-8")
        (folder / "valgrind").chmod(0o755)
        (folder / "kept.json").write_text(json.dumps({part: 1000 for part in PARTS}), encoding="utf-8")
        for proxy, expected, words in CASES:
            code, text = guard(folder, proxy)
            if code != expected or words not in text or (expected != 0 and "proxy" not in text.splitlines()[-1]):
                failures += 1
                print(f"{proxy} instructions of 1000: exit {code}, expected {expected} and {words!r}:\n{text}")
    print(f"{len(CASES)} counts, {failures} wrong")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
