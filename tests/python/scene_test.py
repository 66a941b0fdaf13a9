"""Clouds, builds and scenes of the Python module: judged by known surfaces and by the program `sparsha` on the same scans."""
import gc
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

import numpy as np

import sparsha
from surfaces import WAVE, nodes, wave, wave_points

PROGRAM = os.environ.get("SPARSHA_PROGRAM")
NIGHTLY = os.environ.get("SPARSHA_NIGHTLY") == "1"


def resident_bytes():
    return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def write_ply(path, points, colours=None):
    """Binary PLY of doubles, written here and not by the module."""
    kinds = [("x", "<f8"), ("y", "<f8"), ("z", "<f8")]
    names = ["property double x", "property double y", "property double z"]
    if colours is not None:
        kinds += [("red", "u1"), ("green", "u1"), ("blue", "u1")]
        names += ["property uchar red", "property uchar green", "property uchar blue"]
    rows = np.zeros(len(points), kinds)
    for axis, name in enumerate("xyz"):
        rows[name] = points[:, axis]
    if colours is not None:
        for channel, name in enumerate(("red", "green", "blue")):
            rows[name] = colours[:, channel]
    header = "\n".join(["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}", *names, "end_header\n"])
    pathlib.Path(path).write_bytes(header.encode() + rows.tobytes())


class WithFolder(unittest.TestCase):
    def setUp(self):
        warnings.simplefilter("ignore", sparsha.Warning)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)


class Reading(WithFolder):
    def test_points_and_colours_are_those_of_the_file(self):
        points = wave_points() + [1000.25, -2000.5, 30.0]
        colours = np.random.default_rng(2).integers(0, 256, (len(points), 3))
        write_ply(self.folder / "a.ply", points, colours)
        cloud = sparsha.read(self.folder / "a.ply")
        self.assertEqual(len(cloud), len(points))
        np.testing.assert_allclose(cloud.points + cloud.origin, points, atol=1e-8)
        np.testing.assert_array_equal(cloud.colour[:, :3], colours)
        self.assertIsNone(cloud.intensity)
        self.assertEqual(cloud.points.dtype, np.float32)

    def test_arrays_are_views_that_keep_the_cloud_alive_and_cannot_be_written(self):
        cloud = sparsha.Cloud(wave_points())
        points = cloud.points
        self.assertTrue(np.shares_memory(points, cloud.points))
        self.assertFalse(points.flags.owndata)
        with self.assertRaises(ValueError):
            points[0, 0] = 1.0
        expected = points.copy()
        del cloud
        gc.collect()
        np.ones(len(expected) * 4, np.float32)  # might take the place of what was freed
        np.testing.assert_array_equal(points, expected)

    def test_units_scale_and_several_scans_are_one_cloud(self):
        points = wave_points()
        write_ply(self.folder / "a.ply", 1000 * points[:9000])
        write_ply(self.folder / "b.ply", 1000 * points[9000:])
        cloud = sparsha.read([self.folder / "a.ply", str(self.folder / "b.ply")], units="mm")
        np.testing.assert_allclose(cloud.points + cloud.origin, points, atol=1e-7)

    def test_errors_have_their_place(self):
        with self.assertRaises(sparsha.InputError) as missing:
            sparsha.read(self.folder / "none.ply")
        self.assertEqual(missing.exception.file, str(self.folder / "none.ply"))
        (self.folder / "bad.xyz").write_text("0 0 0\n1 0 0\n1 zwei 0\n")
        with self.assertRaises(sparsha.InputError) as bad:
            sparsha.read(self.folder / "bad.xyz")
        self.assertEqual((bad.exception.file, bad.exception.line), (str(self.folder / "bad.xyz"), 3))
        (self.folder / "c.yaml").write_text("scans: [{file: a.ply}]\ngrid:\n  sizes: 40\n")
        with self.assertRaises(sparsha.UsageError) as key:
            sparsha.build(self.folder / "c.yaml")
        self.assertEqual((key.exception.line, key.exception.column), (3, 3))
        self.assertIn("size", str(key.exception))
        with self.assertRaises(sparsha.UsageError) as keyword:
            sparsha.build(sparsha.Cloud(wave_points(20, 20)), config={}, grid={"siz": 3})
        self.assertEqual(keyword.exception.file, "grid.siz")
        self.assertNotIn("--", str(keyword.exception))
        for wrong in (3, None, [1], object()):
            with self.assertRaises(TypeError):
                sparsha.read(wrong)

    def test_filters_leave_the_cloud_that_they_are_given(self):
        points = np.vstack([wave_points(), [[0.05, 0.05, 1.0]]])
        cloud = sparsha.Cloud(points)
        left, steps = cloud.filtered([{"crop": {"min_m": [-1, -1, -1], "max_m": [1, 1, 0.5]}}])
        self.assertEqual((len(cloud), len(left)), (len(points), len(points) - 1))
        self.assertEqual(steps[0]["removed"], 1)
        with self.assertRaises(sparsha.UsageError):
            cloud.filtered([{"corp": {}}])


