"""`pip install .` of a clone into a virtual environment, without a network: used from an empty folder, and removed whole.

The compiler's options are those of the build folder, and the wheel's own lies in the clone, so that a cache of the compiler
serves. In the nightly run; else exit 77."""
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(os.environ["SPARSHA_SOURCE_DIR"])
BUILD = pathlib.Path(os.environ["SPARSHA_BUILD_DIR"])
KEPT = ("SPARSHA_PRECOMPILE", "SPARSHA_LIBRARY_ASSERTIONS")
USE = """
import numpy as np, pathlib, sparsha
x, y = np.meshgrid(np.arange(40), np.arange(40))
points = np.stack([x, y, x], -1).reshape(-1, 3) * 1e-3
scene = sparsha.build(sparsha.Cloud(points), config={"grid": {"spacing_mm": 1}, "texture": {"sigma_space_mm": 2, "sigma_range_mm": 1, "method": "opencv"}})
proxy, force = sparsha.Renderer(scene).step((0.02, 0.02, 0.019))
assert scene.texture().shape == scene.shape() and force[2] > 0, (proxy, force)
print(pathlib.Path(sparsha.__file__).parent)
"""


def run(*words, **others):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **others)
    if done.returncode != 0:
        sys.exit(f"{words} ended with {done.returncode}:\n{done.stdout[-4000:]}{done.stderr[-4000:]}")
    return done.stdout


def cmake_arguments():
    cache = (BUILD / "CMakeCache.txt").read_text(encoding="utf-8")
    return " ".join(f"-D{name}={value}" for name, value in re.findall(r"^(\w+):\w+=(.*)$", cache, re.MULTILINE) if name in KEPT)


def files(folder):
    return {path for path in folder.rglob("*") if path.is_file()}


def main():
    if os.environ.get("SPARSHA_NIGHTLY") != "1" or not importlib.util.find_spec("venv") or not importlib.util.find_spec("ensurepip"):
        print("skipped: of the nightly run (SPARSHA_NIGHTLY=1), with python3-venv")
        return 77
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run("git", "clone", "--quiet", "--no-hardlinks", SOURCE, folder / "clone")
        environment = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "PYTHONDONTWRITEBYTECODE")}
        run("/usr/bin/python3", "-m", "venv", "--system-site-packages", folder / "venv", env=environment)
        python, pip = folder / "venv/bin/python", [folder / "venv/bin/python", "-m", "pip"]
        before = files(folder / "venv")
        run(*pip, "install", "--no-build-isolation", "--no-index", "--config-settings", "build-dir=build", ".", cwd=folder / "clone",
            env={**environment, "CMAKE_ARGS": cmake_arguments()})
        assert run("git", "-C", folder / "clone", "status", "--porcelain") == "", "the clone was changed"
        (folder / "empty").mkdir()
        told = pathlib.Path(run(python, "-c", USE, cwd=folder / "empty", env=environment).strip())
        assert folder / "venv" in told.parents, told
        assert run(python, "-m", "sparsha", cwd=folder / "empty", env=environment).count("pass") == 16
        assert not files(folder / "empty")
        run(*pip, "uninstall", "--yes", "sparsha", env=environment)
        left = {path for path in files(folder / "venv") - before if "__pycache__" not in path.parts}
        assert not left, left
    return 0


sys.exit(main())
