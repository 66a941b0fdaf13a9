#!/usr/bin/env python3
"""The rooms of tools/rooms.json: what each is for and may include, which headers are installed. Prints or writes what is made
of that list.

  tools/rooms.py --top            the top-level folders that are rooms or hold some
  tools/rooms.py --write [ROOT]   writes docs/images/rooms.svg and the table of the page that shows it
  tools/rooms.py --check [ROOT]   fails where these differ from the list, or an installed header includes one that is not
                                  installed; tools/check-rooms.py does so, too
"""
import fnmatch
import json
import pathlib
import re
import sys
import textwrap
from xml.sax.saxutils import escape

LIST = json.loads(pathlib.Path(__file__).with_name("rooms.json").read_text(encoding="utf-8"))
ROOMS = {name: room["may_include"] for name, room in LIST["rooms"].items()}
PURPOSES = {name: room["purpose"] for name, room in LIST["rooms"].items()}
# What is built on top of a room although its rule or its name would let it in.
NOT_INSIDE = LIST["not_inside"]
SHARED = ("scene", "base")
PICTURE = "docs/images/rooms.svg"
PAGE = "docs/change/architecture.md"
MARKS = ("<!-- made by tools/rooms.py --write -->\n", "<!-- end of what tools/rooms.py wrote -->\n")


def top(name):
    return name.split("/")[0]


def inside(path, room):
    return path.startswith(room + "/")


def tops():
    return list(dict.fromkeys(top(name) for name in ROOMS))


def neighbours(name):
    """The rooms of the same top-level folder that a room may include."""
    whole = [other for rule in ROOMS[name] for other in ROOMS if rule == top(name) or other == rule]
    found = [other for other in whole if top(other) == top(name) and other != name]
    return [other for other in found if other not in NOT_INSIDE.get(name, [])]


def level(name):
    """The longest way down inside the top-level folder: a room includes only rooms of lower levels."""
    return max((1 + level(other) for other in neighbours(name)), default=0)


def levels(folder):
    rows = {}
    for name in ROOMS:
        if inside(name, folder):
            rows.setdefault(level(name), []).append(name)
    return [rows[key][first:first + 4] for key in sorted(rows, reverse=True) for first in range(0, len(rows[key]), 4)]


def in_core(name):
    return any(path == name or inside(path, name) or inside(name, path) for path in LIST["core"]["sources"])


def table():
    lines = ["| folder | what is in it | may include, besides `scene` and `base` |", "| --- | --- | --- |"]
    for name, rules in ROOMS.items():
        other = [rule for rule in rules if rule not in SHARED]
        shown = [f"`{rule.removeprefix(top(name) + '/') if rule in ROOMS else rule}`" for rule in other if rule != top(name)]
        if top(name) in other:
            without = [f"`{room.removeprefix(top(name) + '/')}`" for room in NOT_INSIDE.get(name, [])]
            shown.insert(0, "the whole room" + (" but " + ", ".join(without) if without else ""))
        missing = [room for room in SHARED if room not in rules and name != room]
        none = "nothing, not even " + " and ".join(f"`{room}`" for room in missing) if missing and name != "base" else "nothing else"
        if name == "emulator":
            none = "`base` alone"
        if name in SHARED:
            none = "nothing" if name == "base" else "`base` alone"
        lines.append(f"| `{name}` | {PURPOSES[name]} | {', '.join(shown) if shown else none} |")
    return "\n".join(lines) + "\n"


class Picture:
    """An SVG that is put together from boxes, words and arrows; lengths are in pixels."""

    COLOURS = {"pipeline": ("#e6eff8", "#0072B2"), "haptics": ("#fbeae0", "#D55E00"), "viewer": ("#e6f4ee", "#00805e"),
               "audio": ("#f8eaf3", "#a8487f"), "scene": ("#fbf5dc", "#9a7d00")}

    def __init__(self):
        self.parts = []

    def box(self, room, x, y, width, height):
        fill, line = self.COLOURS.get(room, ("#f3f3f3", "#666"))
        self.parts.append(f'<rect x="{x}" y="{y}" width="{width}" height="{height}" rx="6" fill="{fill}" stroke="{line}" stroke-width="1.5"/>')
        self.words(x + 14, y + 26, room, 15, bold=True)

    def part(self, room, name, x, y, width):
        line = self.COLOURS.get(room, ("", "#666"))[1]
        core = ' stroke-width="3"' if in_core(name) else ' stroke-width="1.2"'
        self.parts.append(f'<rect x="{x:.1f}" y="{y}" width="{width:.1f}" height="30" rx="5" fill="#fff" stroke="{line}"{core}/>')
        self.parts.append(f'<text x="{x + width / 2:.1f}" y="{y + 20}" font-size="12" font-weight="bold" text-anchor="middle">'
                          f'{escape(name.rsplit("/", 1)[-1])}</text>')

    def words(self, x, y, text, size=12, bold=False):
        weight = ' font-weight="bold"' if bold else ""
        self.parts.append(f'<text x="{x}" y="{y}" font-size="{size}"{weight}>{escape(text)}</text>')

    def paragraph(self, x, y, text, letters):
        for row, line in enumerate(textwrap.wrap(text, letters)):
            self.words(x, y + 14 * row, line, 11)

    def arrow(self, *points):
        way = "L".join(f"{x} {y}" for x, y in points)
        self.parts.append(f'<path d="M{way}" fill="none" stroke="#444" stroke-width="1.6" marker-end="url(#arrow)"/>')


