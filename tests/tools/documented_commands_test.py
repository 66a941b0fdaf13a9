"""Every command of a block marked `sh` of a page is run in its order, in an empty folder, as a reader would; the samples are
those of the source tree, and `explore` without a hand of its own gets the simulated one without a window for a second.

  documented_commands_test.py SPARSHA PAGE"""
import pathlib
import re
import subprocess
import sys
import tempfile

PROGRAM, PAGE = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
ROOT = pathlib.Path(__file__).resolve().parents[2]


def words_of(line):
    line = line.replace("/usr/share/sparsha", str(ROOT))
    if line.startswith("sparsha explore") and "--device" not in line:
        line += " --headless --device simulated --duration 1"
    return [str(PROGRAM) if word == "sparsha" else word for word in line.split()]


commands = [line for block in re.findall(r"^```sh\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.M | re.S)
            for line in block.splitlines() if line.strip()]
if len(commands) < 5:
    sys.exit(f"{PAGE} has {len(commands)} commands; expected five and more")
with tempfile.TemporaryDirectory() as folder:
    for command in commands:
        done = subprocess.run(words_of(command), cwd=folder, capture_output=True, text=True, timeout=120, check=False)
        if done.returncode != 0:
            sys.exit(f"{PAGE.name}: `{command}` ended with {done.returncode}:\n{done.stderr}")
        for file in re.findall(r"(?:--out|--to|--record|-o) (\S+)", command):
            if not (pathlib.Path(folder) / file).exists():
                sys.exit(f"{PAGE.name}: `{command}` left no {file}")
print(f"{len(commands)} commands")
