"""Ctrl-C from another thread ends reading, building, filtering, checking and registering early, and leaves no
file behind. Early is meant in processor time of this process, against that of the same work done to its end."""
import os
import pathlib
import signal
import tempfile
import threading
import time
import unittest
import warnings

import numpy as np

import sparsha
from surfaces import wave_points

BEGUN, ENDED = 0.2, 0.75  # shares of the work: when the signal comes, and by when it must have had its effect


class Interrupter:
    """Sends SIGINT to this process once `seconds` of processor time have been used, if the work has not ended by then."""

    def __init__(self, seconds):
        self._limit = time.process_time() + seconds
        self._ended = threading.Event()
        self.sent = False
        self._thread = threading.Thread(target=self._watch)

    def _watch(self):
        while not self._ended.wait(0.001):
            if time.process_time() >= self._limit:
                self.sent = True
                os.kill(os.getpid(), signal.SIGINT)
                return

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._ended.set()
        self._thread.join()


class CtrlC(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        warnings.simplefilter("ignore", sparsha.Warning)
        cls.points = wave_points(900, 700, 0.0002)
        cls.cloud = sparsha.Cloud(cls.points)
        cls.block = {"grid": {"spacing_mm": 0.1}}
        cls.scene = sparsha.build(cls.cloud, config=cls.block)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        scratch = self.folder / "scratch"
        scratch.mkdir()
        before = os.environ.get("TMPDIR")
        os.environ["TMPDIR"] = str(scratch)
        self.addCleanup(lambda: os.environ.pop("TMPDIR") if before is None else os.environ.update(TMPDIR=before))

    def assert_ends_early(self, work):
        """Gives what `work` gives when it is let be."""
        began = time.process_time()
        result = work()
        whole = time.process_time() - began
        self.assertGreater(whole, 0.15, "too little work to be interrupted")
        began = time.process_time()
        with self.assertRaises(KeyboardInterrupt), Interrupter(BEGUN * whole) as interrupter:
            work()
        used = time.process_time() - began
        self.assertTrue(interrupter.sent)
        self.assertLess(used, ENDED * whole, f"{used:.2f} s of {whole:.2f} s")
        self.assertEqual(list((self.folder / "scratch").iterdir()), [], "temporary files stay")
        return result

    def test_reading_ends(self):
        file = self.folder / "big.xyz"
        file.write_text("\n".join("%.6f %.6f %.6f" % tuple(p) for p in self.points[:100000]) + "\n")
        text = file.read_bytes()
        file.write_bytes(text * 12)
        self.assertEqual(len(self.assert_ends_early(lambda: sparsha.read(file))), 1200000)

    def test_a_build_ends_and_leaves_no_folder(self):
        number = iter(range(2))

        def build():
            return sparsha.build(self.cloud, config=self.block, out=self.folder / f"{next(number)}.scene")
        scene = self.assert_ends_early(build)
        np.testing.assert_array_equal(scene.heights(), self.scene.heights())
        self.assertEqual({p.name for p in self.folder.iterdir()}, {"scratch", "0.scene"})

    def test_filtering_ends(self):
        cloud = sparsha.Cloud(self.points)
        left, _ = self.assert_ends_early(lambda: cloud.filtered([{"outliers": {"sigma": 3}}]))
        self.assertGreater(len(left), 0.95 * len(self.points))

    def test_a_check_ends(self):
        told = self.assert_ends_early(lambda: self.scene.check(self.cloud, samples=0))
        self.assertLess(told["check"]["cloud_to_surface"]["rms_m"], 1e-4)

    def test_a_registration_ends(self):
        clouds = [sparsha.Cloud(self.points[self.points[:, 0] < 0.12]), sparsha.Cloud(self.points[self.points[:, 0] > 0.06])]
        found = self.assert_ends_early(lambda: sparsha.register(clouds, voxel_mm=0.3))
        self.assertEqual(len(found["poses"]), 2)


if __name__ == "__main__":
    unittest.main()
