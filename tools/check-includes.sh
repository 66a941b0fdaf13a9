#!/usr/bin/env bash
# Fails on a source that uses a name whose header it gets from precompiled headers alone (cmake/precompiled.cmake): files of
# the latest changes and a rotating tenth of the rest are compiled without them, by the build's own compiler and flags but
# for the optimiser, within a budget of seconds. A function of Eigen that an object leaves to the linker is such a name too:
# Eigen/Core declares determinant() and cross(), and only Eigen/LU and Eigen/Geometry define them.
# The nightly builds compile all files so. Files that are named are compiled instead of those, whatever it takes.
# tools/check-includes.sh BUILD SECONDS [FILE...]
set -euo pipefail
build=$1
seconds=$2
shift 2
if [ $# -gt 0 ]; then
  list=$(printf '%s\n' "$@")
  seconds=inf
else
  rooms=$(python3 tools/rooms.py --top)
  # shellcheck disable=SC2086
  list=$(tools/recent-sources.sh --users $rooms tests)
fi
python3 - "$build" "$seconds" 3<<< "$list" << 'PYTHON'
import concurrent.futures, json, os, re, shlex, subprocess, sys, tempfile, time

build, budget = sys.argv[1], float(sys.argv[2])
wanted = [line for line in os.fdopen(3).read().split("\n") if line]
end = time.monotonic() + budget
commands = {}
for entry in json.load(open(os.path.join(build, "compile_commands.json"), encoding="utf-8")):
    commands.setdefault(os.path.relpath(entry["file"]), entry)


def read_alone(name):
    if time.monotonic() > end or name not in commands:
        return None
    words = shlex.split(commands[name]["command"])
    compiler = next(i for i, word in enumerate(words) if os.path.basename(word).startswith(("c++", "g++", "clang++")))
    words = words[compiler:]
    for option in ("-include", "-o"):
        while option in words:
            at = words.index(option)
            del words[at:at + 2]
    with tempfile.TemporaryDirectory() as folder:
        made = os.path.join(folder, "made.o")
        words = [word for word in words if word != "-Winvalid-pch"] + ["-O0", "-w", "-o", made]
        done = subprocess.run(words, cwd=commands[name]["directory"], capture_output=True, text=True, check=False)
        if done.returncode:
            return name, done.stderr
        left = subprocess.run(["nm", "--undefined-only", made], capture_output=True, text=True, check=True).stdout
        left = re.findall(r"\b_ZNK?5Eigen\w+", left)
        shown = subprocess.run(["c++filt", *left], capture_output=True, text=True, check=True).stdout if left else ""
        return name, "".join(f"declared, not defined: {line}\n" for line in shown.splitlines())


with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
    read = [result for result in pool.map(read_alone, wanted) if result]
wrong = [result for result in read if result[1]]
for name, errors in wrong:
    print(f"{name} needs more than it includes:\n{errors[:2000]}")
print(f"read without precompiled headers: {len(read)} of {len(wanted)} files, {len(wrong)} wrong")
sys.exit(1 if wrong else 0)
PYTHON
