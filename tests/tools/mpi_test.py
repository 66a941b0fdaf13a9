"""Scenes that mpirun builds are those of one process, byte by byte, and faults end all ranks with one message.

77 when mpirun or Sparsha's plug-in is not there."""
import array
import json
import math
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

PROGRAM = sys.argv[1]
PLUGIN = pathlib.Path(sys.argv[2])
CONFIG = pathlib.Path(__file__).resolve().parents[2] / "configs" / "relief.yaml"
SETTINGS = ["--set", "filters=[]", "--set", "grid.spacing_mm=2"]
LONGEST_S = 10.0  # from a fault to the end of all ranks


def environment():
    return {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
            "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_btl_vader_single_copy_mechanism": "none"}


def build(ranks, out, *more, settings=SETTINGS, config=CONFIG):
    launcher = ["mpirun", "-n", str(ranks)] if ranks else []
    return subprocess.run([*launcher, PROGRAM, "build", str(config), *settings, "--threads", "1", "--quiet", "--out", str(out),
                           *more], capture_output=True, text=True, timeout=100, env=environment())


def content(scene):
    files = {str(p.relative_to(scene)): p.read_bytes() for p in scene.rglob("*") if p.is_file()}
    report = json.loads(files.pop("report.json"))
    files.pop("report.html", None)
    for key in ("stages", "total_seconds", "peak_rss_bytes"):
        report.pop(key)
    return files, report


def same_bytes(folder):
    assert build(0, folder / "alone").returncode == 0
    expected = content(folder / "alone")
    for ranks in (1, 2, 3, 8):
        run = build(ranks, folder / "shared")
        assert run.returncode == 0, (ranks, run.stderr)
        assert content(folder / "shared") == expected, f"{ranks} ranks build another scene"
        assert run.stdout.count("\n") < 100, "each rank printed a summary"
    shutil.rmtree(folder / "shared")


def pictures_are_the_same(folder):
    """Of what a filter takes away, and of the sides of a closed object."""
    golden = math.pi * (3.0 - math.sqrt(5.0))
    rows = []
    for k in range(40000):
        z = 1.0 - (2.0 * k + 1.0) / 40000.0
        r, u = math.sqrt(1.0 - z * z), golden * k
        rows.append(f"{0.2 * r * math.cos(u):.6f} {0.2 * r * math.sin(u):.6f} {0.2 * z:.6f}\n")
    (folder / "ball.xyz").write_text("".join(rows))
    config = folder / "ball.yaml"
    config.write_text("scans:\n  - {file: ball.xyz, units: m}\ngrid: {size: 60}\n"
                      "filters:\n  - crop: {min_m: [-1, -1, -1], max_m: [0.15, 1, 1]}\n")
    assert build(0, folder / "ball.scene", config=config, settings=[]).returncode == 0
    expected = content(folder / "ball.scene")
    assert {"filters.png", "sides.png"} <= expected[0].keys(), expected[0].keys()
    for ranks in (1, 2, 3):
        run = build(ranks, folder / "ball_shared", config=config, settings=[])
        assert run.returncode == 0, (ranks, run.stderr)
        assert content(folder / "ball_shared") == expected, f"{ranks} ranks build another scene"
    for scene in ("ball.scene", "ball_shared"):
        shutil.rmtree(folder / scene)
    for file in folder.glob("ball.*"):
        file.unlink()


def refusal_is_said_once(folder):
    run = build(3, folder / "shared", settings=["--set", "around={}"])
    assert run.returncode == 2, run
    assert run.stderr.count("error:") == 1 and "rank 0 of 3" in run.stderr and "around" in run.stderr, run.stderr
    assert not (folder / "shared").exists()


def other_commands_are_refused_by_name(folder):
    for words in (["info", str(CONFIG)], ["export", "scene", "--to", "a.ply"], ["build", str(CONFIG), "--resume"]):
        run = subprocess.run(["mpirun", "-n", "3", PROGRAM, *words], capture_output=True, text=True, timeout=60,
                             env=environment(), cwd=folder)
        assert run.returncode == 2, run
        assert run.stderr.count("error:") == 1 and (words[0] in run.stderr or "--resume" in run.stderr), run.stderr
    run = subprocess.run(["mpirun", "-n", "1", PROGRAM, "--version"], capture_output=True, text=True, timeout=60,
                         env=environment())
    assert run.returncode == 0, run
    assert not list(folder.iterdir()), "something was written"


