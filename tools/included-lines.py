#!/usr/bin/env python3
"""Fails where the sources of a room include more lines than before: what each of them costs a compiler.

  tools/included-lines.py BUILD KEPT.json [--keep]   BUILD: a folder that CMake has configured with precompiled headers,
                                                     and without SPARSHA_UNITY; it need not be built

Lines are those of all files that a source includes, directly or not, besides precompiled headers (cmake/precompiled.cmake).
Every #include counts, also one that a macro leaves out. Of each room (tools/rooms.json; tests are one) the mean over its
sources may rise by a tenth and the largest number by a fifth, before somebody looks at it; with --keep the present numbers
are kept."""
import collections
import json
import os
import re
import shlex
import subprocess
import sys

from rooms import ROOMS, inside

MEAN, MOST = 1.1, 1.2  # how far above what is kept
SHOWN = 5  # the files with the most lines of a room that fails
INCLUDE = re.compile(rb'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"\n]+)[>"]', re.M)
FOLDERS = {"-I": False, "-isystem": True, "-idirafter": True}


class Files:
    """What each file includes, and its lines."""

    def __init__(self):
        self.read, self.found, self.closures = {}, {}, {}

    def of(self, path):
        if path not in self.read:
            try:
                with open(path, "rb") as file:
                    text = file.read()
                self.read[path] = (text.count(b"\n"), INCLUDE.findall(text))
            except OSError:
                self.read[path] = (0, [])
        return self.read[path]

    def place(self, name, by_quotes, path, folders):
        """The file that an #include means; None: no such file, for example one of another system."""
        beside = os.path.dirname(path) if by_quotes else None
        key = (name, beside, folders)
        if key not in self.found:
            tried = ([beside] if by_quotes else []) + list(folders)
            whole = (os.path.normpath(os.path.join(folder, name)) for folder in tried)
            self.found[key] = next((file for file in whole if os.path.isfile(file)), None)
        return self.found[key]

    def closure(self, path, folders):
        """The file and all that it includes."""
        key = (path, folders)
        if key not in self.closures:
            seen, left = {path}, [path]
            while left:
                file = left.pop()
                for mark, name in self.of(file)[1]:
                    found = self.place(name.decode(errors="replace"), mark == b'"', file, folders)
                    if found and found not in seen:
                        seen.add(found)
                        left.append(found)
            self.closures[key] = seen
        return self.closures[key]


def compilers_folders(compiler):
    """Where the compiler looks for headers of itself."""
    told = subprocess.run([compiler, "-E", "-x", "c++", "-v", os.devnull], capture_output=True, text=True, check=True).stderr
    told = told.split("#include <...> search starts here:\n")[1].split("End of search list.")[0]
    return tuple(os.path.normpath(line.strip()) for line in told.splitlines())


def folders_of(words):
    """Folders of a compiler's command in the order in which it searches them, and its precompiled header."""
    plain, systems, header = [], [], None
    for n, word in enumerate(words):
        for option, late in FOLDERS.items():
            if word.startswith(option):
                folder = word[len(option):] or words[n + 1]
                (systems if late else plain).append(os.path.normpath(folder))
        if word == "-include" and "cmake_pch" in words[n + 1]:
            header = words[n + 1]
    return tuple(plain + systems), header


def room_of(source):
    if inside(source, "tests"):
        return "tests"
    return max((room for room in ROOMS if inside(source, room)), key=len, default=None)


def counted(build):
    """Room -> its sources, each with the lines that it includes."""
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        commands = json.load(file)
    files, rooms, own = Files(), collections.defaultdict(dict), {}
    for command in commands:
        source = os.path.relpath(command["file"])
        room = room_of(source)
        if not room or not source.endswith(".cpp"):
            continue
        words = shlex.split(command["command"])
        compiler = next(word for word in words if os.path.basename(word).startswith(("c++", "g++", "clang++")))
        if compiler not in own:
            own[compiler] = compilers_folders(compiler)
        folders, header = folders_of(words)
        folders += own[compiler]
        read = files.closure(os.path.normpath(command["file"]), folders)
        if header:
            read = read - files.closure(os.path.normpath(os.path.join(command["directory"], header)), folders)
        total = sum(files.of(file)[0] for file in read)
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
        print(f"{build} has no commands of sources; expected a folder that CMake has configured")
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
