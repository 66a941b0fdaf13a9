"""The backend of pyproject.toml (PEP 517): CMake builds and installs the component python, which becomes a wheel.

Settings, as `pip install . --config-settings NAME=VALUE`: build-dir, a build folder to use and keep (default: one that goes
afterwards); jobs, how many files are compiled at once (default: one a core). CMAKE_ARGS of the environment is handed to CMake."""
import base64
import hashlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SUMMARY = "Raw scans of cultural heritage, made into surfaces that can be touched"
LICENCES = (ROOT / "LICENSE", ROOT / "packaging/copyright")  # ours, and those of what is compiled in
DATE = (1980, 1, 1, 0, 0, 0)  # of every file, so that the same package is the same wheel


def version():
    """As include/sparsha/version.h has it, which CMake reads, too."""
    text = (ROOT / "include/sparsha/version.h").read_text(encoding="utf-8")
    return ".".join(re.search(rf"#define SPARSHA_VERSION_{part} (\d+)", text).group(1) for part in ("MAJOR", "MINOR", "PATCH"))


def tag():
    """Of this interpreter and machine."""
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def run(*command):
    try:
        subprocess.run([str(word) for word in command], check=True)
    except FileNotFoundError:
        sys.exit(f"{command[0]} is missing; packages.txt names what builds Sparsha on Debian")
    except subprocess.CalledProcessError as error:
        sys.exit(f"{' '.join(map(str, command))} ended with {error.returncode}; packages.txt names what builds Sparsha")


def install_into(prefix, build, jobs):
    """Builds the module for this interpreter and installs it below `prefix`; gives the package's folder."""
    generator = [] if (build / "CMakeCache.txt").exists() or not shutil.which("ninja") else ["-G", "Ninja"]
    run("cmake", "-S", ROOT, "-B", build, *generator, "-DCMAKE_BUILD_TYPE=Release", "-DSPARSHA_PYTHON=ON",
        f"-DSPARSHA_PYTHON_EXECUTABLE={sys.executable}", *shlex.split(os.environ.get("CMAKE_ARGS", "")))
    run("cmake", "--build", build, "-j", jobs, "--target", "sparsha_python_package")
    os.environ.pop("DESTDIR", None)  # of a packager's own, which is not this folder's
    run("cmake", "--install", build, "--component", "python", "--prefix", prefix, "--strip")
    return next(pathlib.Path(prefix).rglob("_core.*")).parent


def numpy_of(build):
    """The NumPy that the module built in this folder bears: pybind11 before 2.12 knows NumPy 1 alone."""
    cache = (build / "CMakeCache.txt").read_text(encoding="utf-8")
    headers = pathlib.Path(re.search(r"^SPARSHA_PYBIND11:\w+=(.+)$", cache, re.M).group(1))
    text = (headers / "pybind11/detail/common.h").read_text(encoding="utf-8")
    found = tuple(int(re.search(rf"#define PYBIND11_VERSION_{part} (\d+)", text).group(1)) for part in ("MAJOR", "MINOR"))
    return "numpy<2" if found < (2, 12) else "numpy"


def metadata(numpy):
    return (f"Metadata-Version: 2.1\nName: sparsha\nVersion: {version()}\nSummary: {SUMMARY}\nRequires-Python: >=3.9\n"
            f"Requires-Dist: {numpy}\nLicense-File: LICENSE\nLicense-File: copyright\n")


def wheel_of(package, folder, numpy="numpy"):
    """Writes the wheel of an installed package, which needs this NumPy, into a folder; gives its name."""
    info = f"sparsha-{version()}.dist-info"
    name = f"sparsha-{version()}-{tag()}.whl"
    files = {f"sparsha/{path.name}": path.read_bytes() for path in sorted(pathlib.Path(package).iterdir()) if path.is_file()}
    files[f"{info}/METADATA"] = metadata(numpy).encode()
    for licence in LICENCES:
        files[f"{info}/{licence.name}"] = licence.read_bytes()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: sparsha\nRoot-Is-Purelib: false\nTag: {tag()}\n".encode()
    records = []
    for path, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        records.append(f"{path},sha256={digest},{len(data)}\n")
    records.append(f"{info}/RECORD,,\n")
    files[f"{info}/RECORD"] = "".join(records).encode()
    with zipfile.ZipFile(pathlib.Path(folder) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in files.items():
            entry = zipfile.ZipInfo(path, DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if ".so" in path else 0o644) << 16
            wheel.writestr(entry, data)
    return name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):  # noqa: ARG001
    settings = config_settings or {}
    with tempfile.TemporaryDirectory() as work:
        build = pathlib.Path(settings.get("build-dir", pathlib.Path(work) / "build")).absolute()
        package = install_into(pathlib.Path(work) / "prefix", build, settings.get("jobs", os.cpu_count() or 1))
        return wheel_of(package, wheel_directory, numpy_of(build))


def build_sdist(sdist_directory, config_settings=None):  # noqa: ARG001
    """The files that Git knows."""
    listed = subprocess.run(["git", "-C", str(ROOT), "ls-files", "-z"], capture_output=True, check=True).stdout
    base = f"sparsha-{version()}"
    with tarfile.open(pathlib.Path(sdist_directory) / f"{base}.tar.gz", "w:gz", format=tarfile.PAX_FORMAT) as archive:
        for name in sorted(filter(None, listed.decode().split("\0"))):
            archive.add(ROOT / name, f"{base}/{name}", recursive=False)
        with tempfile.TemporaryDirectory() as work:
            info = pathlib.Path(work) / "PKG-INFO"
            info.write_text(metadata("numpy"), encoding="utf-8")
            archive.add(info, f"{base}/PKG-INFO")
    return f"{base}.tar.gz"