def file_that_one_rank_cannot_read_is_named(folder):
    ply = folder / "plane.ply"
    points = "".join(f"{i % 40} {i // 40} {(i * 7) % 3 * 0.1}\n" for i in range(1600))
    ply.write_text("ply\nformat ascii 1.0\nelement vertex 1600\nproperty float x\nproperty float y\nproperty float z\n"
                   "end_header\n" + points)
    run = build_in_two_folders(folder, ply.read_bytes(), None)
    assert run.returncode == 3 and run.stderr.count("error:") == 1, run
    assert "rank 1 of 2" in run.stderr and "plane.ply" in run.stderr, run.stderr
    ply.unlink()


def build_in_two_folders(folder, *files, more=((), ())):
    """Each of two ranks in a folder of its own, with the same configuration and its own plane.ply; None: without."""
    parts = []
    for rank, content in enumerate(files):
        place = folder / f"machine{rank}"
        place.mkdir()
        (place / "plane.yaml").write_text("scans:\n  - {file: plane.ply, units: m}\ngrid: {size: 40}\n")
        if content is not None:
            (place / "plane.ply").write_bytes(content)
        parts += [":"] * bool(parts) + ["-n", "1", "-wdir", str(place), PROGRAM, "build", "plane.yaml", "--quiet",
                                        "--out", "shared", *more[rank]]
    began = time.monotonic()
    run = subprocess.run(["mpirun", *parts], capture_output=True, text=True, timeout=60, env=environment())
    assert time.monotonic() - began < LONGEST_S
    for rank in range(len(files)):
        left = {path.name for path in (folder / f"machine{rank}").iterdir()} - {"plane.yaml", "plane.ply"}
        assert run.returncode == 0 or not left, (left, run)
        shutil.rmtree(folder / f"machine{rank}")
    return run


def what_one_rank_has_otherwise_is_named(folder):
    header = ("ply\nformat ascii 1.0\nelement vertex 20000\nproperty float x\nproperty float y\nproperty float z\n"
              "end_header\n")
    lines = [f"{i % 200:03d} {i // 200:03d} {(i * 7) % 3}.0\n" for i in range(20000)]
    scan = (header + "".join(lines)).encode()
    assert build_in_two_folders(folder, scan, scan).returncode == 0

    middle = lines[:10000] + ["000 050 9.0\n"] + lines[10001:]  # as long, and the same at both ends
    ends = ["000 000 9.0\n"] + lines[1:]
    for other in (header + "".join(middle), header + "".join(ends), header.replace("20000", "19999") + "".join(lines[1:])):
        run = build_in_two_folders(folder, scan, other.encode())
        assert run.returncode == 3 and run.stderr.count("error:") == 1, run
        assert "rank 1 on" in run.stderr and "plane.ply" in run.stderr and "another file" in run.stderr, run.stderr
    for settings in (["--set", "grid.size=41"], ["--only", "grid"], ["--force"]):
        run = build_in_two_folders(folder, scan, scan, more=((), settings))
        assert run.returncode == 2 and run.stderr.count("error:") == 1, run
        assert "rank 1 on" in run.stderr and "another configuration" in run.stderr, run.stderr


