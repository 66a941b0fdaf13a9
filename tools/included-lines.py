#!/usr/bin/env python3
"""Fails where the sources of a room include more lines than before: what each of them costs a compiler.

  tools/included-lines.py BUILD KEPT.json [--keep]   BUILD: a folder that Ninja has built with precompiled headers

Lines are those of all files that the compiler read for an object, besides precompiled headers (cmake/precompiled.cmake), from
Ninja's record of dependencies. Of each room (tools/rooms.json; tests are one) the mean over its objects may rise by a
tenth and the largest number by a fifth, before somebody looks at it; with --keep the present numbers are kept."""
import collections
import json
import os
import subprocess
import sys

from rooms import ROOMS, inside

MEAN, MOST = 1.1, 1.2  # how far above what is kept
SHOWN = 5  # the files with the most lines of a room that fails


def dependencies(build):
    """Object -> the files that were read for it, relative to BUILD."""
    told = subprocess.run(["ninja", "-C", build, "-t", "deps"], capture_output=True, text=True, check=True).stdout
    objects, read = {}, []
    for line in told.splitlines():
        if line.startswith(" "):
            read.append(line.strip())
        elif line:
            read = objects.setdefault(line.split(": #deps")[0], [])
    return objects


def room_of(source):
    if inside(source, "tests"):
        return "tests"
    return max((room for room in ROOMS if inside(source, room)), key=len, default=None)


def counted(build):
    """Room -> its sources, each with the lines that were read for it."""
    lines = {}

    def count(name):
        if name not in lines:
            try:
                with open(os.path.join(build, name), "rb") as file:
                    lines[name] = sum(1 for _ in file)
            except OSError:
                lines[name] = 0
        return lines[name]

    rooms = collections.defaultdict(dict)
    for name, read in dependencies(build).items():
        if not read or "cmake_pch" in name:
            continue
        source = os.path.relpath(os.path.join(build, read[0]))
        room = room_of(source)
        if room:
            total = sum(count(file) for file in read if "cmake_pch" not in file)
            rooms[room][source] = min(total, rooms[room].get(source, total))
    return rooms


def summary(files):
    return {"mean": round(sum(files.values()) / len(files)), "most": max(files.values())}


def main():
    arguments = [word for word in sys.argv[1:] if word != "--keep"]
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    build, path = arguments
    rooms = counted(build)
    if not rooms:
        print(f"{build} has no record of dependencies; expected a folder that Ninja has built")
        return 1
    now = {room: summary(files) for room, files in sorted(rooms.items())}
    if "--keep" in sys.argv:
        with open(path, "w", encoding="utf-8") as file:
            file.write("{\n" + ",\n".join(f"  {json.dumps(room)}: {json.dumps(row)}" for room, row in now.items()) + "\n}\n")
    with open(path, encoding="utf-8") as file:
        kept = json.load(file)
    wrong = 0
    for room, row in now.items():
        old = kept.get(room)
        above = old and [f"{what} {row[what]}, kept {old[what]}" for what, factor in (("mean", MEAN), ("most", MOST))
                         if row[what] > factor * old[what]]
        if above:
            wrong += 1
            print(f"{room}: included lines rose: {'; '.join(above)}")
            for source in sorted(rooms[room], key=rooms[room].get, reverse=True)[:SHOWN]:
                print(f"  {rooms[room][source]:7d} {source}")
        if not old:
            print(f"{room}: no numbers are kept; tools/included-lines.py --keep adds mean {row['mean']}, most {row['most']}")
    total = sum(map(len, rooms.values()))
    print(f"lines included by {total} sources of {len(rooms)} rooms: {wrong} rooms too many")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
