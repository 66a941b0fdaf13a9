"""Each message that docs/use/troubleshooting.md explains is one that the program can say: every piece of it between `...` stands in
one string of the sources. And each page that a row names is checked by tools/check-links.py."""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROOMS = ("app", "audio", "base", "haptics", "pipeline", "scene", "viewer")
LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')


def messages_of(text):
    """Strings of a source file; literals that follow each other are one."""
    joined = re.sub(r'"\s*\n\s*"', "", re.sub(r"(?m)^\s*//.*$", "", text))
    return [literal.replace('\\"', '"') for literal in LITERAL.findall(joined)]


def missing(page, literals):
    rows = re.findall(r"^\| `([^`]+)` \|", page, re.M)
    for message in rows:
        pieces = [piece for piece in re.split(r"\s*\.\.\.,?\s*", message) if len(piece) > 3]
        for piece in pieces:
            if not any(piece in literal for literal in literals):
                yield f"no message has '{piece}'"
    if len(rows) < 40:
        yield f"only {len(rows)} messages"


def main():
    files = [file for room in ROOMS for file in (ROOT / room).rglob("*.cpp")]
    literals = [literal for file in files for literal in messages_of(file.read_text(encoding="utf-8"))]
    page = (ROOT / "docs/use/troubleshooting.md").read_text(encoding="utf-8")
    faults = list(missing(page, literals))
    # What finds a fault: a message that nobody says.
    if not list(missing(page + "| `the moon is in the way` | | |\n", literals))[len(faults):]:
        faults.append("a message that nobody says is not found")
    print("\n".join(faults) if faults else "every message exists")
    return 1 if faults else 0


sys.exit(main())
