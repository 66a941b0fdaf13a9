"""A room whose sources include more lines than kept fails with its files; tools/included-lines.py passes where they do not."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

GUARD = pathlib.Path(__file__).resolve().parents[2] / "tools" / "included-lines.py"
# What stands for Ninja here tells the record of two objects, one of them made with a precompiled header.
NINJA = """#!/bin/sh
cat <<'TOLD'
a.cpp.o: #deps 2, deps mtime 1 (VALID)
    ../base/a.cpp
    ../base/a.h

b.cpp.o: #deps 3, deps mtime 1 (VALID)
    ../base/b.cpp
    ../base/a.h
    cmake_pch.hxx.gch
TOLD
"""


def run(root, kept, *more):
    (root / "kept.json").write_text(json.dumps(kept), encoding="utf-8")
    environment = {**os.environ, "PATH": f"{root / 'bin'}:{os.environ['PATH']}"}
    done = subprocess.run([sys.executable, str(GUARD), "build", "kept.json", *more], cwd=root, env=environment,
                          capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def main():
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name in ("bin", "base", "build"):
            (root / name).mkdir()
        (root / "bin/ninja").write_text(NINJA, encoding="utf-8")
        (root / "bin/ninja").chmod(0o755)
        for name, lines in (("a.cpp", 10), ("a.h", 100), ("b.cpp", 30)):
            (root / "base" / name).write_text("\n" * lines, encoding="utf-8")
        (root / "build/cmake_pch.hxx.gch").write_text("\n" * 100000, encoding="utf-8")
        # 110 and 130 lines: the mean is 120.
        for kept, code, words in (({"base": {"mean": 120, "most": 130}}, 0, "0 rooms too many"),
                                  ({"base": {"mean": 110, "most": 130}}, 0, "0 rooms too many"),
                                  ({"base": {"mean": 108, "most": 130}}, 1, "mean 120, kept 108"),
                                  ({"base": {"mean": 120, "most": 107}}, 1, "most 130, kept 107"),
                                  ({"base": {"mean": 120, "most": 107}}, 1, "130 base/b.cpp"),
                                  ({}, 0, "no numbers are kept")):
            found = run(root, kept)
            if found[0] != code or words not in found[1]:
                failures += 1
                print(f"kept {kept}: exit {found[0]}, {found[1]!r}; expected exit {code}, {words!r}")
        run(root, {}, "--keep")
        written = json.loads((root / "kept.json").read_text(encoding="utf-8"))
        if written != {"base": {"mean": 120, "most": 130}}:
            failures += 1
            print(f"kept: {written}")
    print(f"7 runs, {failures} wrong")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
