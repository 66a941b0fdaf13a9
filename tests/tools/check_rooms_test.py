"""A tree with one fault each: tools/check-rooms.py names it with its place, and says nothing of a tree without fault."""
import pathlib
import subprocess
import sys
import tempfile

CHECK = pathlib.Path(__file__).resolve().parents[2] / "tools" / "check-rooms.py"
FILES = {
    "base/error.h": "namespace sparsha {\nclass Error {};\n}  // namespace sparsha\n",
    "protocol/judge.h": '#include "base/error.h"\n',
    "bench/race/main.cpp": '#include "protocol/judge.h"\n#include "tests/support/clouds.h"\n',
    "app/commands/bench.cpp": '#include "protocol/judge.h"\n',
    "tests/base/error_test.cpp": '#include "base/error.h"\n',
    "tests/protocol/judge_test.cpp": '#include "protocol/judge.h"\n',
    "tests/support/clouds.h": "\n",
}
# What is put into which new file, and how what is found begins.
FAULTS = [
    ("protocol/score.cpp", '#include "app/main.h"', "protocol/score.cpp:1: protocol must not include app/main.h"),
    ("protocol/score.cpp", '#include "judge.h"', 'protocol/score.cpp:1: include "judge.h" by its path'),
    ("protocol/score.h", "#include <fmt/format.h>", "protocol/score.h:1: <fmt/format.h> belongs in a .cpp file"),
    ("protocol/score.h", '#include "base/trees.hpp"', "protocol/score.h:1: base/trees.hpp shows a library"),
    ("bench/new/main.cpp", "", "bench/new/main.cpp: no rule for this folder"),
    ("app/commands/race.cpp", '#include "bench/race/measure.h"', "app/commands/race.cpp:1: app must not include bench/race/measure.h"),
    ("base/yaml.cpp", '#include "protocol/judge.h"', "base/yaml.cpp:1: base must not include protocol/judge.h"),
    ("base/yaml.cpp", '#include "tests/support/clouds.h"', "base/yaml.cpp:1: base must not include tests/support/clouds.h"),
    ("app/hand.cpp", "namespace sparsha::haptics {\nint hand;\n}  // namespace sparsha::haptics\n",
     "app/hand.cpp: namespace sparsha::haptics is another room's"),
    ("tests/gone/room_test.cpp", "", "tests/gone: there is no room gone"),
    ("tests/bench/gone/room_test.cpp", "", "tests/bench/gone: there is no room bench/gone"),
]


def check(added):
    with tempfile.TemporaryDirectory() as folder:
        for name, text in {**FILES, **added}.items():
            path = pathlib.Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        subprocess.run(["git", "init", "-q", folder], check=True)
        subprocess.run(["git", "-C", folder, "add", "."], check=True)
        done = subprocess.run([sys.executable, str(CHECK), folder], cwd=folder, capture_output=True, text=True, check=False)
        return done.returncode, (done.stdout + done.stderr).splitlines()


def main():
    failures = 0
    code, lines = check({})
    if code != 0 or len(lines) != 1:
        failures += 1
        print(f"a tree without fault: exit {code}, {lines}")
    for name, text, problem in FAULTS:
        code, lines = check({name: text + "\n"})
        if code != 1 or len(lines) != 1 or not lines[0].startswith(problem):
            failures += 1
            print(f"{text!r} in {name}: exit {code}, {lines}; expected exit 1, {problem!r}")
    print(f"{len(FAULTS) + 1} trees, {failures} wrong")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
