#!/usr/bin/env python3
"""Fails on an include that the rooms' rules forbid, and on third-party headers in public headers."""
import re
import subprocess
import sys

# Who may include whom, besides itself (docs/architecture.md).
ALLOWED = {
    "app": ["pipeline", "haptics", "audio", "viewer"],
    "viewer": ["haptics/shared", "pipeline/scene", "pipeline/base"],
    "audio": ["haptics/shared", "pipeline/scene", "pipeline/base"],
    "haptics": ["pipeline/scene", "pipeline/base"],
    "pipeline": [],
}
# Within the pipeline, base and scene stand alone, and so does haptics/shared.
ALONE = {
    "pipeline/base": [],
    "pipeline/scene": ["pipeline/base"],
    "haptics/shared": [],
}
THIRD_PARTY = re.compile(
    r"(pcl|opencv2|libusb|portaudio|epoxy|imgui|GLFW|GL|EGL|CLI|yaml-cpp|nlohmann|tiffio|png|sndfile|spdlog|fmt|pugixml)"
    r"([./-]|$|\.h)"
)
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^">]+)[">]')


def problems(path):
    room = path.split("/")[0]
    folder = "/".join(path.split("/")[:2])
    for number, line in enumerate(open(path, encoding="utf-8"), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        kind, name = match.groups()
        where = f"{path}:{number}"
        if kind == '"':
            target = name.split("/")[0]
            if target not in ALLOWED:
                if "/" not in name:
                    yield f'{where}: include "{name}" by its path from the root'
                continue
            allowed = target == room or any(name.startswith(p + "/") for p in ALLOWED[room])
            if folder in ALONE:
                allowed = name.startswith((folder + "/", *[p + "/" for p in ALONE[folder]]))
            if not allowed:
                yield f"{where}: {folder} must not include {name}"
        elif path.endswith(".h") and THIRD_PARTY.match(name):
            yield f"{where}: <{name}> belongs in a .cpp file"


def main():
    files = subprocess.run(["git", "ls-files", "*.h", "*.cpp"], capture_output=True, text=True, check=True).stdout.split()
    found = [p for path in files if path.split("/")[0] in ALLOWED for p in problems(path)]
    print("\n".join(found) if found else f"{len(files)} files keep the rules")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
