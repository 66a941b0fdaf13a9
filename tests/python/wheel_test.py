"""The installed component as a wheel: whole, the same each time, and used from where it was unpacked."""
import base64
import csv
import hashlib
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import zipfile

SOURCE = pathlib.Path(os.environ["SPARSHA_SOURCE_DIR"])
BUILD = pathlib.Path(os.environ["SPARSHA_BUILD_DIR"])
sys.path.insert(0, str(SOURCE / "python/wheel"))
import sparsha_wheel  # noqa: E402


ELF = b"\x7fELF"


class Wheel(unittest.TestCase):
    def assert_needed_alone(self, archive):
        """The package's own files, and nothing that names the build folder."""
        info = next(name for name in archive.namelist() if name.endswith("/METADATA")).rpartition("/")[0]
        expected = {f"sparsha/{f.name}" for f in (SOURCE / "python/sparsha").iterdir() if f.is_file()}
        expected |= {f"{info}/{name}" for name in ("METADATA", "WHEEL", "RECORD", "LICENSE", "copyright")}
        libraries = set(archive.namelist()) - expected
        self.assertEqual(expected - set(archive.namelist()), set())
        self.assertTrue(all(re.fullmatch(r"sparsha/(_core\.[\w-]+|libsparsha_opencv_images)\.so", name) for name in libraries), libraries)
        for name in archive.namelist():
            data = archive.read(name)
            for folder in {str(BUILD), str(SOURCE)}:
                self.assertNotIn(folder.encode(), data, name)
            self.assertEqual(data.startswith(ELF), name in libraries)
        with tempfile.TemporaryDirectory() as folder:
            for name in libraries:
                told = subprocess.run(["readelf", "-Wd", archive.extract(name, folder)], check=True, capture_output=True, text=True).stdout
                paths = re.findall(r"\((?:RUNPATH|RPATH)\).*\[(.*)\]", told)
                self.assertLessEqual(set(paths), {"$ORIGIN"}, name)
                self.assertTrue(paths or "_core" not in name)

    def test_a_wheel_of_the_installed_component_is_whole_and_runs_where_it_is_unpacked(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            subprocess.run(["cmake", "--install", BUILD, "--component", "python", "--prefix", folder / "prefix"], check=True,
                           capture_output=True)
            package = folder / "prefix/lib/python3/dist-packages/sparsha"
            self.assertTrue((package / "py.typed").exists())
            wheel = folder / sparsha_wheel.wheel_of(package, folder)
            first = wheel.read_bytes()
            sparsha_wheel.wheel_of(package, folder)
            self.assertEqual(wheel.read_bytes(), first)
            with zipfile.ZipFile(wheel) as archive:
                names = archive.namelist()
                self.assert_needed_alone(archive)
                record = next(n for n in names if n.endswith("/RECORD"))
                rows = list(csv.reader(io.StringIO(archive.read(record).decode())))
                self.assertEqual([row[0] for row in rows], names)
                for path, digest, size in rows[:-1]:
                    data = archive.read(path)
                    self.assertEqual(digest, "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip("="))
                    self.assertEqual(int(size), len(data))
                archive.extractall(folder / "site")
            (folder / "prefix").rename(folder / "elsewhere")
            # OpenCV's library lies beside the module, and is found there.
            code = ("import numpy as np, sparsha; x, y = np.meshgrid(np.arange(40), np.arange(40)); "
                    "s = sparsha.build(sparsha.Cloud(np.stack([x, y, x], -1).reshape(-1, 3) * 1e-3), "
                    "config={'grid': {'spacing_mm': 1}, 'texture': {'sigma_space_mm': 2, 'sigma_range_mm': 1, 'method': 'opencv'}}); "
                    "print(sparsha.__file__, s.texture().shape)")
            environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
            told = subprocess.run([sys.executable, "-W", "ignore", "-c", code], cwd=folder, check=True, capture_output=True, text=True,
                                  env={**environment, "PYTHONPATH": str(folder / "site")}).stdout
            self.assertIn(str(folder / "site"), told)


if __name__ == "__main__":
    unittest.main()
