"""Names of files and folders: of any bytes, relative, and of what is replaced meanwhile."""
import os
import pathlib
import tempfile
import unittest
import warnings
from unittest import mock

import numpy as np

import sparsha
from surfaces import wave_points

GRID = {"grid": {"spacing_mm": 1}}
LATIN = b"latin\xe4"  # no UTF-8


class InFolder(unittest.TestCase):
    def setUp(self):
        warnings.simplefilter("ignore", sparsha.Warning)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        self.cloud = sparsha.Cloud(wave_points(30, 30))


class AnyBytes(InFolder):
    def names(self, ending):
        """The same name as bytes, as text and as a Path."""
        name = LATIN + ending
        return name, os.fsdecode(name), pathlib.Path(os.fsdecode(name))

    def test_files_and_folders_whose_names_are_no_utf_8(self):
        np.savetxt(os.fsdecode(LATIN + b".xyz"), self.cloud.points, fmt="%.6f")
        expected = sparsha.build(os.fsdecode(LATIN + b".xyz"), config=GRID).heights()
        guessed = sparsha.build(os.fsdecode(LATIN + b".xyz"), **GRID).heights()
        for name in self.names(b".xyz"):
            self.assertEqual(len(sparsha.read(name)), 900)
            self.assertEqual(len(sparsha.read([{"file": name}])), 900)
            for source in (name, [name]):
                np.testing.assert_array_equal(sparsha.build(source, **GRID).heights(), guessed)
            np.testing.assert_array_equal(sparsha.build({"scans": [{"file": name}], **GRID}).heights(), expected)
        trace = sparsha.Renderer.of_heights(np.zeros((3, 3)), 1.0).trace(np.zeros((2, 3)))
        for name in self.names(b".scene"):
            sparsha.build(self.names(b".xyz")[0], config=GRID, out=name)
            scene = sparsha.open(name)
            self.assertEqual(os.path.basename(os.fsencode(scene.folder)), LATIN + b".scene")
            self.assertIn("!!binary", scene.config)
            np.testing.assert_array_equal(scene.heights(), expected)
            self.assertIn("check", scene.check())
            self.assertIn("check", scene.check(self.names(b".xyz")))
            scene.save(name + b"2" if isinstance(name, bytes) else f"{name}2")
            sparsha.export(scene, self.names(b".ply")[0])
        for name in self.names(b".csv"):
            trace.save(name)
        self.assertEqual({p for p in os.listdir(b".") if p.startswith(LATIN)},
                         {LATIN + e for e in (b".xyz", b".scene", b".scene2", b".ply", b".csv")})

    def test_errors_and_progress_name_such_files(self):
        name = os.fsdecode(LATIN + b".xyz")
        with self.assertRaises(sparsha.InputError) as raised:
            sparsha.read(name)
        self.assertEqual(raised.exception.file, name)
        self.assertIn(name, str(raised.exception))
        os.mkdir(LATIN)
        folder = mock.patch.dict(os.environ, TMPDIR=os.path.abspath(os.fsdecode(LATIN)))
        folder.start()
        self.addCleanup(folder.stop)
        for config in (None, GRID):
            self.assertGreater(sparsha.build(self.cloud, config=config).levels, 0)
        with self.assertRaises(sparsha.InputError) as raised:  # a wave may slide
            sparsha.register([self.cloud, self.cloud], voxel_mm=3)
        self.assertTrue(raised.exception.file.startswith(os.environ["TMPDIR"]))

    def test_a_nul_is_refused_and_nothing_is_written(self):
        scene = sparsha.build(self.cloud, config=GRID)
        trace = sparsha.Renderer.of_heights(np.zeros((3, 3)), 1.0).trace(np.zeros((2, 3)))
        np.savetxt("good.xyz", self.cloud.points)
        for work in (lambda: trace.save("x\0y.csv"), lambda: scene.save("sc\0ene"), lambda: sparsha.export(scene, b"q.ply\0.obj"),
                     lambda: sparsha.simulate({}, "a\0b"), lambda: sparsha.read("good.xyz\0.pcd"), lambda: sparsha.open("a\0"),
                     lambda: sparsha.read({"file": "good.xyz\0.pcd"}), lambda: sparsha.build("good.xyz\0"),
                     lambda: sparsha.build(self.cloud, config=GRID, out="b\0"), lambda: sparsha.bench_export("c\0")):
            with self.assertRaisesRegex(ValueError, "NUL"):
                work()
        self.assertEqual(os.listdir(), ["good.xyz"])


