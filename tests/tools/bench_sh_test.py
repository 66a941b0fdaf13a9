"""tools/bench.sh writes the page whatever a program does, and fails at the end when one of them failed."""
import os
import pathlib
import subprocess
import sys
import tempfile

BENCH = pathlib.Path(__file__).resolve().parents[2] / "tools" / "bench.sh"
PROGRAMS = ("bench_race", "bench_effects", "bench_haptics", "bench_pipeline", "bench_audio", "bench_realtime")
# Each program notes that it ran and what it sees of the scans.
PROGRAM = '#!/bin/sh\necho "{name} $* ${{SPARSHA_SCANS_DIR:-no scans}}" >> "{log}"\nexit {code}\n'


def bench(failing, scans):
    """Exit code and output of a run in which the programs of `failing` end with 3, and what ran."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder, "tree")
        log = root / "log"
        (root / "build" / "bin").mkdir(parents=True)
        (root / "path").mkdir()
        if scans:
            pathlib.Path(folder, "shared", "data").mkdir(parents=True)
        for name in (*PROGRAMS, "bench_report"):
            write(root / "build" / "bin" / name, PROGRAM.format(name=name, log=log, code=3 if name in failing else 0))
        write(root / "path" / "cmake", "#!/bin/sh\n")
        environment = {name: value for name, value in os.environ.items() if name != "SPARSHA_SCANS_DIR"}
        environment["PATH"] = f"{root / 'path'}:{environment['PATH']}"
        done = subprocess.run([str(BENCH), "build", "quick"], cwd=root, env=environment, capture_output=True, text=True,
                              check=False)
        ran = [line.split()[0] for line in log.read_text(encoding="utf-8").splitlines()]
        seen = str(pathlib.Path(folder, "shared", "data")) in log.read_text(encoding="utf-8")
        return done.returncode, done.stdout + done.stderr, ran, seen


def write(path, text):
    path.write_text(text, encoding="utf-8")
    path.chmod(0o755)


def main():
    failures = 0

    def expect(holds, what):
        nonlocal failures
        if not holds:
            failures += 1
            print(what)

    everything = [*PROGRAMS, "bench_report"]
    code, text, ran, seen = bench((), scans=True)
    expect(code == 0 and ran == everything, f"no failure: exit {code}, ran {ran}\n{text}")
    expect(seen, f"the scans beside the tree are not seen:\n{text}")
    expect(" s in all" in text.splitlines()[-1], f"the last line lacks the seconds of the whole run:\n{text}")
    code, text, ran, seen = bench(("bench_race", "bench_audio"), scans=False)
    expect(code == 1 and ran == everything, f"two failures: exit {code}, ran {ran}\n{text}")
    expect("failed: bench_race bench_audio" in text.splitlines()[-1], f"the last line lacks the programs that failed:\n{text}")
    expect(not seen, "scans are seen where there are none")
    code, text, ran, _ = bench(("bench_report",), scans=False)
    expect(code == 1 and "failed: bench_report" in text, f"the page failed: exit {code}\n{text}")
    print(f"3 runs, {failures} wrong")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