def bytes_read_by_ranks(folder):
    """Two ranks, each with its own copy of two scans that no cache holds: how much each has read from the disk, and the
    size of the scans. None where the system does not tell, as of a disk in memory."""
    random_ = random.Random(2)  # no raster, whose steps would be looked for in all points
    block = array.array("f", (random_.random() / side for _ in range(20000) for side in (1, 1, 100)))
    parts, scans_bytes = [], 0
    for rank in range(2):
        place = folder / f"machine{rank}"
        place.mkdir()
        (place / "scans.yaml").write_text("scans:\n  - {file: a.ply, units: m}\n  - {file: b.ply, units: m}\n"
                                          "grid: {spacing_mm: 10}\n")
        scans_bytes = 0
        for name, blocks in (("a.ply", 80), ("b.ply", 81)):
            with open(place / name, "wb") as file:
                file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % (20000 * blocks))
                file.write(b"property float x\nproperty float y\nproperty float z\nend_header\n")
                for _ in range(blocks):
                    block.tofile(file)
                scans_bytes += file.tell()
                file.flush()
                os.fsync(file.fileno())
                os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)
        # What a shell has read counts its children that have ended.
        run = f'"{PROGRAM}" build scans.yaml --only grid --quiet --out shared; code=$?; cat /proc/$$/io > io; exit $code'
        parts += [":"] * bool(parts) + ["-n", "1", "-wdir", str(place), "sh", "-c", run]
    done = subprocess.run(["mpirun", *parts], capture_output=True, text=True, timeout=100, env=environment())
    assert done.returncode == 0, done
    read = [int(re.search(r"^read_bytes: (\d+)", (folder / f"machine{rank}" / "io").read_text(), re.M)[1]) for rank in range(2)]
    for rank in range(2):
        shutil.rmtree(folder / f"machine{rank}")
    return (read, scans_bytes) if sum(read) >= scans_bytes / 2 else None


def each_rank_reads_its_part(folder):
    found = bytes_read_by_ranks(folder)
    if found is None:
        return
    read, scans_bytes = found
    # Half of the bytes, the 64 pieces of each file that are compared, and what the system reads ahead: up to 8 MiB about
    # the place where the two meet.
    assert all(one < 0.9 * scans_bytes for one in read), (read, scans_bytes)


def children_of(pid):
    found = []
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            if int(stat.read_text().rpartition(")")[2].split()[1]) == pid:
                found.append(int(stat.parent.name))
        except (FileNotFoundError, ProcessLookupError):
            pass
    return sorted(found)


def runs(pid):
    """Whether there is such a process that has not ended; one that nobody has waited for has."""
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def works_in(pid, folder):
    """Whether the process has a nameless file in the folder, as a rank that keeps its points there has."""
    try:
        links = [os.readlink(link) for link in pathlib.Path(f"/proc/{pid}/fd").iterdir()]
        return any(link.startswith(str(folder)) and link.endswith("(deleted)") for link in links)
    except (FileNotFoundError, ProcessLookupError):
        return False


def killed_rank_ends_all(folder):
    mpirun = subprocess.Popen(["mpirun", "-n", "2", PROGRAM, "build", str(CONFIG), "--set", "filters=[]", "--set",
                               "grid.spacing_mm=0.2", "--threads", "1", "--quiet", "--out", str(folder / "shared")],
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=environment())
    ranks = []
    deadline = time.monotonic() + 30
    # Of a process that has not come as far as MPI, the launcher does not know which rank it is.
    while len(ranks) < 2 and time.monotonic() < deadline and mpirun.poll() is None:
        ranks = [pid for pid in children_of(mpirun.pid) if works_in(pid, folder)]
    assert len(ranks) == 2, "the ranks did not begin to build"
    os.kill(ranks[1], signal.SIGKILL)
    began = time.monotonic()
    try:
        err = mpirun.communicate(timeout=LONGEST_S)[1]
    finally:
        mpirun.kill()
    while any(runs(pid) for pid in ranks) and time.monotonic() - began < LONGEST_S:
        time.sleep(0.05)
    assert time.monotonic() - began < LONGEST_S, f"running after {LONGEST_S} s: {[pid for pid in ranks if runs(pid)]}"
    assert mpirun.returncode != 0 and "rank 1" in err, err
    left = [str(p.relative_to(folder)) for p in folder.rglob("*") if not str(p).startswith(str(folder / "alone"))]
    assert not left, f"left: {left}; {err}"


def main():
    if shutil.which("mpirun") is None or not PLUGIN.is_file():
        print("skipped: mpirun or the plug-in for MPI is not installed")
        return 77
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        other_commands_are_refused_by_name(folder)
        same_bytes(folder)
        pictures_are_the_same(folder)
        refusal_is_said_once(folder)
        file_that_one_rank_cannot_read_is_named(folder)
        what_one_rank_has_otherwise_is_named(folder)
        each_rank_reads_its_part(folder)
        killed_rank_ends_all(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