def svg():
    picture = Picture()
    columns = {"pipeline": (30, 370), "haptics": (430, 260)}
    rows = {room: levels(room) for room in columns}
    y, step = 150, 40
    height = 96 + step * max(map(len, rows.values()))
    bottom = y + height
    picture.box("app", 30, 78, 900, 42)
    picture.words(84, 104, PURPOSES["app"] + "; may include every room but bench")
    where = {}
    for room, (x, width) in columns.items():
        picture.box(room, x, y, width, height)
        for number, row in enumerate(rows[room]):
            part = (width - 28 - 6 * (len(row) - 1)) / len(row)
            for place, name in enumerate(row):
                where[name] = (x + 14 + place * (part + 6), y + 40 + step * number, part)
                picture.part(room, name, *where[name])
        picture.arrow((x + width / 2, 120), (x + width / 2, y - 2))
        picture.arrow((x + width / 2, bottom), (x + width / 2, bottom + 28))
    side = ["sparsha/pcl", "emulator", "protocol", "audio", "viewer"]
    tall = (height - 12 * (len(side) - 1)) // len(side)
    for place, room in enumerate(side):
        at = y + place * (tall + 12)
        picture.box(room, 750, at, 160, tall)
        picture.paragraph(764, at + 44, re.split("[:,]", PURPOSES[room])[0], 25)
        if room in ROOMS["app"]:
            picture.arrow((924, 120), (924, at + 18), (912, at + 18))
        for name in ROOMS[room]:
            if name in where and name not in ("pipeline/projection", "pipeline/filter", "pipeline/scan"):
                x, below, part = where[name]
                turn, low, end = 744 - 8 * place, bottom - 8 - 8 * (place - 1), x + part / 2 + 8 * (place - 3)
                picture.arrow((750, at + tall - 14), (turn, at + tall - 14), (turn, low), (end, low), (end, below + 32))
    picture.arrow((830, bottom), (830, bottom + 28))
    picture.box("scene", 30, bottom + 30, 900, 42)
    picture.words(96, bottom + 56, PURPOSES["scene"])
    picture.arrow((480, bottom + 72), (480, bottom + 96))
    picture.box("base", 30, bottom + 98, 900, 42)
    picture.words(96, bottom + 124, PURPOSES["base"])
    told = "; ".join(f"{name} may include {', '.join(rules) if rules else 'no other room'}" for name, rules in ROOMS.items() if top(name) != "bench")
    head = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 960 {bottom + 156}" font-family="Helvetica, Arial, sans-serif" font-size="13" fill="#111" role="img" aria-labelledby="title desc">',
            '<title id="title">The rooms of Sparsha and who may include whom</title>',
            f'<desc id="desc">{escape(told)}.</desc>',
            '<defs><marker id="arrow" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="8" markerHeight="8" orient="auto"><path d="M0 0L10 5L0 10z" fill="#444"/></marker></defs>',
            '<rect width="100%" height="100%" fill="white"/>',
            '<text x="30" y="28" font-size="16" font-weight="bold">Rooms: an arrow means &quot;may include&quot;</text>',
            '<text x="30" y="48" font-size="12" fill="#333">Inside pipeline and haptics a folder includes only folders of lower rows. '
            'Thick frames: what other programs may embed.</text>',
            '<text x="30" y="64" font-size="12" fill="#333">Rooms on the right include scene and base too, emulator base alone; sparsha/pcl includes projection, filter and scan.</text>']
    return "\n".join([*head, *picture.parts, "</svg>", ""])


def with_table(page):
    begin, end = (re.escape(mark) for mark in MARKS)
    return re.sub(begin + ".*?" + end, lambda _: MARKS[0] + "\n" + table() + "\n" + MARKS[1], page, flags=re.S)


def made(root):
    """The files that are made of the list, and their text."""
    page = root / PAGE
    yield root / PICTURE, svg()
    yield page, with_table(page.read_text(encoding="utf-8"))


def installed(name):
    return any(fnmatch.fnmatch(path, pattern) for path in (name, f"include/{name}") for patterns in LIST["installed"].values() for pattern in patterns)


def differences(root):
    """What is not as the list would make it."""
    if not (root / PAGE).exists():
        return
    for path, text in made(root):
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            yield f"{path.relative_to(root)}: differs from tools/rooms.json; tools/rooms.py --write makes it"
    if MARKS[0] not in (root / PAGE).read_text(encoding="utf-8"):
        yield f"{PAGE}: expected the marks of tools/rooms.py, which writes the table of rooms between them"


def installation(root):
    """Headers that an installation would miss."""
    if not (root / "cmake" / "install.cmake").exists():
        return
    for pattern in [pattern for patterns in LIST["installed"].values() for pattern in patterns]:
        found = sorted(root.glob(pattern))
        if not found:
            yield f"tools/rooms.json: no header {pattern}, which is to be installed"
        for path in found:
            for name in re.findall(r'^#include "([^"]+)"', path.read_text(encoding="utf-8"), re.M):
                if not installed(name):
                    yield f"{path.relative_to(root)}: is installed and includes {name}, which is not"


def problems(root):
    yield from differences(root)
    yield from installation(root)


def main():
    root = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parents[1])
    action = sys.argv[1] if len(sys.argv) > 1 else ""
    if action == "--top":
        print("\n".join(tops()))
    elif action == "--write":
        for path, text in made(root):
            path.write_text(text, encoding="utf-8")
    elif action == "--check":
        found = list(problems(root))
        print("\n".join(found) if found else f"what is made of {len(ROOMS)} rooms is as their list says")
        return 1 if found else 0
    else:
        print(__doc__, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
