"""A tree with one broken reference of each kind: tools/check-links.py names each with file and line, and no other."""
import pathlib
import subprocess
import sys
import tempfile

CHECK = pathlib.Path(__file__).resolve().parents[2] / "tools" / "check-links.py"
FILES = {
    "README.md": "# Top\n\n[a](docs/a.md#two-words) [own](#top) ![p](docs/p.svg) [web](https://example.org/x.md)\n"
    "`docs/a.md` `room/a.h` `a.h` `room` `A/b.yaml`\n```\nroom/a.h [no](link.md)\n```\n",
    "docs/a.md": "# One\n\n## Two words\n\n## `C++` & names, twice\n\n## Two words\n\n[b](a.md#two-words-1) [c](#c--names-twice)\n",
    "docs/p.svg": "<svg/>\n",
    "room/a.h": '// See docs/a.md, "One" and "Two\n// words", and a.h.\n#include "gone/by/the/compiler.h"\n'
    'const char* written = "b.cpp";  // a user\'s own\n#include <sys/c.h>  // a.h, c.h\n',
}
# What is put at the end of which file, and what is found then.
BROKEN = [
    ("README.md", "[x](docs/b.md)", "docs/b.md: no such file"),
    ("README.md", "[x](docs/a.md#three)", "docs/a.md#three: no such heading in docs/a.md"),
    ("README.md", "[x](#two-words)", "#two-words: no such heading in README.md"),
    ("README.md", "![x](docs/q.png)", "docs/q.png: no such file"),
    ("README.md", "[x](../README.md)", "../README.md: no such file"),
    ("README.md", "[x]: docs/b.md", "docs/b.md: no such file"),
    ("README.md", '<img src="q.png">', "q.png: no such file"),
    ("README.md", "`room/b.h`", "room/b.h: no such file"),
    ("README.md", "`room/inner`", "room/inner: no such file"),
    ("README.md", "`old/a.cpp`", "old/a.cpp: no such file"),
    ("README.md", "`b.h`", "b.h: no such file"),
    ("README.md", "```\nroom/b.h\n```", "room/b.h: no such file"),
    ("docs/a.md", "[x](docs/a.md)", "docs/a.md: no such file"),
    ("docs/a.md", '(`docs/a.md`, "Three")', 'docs/a.md, "Three": no such section'),
    ("room/a.h", "// docs/b.md", "docs/b.md: no such page"),
    ("room/a.h", "// see b.md", "b.md: no such page"),
    ("room/a.h", '// (docs/a.md, "Three")', 'docs/a.md, "Three": no such section'),
    ("room/a.h", '// (docs/a.md, "One"\n// and "Three")', 'docs/a.md, "Three": no such section'),
    ("room/a.h", "// room/b.h", "room/b.h: no such file"),
    ("room/a.h", "int a;  ///< as in b.h", "b.h: no such file"),
    ("room/a.h", "// The flags of b.cpp.", "b.cpp: no such file"),
    ("room/a.h", "// b-c.py and a.h", "b-c.py: no such file"),
    ("room/a.h", "/* tools.sh */", "tools.sh: no such file"),
]


def check(changed):
    with tempfile.TemporaryDirectory() as folder:
        for name, text in {**FILES, **changed}.items():
            path = pathlib.Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        subprocess.run(["git", "init", "-q", folder], check=True)
        subprocess.run(["git", "-C", folder, "add", "."], check=True)
        done = subprocess.run([sys.executable, str(CHECK), folder], capture_output=True, text=True, check=False)
        return done.returncode, (done.stdout + done.stderr).splitlines()


def main():
    failures = 0
    code, lines = check({})
    if code != 0 or len(lines) != 1 or " references in " not in lines[0]:
        failures += 1
        print(f"a tree without fault: exit {code}, {lines}")
    for name, text, problem in BROKEN:
        code, lines = check({name: FILES[name] + "\n" + text + "\n"})
        first = FILES[name].count("\n") + 2
        expected = [f"{name}:{line}: {problem}" for line in range(first, first + text.count("\n") + 1)]
        if code != 1 or len(lines) != 1 or lines[0] not in expected:
            failures += 1
            print(f"{text!r} in {name}: exit {code}, {lines}; expected exit 1, {expected[0]!r}")
    print(f"{len(BROKEN) + 1} trees, {failures} wrong")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
