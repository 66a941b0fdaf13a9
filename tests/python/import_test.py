"""The package as another Python than its own meets it, and NumPy missing: one sentence that says what to do."""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import sparsha

PACKAGE = pathlib.Path(sparsha.__file__).parent


class Importing(unittest.TestCase):
    def told(self):
        done = subprocess.run([sys.executable, "-c", "import sparsha"], capture_output=True, text=True,
                              env={"PYTHONPATH": str(self.folder)})
        self.assertNotEqual(done.returncode, 0)
        return done.stderr.strip().split("\n")[-1]

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        shutil.copytree(PACKAGE, self.folder / "sparsha", ignore=shutil.ignore_patterns("*.so", "__pycache__"))

    def test_a_module_of_another_python_is_named_with_both_versions(self):
        (self.folder / "sparsha/_core.cpython-399-x86_64-linux-gnu.so").touch()
        told = self.told()
        for part in ("Python 3.99", f"Python {sys.version_info.major}.{sys.version_info.minor}", sys.executable, "/usr/bin/python3"):
            self.assertIn(part, told)

    def test_a_missing_module_stays_a_missing_module(self):
        self.assertIn("_core", self.told())

    def test_a_numpy_that_the_module_would_misread_is_refused(self):
        for module in PACKAGE.glob("*.so"):
            (self.folder / "sparsha" / module.name).symlink_to(module)
        code = "import numpy; numpy.__version__ = '2.1.0'; import sparsha"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env={"PYTHONPATH": str(self.folder)})
        if done.returncode != 0:  # else it was built by a pybind11 that knows NumPy 2
            self.assertRegex(done.stderr.strip().split("\n")[-1], r"^ImportError: .*NumPy is 2\.1\.0; use numpy<2")

    def test_missing_numpy_is_named_with_its_package(self):
        for module in PACKAGE.glob("*.so"):
            (self.folder / "sparsha" / module.name).symlink_to(module)
        code = f"import sys; sys.path.append({str(self.folder)!r}); import sparsha"  # -S: without the system's packages
        done = subprocess.run([sys.executable, "-I", "-S", "-c", code], capture_output=True, text=True)
        self.assertIn("python3-numpy", done.stderr.strip().split("\n")[-1])


if __name__ == "__main__":
    unittest.main()