class Places(InFolder):
    def test_a_scene_of_a_cloud_is_the_same_bytes_wherever_the_process_works(self):
        scene = sparsha.build(self.cloud, config=GRID)
        os.makedirs("x/y")
        texts = []
        for work, name in ((".", "a"), ("x/y", "b"), ("/", "c"), (".", "d")):
            os.chdir(self.folder / work)
            folder = self.folder / f"{name}.scene"
            if name == "d":
                sparsha.build(self.cloud, config=GRID, out=folder)
            else:
                scene.save(os.path.relpath(folder))
            texts.append((folder / "scene.yaml").read_text())
        self.assertEqual(len(set(texts)), 1)
        self.assertIn('file: "cloud.ply"', texts[0].replace("file: cloud.ply", 'file: "cloud.ply"'))

    def test_no_file_of_somebody_else_is_taken_for_the_cloud(self):
        sparsha.build(self.cloud, config=GRID, out="a.scene")
        (self.folder / "cloud.ply").write_text("of somebody else")
        for trust in (False, True):
            with self.assertRaisesRegex(sparsha.InputError, "a.scene/cloud.ply"):
                sparsha.open("a.scene").check(trust=trust)
        self.assertIn("check", sparsha.open("a.scene").check(self.cloud))

    def test_an_opened_scene_of_a_cloud_is_saved_over_itself(self):
        sparsha.build(self.cloud, config=GRID, out="a.scene")
        before = (self.folder / "a.scene/scene.yaml").read_text()
        scene = sparsha.open("a.scene")
        heights = scene.heights()
        scene.save("a.scene")
        self.assertEqual((self.folder / "a.scene/scene.yaml").read_text(), before)
        np.testing.assert_array_equal(sparsha.open("a.scene").heights(), heights)

    def test_an_opened_scene_goes_on_where_the_process_works_elsewhere(self):
        expected = sparsha.build(self.cloud, config=GRID, out="a.scene").heights()
        scene = sparsha.open("a.scene")
        os.chdir("/")
        self.assertEqual(scene.folder, str(self.folder / "a.scene"))
        np.testing.assert_array_equal(scene.heights(), expected)
        self.assertIsNotNone(scene.report)
        self.assertEqual(len(sparsha.Renderer(scene).trace(np.zeros((2, 3)))), 2)
        scene.save(self.folder / "b.scene")
        self.assertTrue((self.folder / "b.scene/scene.yaml").exists())

    def test_a_scene_that_is_replaced_while_it_is_open_is_an_error(self):
        scene = sparsha.build(self.cloud, config=GRID)
        scene.save("a.scene")
        first = sparsha.open("a.scene")
        first.heights()
        moved = sparsha.build(sparsha.Cloud(wave_points(30, 30) + [0, 0, 5]), config=GRID)
        moved.save("a.scene")
        self.assertEqual(moved.shape(), scene.shape())
        for work in (first.heights, first.mask, lambda: sparsha.Renderer(first), lambda: sparsha.export(first, "a.ply")):
            with self.assertRaisesRegex(sparsha.InputError, "another scene has taken the place"):
                work()
        np.testing.assert_array_equal(sparsha.open("a.scene").heights(), moved.heights())

    def test_a_missing_folder_for_temporary_files_is_a_failure(self):
        folder = mock.patch.dict(os.environ, TMPDIR=str(self.folder / "missing"))
        folder.start()
        self.addCleanup(folder.stop)
        for work in (lambda: sparsha.build(self.cloud, config=GRID), lambda: sparsha.register([self.cloud, self.cloud])):
            with self.assertRaises(sparsha.Failure) as raised:
                work()
            self.assertIn("missing", raised.exception.file)


if __name__ == "__main__":
    unittest.main()
