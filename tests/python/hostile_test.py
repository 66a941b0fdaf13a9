"""What no caller should do: it is refused with what was expected, and never ends the interpreter."""
import collections
import contextlib
import importlib.util
import io
import os
import pathlib
import subprocess
import sys
import tempfile
import textwrap
import unittest
import warnings

import numpy as np

import sparsha
from surfaces import wave_points

SETUP = """
import os, sys, threading, time, warnings
import numpy as np
import sparsha
from surfaces import wave_points
warnings.simplefilter("ignore", sparsha.Warning)
"""


def in_child(code, **options):
    """Runs Python code in an interpreter of its own, which may crash."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([os.path.dirname(os.path.abspath(__file__)), *sys.path])}
    with tempfile.TemporaryDirectory() as folder:
        return subprocess.run([sys.executable, "-c", SETUP + textwrap.dedent(code)], env=environment, capture_output=True,
                              text=True, timeout=120, **{"cwd": folder, **options})


class Hostile(unittest.TestCase):
    def setUp(self):
        warnings.simplefilter("ignore", sparsha.Warning)

    def assert_says(self, code, expected):
        done = in_child(code)
        self.assertEqual((done.returncode, done.stdout.strip()), (0, expected), done.stderr[-2000:])


class Threads(Hostile):
    def test_more_threads_than_the_program_allows_are_refused(self):
        self.assert_says("""
            cloud = sparsha.Cloud(wave_points(30, 30))
            grid = {"grid": {"spacing_mm": 1}}
            scene = sparsha.build(cloud, config=grid)
            refused = 0
            for threads in (1025, 100000, 4294967295, 2**32, 2**70, -1):
                for work in (lambda: cloud.filtered([{"voxel": {"leaf_mm": 1}}], threads=threads), lambda: scene.check(threads=threads),
                             lambda: sparsha.build(cloud, config=grid, threads=threads), lambda: sparsha.register([cloud, cloud], threads=threads)):
                    try:
                        work()
                    except sparsha.UsageError as error:
                        assert str(error) == f"threads is {threads}; 0 to 1024, where 0 is one a core", error
                        refused += 1
            print(refused)
            """, "24")

    def test_threads_are_whole_numbers(self):
        cloud = sparsha.Cloud(wave_points(30, 30))
        for wrong in (2.0, "2", None, np.float64(1)):
            with self.assertRaisesRegex(TypeError, "^threads is .*expected a whole number"):
                cloud.filtered([], threads=wrong)
        for threads in (0, 1, 3, np.int64(2), np.uint8(2)):
            self.assertEqual(len(cloud.filtered([], threads=threads)[0]), len(cloud))


class NeverMade(Hostile):
    def test_objects_without_a_value_are_refused(self):
        self.assert_says("""
            cloud = sparsha.Cloud(wave_points(30, 30))
            scene = sparsha.build(cloud, config={"grid": {"spacing_mm": 1}})
            renderer = sparsha.Renderer(scene)
            trace = renderer.trace(np.zeros((2, 3)))
            refused = []
            def refuse(work):
                try:
                    work()
                except TypeError as error:
                    assert "never made" in str(error), error
                    refused.append(error)
            for made in (cloud, scene, renderer, trace):
                kind = type(made)
                for empty in (kind.__new__(kind),):
                    names = [n for n in dir(kind) if n == "__len__" or n[0] != "_" and n != "of_heights"]
                    for _ in range(2):
                        for name in names:
                            def work():
                                member = getattr(empty, name)
                                if callable(member):
                                    member(*{"save": ["x"], "trace": [np.zeros((2, 3))], "filtered": [[]], "step": [(0.0, 0.0, 0.0)]}.get(name, []))
                            before = len(refused)
                            refuse(work)
                            assert len(refused) == before + 1, (kind, name)
            no_cloud, no_scene = sparsha.Cloud.__new__(sparsha.Cloud), sparsha.Scene.__new__(sparsha.Scene)
            del refused[:]
            for work in (lambda: sparsha.build(no_cloud), lambda: sparsha.register([no_cloud, no_cloud]), lambda: scene.check(no_cloud),
                         lambda: sparsha.Renderer(no_scene), lambda: sparsha.export(no_scene, "x.ply"), lambda: repr(no_scene), lambda: repr(no_cloud)):
                refuse(work)
            print(len(refused))
            """, "7")

    def test_a_class_of_ones_own_may_make_them(self):
        class Named(sparsha.Cloud):
            def __new__(cls, points, name):
                made = super().__new__(cls)
                made.name = name
                return made

            def __init__(self, points, name):
                super().__init__(points)
        self.assertEqual((len(Named(wave_points(30, 30), "a")), Named(wave_points(30, 30), "a").name), (900, "a"))


class Arguments(Hostile):
    def test_a_view_of_itself_is_refused(self):
        class Looped:
            def __init__(self, array):
                self.array, self.base = array, self
                self.__array_interface__ = array.__array_interface__
        looped = np.asarray(Looped(wave_points(30, 30)))
        with self.assertRaisesRegex(sparsha.UsageError, "a view of itself"):
            sparsha.Cloud(looped)

    def test_a_configuration_that_holds_itself_is_refused(self):
        cloud = sparsha.Cloud(wave_points(30, 30))
        block, items, array = {}, [], np.empty(1, object)
        block["grid"], array[0] = block, array
        items.append(items)
        for wrong in (block, {"grid": {"size": items}}, {"grid": {"size": array}}):
            for work in (lambda: sparsha.build(cloud, config=wrong), lambda: sparsha.build(cloud, config={}, **wrong)):
                with self.assertRaisesRegex(ValueError, "Circular|hold itself"):
                    work()

    def test_what_an_object_raises_itself_passes_through(self):
        class Raising:
            def __init__(self, error):
                self.error = error

            def __array__(self, *rest, **more):
                raise self.error
        points = wave_points(30, 30)
        renderer = sparsha.Renderer.of_heights(np.zeros((4, 4)), 1.0)
        doors = (sparsha.Cloud, lambda a: sparsha.Cloud(points, colour=a), lambda a: sparsha.Cloud(points, intensity=a),
                 lambda a: sparsha.Renderer.of_heights(a, 1.0), renderer.step, renderer.trace)
        for door in doors:
            for error in (KeyboardInterrupt("now"), SystemExit(3), MemoryError("9 GB")):
                with self.assertRaises(type(error)) as raised:
                    door(Raising(error))
                self.assertIs(raised.exception, error)
            with self.assertRaisesRegex(TypeError, "cannot be made an array"):
                door(Raising(LookupError("x")))

    def test_messages_name_arguments_and_no_options(self):
        scene = sparsha.build(sparsha.Cloud(wave_points(30, 30)), config={"grid": {"spacing_mm": 1}})
        with tempfile.TemporaryDirectory() as folder:
            for told, work in (("size_mm cannot be -1", lambda: sparsha.export(scene, folder + "/a.stl", size_mm=-1)),
                               ("with nodes=True", lambda: sparsha.export(scene, folder + "/a.glb", nodes=True)),
                               ("with haptics=True", lambda: sparsha.export(scene, folder + "/a.ply", haptics=True))):
                with self.assertRaisesRegex(sparsha.UsageError, told) as raised:
                    work()
                error = raised.exception
                self.assertNotRegex(f"{error} {error.wrong} {error.expected}", r"(^|\s)--[a-z]")
        as_arguments = sparsha._errors._as_arguments
        for option, argument in (("--trust, if you know", "trust=True, if you know"), ("or --holes leave", "or holes='leave'"),
                                 ("a higher --memory", "a higher memory"), ("--memory 12MB, a finer", "memory='12MB', a finer"),
                                 ("a display and no --headless, or --device simulated", "a display, or simulated"),
                                 ("as `explore --record` left it", "as `explore --record` left it"), ("--set grid.size is 1", "grid.size is 1"),
                                 ("a--b", "a--b")):
            self.assertEqual(as_arguments(option), argument)

    def test_two_fields_of_one_name_and_scans_beside_a_cloud_are_refused(self):
        points = wave_points(30, 30)
        with self.assertRaisesRegex(sparsha.UsageError, "two fields are named 'a'"):
            sparsha.Cloud(points, fields={"a": points[:, 0], "A": points[:, 1]})
        for settings in ({"config": {"scans": 3}}, {"config": {}, "scans": [{"file": "x.ply"}]}):
            with self.assertRaisesRegex(sparsha.UsageError, "scans are named besides the cloud"):
                sparsha.build(sparsha.Cloud(points), **settings)

    def test_any_sequence_is_one(self):
        grid = {"spacing_mm": 1}
        with tempfile.TemporaryDirectory() as folder:
            names = [f"{folder}/{n}.xyz" for n in range(2)]
            points = wave_points(30, 30)
            for name, part in zip(names, (points, points + [0.02, 0, 0])):
                np.savetxt(name, part, fmt="%.6f")
            for sequence in (list, tuple, collections.UserList, collections.deque):
                self.assertEqual(len(sparsha.read(sequence(names))), 1800)
                self.assertEqual(len(sparsha.read(sequence([{"file": names[0]}]), fields=sequence([]))), 900)
                scene = sparsha.build(sequence(names), grid=grid)
                self.assertIn("check", scene.check(sequence(names)))
                with self.assertRaisesRegex(sparsha.InputError, "aligning this scan"):  # they are read, and lie too far apart
                    sparsha.register(sequence(names), voxel_mm=2)
            for wrong in ({1, 2}, 3, {"a": 1}.keys()):
                for work in (sparsha.read, sparsha.build, scene.check, sparsha.register):
                    with self.assertRaises(TypeError):
                        work(wrong)


class Opinion(Hostile):
    def test_broken_benchmarks_are_told_in_a_sentence(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name) / "bench"
            sparsha.bench_export(folder)
            ply, path, cases = folder / "surfaces/sinusoid.ply", folder / "paths/sinusoid.csv", folder / "cases.csv"
            begin = b"ply\nformat binary_little_endian 1.0\n"
            vertex = b"element vertex 1\nproperty double x\nproperty double y\n"
            for file, data in ((ply, begin + b"end_header\n"), (ply, begin + vertex + b"property short z\nend_header\n" + bytes(18)),
                               (ply, begin + vertex + b"property double q\nend_header\n" + bytes(24)),
                               (ply, begin + vertex + b"property double z\nend_header\n" + bytes(24)),
                               (ply, begin + vertex + b"property list uchar int x\nproperty double z\nend_header\n"), (ply, b""),
                               (cases, b"a,b\n1,2\n"), (cases, b""), (cases, cases.read_bytes().split(b"\n")[0] + b"\n"),
                               (path, b"t_s,x_m,y_m,z_m\n"), (path, b""), (path, b"t_s,x_m\n0,1\n")):
                whole = file.read_bytes()
                file.write_bytes(data)
                done = in_child(f"from sparsha.__main__ import run; sys.argv[1:] = [{str(folder)!r}, '--out', {name + '/r.csv'!r}]; sys.exit(run())")
                file.write_bytes(whole)
                self.assertEqual((done.returncode, done.stderr.count("\n")), (3, 1), f"{data[:90]} {done.stderr[-500:]}")


class Figures(unittest.TestCase):
    def test_only_figures_beyond_three_times_what_is_asked_fail(self):
        file = pathlib.Path(os.environ["SPARSHA_SOURCE_DIR"]) / "tools/python-figures.py"
        spec = importlib.util.spec_from_file_location("python_figures", file)
        figures = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(figures)
        for name, asked in figures.ASKED.items():
            for times, good in ((0.5, True), (2.9, True), (3.1, False)):
                told = io.StringIO()
                with contextlib.redirect_stdout(told):
                    self.assertEqual(figures.judge([(name, times * asked)]), good)
                self.assertIn(name, told.getvalue())


class TheEnd(Hostile):
    def test_daemon_threads_at_work_do_not_abort_the_process(self):
        for work in ("sparsha.build(cloud, config=grid)", "renderer.trace(path)", "cloud.filtered([{'outliers': {'sigma': 2}}])",
                     "renderer.trace(path, progress=lambda stage, share: sum(range(100)))", "sparsha.open(folder).heights()"):
            for delay in (0.0, 0.02, 0.1):
                with tempfile.TemporaryDirectory() as folder:
                    done = in_child(f"""
                        folder = {folder!r} + "/a.scene"
                        cloud, grid = sparsha.Cloud(wave_points(300, 300, 0.0003)), {{"grid": {{"spacing_mm": 0.2}}}}
                        scene = sparsha.build(cloud, config=grid)
                        scene.save(folder)
                        path = np.tile([0.04, 0.04, 0.0], (200000, 1))
                        renderer = sparsha.Renderer(scene)
                        began = threading.Event()
                        def forever():
                            while True:
                                began.set()
                                {work}
                        for _ in range(2):
                            threading.Thread(target=forever, daemon=True).start()
                        began.wait()
                        time.sleep({delay})
                        """)
                self.assertEqual((done.returncode, done.stderr), (0, ""), work)

    def test_a_child_that_was_forked_amid_work_ends(self):
        self.assert_says("""
            warnings.simplefilter("ignore")
            cloud = sparsha.Cloud(wave_points(300, 300, 0.0003))
            thread = threading.Thread(target=lambda: sparsha.build(cloud, config={"grid": {"spacing_mm": 0.1}}))
            thread.start()
            time.sleep(0.05)
            child = os.fork()
            if child == 0:
                sys.exit(7)
            print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
            thread.join()
            """, "7")


if __name__ == "__main__":
    unittest.main()
