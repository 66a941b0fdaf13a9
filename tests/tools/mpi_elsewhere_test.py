"""Scenes that ranks build by MPICH, and that two machines build over a network, are those of one process. By night.

The machines are two network namespaces with addresses and names of their own. 77 where none of this is there."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import mpi_test

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PLUGIN_SOURCE = SOURCE / "pipeline" / "cluster" / "mpi" / "mpi.cpp"


def build_command(out):
    return [mpi_test.PROGRAM, "build", str(mpi_test.CONFIG), *mpi_test.SETTINGS, "--threads", "1", "--quiet", "--out", str(out)]


def by_mpich(folder, expected):
    """Whether MPICH is there; its plug-in is found before that of the build."""
    if shutil.which("mpicxx.mpich") is None or shutil.which("mpirun.mpich") is None:
        return False
    subprocess.run(["mpicxx.mpich", "-std=c++20", "-O1", "-shared", "-fPIC", "-I", str(SOURCE), "-o",
                    str(folder / mpi_test.PLUGIN.name), str(PLUGIN_SOURCE)], check=True, timeout=120)
    for ranks in (1, 2, 3, 8):
        run = subprocess.run(["mpirun.mpich", "-n", str(ranks), *build_command(folder / "mpich")], capture_output=True,
                             text=True, timeout=200, env={**os.environ, "LD_LIBRARY_PATH": str(folder)})
        assert run.returncode == 0, (ranks, run.stderr)
        assert mpi_test.content(folder / "mpich") == expected, f"{ranks} ranks of MPICH build another scene"
        shutil.rmtree(folder / "mpich")
    run = subprocess.run(["mpirun.mpich", "-n", "3", *build_command(folder / "mpich"), "--set", "around={}"],
                         capture_output=True, text=True, timeout=60, env={**os.environ, "LD_LIBRARY_PATH": str(folder)})
    assert run.returncode != 0 and run.stderr.count("error:") == 1 and "rank 0 of 3" in run.stderr, run.stderr
    return True


class Machines:
    """Two of them, joined by a wire; taken down at the end."""

    def __init__(self):
        self.names = [f"sparsha{os.getpid()}{which}" for which in "ab"]

    def ip(self, *words):
        return subprocess.run(["ip", *words], capture_output=True, text=True)

    def __enter__(self):
        self.there = all(self.ip("netns", "add", name).returncode == 0 for name in self.names)
        if not self.there:
            return self
        a, b = self.names
        self.there = self.ip("link", "add", "wire0", "netns", a, "type", "veth", "peer", "name", "wire0", "netns", b).returncode == 0
        for k, name in enumerate(self.names):
            self.ip("-n", name, "address", "add", f"10.77.0.{k + 1}/24", "dev", "wire0")
            self.ip("-n", name, "link", "set", "wire0", "up")
            self.ip("-n", name, "link", "set", "lo", "up")
        return self

    def __exit__(self, *_):
        for name in self.names:
            self.ip("netns", "delete", name)

    def received_bytes(self):
        words = self.ip("-n", self.names[0], "-s", "link", "show", "wire0").stdout.split()
        return int(words[words.index("RX:") + words[words.index("RX:"):].index("missed") + 2])


def over_a_network(folder, expected):
    """Whether the machine lets us have two others."""
    if shutil.which("ip") is None or shutil.which("unshare") is None:
        return False
    with Machines() as machines:
        if not machines.there:
            return False
        a, b = machines.names
        # The launcher starts what runs on the other machine by this, in place of ssh.
        agent = folder / "agent"
        agent.write_text(f"#!/bin/sh\nshift\nexec ip netns exec {b} unshare -u sh -c 'hostname stone2; exec sh -c \"$0\"' \"$*\"\n")
        agent.chmod(0o755)
        wire = [word for layer in ("btl_tcp", "oob_tcp") for word in ("--mca", f"{layer}_if_include", "10.77.0.0/24")]
        launch = ["mpirun", "--host", "10.77.0.1:2,10.77.0.2:2", "--map-by", "node", "--mca", "plm_rsh_agent", str(agent), "--mca", "btl",
                  "tcp,self", *wire]
        on_a = ["ip", "netns", "exec", a, "unshare", "-u", "sh", "-c", 'hostname stone1; exec "$0" "$@"']
        for ranks in (2, 4):
            before = machines.received_bytes()
            run = subprocess.run([*on_a, *launch, "-n", str(ranks), *build_command(folder / "network")], capture_output=True, text=True,
                                 timeout=200, env=mpi_test.environment())
            assert run.returncode == 0, (ranks, run.stderr)
            assert mpi_test.content(folder / "network") == expected, f"{ranks} ranks on two machines build another scene"
            shutil.rmtree(folder / "network")
            points = expected[1]["points"]["used"]
            # Half of the points come to the first machine from the other, 16 bytes each.
            assert machines.received_bytes() - before > 8 * points * 0.9, (machines.received_bytes() - before, points)
        run = subprocess.run([*on_a, *launch, "-n", "2", *build_command(folder / "network"), "--set", "around={}"],
                             capture_output=True, text=True, timeout=60, env=mpi_test.environment())
        # The end of all reaches the other machine late at times, so that its rank says the same.
        said = [line.split(": error: ") for line in run.stderr.splitlines() if "error: " in line]
        assert run.returncode == 2 and said[0][0] == "rank 0 of 2 on stone1", run.stderr
        assert {who for who, _ in said} <= {"rank 0 of 2 on stone1", "rank 1 of 2 on stone2"} and len({what for _, what in said}) == 1, run.stderr
    return True


def main():
    if "SPARSHA_NIGHTLY" not in os.environ:
        print("skipped: by night, with SPARSHA_NIGHTLY set")
        return 77
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        assert mpi_test.build(0, folder / "alone").returncode == 0
        expected = mpi_test.content(folder / "alone")
        tested = [what for what, test in (("MPICH", by_mpich), ("two machines", over_a_network)) if test(folder, expected)]
    print("tested: " + (", ".join(tested) or "nothing"))
    return 0 if tested else 77


sys.exit(main())
