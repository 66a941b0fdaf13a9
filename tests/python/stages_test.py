"""Registration, simulation, export and the second opinion on forces, from Python."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import warnings

import numpy as np

import sparsha
from sparsha import opinion
from surfaces import nodes


class Stages(unittest.TestCase):
    def setUp(self):
        warnings.simplefilter("ignore", sparsha.Warning)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_registration_finds_the_pose_that_a_cloud_was_moved_by(self):
        rng = np.random.default_rng(5)
        x, y = rng.uniform(0, 0.2, (2, 30000))
        z = 0.02 * np.sin(40 * x) * np.cos(31 * y) + 0.015 * np.sin(23 * x + 50 * y)
        points = np.stack([x, y, z], -1)
        angle = 0.02
        turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
        shift = np.array([0.003, -0.002, 0.001])
        moved = (points[points[:, 0] > 0.05] - shift) @ turn  # the pose takes it back: turn * p + shift
        found = sparsha.register([sparsha.Cloud(points[points[:, 0] < 0.15]), sparsha.Cloud(moved)])
        np.testing.assert_array_equal(found["poses"][0], np.eye(4))
        np.testing.assert_allclose(found["poses"][1][:3, :3], turn, atol=2e-3)
        np.testing.assert_allclose(found["poses"][1][:3, 3], shift, atol=2e-4)
        self.assertEqual(found["pairs"][0]["use"], "used")
        with self.assertRaises(sparsha.UsageError):
            sparsha.register([sparsha.Cloud(points)])
        with self.assertRaises(sparsha.UsageError):
            sparsha.register([sparsha.Cloud(points), sparsha.Cloud(moved)], metod="icp")

    def test_no_output_takes_the_place_of_a_scan(self):
        simulation = {"nodes": 32, "sampler": {}, "surface": {"form": "plane", "size_m": [0.2, 0.2]}}
        sparsha.simulate(simulation, self.folder / "sim")
        scan = self.folder / "sim/scan.ply"
        points = scan.read_bytes()
        scene = sparsha.build(scan, grid={"size": 32}, out=self.folder / "scene")
        os.link(scan, self.folder / "hard.csv")
        trace = sparsha.Renderer(scene).trace(np.array([[0.1, 0.1, -0.001]]))
        for opened in (scene, sparsha.open(self.folder / "scene")):
            for output in (lambda: sparsha.export(opened, scan),
                           lambda: sparsha.export(opened, self.folder / "scene/level-0/height.tif"),
                           lambda: trace.save(scan), lambda: trace.save(self.folder / "hard.csv")):
                with self.assertRaises(sparsha.UsageError):
                    output()
        other = self.folder / "mine"
        other.mkdir()
        (other / "scan.ply").write_text("mine")
        with self.assertRaises(sparsha.UsageError):
            sparsha.simulate(simulation, other)
        self.assertEqual((other / "scan.ply").read_text(), "mine")
        self.assertEqual(scan.read_bytes(), points)

    def test_a_simulated_scan_is_built_and_exported_where_its_truth_is(self):
        sparsha.simulate({"seed": 3, "nodes": 96, "noise_mm": 0, "sampler": {},
                          "surface": {"form": "sinusoid", "size_m": [0.2, 0.15], "amplitude_mm": 5, "wavelength_mm": 100}}, self.folder / "sim")
        scene = sparsha.build(self.folder / "sim/sparsha.yaml")
        sparsha.export(scene, self.folder / "mesh.ply")
        read = sparsha.read(self.folder / "mesh.ply")
        self.assertEqual(len(read), int((scene.mask() > 0).sum()))
        self.assertGreater(len(read.faces), len(read))
        x, y = nodes(scene)
        known = scene.mask() > 0
        grid = np.stack([x, y, scene.heights() + scene.origin[2], np.ones_like(x)], -1)[known]
        expected = (scene.scan_from_grid @ grid.T).T[:, :3]
        got = read.points + read.origin
        truth = 0.005 * np.sin(20 * np.pi * got[:, 0]) * np.sin(20 * np.pi * got[:, 1])
        self.assertLess(np.median(np.abs(got[:, 2] - truth)), 2e-4)
        np.testing.assert_allclose(np.sort(got, axis=0), np.sort(expected, axis=0), atol=1e-5)
        told = sparsha.export(scene, self.folder / "print.stl", size_mm=50)
        self.assertGreater(told["triangles"], 1000)
        for wrong in ("mesh.doc", "mesh"):
            with self.assertRaises(sparsha.UsageError):
                sparsha.export(scene, self.folder / wrong)
        with self.assertRaises(sparsha.UsageError):
            sparsha.export(scene, self.folder / "mesh.ply", holes="fill")
        with self.assertRaises(sparsha.UsageError):
            sparsha.simulate({"sed": 3}, self.folder / "none")

    def test_a_device_is_listened_to(self):
        heard = sparsha.monitor("simulated", 0.1)
        self.assertEqual(heard["position"].shape, (len(heard["time"]), 3))
        self.assertGreater(len(heard["time"]), 3)
        self.assertTrue((np.diff(heard["time"]) > 0).all())
        self.assertTrue(np.isfinite(heard["position"]).all())
        self.assertEqual(heard["homed"].dtype, bool)
        with self.assertRaisesRegex(sparsha.UsageError, "simulated"):
            sparsha.monitor("simulatd", 0.1)
        for seconds in (0, -1, float("nan"), 1e9):
            with self.assertRaises(sparsha.UsageError):
                sparsha.monitor("simulated", seconds)
        with self.assertRaises(sparsha.DeviceError):
            sparsha.monitor("gamepad", 0.1)

    def test_the_second_opinion_finds_the_nearest_point_of_a_sphere_and_a_plane(self):
        x, y = np.meshgrid(np.linspace(-0.5, 0.5, 101), np.linspace(-0.5, 0.5, 101))
        sphere = opinion.Spline(np.stack([x, y, np.sqrt(4 - x**2 - y**2)], -1).reshape(-1, 3))
        directions = np.array([[0, 0, 1], [0.1, 0.05, 1], [-0.15, 0.1, 1]])
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        np.testing.assert_allclose(opinion.forces(sphere, 1.99 * directions, 500), 5 * directions, atol=1e-4)
        np.testing.assert_array_equal(opinion.forces(sphere, 2.01 * directions, 500), 0)

    def test_the_module_judges_forces_and_numpy_passes_its_benchmark(self):
        sparsha.bench_export(self.folder / "bench")
        out = self.folder / "numpy.csv"
        subprocess.run([sys.executable, "-m", "sparsha", str(self.folder / "bench"), "--out", str(out)], check=True)
        verdict = sparsha.bench_judge(self.folder / "bench", out)
        self.assertEqual(len(verdict), 8)
        for case in verdict:
            self.assertTrue(case["pass"], case)
            self.assertLess(case["error_p99"], 0.005, case)
        rows = out.read_text().split("\n")
        rows[5] = rows[5].replace(",", ",x", 1)
        out.write_text("\n".join(rows))
        with self.assertRaises(sparsha.InputError) as wrong:
            sparsha.bench_judge(self.folder / "bench", out)
        self.assertEqual((wrong.exception.file, wrong.exception.line), (str(out), 6))
        told = subprocess.run([sys.executable, "-m", "sparsha", str(self.folder / "none")], capture_output=True, text=True)
        self.assertEqual(told.returncode, 3)
        self.assertNotIn("Traceback", told.stderr)


if __name__ == "__main__":
    unittest.main()
