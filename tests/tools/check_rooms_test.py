"""A tree with one fault each: tools/check-rooms.py names it with its place, and says nothing of a tree without fault."""
import pathlib
import subprocess
import sys
import tempfile

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"
CHECK = TOOLS / "check-rooms.py"
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
    ("base/yaml/yaml.cpp", '#include "protocol/judge.h"', "base/yaml/yaml.cpp:1: base must not include protocol/judge.h"),
    ("base/yaml/yaml.cpp", '#include "tests/support/clouds.h"', "base/yaml/yaml.cpp:1: base must not include tests/support/clouds.h"),
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


def rooms(action, folder):
    done = subprocess.run([sys.executable, str(TOOLS / "rooms.py"), action, folder], capture_output=True, text=True, check=False)
    return done.returncode, (done.stdout + done.stderr).splitlines()


def stale():
    """What is wrong with the check of the files that are made of the list of rooms."""
    page = "<!-- made by tools/rooms.py --write -->\n<!-- end of what tools/rooms.py wrote -->\n"
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for folder_of_pages in ("docs/images", "docs/change"):
            (root / folder_of_pages).mkdir(parents=True)
        shown = root / "docs/change/architecture.md"
        shown.write_text("# Rooms\n" + page + "The end.\n", encoding="utf-8")
        if rooms("--check", folder)[0] == 0:
            yield "a page without its table passes"
        rooms("--write", folder)
        text = shown.read_text(encoding="utf-8")
        if rooms("--check", folder)[0] != 0 or "| `scene` |" not in text or not text.endswith("The end.\n"):
            yield f"what was just written is refused or incomplete: {text[:200]}"
        shown.write_text(text.replace("| `scene` |", "| `scenery` |"), encoding="utf-8")
        code, lines = rooms("--check", folder)
        if code != 1 or len(lines) != 1 or not lines[0].startswith("docs/change/architecture.md: differs from tools/rooms.json"):
            yield f"a changed table: exit {code}, {lines}"
        (root / "cmake").mkdir()
        (root / "cmake/install.cmake").write_text("", encoding="utf-8")
        (root / "base").mkdir()
        (root / "base/error.h").write_text('#include "base/yaml/yaml.h"\n', encoding="utf-8")
        code, lines = rooms("--check", folder)
        if "base/error.h: is installed and includes base/yaml/yaml.h, which is not" not in lines:
            yield f"an installed header that includes another: exit {code}, {lines}"


def main():
    failures = 0
    for problem in stale():
        failures += 1
        print(problem)
    code, lines = check({})
    if code != 0 or len(lines) != 1:
        failures += 1
        print(f"a tree without fault: exit {code}, {lines}")
    for name, text, problem in FAULTS:
        code, lines = check({name: text + "\n"})
        if code != 1 or len(lines) != 1 or not lines[0].startswith(problem):
            failures += 1
            print(f"{text!r} in {name}: exit {code}, {lines}; expected exit 1, {problem!r}")
    print(f"{len(FAULTS) + 2} trees, {failures} wrong")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
