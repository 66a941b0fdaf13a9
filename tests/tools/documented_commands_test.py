"""Every command of the pages is run, in the order of its page and in a folder of the page's own, as a reader would: what stands in
blocks marked `sh`. What a reader has (a scan called statue.ply) is laid there first; what needs a window, a terminal or a device
gets a stand-in; what cannot run here is listed with the reason and the test that runs it elsewhere. Each rule must be of use,
and each block of a page must say what it is.

  documented_commands_test.py SPARSHA emulated|others     pages with a command for the emulated Falcon, which keeps time; those without
  documented_commands_test.py SPARSHA PAGE..."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLE = "data/relief/station-1.ply"
FENCES = {"sh", "yaml", "text", "python", "cmake", "cpp", "c", "csv", "json", "xml"}

# What the readers of a page have before its first command: a file of the tree, or what makes it.
HAVE = {
    "README.md": {"statue.ply": SAMPLE},
    "docs/use/commands.md": {"statue.ply": SAMPLE, "STRIKE.wav": "data/audio/bell.wav", "stations.yaml": "stations",
                             "configs": "configs", "path.csv": "path"},
    "docs/use/kiosk.md": {"SCENE": "scene", "DIR": "scenes"},
    "docs/use/hardware.md": {"SCENE": "scene", "scene": "scene"},
    "docs/use/registration.md": {"statue.yaml": "stations"},
    "docs/measure/simulation.md": {"configs": "configs"},
    "docs/scaling.md": {"site.yaml": "stations"},
    "docs/change/extending.md": {"SCENE": "scene", "PREFIX/include": ".", "my_device.cpp": "examples/plugin/a_device_plugin.cpp"},
    "docs/configuration.md": {},
}

# (what, instead, why): the first that matches; () stands for the command.
EMULATED = "sparsha device emulate -- ()"
HAND = " --headless --device simulated --duration 1"
STAND_INS = [
    (r"^sparsha device emulate --fault unplug", "() --headless --duration 3 || test $? = 4", "no window; the fault ends it with 4"),
    (r"^sparsha device emulate", "()", "an emulated Falcon"),
    (r"^sparsha device (check|home)$", " || ".join(3 * [EMULATED]),
     "an emulated Falcon; again where the machine was too busy for its rate"),
    (r"^sparsha explore .*--device falcon", "sparsha device emulate -- () --headless --duration 1", "an emulated Falcon, no window"),
    (r"^sparsha explore .*--kiosk", "xvfb-run -a () --device simulated --duration 1", "a display in memory"),
    (r"^sparsha explore .*--device keys", "script -qec '() --duration 1' /dev/null < /dev/null", "a terminal of its own"),
    (r"^sparsha explore .*--device plugin", "() --headless --duration 1", "no window"),
    (r"^sparsha explore (?!.*--device)", "()" + HAND, "no window, a simulated hand"),
    (r"^mpirun -n", "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 ()", "root may run it"),
]
NOT_RUN = [
    (r"^make (run|test|package|docs|nightly|bench)", "builds the whole tree: .ci/run and tools/nightly.sh call it"),
    (r"^sudo apt", "installs: tests/tools/package_test.py does it into an empty root"),
    (r"^cmake --build|^build/bin/viewer_pictures", "builds a program: viewer_test draws the same sheet"),
    (r"^mpirun --host|^srun", "several machines: tests/tools/mpi_test.py runs several processes on one"),
    (r"^sparsha device (monitor|calibrate)", "somebody must move the device or hang a weight on it: falcon_test does, on the emulated bus"),
]


# Where the packages put what the pages name.
INSTALLED = {"/usr/share/doc/libsparsha-dev": str(ROOT), "/usr/share/sparsha": str(ROOT)}


def commands_of(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    for match in re.finditer(r"^```(\S*)[^\n]*\n(.*?)^```", text, re.M | re.S):
        added = re.search(r"Add these lines to\s+`([^`]+)`:\s*$", text[:match.start()])
        if added:  # as the page says; quoted, so that the shell takes them as they are
            yield f"cat >> {added[1]} <<'THE END'\n{match[2]}THE END", None
        if match[1] not in FENCES:
            yield None, f"{page}:{text.count(chr(10), 0, match.start()) + 1}: a block says '{match[1]}'; one of {sorted(FENCES)}"
        if match[1] != "sh":
            continue
        for line in match[2].splitlines():
            command = re.split(r"\s{2,}|\s+#\s", line.strip())[0].replace("build/bin/sparsha", "sparsha")
            if command and not command.startswith("#"):
                yield command, None


def rule_of(rules, command):
    return next((rule for rule in rules if re.search(rule[0], command)), None)


def emulated(commands):
    rules = [rule_of(STAND_INS, command) for command, _ in commands if command and not rule_of(NOT_RUN, command)]
    return any("device emulate" in rule[1] or "device emulate" in rule[0] for rule in rules if rule)


class Shop:
    """What pages ask for that has to be made first."""

    def __init__(self, folder):
        self.folder = folder
        (folder / "bin").mkdir()
        (folder / "bin" / "sparsha").symlink_to(PROGRAM)
        self.environment = {**os.environ, "PATH": f"{folder / 'bin'}:{os.environ['PATH']}", "HOME": str(folder),
                            "CPLUS_INCLUDE_PATH": f"{ROOT}:{ROOT / 'include'}"}

    def run(self, command, cwd):
        return subprocess.run(["bash", "-c", command], cwd=cwd, env=self.environment, capture_output=True, text=True, timeout=300,
                              check=False, stdin=subprocess.DEVNULL)

    def scene(self):
        out = self.folder / "scene"
        if not out.exists():
            done = self.run(f"sparsha build {ROOT / SAMPLE} --out {out} --set grid.size=200", self.folder)
            if done.returncode != 0:
                sys.exit(f"no scene for the pages: {done.stderr}")
        return out

    def lay(self, name, what, folder):
        at = folder / name
        at.parent.mkdir(parents=True, exist_ok=True)
        if what == "scene":
            shutil.copytree(self.scene(), at)
        elif what == "scenes":
            shutil.copytree(self.scene(), at / "one")
        elif what == "path":
            at.write_text("t_s,x_m,y_m,z_m\n0,0,0,0.1\n0.001,0,0,0.09\n0.002,0,0,0.08\n", encoding="utf-8")
        elif what == "stations":
            at.write_text((ROOT / "data/relief/sparsha.yaml").read_text(encoding="utf-8").replace(
                'file: "', f'file: "{ROOT}/data/relief/'), encoding="utf-8")
        else:
            at.symlink_to(ROOT / what)


def main():
    part = sys.argv[2] if sys.argv[2:] in (["emulated"], ["others"]) else None
    pages = sorted(str(page.relative_to(ROOT)) for page in
                   [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "data").glob("*.md")]) if part else sys.argv[2:]
    faults, used, ran, listed = [], set(), 0, []
    with tempfile.TemporaryDirectory() as top:
        shop = Shop(pathlib.Path(top))
        for page in pages:
            folder = pathlib.Path(top) / page.replace("/", "_")
            folder.mkdir()
            commands = list(commands_of(page))
            if part and emulated(commands) != (part == "emulated"):
                used.update(rule for command, _ in commands if command for rule in [rule_of(NOT_RUN, command) or rule_of(STAND_INS, command)])
                continue
            if commands:
                for name, what in HAVE.get(page, {}).items():
                    shop.lay(name, what, folder)
            for command, fault in commands:
                if fault:
                    faults.append(fault)
                    continue
                reason = rule_of(NOT_RUN, command)
                if reason:
                    used.add(reason)
                    listed.append(f"{page}: `{command}`: {reason[1]}")
                    continue
                absent = [tool for tool in ("mpirun", "c++") if command.startswith(tool + " ") and not shutil.which(tool)]
                if absent:
                    used.update(rule for rule in STAND_INS if re.search(rule[0], command))
                    listed.append(f"{page}: `{command}`: {absent[0]} is not installed")
                    continue
                stand_in = rule_of(STAND_INS, command) or (None, "()", "")
                used.add(stand_in)
                line = stand_in[1].replace("()", command)
                for installed, here in INSTALLED.items():
                    line = line.replace(installed, here)
                done = shop.run(line, folder)
                ran += 1
                if done.returncode != 0:
                    faults.append(f"{page}: `{line}` ended with {done.returncode}: {done.stderr.strip()[-400:]}")
                for file in re.findall(r"(?:--out|--to|--record|-o|>) (\S+)", command):
                    if not (folder / file).exists():
                        faults.append(f"{page}: `{command}` left no {file}")
    if part:
        faults += [f"no command needs the rule {rule}" for rule in [*STAND_INS, *NOT_RUN] if rule not in used]
        if ran < {"emulated": 15, "others": 30}[part]:
            faults.append(f"only {ran} commands were run")
    print("\n".join(["not run:", *listed] if listed else []))
    print("\n".join(faults) if faults else f"{ran} commands were run")
    return 1 if faults else 0


sys.exit(main())
