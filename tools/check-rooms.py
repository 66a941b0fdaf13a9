#!/usr/bin/env python3
"""Fails on an include that the rules of tools/rooms.json forbid, on names outside the room's own namespace, on third-party
headers in public headers, on a folder of tests without a room, and on what is made of the list of rooms and is older."""
import os
import pathlib
import re
import subprocess
import sys

from rooms import LIST, NOT_INSIDE, ROOMS as ALLOWED, inside, problems as problems_of_list, tops

# One file chooses the reader of a format, and no other file of its room knows the formats.
EXCEPTIONS = {"pipeline/scan/reader.cpp": "pipeline/scan/formats"}
# Templates over PCL's point types, for programs that include PCL anyway.
PCL_API = "sparsha/pcl"
TOPS = set(tops())
# Folders below tests/ that mirror no room: helpers, tests of tools, and parts of one folder's test.
NO_ROOM = {"support", "tools", "arm64", "fuzz", "guard", "falcon", "haptics/device/falcon/usb", "haptics/device/plugin/faulty", "haptics/proxy/soak",
           "viewer/pictures", "viewer/reference"}
THIRD_PARTY = re.compile(
    r"(pcl|opencv2|libusb|portaudio|epoxy|imgui|GLFW|GL|EGL|CLI|yaml-cpp|nlohmann|tiffio|png|sndfile|spdlog|fmt|pugixml|lzf)"
    r"([./-]|$|\.h)"
)
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^">]+)[">]')


def room_of(path):
    return max((room for room in ALLOWED if inside(path, room)), key=len, default=None)


def may_include(path, room, name):
    if path in EXCEPTIONS and inside(name, EXCEPTIONS[path]):
        return True
    if any(inside(name, other) for other in NOT_INSIDE.get(room, [])):
        return False
    return inside(name, room) or any(name == other or inside(name, other) for other in ALLOWED[room])


def in_core(path):
    return any(path == part or inside(path, part) for part in LIST["core"]["sources"])


def problems(path):
    room = room_of(path)
    if room is None:
        yield f"{path}: no rule for this folder"
        return
    for number, line in enumerate(open(path, encoding="utf-8"), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        kind, name = match.groups()
        where = f"{path}:{number}"
        if kind == '"':
            if "/" not in name:
                yield f'{where}: include "{name}" by its path from the root'
            elif path.endswith(".h") and name.endswith(".hpp") and room != PCL_API:
                yield f"{where}: {name} shows a library, it belongs in a .cpp file"
            elif name.split("/")[0] in {*TOPS, "tests"} and not may_include(path, room, name):
                yield f"{where}: {room} must not include {name}"
            elif in_core(path) and not in_core(name) and name not in LIST["core"]["may_include"]:
                yield f"{where}: {name} is not for the embeddable core"
        elif path.endswith(".h") and room != PCL_API and THIRD_PARTY.match(name):
            yield f"{where}: <{name}> belongs in a .cpp file"


NAMESPACE = re.compile(r"^namespace (sparsha[\w:]*) {\n((?:[^}\n].*\n|\n)*)}", re.M)
DECLARATION = re.compile(r"(?:struct|class|enum class) [\w:]+(?: : [\w:]+)?;|//.*|using \w+ = [^;]*;|")


def foreign_namespaces(path):
    """A room's names are in the namespace of its name; names of other rooms are at most declared."""
    room = path.split("/")[0]
    own = ["sparsha"] if room in ("base", "sparsha", "include") else [f"sparsha::{room}"]
    for match in NAMESPACE.finditer(open(path, encoding="utf-8").read()):
        name, body = match.groups()
        if any(name == space or name.startswith(space + "::") for space in own):
            continue
        if not all(DECLARATION.fullmatch(line.strip()) for line in body.split("\n")):
            yield f"{path}: namespace {name} is another room's; {own[0]} is this one's"


def types_of(path):
    """Qualified names of the types that a file defines outside anonymous namespaces."""
    spaces = []
    for number, line in enumerate(open(path, encoding="utf-8"), 1):
        opened = re.match(r"^namespace ?([\w:]*) ?{", line)
        if opened:
            spaces.append(opened.group(1))
        elif line.startswith("}  // namespace") and spaces:
            spaces.pop()
        defined = re.match(r"^(?:class|struct|enum class|enum|union) (\w+)(?: final)?(?: :[^:].*)? ?{", line)
        if defined and "" not in spaces:
            yield "::".join([*spaces, defined.group(1)]), f"{path}:{number}"


def types_defined_twice(files):
    """Two types of one name make one program undefined, and the linker does not say so."""
    places = {}
    for path in files:
        for name, where in types_of(path):
            places.setdefault(name, []).append(where)
    for name, found in places.items():
        if len(found) > 1:
            yield f"{found[1]}: {name} is defined in {found[0]} too"


def tests_without_room(names):
    folders = {name.rsplit("/", 1)[0] for name in names if "/" in name}
    rooms = {"/".join(folder.split("/")[:depth]) for folder in folders for depth in range(1, folder.count("/") + 2)}
    for folder in sorted(folders):
        room = folder.removeprefix("tests/")
        exempt = any(room == other or inside(room, other) for other in NO_ROOM)
        if inside(folder, "tests") and room not in rooms and not exempt:
            yield f"{folder}: there is no room {room}; a test lies where its room does, or in NO_ROOM of tools/check-rooms.py"


def main():
    if len(sys.argv) > 1:
        os.chdir(sys.argv[1])
    names = subprocess.run(["git", "ls-files"], capture_output=True, text=True, check=True).stdout.split("\n")
    files = [name for name in names if name.endswith((".h", ".cpp", ".hpp"))]
    found = [p for path in files if path.split("/")[0] in TOPS for p in problems(path)]
    found += [p for path in files if path.split("/")[0] in TOPS for p in foreign_namespaces(path)]
    found += types_defined_twice([path for path in files if path.split("/")[0] in TOPS])
    found += tests_without_room(names)
    found += problems_of_list(pathlib.Path("."))
    print("\n".join(found) if found else f"{len(files)} files keep the rules")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