class HostileArrays(unittest.TestCase):
    def refused(self, kind, match, **arrays):
        arrays.setdefault("points", wave_points())
        with self.assertRaisesRegex(kind, match):
            sparsha.Cloud(**arrays)

    def test_what_is_no_array_of_points_is_refused_with_what_was_expected(self):
        good = wave_points()
        bad = good.copy()
        bad[17, 2] = np.nan
        self.refused(sparsha.UsageError, "row 17 of points is not finite", points=bad)
        bad[17, 2] = np.inf
        self.refused(sparsha.UsageError, "row 17", points=bad.T.copy().T)
        self.refused(sparsha.UsageError, r"shape \(3,\)", points=[1.0, 2.0, 3.0])
        self.refused(sparsha.UsageError, r"expected|\(rows, 3\)", points=good[:, :2])
        self.refused(sparsha.UsageError, "shape", points=good[None])
        self.refused(sparsha.UsageError, "no rows", points=np.empty((0, 3)))
        self.refused(sparsha.UsageError, "shape", points=[])
        self.refused(TypeError, "complex", points=good.astype(complex))
        self.refused(TypeError, "real numbers", points=good.astype(str))
        self.refused(TypeError, "real numbers", points=good.astype(object))
        self.refused(TypeError, "bool", points=good > 0)
        self.refused(TypeError, "None", points=None)
        self.refused(TypeError, "", points=[[1, 2, 3], [4, 5]])

    def test_rows_that_are_claimed_and_not_there_are_refused_at_once(self):
        began = resident_bytes()
        self.refused(sparsha.UsageError, "1000000000 rows, which are one row repeated",
                     points=np.broadcast_to(np.zeros(3), (10**9, 3)))
        strided = np.lib.stride_tricks.as_strided(np.zeros(10), (10**12, 3), (8, 8), writeable=False)
        self.refused(sparsha.UsageError, "less than this machine's memory", points=strided)
        self.assertLess(resident_bytes() - began, 50e6)

    def test_any_layout_of_the_same_numbers_is_the_same_cloud(self):
        good = wave_points().astype(np.float32)
        plain = sparsha.Cloud(good)
        frozen = good.copy()
        frozen.flags.writeable = False
        wide = np.zeros((len(good), 7), np.float32)
        wide[:, 1:6:2] = good
        for other in (np.asfortranarray(good), good.astype(">f4"), good.astype(np.float64), frozen, wide[:, 1:6:2],
                      good[::-1][::-1], good.tolist(), good.astype(">f8").T.copy().T):
            np.testing.assert_array_equal(sparsha.Cloud(other).points, plain.points)
        np.testing.assert_array_equal(sparsha.Cloud(good[::-1]).points, plain.points[::-1])
        whole = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 2]])
        for kind in (np.int8, ">i4", np.uint16, np.int64, np.float16):
            cloud = sparsha.Cloud(whole.astype(kind))
            np.testing.assert_array_equal(cloud.points + cloud.origin, whole)

    def test_what_no_configuration_can_hold_is_refused(self):
        cloud = sparsha.Cloud(wave_points(20, 20))
        strided = np.lib.stride_tricks.as_strided(np.zeros(3), (1 << 40, 3), (0, 8))
        for wrong in (strided, np.zeros(2, np.longdouble), object(), {1, 2}, np.zeros(2, complex)):
            with self.assertRaisesRegex(TypeError, "cannot hold"):
                sparsha.build(cloud, config={}, grid=wrong)
        for wrong in (float("nan"), "x", [1], -3, True, 10**40):
            with self.assertRaises(sparsha.UsageError):
                sparsha.build(cloud, config={}, grid={"size": wrong})
        for wrong in ([], ["a.scene", "b.scene"], None, 3):
            with self.assertRaises(TypeError):
                sparsha.open(wrong)
        scene = sparsha.build(cloud, config={"grid": {"spacing_mm": np.float64(1)}})
        self.assertEqual(scene.spacing(), 0.001)

    def test_attributes_must_fit_the_points(self):
        count = len(wave_points())
        self.refused(sparsha.UsageError, "colour has 5 rows", colour=np.zeros((5, 3)))
        self.refused(sparsha.UsageError, "colour holds 256", colour=np.full((count, 3), 256))
        self.refused(sparsha.UsageError, "fractions", colour=np.full((count, 3), 1.5))
        self.refused(sparsha.UsageError, "faces holds", faces=[[0, 1, count]])
        self.refused(sparsha.UsageError, "faces holds", faces=[[0, 1, -1]])
        self.refused(TypeError, "whole numbers", faces=[[0.0, 1.0, 2.0]])
        self.refused(sparsha.UsageError, "normals", normals=np.full((count, 3), np.nan))
        self.refused(sparsha.UsageError, "intensity", intensity=np.zeros(count - 1))
        self.refused(sparsha.UsageError, "cannot be one", fields={"x": np.zeros(count)})
        self.refused(sparsha.UsageError, "cannot be one", fields={"a\nb": np.zeros(count)})
        self.refused(sparsha.UsageError, "2 numbers", origin=[1, 2])
        self.refused(sparsha.UsageError, "too far", points=np.array([[0, 0, 0], [1e300, 0, 0]]))


