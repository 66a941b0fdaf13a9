"""A room whose sources include more lines than kept fails with its files; tools/included-lines.py passes where they do not."""
import json
import pathlib
import subprocess
import sys
import tempfile

GUARD = pathlib.Path(__file__).resolve().parents[2] / "tools" / "included-lines.py"
# a.cpp and b.cpp include a.h; what a precompiled header includes does not count for b.cpp. A header that is nowhere, and
# one that is included twice, count for nothing more.
FILES = {
    "base/a.cpp": ('#include "base/a.h"', 10),
    "base/a.h": ('#include <nowhere.h>\n#  include "b.h"', 100),
    "base/b.h": ('#include "base/a.h"', 20),
    "base/b.cpp": ('#include <big.h>\n#include "base/a.h"\n#include "base/b.h"', 30),
    "system/big.h": ("", 100000),
    "build/cmake_pch.hxx": ("#include <big.h>", 10),
}


def command(root, source, more):
    return {"directory": str(root / "build"), "file": str(root / source),
            "command": f"c++ -I{root} -isystem {root}/system {more} -c {root / source}"}


def run(root, kept, *more):
    (root / "kept.json").write_text(json.dumps(kept), encoding="utf-8")
    done = subprocess.run([sys.executable, str(GUARD), "build", "kept.json", *more], cwd=root,
                          capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def main():
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, (text, lines) in FILES.items():
            (root / name).parent.mkdir(exist_ok=True)
            (root / name).write_text(text + "\n" * (lines - text.count("\n")), encoding="utf-8")
        (root / "build/compile_commands.json").write_text(json.dumps(
            [command(root, "base/a.cpp", ""), command(root, "base/b.cpp", f"-include {root}/build/cmake_pch.hxx")]))
        # 130 and 150 lines: the mean is 140.
        for kept, code, words in (({"base": {"mean": 140, "most": 150}}, 0, "0 rooms too many"),
                                  ({"base": {"mean": 130, "most": 150}}, 0, "0 rooms too many"),
                                  ({"base": {"mean": 127, "most": 150}}, 1, "mean 140, kept 127"),
                                  ({"base": {"mean": 140, "most": 124}}, 1, "most 150, kept 124"),
                                  ({"base": {"mean": 140, "most": 124}}, 1, "150 base/b.cpp"),
                                  ({}, 0, "no numbers are kept")):
            found = run(root, kept)
            if found[0] != code or words not in found[1]:
                failures += 1
                print(f"kept {kept}: exit {found[0]}, {found[1]!r}; expected exit {code}, {words!r}")
        run(root, {}, "--keep")
        written = json.loads((root / "kept.json").read_text(encoding="utf-8"))
        if written != {"base": {"mean": 140, "most": 150}}:
            failures += 1
            print(f"kept: {written}")
    print(f"7 runs, {failures} wrong")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
