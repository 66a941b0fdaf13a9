#!/usr/bin/env python3
"""Reads every ELF file below some folders and names those that load libraries from where a stranger may put them, or
that lack the guards that all our objects have.

check-binaries.py [--hardened] [--commands FILE] [--with NAME]... FOLDER...

A program's RUNPATH is a list of folders between colons. An empty element is the present folder and a relative one lies
below it, so that whoever runs the program in a folder of scans runs that folder's libraries; an absolute one names a
folder of the machine that built it. Only $ORIGIN, the program's own folder, and what lies beside it pass.

--hardened: programs and libraries are also position-independent, with all symbols bound at start and their tables
read-only afterwards (full RELRO), and objects (.o) are marked for control-flow enforcement (IBT, SHSTK).
--commands: the compiler's commands (compile_commands.json). Each has -fstack-protector-strong, and _FORTIFY_SOURCE=2 with
the optimisation that makes it more than a word, and a program named sparsha calls at least one of the C library's checked
functions.
--with: a file of this name must be among those that are read.
"""
import argparse
import json
import pathlib
import re
import shlex
import subprocess
import sys

AT_ONCE = 200  # files for each call of readelf


def is_elf(path):
    with path.open("rb") as file:
        return file.read(4) == b"\x7fELF"


def readelf(paths, flags):
    """The output for each path."""
    texts = {}
    for first in range(0, len(paths), AT_ONCE):
        some = [str(path) for path in paths[first:first + AT_ONCE]]
        # An empty file beside keeps the headings, which readelf leaves out for a single file.
        out = subprocess.run(["readelf", flags, *some, "/dev/null"], capture_output=True, text=True, check=False).stdout
        parts = re.split(r"^File: (.*)\n", out, flags=re.MULTILINE)
        texts.update(zip(parts[1::2], parts[2::2]))
    return [texts.get(str(path), "") for path in paths]


def faults_of_path(text):
    for kind, value in re.findall(r"\((RUNPATH|RPATH)\).*\[(.*)\]", text):
        for element in value.split(":"):
            if element == "":
                yield f"its {kind} has an empty element, which is the present folder: '{value}'"
            elif not re.match(r"\$ORIGIN(/|$)", element):
                yield f"its {kind} names '{element}'; only $ORIGIN and folders beside it are allowed"


def faults_of_guards(text):
    if not re.search(r"Type:\s+DYN", text):
        yield "it is not position-independent"
    if "GNU_RELRO" not in text or not re.search(r"\(FLAGS\).*BIND_NOW|\(BIND_NOW\)|\(FLAGS_1\).*NOW", text):
        yield "it is linked without full RELRO (-z relro -z now)"


def faults_of_commands(file):
    """Of how each source is compiled; what stands last counts."""
    for entry in json.loads(file.read_text(encoding="utf-8")):
        words = entry.get("arguments") or shlex.split(entry["command"])
        fortified = [word for word in words if re.match(r"-[DU]_FORTIFY_SOURCE", word)]
        stack = [word for word in words if re.match(r"-f(no-)?stack-protector", word)]
        if not stack or stack[-1] not in ("-fstack-protector-strong", "-fstack-protector-all"):
            yield f"{entry['file']}: its stack is not guarded (-fstack-protector-strong)"
        optimised = [word for word in words if re.match(r"-O", word)]
        if not fortified or fortified[-1] != "-D_FORTIFY_SOURCE=2":
            yield f"{entry['file']}: it is not compiled with _FORTIFY_SOURCE=2"
        elif not optimised or optimised[-1] == "-O0":
            yield f"{entry['file']}: _FORTIFY_SOURCE=2 does nothing without optimisation"


def calls_checked_functions(path):
    text = subprocess.run(["readelf", "--dyn-syms", "-W", str(path)], capture_output=True, text=True, check=False).stdout
    return re.search(r"UND __\w+_chk\b", text) is not None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hardened", action="store_true")
    parser.add_argument("--commands", type=pathlib.Path)
    parser.add_argument("--with", dest="needed", action="append", default=[])
    parser.add_argument("folders", nargs="+", type=pathlib.Path)
    asked = parser.parse_args()
    files = sorted({path for folder in asked.folders for path in folder.rglob("*")
                    if path.is_file() and not path.is_symlink() and is_elf(path)})
    objects = [path for path in files if path.suffix == ".o"]
    linked = [path for path in files if path.suffix != ".o"]
    if not linked:
        sys.exit("error: no program or library in " + ", ".join(map(str, asked.folders)))
    faults = []
    for path, text in zip(linked, readelf(linked, "-hdlW")):
        faults += [f"{path}: {fault}" for fault in faults_of_path(text)]
        if asked.hardened:
            faults += [f"{path}: {fault}" for fault in faults_of_guards(text)]
    if asked.hardened:
        for path, text in zip(objects, readelf(objects, "-nW")):
            if not re.search(r"x86 feature: IBT, SHSTK", text):
                faults.append(f"{path}: it is not marked for control-flow enforcement (-fcf-protection=full)")
    for name in asked.needed:
        named = [path for path in files if path.name == name]
        if not named:
            faults.append(f"{name}: it is not among the files that were read")
    if asked.commands:
        faults += faults_of_commands(asked.commands)
        programs = [path for path in linked if path.name == "sparsha"]
        if programs and not any(map(calls_checked_functions, programs)):  # one of them may only start the other
            faults.append(f"{programs[0]}: it calls none of the C library's checked functions (__*_chk)")
    for fault in faults:
        print("error: " + fault, file=sys.stderr)
    print(f"{len(linked)} programs and libraries and {len(objects)} objects read, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