class Building(WithFolder):
    def test_a_cloud_gives_the_surface_it_lies_on(self):
        scene = sparsha.build(sparsha.Cloud(wave_points()), config=WAVE)
        x, y = nodes(scene)
        heights = scene.heights() + scene.origin[2]
        known = scene.mask() > 0
        self.assertGreater(known.mean(), 0.95)
        self.assertLess(np.abs(heights - wave(x, y))[known].max(), 1e-4)
        np.testing.assert_allclose(scene.texture(), scene.heights() - scene.envelope(), atol=1e-9)
        dynamic, static = scene.friction()
        self.assertEqual(dynamic.shape, scene.shape())
        self.assertTrue((static >= dynamic).all())
        np.testing.assert_array_equal(scene.scan_from_grid, np.eye(4))
        self.assertEqual(scene.report["points"]["read"], len(wave_points()))
        self.assertLess(scene.check()["check"]["cloud_to_surface"]["rms_m"], 5e-5)
        self.assertIsNone(scene.colour())
        with self.assertRaisesRegex(sparsha.UsageError, "no level 9"):
            scene.heights(9)

    @unittest.skipUnless(PROGRAM, "SPARSHA_PROGRAM names the program")
    def test_module_and_program_make_the_same_scene(self):
        points = wave_points()
        write_ply(self.folder / "wave.ply", points, np.random.default_rng(3).integers(0, 256, (len(points), 3)))
        block = {**WAVE, "grid": {"spacing_mm": 1, "colour": True}}
        config = {"scans": [{"file": str(self.folder / "wave.ply"), "units": "m"}], **block}
        (self.folder / "wave.yaml").write_text(json.dumps(config))
        subprocess.run([PROGRAM, "build", self.folder / "wave.yaml", "--out", self.folder / "by-program"], check=True,
                       capture_output=True)
        told = sparsha.open(self.folder / "by-program")
        cloud = sparsha.read(self.folder / "wave.ply")
        scenes = [sparsha.build(config), sparsha.build(self.folder / "wave.yaml", out=self.folder / "by-module"),
                  sparsha.build(cloud, config=block, threads=1)]
        self.assertEqual(told.colour().shape, (*told.shape(), 4))
        scenes.append(sparsha.open(self.folder / "by-module"))
        scenes[0].save(self.folder / "saved")
        scenes.append(sparsha.open(self.folder / "saved"))
        for scene in scenes:
            self.assertEqual(scene.levels, told.levels)
            for level in range(told.levels):
                np.testing.assert_array_equal(scene.heights(level), told.heights(level))
                np.testing.assert_array_equal(scene.mask(level), told.mask(level))
                np.testing.assert_array_equal(scene.colour(level), told.colour(level))
                np.testing.assert_array_equal(scene.friction(level), told.friction(level))
        guessed = sparsha.build([self.folder / "wave.ply"], grid={"size": 60})
        self.assertEqual(max(guessed.shape()), 60)

    def test_a_scene_in_memory_gives_views(self):
        scene = sparsha.build(sparsha.Cloud(wave_points()), config=WAVE)
        heights = scene.heights()
        self.assertTrue(np.shares_memory(heights, scene.heights()))
        kept = heights.copy()
        del scene
        gc.collect()
        np.testing.assert_array_equal(heights, kept)

    def test_progress_is_told_and_may_stop_the_work(self):
        told = []
        sparsha.build(sparsha.Cloud(wave_points()), config=WAVE, progress=lambda stage, share: told.append((stage, share)))
        self.assertIn("pyramid", {stage for stage, _ in told})
        self.assertTrue(all(0 <= share <= 1 for _, share in told))

        def stop(stage, share):
            raise LookupError(stage)
        with self.assertRaises(LookupError):
            sparsha.build(sparsha.Cloud(wave_points()), config=WAVE, progress=stop)
        with self.assertRaises(TypeError):
            sparsha.build(sparsha.Cloud(wave_points()), config=WAVE, progress=3)

    def test_ctrl_c_ends_a_build_and_other_threads_go_on_meanwhile(self):
        big = sparsha.Cloud(wave_points(1500, 1000, 0.0002))
        counted = [0]
        ended = threading.Event()

        def count():
            while not ended.is_set():
                counted[0] += 1
                time.sleep(0.001)
        thread = threading.Thread(target=count)
        thread.start()
        began = []

        def interrupt(stage, share):
            if not began:
                began.append(time.monotonic())
                os.kill(os.getpid(), signal.SIGINT)
        try:
            with self.assertRaises(KeyboardInterrupt):
                sparsha.build(big, config={"grid": {"spacing_mm": 0.1}}, progress=interrupt)
        finally:
            ended.set()
            thread.join()
        self.assertGreater(counted[0], 1)

    def test_threads_build_scenes_side_by_side(self):
        clouds = [sparsha.Cloud(wave_points(seed=seed)) for seed in range(4)]
        alone = [sparsha.build(cloud, config=WAVE).heights() for cloud in clouds]
        together = [None] * len(clouds)

        def build(index):
            together[index] = sparsha.build(clouds[index], config=WAVE, threads=2).heights()
        threads = [threading.Thread(target=build, args=(index,)) for index in range(len(clouds))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for one, other in zip(alone, together):
            np.testing.assert_array_equal(one, other)

    def test_nothing_is_lost_in_many_rounds(self):
        points = wave_points(20, 20)
        scene = sparsha.build(sparsha.Cloud(wave_points()), config=WAVE)

        def rounds(count):
            for _ in range(count):
                cloud = sparsha.Cloud(points, colour=np.zeros((len(points), 3)), fields={"a": points[:, 0]})
                cloud.points, cloud.colour, cloud.fields, scene.heights(), scene.texture(), scene.friction()
                try:
                    sparsha.Cloud(points[:, :2])
                except sparsha.UsageError:
                    pass
        rounds(300)
        before = resident_bytes()
        rounds(100000 if NIGHTLY else 3000)
        gc.collect()
        self.assertLess(resident_bytes() - before, 8e6)


if __name__ == "__main__":
    unittest.main()
