"""The same sources give the same bytes in two folders, at two times: each library, program and package of two builds that know
nothing of each other, without a compiler cache.

  reproducible_test.py CMAKE SOURCE small     two libraries, with debug information, which would name folders
  reproducible_test.py CMAKE SOURCE whole     the packages (tools/nightly.sh)"""
import filecmp
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

CMAKE, SOURCE, SIZE = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), sys.argv[3]
SMALL = ["-DCMAKE_BUILD_TYPE=RelWithDebInfo", "-DSPARSHA_COMPONENTS=haptics", "-DSPARSHA_UNITY=ON"]  # as first builds are
WHOLE = ["-DCMAKE_BUILD_TYPE=Release"]
TARGETS = {"small": ["sparsha_base_core", "sparsha_scene_core"], "whole": ["sparsha_packaged"]}[SIZE]
MADE = {"small": ["*.a"], "whole": ["*.a", "*.so", "bin/sparsha", "lib/sparsha/sparsha", "*.deb", "*.tar.gz"]}[SIZE]


def sources():
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=SOURCE, capture_output=True, check=False)
    if listed.returncode != 0:
        print("no checkout here, so that its files are not known")
        sys.exit(77)
    return [name for name in listed.stdout.decode().split("\0") if name and (SOURCE / name).is_file()]


def build(folder, environment):
    for name in sources():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(SOURCE / name, folder / name)
        shutil.copymode(SOURCE / name, folder / name)
    jobs = "1" if SIZE == "small" else str(os.cpu_count())
    for command in ([CMAKE, "-S", ".", "-B", "out", "-DSPARSHA_BUILD_TESTS=OFF", "-DCMAKE_CXX_COMPILER_LAUNCHER=env",
                     *(SMALL if SIZE == "small" else WHOLE)],
                    [CMAKE, "--build", "out", f"-j{jobs}", "--target", *TARGETS]):
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    if SIZE == "whole":
        subprocess.run([pathlib.Path(CMAKE).with_name("cpack")], cwd=folder / "out", env=environment, check=True, capture_output=True)
    return {str(file.relative_to(folder)): file for pattern in MADE for file in sorted((folder / "out").rglob(pattern))
            if file.is_file() and "CMakeFiles" not in file.parts and "_CPack_Packages" not in file.parts}


def main():
    environment = {**os.environ, "SOURCE_DATE_EPOCH": "1700000000", "CCACHE_DISABLE": "1", "LC_ALL": "C"}
    with tempfile.TemporaryDirectory() as top:
        first, second = (build(pathlib.Path(top) / name, environment) for name in ("a", "a folder of another name"))
        if first.keys() != second.keys() or len(first) < len(TARGETS):
            sys.exit(f"one build made {sorted(first)}, the other {sorted(second)}")
        differing = [name for name in first if not filecmp.cmp(first[name], second[name], shallow=False)]
        leaking = [name for name in first if SIZE == "small" and top.encode() in first[name].read_bytes()]
        for name in differing:
            print(f"{name} differs")
        for name in leaking:
            print(f"{name} names the folder in which it was built")
        print(f"{len(first)} files were compared")
        return 1 if differing or leaking else 0


sys.exit(main())
