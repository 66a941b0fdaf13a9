#!/usr/bin/env python3
"""page_blocks_test.py SPARSHA LIBRARY: a build whose arrays lie in files ends, with the same bytes, wherever the blocks
of its heap begin: the library makes many of them begin at pages."""
import filecmp
import os
import random
import subprocess
import sys
import tempfile

SPARSHA, LIBRARY = map(os.path.abspath, sys.argv[1:])
LIMIT_S = 300  # a build takes some seconds


def write_relief(path, points):
    random_ = random.Random(7)
    with open(path, "w", encoding="ascii") as file:
        for _ in range(points):
            x, y = random_.random(), random_.random()
            file.write("%.5f %.5f %.5f\n" % (x, y, 0.02 * abs((7 * x) % 2 - 1)))


def build(folder, name, environment, *options):
    scene = os.path.join(folder, name)
    done = subprocess.run([SPARSHA, "build", os.path.join(folder, "relief.yaml"), "--out", scene, *options],
                          env={**os.environ, **environment}, capture_output=True, text=True, timeout=LIMIT_S)
    assert done.returncode == 0, done.stderr
    return scene


def main():
    with tempfile.TemporaryDirectory() as folder:
        write_relief(os.path.join(folder, "relief.xyz"), 50_000)
        with open(os.path.join(folder, "relief.yaml"), "w", encoding="ascii") as file:
            file.write("scans: [{file: relief.xyz}]\ngrid: {size: 1600}\ntexture: {}\nfriction: {}\n")
        plain = build(folder, "plain", {})
        for threads in "1", "2", "5":
            paged = build(folder, "paged" + threads, {"LD_PRELOAD": LIBRARY}, "--memory", "115MB", "--threads", threads)
            heights = os.path.join("level-0", "height.tif")
            assert filecmp.cmp(os.path.join(plain, heights), os.path.join(paged, heights), shallow=False)
    print("builds under a limit end wherever blocks begin")


if __name__ == "__main__":
    main()
