"""Packages of a build that has `sparsha_packaged`: unpacked into an empty root, their libraries resolved, the program used
from there, installed over itself beside a user's files and removed without trace; the same bytes are made twice.

  package_test.py CMAKE BUILD     in the nightly run, as root (dpkg); else exit 77
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

CPACK, BUILD = pathlib.Path(sys.argv[1]).with_name("cpack"), pathlib.Path(sys.argv[2])
EPOCH = "1700000000"
PYTHON, MODULES = "python3-sparsha", "usr/lib/python3/dist-packages"
PARTS = {"sparsha-mpi": "lib*/sparsha/libsparsha_mpi.so", PYTHON: "python/sparsha/_core.*.so"}  # of the build folder


def run(*words, **others):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=600, check=False, **others)
    if done.returncode != 0:
        sys.exit(f"{words} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


def packages(folder):
    folder.mkdir()
    run(CPACK, "-G", "DEB", "-B", folder, cwd=BUILD, env={**os.environ, "SOURCE_DATE_EPOCH": EPOCH})
    return {path.name.split("_")[0]: path for path in folder.glob("*.deb")}


def files(root):
    """All but what dpkg keeps for itself."""
    return sorted(path for path in (str(path.relative_to(root)) for path in root.rglob("*") if not path.is_dir())
                  if not path.startswith("var/lib/dpkg/"))


def use(root, work):
    program = root / "usr/bin/sparsha"
    for binary in (root / "usr/lib/sparsha").iterdir():
        missing = re.findall(r".*not found", run("ldd", binary))
        assert not missing, missing
    scene = work / "scene"
    run(program, "build", root / "usr/share/sparsha/configs/relief.yaml", "--set", "grid.spacing_mm=3", "--out", scene)
    run(program, "explore", scene, "--headless", "--device", "simulated", "--duration", "2", "--record", work / "run.csv")
    assert (work / "run.csv").stat().st_size > 10000
    run(program, "export", scene, "--to", work / "relief.stl")
    assert (work / "relief.stl").stat().st_size > 10000


def use_module(root, work):
    """As the system's Python would, which writes its bytecode beside the modules."""
    (work / "empty").mkdir()
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    python = ["/usr/bin/python3", "-W", "ignore", "-c"]
    told = run(*python, "import sys; sys.path.insert(0, sys.argv[1]); import sparsha, importlib.metadata as m;"
               "print(sparsha.__file__, m.version('sparsha') == sparsha.__version__, sparsha.open(sys.argv[2]).report['points']['read'] > 0)",
               root / MODULES, work / "scene", cwd=work / "empty", env=environment)
    assert told.split() == [str(root / MODULES / "sparsha" / "__init__.py"), "True", "True"], told
    assert any((root / MODULES / "sparsha/__pycache__").iterdir())
    example = root / "usr/share/doc/python3-sparsha/examples/friction.py"
    run("/usr/bin/python3", "-W", "ignore", example, "--quick", cwd=work / "empty", env={**environment, "PYTHONPATH": root / MODULES, "PYTHONDONTWRITEBYTECODE": "1"})
    assert (work / "empty/pictures").is_dir()
    for library in (root / MODULES / "sparsha").glob("*.so"):
        assert "not found" not in run("ldd", library), library


def main():
    if os.environ.get("SPARSHA_NIGHTLY") != "1" or os.geteuid() != 0 or not shutil.which("dpkg-shlibdeps"):
        print("skipped: of the nightly run (SPARSHA_NIGHTLY=1), as root, with dpkg-dev")
        return 77
    with tempfile.TemporaryDirectory() as name:
        work = pathlib.Path(name)
        made = packages(work / "first")
        others = [package for package, part in PARTS.items() if any(BUILD.glob(part))]
        assert sorted(made) == sorted(["libsparsha-dev", "sparsha", *others]), made
        again = packages(work / "second")
        for package, path in made.items():
            assert path.read_bytes() == again[package].read_bytes(), f"{package}: two runs give other bytes"

        depends = run("dpkg-deb", "-f", made["sparsha"], "Depends")
        assert "libc6" in depends and not re.search(r"-dev\b|vtk|qt|gdal|mpi", depends), depends
        if "sparsha-mpi" in made:
            depends = run("dpkg-deb", "-f", made["sparsha-mpi"], "Depends")
            assert "mpi" in depends and "sparsha (= " in depends, depends
        if PYTHON in made:
            depends = run("dpkg-deb", "-f", made[PYTHON], "Depends")
            for needed in (r"python3 \(>= 3\.\d+~\)", r"python3 \(<< 3\.\d+\)", "python3-numpy", "libc6", "libstdc\\+\\+6"):
                assert re.search(needed, depends), depends
            assert not re.search(r"-dev\b|vtk|qt|gdal|mpi|sparsha", depends), depends

        root, admin = work / "root", work / "root/var/lib/dpkg"
        for folder in (root / "home/user/sparsha-scenes", admin / "updates", admin / "info"):
            folder.mkdir(parents=True)
        for file in ("status", "available"):
            (admin / file).touch()
        (root / "home/user/sparsha-scenes/notes.yaml").write_text("pins: []\n", encoding="utf-8")
        before = files(root)
        dpkg = ["dpkg", f"--root={root}", "--force-depends", "--force-script-chrootless", "--log=/dev/null"]
        run(*dpkg, "-i", *made.values())
        installed = files(root)
        wanted = ["usr/share/man/man1/sparsha-build.1.gz", "usr/share/bash-completion/completions/sparsha",
                  "usr/share/zsh/vendor-completions/_sparsha", "usr/share/applications/sparsha.desktop",
                  "usr/share/mime/packages/sparsha.xml", "usr/share/icons/hicolor/scalable/apps/sparsha.svg",
                  "usr/share/metainfo/org.sparsha.sparsha.metainfo.xml", "usr/lib/udev/rules.d/40-novint-falcon.rules",
                  "usr/share/doc/sparsha/copyright", "usr/share/doc/libsparsha-dev/copyright", "usr/include/sparsha/servo.h",
                  "usr/lib/cmake/Sparsha/SparshaConfig.cmake"]
        if "sparsha-mpi" in made:
            wanted += ["usr/lib/sparsha/libsparsha_mpi.so", "usr/share/doc/sparsha-mpi/copyright"]
        if PYTHON in made:
            wanted += [f"{MODULES}/sparsha/{name}" for name in ("__init__.py", "_core.pyi", "py.typed")]
            wanted += ["usr/share/doc/python3-sparsha/copyright", "usr/share/doc/python3-sparsha/examples/statue.py"]
        missing = [path for path in wanted if path not in installed]
        assert not missing, missing
        use(root, work)
        if PYTHON in made:
            use_module(root, work)
        run(*dpkg, "-i", *made.values())  # an upgrade
        assert [path for path in files(root) if "__pycache__" not in path] == installed
        run(*dpkg, "--purge", *made)
        assert files(root) == before, sorted(set(files(root)) - set(before))
        assert not (root / "usr").exists(), "a folder stays"
        if shutil.which("lintian"):
            run("lintian", "--fail-on", "error", *made.values())
        print({package: f"{path.stat().st_size / 1e6:.1f} MB" for package, path in made.items()})
    return 0


sys.exit(main())
