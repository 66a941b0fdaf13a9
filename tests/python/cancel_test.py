"""Ctrl-C ends reading, building, filtering, checking, registering and tracing before their end, and leaves no file behind.

What ended early is known by its note: without a note the work had come to its own end before the signal had an effect.
A machine with other work may let that happen; then the same is tried again."""
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

TRIES = 50


@unittest.skipUnless(hasattr(BaseException, "add_note"), "exceptions have no notes before Python 3.11")
class CtrlC(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        warnings.simplefilter("ignore", sparsha.Warning)
        cls.points = wave_points(500, 500, 0.0002)
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

    def interrupted(self, work):
        """The notes of the KeyboardInterrupt of a signal that another thread sends once `work` has told of itself."""
        begun = threading.Event()

        def send():
            begun.wait()
            os.kill(os.getpid(), signal.SIGINT)
        thread = threading.Thread(target=send)
        with self.assertRaises(KeyboardInterrupt) as raised:
            thread.start()
            try:
                work(lambda stage, share: begun.set())
            finally:
                begun.set()
                thread.join()
            while True:  # the signal is on its way
                time.sleep(0.001)
        return getattr(raised.exception, "__notes__", [])

    def assert_ends_early(self, work):
        """Gives what `work` gives when it is let be."""
        for _ in range(TRIES):
            notes = self.interrupted(work)
            self.assertEqual(list((self.folder / "scratch").iterdir()), [], "temporary files stay")
            if notes:
                break
        self.assertRegex("".join(notes), r"^sparsha ended its work at \d+ % of the stage '\w+[^']*'$")
        return work(None)

    def test_reading_ends(self):
        file = self.folder / "big.xyz"
        file.write_text("\n".join("%.6f %.6f %.6f" % tuple(p) for p in self.points[:100000]) + "\n")
        text = file.read_bytes()
        file.write_bytes(text * 6)
        self.assertEqual(len(self.assert_ends_early(lambda told: sparsha.read(file, progress=told))), 600000)

    def test_a_build_ends_and_leaves_no_folder(self):
        folders = []

        def build(told):
            folders.append(self.folder / f"{len(folders)}.scene")
            return sparsha.build(self.cloud, config=self.block, out=folders[-1], progress=told)
        scene = self.assert_ends_early(build)
        np.testing.assert_array_equal(scene.heights(), self.scene.heights())
        self.assertFalse(folders[-2].exists())
        self.assertLessEqual({p.name for p in self.folder.iterdir()}, {"scratch", *(p.name for p in folders)})

    def test_filtering_ends(self):
        cloud = sparsha.Cloud(self.points)
        left, _ = self.assert_ends_early(lambda told: cloud.filtered([{"outliers": {"sigma": 3}}], progress=told))
        self.assertGreater(len(left), 0.95 * len(self.points))

    def test_a_check_ends(self):
        told = self.assert_ends_early(lambda told: self.scene.check(self.cloud, samples=0, progress=told))
        self.assertLess(told["check"]["cloud_to_surface"]["rms_m"], 1e-4)

    def test_a_registration_ends(self):
        clouds = [sparsha.Cloud(self.points[self.points[:, 0] < 0.07]), sparsha.Cloud(self.points[self.points[:, 0] > 0.03])]
        found = self.assert_ends_early(lambda told: sparsha.register(clouds, voxel_mm=0.3, progress=told))
        self.assertEqual(len(found["poses"]), 2)

    def test_a_trace_ends_and_its_renderer_goes_on(self):
        t = np.arange(250000) / 1000
        x0, y0, z0 = self.scene.origin
        path = np.stack([x0 + 0.05 + 0.04 * np.sin(2.1 * t), y0 + 0.05 + 0.04 * np.sin(1.7 * t), z0 + 0.002 * np.sin(9 * t)], -1)
        renderer = sparsha.Renderer(self.scene)
        expected = renderer.trace(path)
        first = renderer.step(path[0])
        trace = self.assert_ends_early(lambda told: renderer.trace(path, progress=told))
        np.testing.assert_array_equal(trace.force, expected.force)
        np.testing.assert_array_equal(trace.proxy, expected.proxy)
        np.testing.assert_array_equal(renderer.step(path[0]), first)

        def save(told):
            files.append(self.folder / f"{len(files)}.csv")
            trace.save(files[-1], progress=told)
        files = []
        self.assert_ends_early(save)
        self.assertFalse(files[-2].exists())
        with open(files[-1]) as rows:
            self.assertEqual(sum(1 for _ in rows), len(path) + 1)
        self.assertLessEqual({p.name for p in self.folder.iterdir()}, {"scratch", *(p.name for p in files)})

    def test_saving_a_scene_is_told_and_ends_and_leaves_no_folder(self):
        told = []
        coloured = sparsha.Cloud(self.points, colour=np.full((len(self.points), 3), 0.5))
        scene = sparsha.build(coloured, config={"grid": {"spacing_mm": 0.04, "colour": True}})

        def save(progress):
            folders.append(self.folder / f"{len(folders)}.scene")
            scene.save(folders[-1], progress=progress)
        folders = []
        self.assert_ends_early(save)
        self.assertFalse(folders[-2].exists())
        np.testing.assert_array_equal(sparsha.open(folders[-1]).heights(), scene.heights())
        self.scene.save(self.folder / "told.scene", progress=lambda *step: told.append(step))
        self.assertEqual((told[0][0], told[-1]), ("write", ("write", 1.0)))
        self.assertEqual(told, sorted(told))
        self.assertLessEqual({p.name for p in self.folder.iterdir()}, {"scratch", "told.scene", *(p.name for p in folders)})

    def test_exporting_the_benchmark_ends_and_leaves_no_folder(self):
        def export(progress):
            folders.append(self.folder / f"bench{len(folders)}")
            sparsha.bench_export(folders[-1], progress=progress)
        folders = []
        self.assert_ends_early(export)
        self.assertFalse(folders[-2].exists())
        self.assertTrue((folders[-1] / "cases.csv").exists())

    def test_a_replica_ends(self):
        def export(progress):
            files.append(self.folder / f"{len(files)}.3mf")
            sparsha.export(self.scene, files[-1], progress=progress)
        files = []
        self.assert_ends_early(export)
        self.assertFalse(files[-2].exists())

    def assert_ends_early_without_progress(self, make_work):
        """A signal ends `make_work(times)`, work of `times` the least size that tells of no progress: a note says so.

        Each size is tried at several moments of its work. Work that is over before the first look for signals, 20 ms
        after its begin, cannot end early: its size doubles."""
        for times in (1, 2, 4, 8, 16):
            work = make_work(times)
            work()
            begun = time.perf_counter()
            work()
            whole = time.perf_counter() - begun
            for share in (0.1, 0.3, 0.5, 0.7):
                if self.ends_early_after(whole * share, work):
                    return
        self.fail("no signal ended the work early")

    def ends_early_after(self, seconds, work):
        """Whether a signal after `seconds` ends `work` before its own end."""
        def send():
            time.sleep(seconds)
            os.kill(os.getpid(), signal.SIGINT)
        thread = threading.Thread(target=send)
        with self.assertRaises(KeyboardInterrupt) as raised:
            thread.start()
            try:
                work()
            finally:
                thread.join()
            while True:  # the signal is on its way
                time.sleep(0.001)
        return bool(getattr(raised.exception, "__notes__", []))

    def test_making_clouds_heights_and_renderers_ends(self):
        def cloud(times):
            points = np.tile(self.points, (8 * times, 1))
            return lambda: sparsha.Cloud(points)

        def heights(times):
            plane = np.zeros((2000 * times, 2000), np.float32)
            return lambda: sparsha.Renderer.of_heights(plane, 0.001)

        for make_work in (cloud, heights, lambda times: lambda: sparsha.Renderer(self.scene, tip_radius_mm=2.0)):
            self.assert_ends_early_without_progress(make_work)
        self.assertEqual(len(sparsha.Cloud(self.points)), len(self.points))

    def test_what_progress_raises_is_noted_too(self):
        def stop(stage, share):
            raise LookupError(stage)
        path = np.zeros((250000, 3))
        for _ in range(TRIES):
            with self.assertRaises(LookupError) as raised:
                sparsha.Renderer(self.scene).trace(path, progress=stop)
            if hasattr(raised.exception, "__notes__"):
                return
        self.fail("the work never ended early")


class OtherThreads(unittest.TestCase):
    """What another thread does while a large array is taken in: it has many turns, and not one at the end."""

    def turns_during(self, work):
        turns, done = [0], threading.Event()

        def count():
            while not done.is_set():
                turns[0] += 1
                time.sleep(0.0005)
        thread = threading.Thread(target=count)
        thread.start()
        before = time.thread_time()
        work()
        held = time.thread_time() - before  # by the calling thread itself, which only waits where the work is not its own
        done.set()
        thread.join()
        return turns[0], held

    def register(self, cloud):
        with self.assertRaises(sparsha.InputError):  # once the clouds' files are written: a wave may slide
            sparsha.register([cloud, cloud], voxel_mm=20)

    def test_they_go_on(self):
        warnings.simplefilter("ignore", sparsha.Warning)
        points = np.tile(wave_points(500, 500, 0.0002), (8, 1))
        cloud, path = sparsha.Cloud(points), np.tile([0.001, 0.001, 0.1], (10**6, 1))
        heights = np.zeros((2500, 2500), np.float32)
        renderer = sparsha.Renderer.of_heights(np.zeros((9, 9)), 0.001)
        for name, work in (("Cloud", lambda: sparsha.Cloud(points)), ("of_heights", lambda: sparsha.Renderer.of_heights(heights, 0.001)),
                           ("trace", lambda: renderer.trace(path)),
                           ("register", lambda: self.register(cloud))):
            whole = time.process_time()
            turns, held = self.turns_during(work)
            whole = time.process_time() - whole
            self.assertGreater(turns, 1, name)
            self.assertLess(held, 0.35 * whole, name)


if __name__ == "__main__":
    unittest.main()
