"""Hands in the frame of the scans, on turned and scaled views, on whole objects and on unrolled ones: judged by closed forms
and, for whole paths, by the program `sparsha trace`."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
import warnings

import numpy as np

import sparsha
from sparsha import on_scene
from surfaces import wave_points

PROGRAM = os.environ.get("SPARSHA_PROGRAM")
STIFFNESS = 500.0
# A view that is turned and twice as large, and the direction that it looks from.
VIEW = {"look_from": [1, 0.4, 0.3], "up": [0, 0, 1], "scale": 2}
TOWARDS = np.array([1, 0.4, 0.3]) / np.linalg.norm([1, 0.4, 0.3])


def homogeneous(matrix, points):
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def by_program(scene, path, *options):
    """trace.csv of `sparsha trace --frame scan` as rows of numbers."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene.save(folder / "a.scene")
        np.savetxt(folder / "path.csv", np.column_stack([np.arange(len(path)) / 1000, path]), delimiter=",", fmt="%.17g",
                   header="t_s,x_m,y_m,z_m", comments="")
        subprocess.run([PROGRAM, "trace", folder / "a.scene", "--hip", folder / "path.csv", "--frame", "scan", "--out",
                        folder / "t.csv", *options], check=True, capture_output=True)
        return np.loadtxt(folder / "t.csv", delimiter=",", skiprows=1)


def second_opinion(scene):
    """`python3 -m sparsha` on the scene: its exit code and what it prints."""
    with tempfile.TemporaryDirectory() as folder:
        scene.save(pathlib.Path(folder) / "a.scene")
        done = subprocess.run([sys.executable, "-m", "sparsha", "a.scene"], cwd=folder, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


class Moved(sparsha.Renderer):
    """A renderer whose proxies are a thousandth of a spacing (2 mm) beside their rest."""

    def step(self, hip):
        proxy, force = super().step(hip)
        return proxy + [2e-6, 0, 0], force


def columns(trace):
    return np.column_stack([trace.time, trace.hip, trace.proxy, trace.force, trace.contact])


class Turned(unittest.TestCase):
    """A plane whose normal is TOWARDS, 0.3 m before the scan frame's zero."""

    @classmethod
    def setUpClass(cls):
        warnings.simplefilter("ignore", sparsha.Warning)
        flat = wave_points()[:, :2] - [0.075, 0.06]
        right = np.cross([0, 0, 1], TOWARDS)
        right /= np.linalg.norm(right)
        up = np.cross(TOWARDS, right)
        cls.right, cls.up = right, up
        points = 0.3 * TOWARDS + flat[:, :1] * right + flat[:, 1:] * up
        cls.scene = sparsha.build(sparsha.Cloud(points), config={"orientation": VIEW, "grid": {"spacing_mm": 2}})

    def path(self, count=1500):
        t = np.arange(count) / 1000
        depth = 0.002 * np.sin(7 * t)[:, None]  # below the plane where positive
        sideways = 0.04 * np.sin(2 * t)[:, None] * self.right + 0.03 * np.sin(3 * t)[:, None] * self.up
        return 0.3 * TOWARDS + sideways - depth * TOWARDS, depth[:, 0]

    def test_the_scene_is_turned_and_scaled(self):
        turn = self.scene.scan_from_grid[:3, :3]
        np.testing.assert_allclose(turn.T @ turn, 0.25 * np.eye(3), atol=1e-12)
        np.testing.assert_allclose(2 * turn[:, 2], TOWARDS, atol=1e-12)

    def test_a_hand_of_the_scan_frame_is_held_at_the_plane_in_the_grid_frame(self):
        path, depth = self.path()
        renderer = sparsha.Renderer(self.scene, frame="scan", stiffness=STIFFNESS, friction=False)
        trace = renderer.trace(path)
        grid = homogeneous(np.linalg.inv(self.scene.scan_from_grid), path)
        np.testing.assert_allclose(trace.hip, grid, atol=1e-12)
        touched = depth > 1e-5
        self.assertTrue(trace.contact[touched].all())
        np.testing.assert_allclose(trace.proxy[touched, 2], 2 * 0.3, atol=2e-6)
        np.testing.assert_allclose(trace.force[touched, 2], STIFFNESS * 2 * depth[touched], atol=2e-3)  # 2: of the view
        np.testing.assert_allclose(trace.force[touched, :2], 0, atol=2e-3)
        self.assertTrue((trace.force[depth < -1e-5] == 0).all())
        plain = sparsha.Renderer(self.scene, stiffness=STIFFNESS, friction=False).trace(trace.hip)
        np.testing.assert_array_equal(plain.force, trace.force)
        for hip, proxy, force in zip(path[:400], trace.proxy, trace.force):
            got = renderer.step(hip)
            np.testing.assert_array_equal(got[0], proxy)
            np.testing.assert_array_equal(got[1], force)

    def test_numpy_agrees_and_sees_a_fault(self):
        code, told = second_opinion(self.scene)
        self.assertEqual((code, told.count(" pass ")), (0, 1), told)
        self.assertTrue(on_scene.judge_view(self.scene)["pass"])
        with unittest.mock.patch.object(on_scene, "Renderer", Moved):
            self.assertFalse(on_scene.judge_view(self.scene)["pass"])

    @unittest.skipUnless(PROGRAM, "SPARSHA_PROGRAM names the program")
    def test_the_program_traces_the_same(self):
        path, _ = self.path(300)
        np.testing.assert_array_equal(by_program(self.scene, path)[:, :11],
                                      columns(sparsha.Renderer(self.scene, frame="scan").trace(path)))


class Around(unittest.TestCase):
    """A sphere away from the scan frame's zero, of which the scene is a turned and twice as large one."""
    RADIUS, MIDDLE = 0.05, np.array([0.3, -0.2, 0.1])

    @classmethod
    def setUpClass(cls):
        warnings.simplefilter("ignore", sparsha.Warning)
        count = 20000
        k = np.arange(count) + 0.5
        height = 1 - 2 * k / count
        turn = np.pi * (1 + 5**0.5) * k
        across = np.sqrt(1 - height**2)
        directions = np.stack([across * np.cos(turn), across * np.sin(turn), height], -1)
        colour = np.round(128 + 100 * directions).astype(np.uint8)
        cloud = sparsha.Cloud(cls.MIDDLE + cls.RADIUS * directions, normals=directions, colour=colour)
        cls.scene = sparsha.build(cloud, config={"orientation": VIEW, "grid": {"spacing_mm": 3, "colour": True}, "around": {}})

    def test_all_sides_push_outwards_in_the_scan_frame(self):
        renderer = sparsha.Renderer(self.scene, frame="scan", stiffness=STIFFNESS, friction=False)
        for direction in np.concatenate([np.eye(3), -np.eye(3), [[0.6, 0, 0.8], [-0.48, 0.6, -0.64]]]):
            path = self.MIDDLE + np.linspace(1.2, 0.96, 60)[:, None] * self.RADIUS * direction
            trace = renderer.trace(path)
            np.testing.assert_allclose(trace.force[-1], STIFFNESS * 2 * 0.04 * self.RADIUS * direction, atol=0.1)
            np.testing.assert_allclose(trace.proxy[-1], self.MIDDLE + self.RADIUS * direction, atol=2e-4)
            np.testing.assert_array_equal(trace.hip, path)
            renderer.reset()
            for hip, proxy, force in zip(path, trace.proxy, trace.force):
                got = renderer.step(hip)
                np.testing.assert_array_equal(got[0], proxy)
                np.testing.assert_array_equal(got[1], force)

    def test_numpy_agrees(self):
        code, told = second_opinion(self.scene)
        self.assertEqual((code, told.count(" pass ")), (0, 2), told)

    def test_nodes_of_all_sides_have_places_normals_and_colours_in_the_scan_frame(self):
        nodes = self.scene.nodes()
        away = nodes["place"] - self.MIDDLE
        directions = away / np.linalg.norm(away, axis=1)[:, None]
        self.assertGreater(len(away), 10000)
        np.testing.assert_allclose(np.linalg.norm(away, axis=1), self.RADIUS, atol=1e-4)
        self.assertGreater((directions * nodes["normal"]).sum(axis=1).min(), 0.999)
        self.assertLess(np.linalg.norm(directions.mean(axis=0)), 0.01)  # of all sides alike
        np.testing.assert_allclose(nodes["colour"][:, :3], 128 + 100 * directions, atol=100 * 2.5 * 0.0015 / self.RADIUS)
        self.assertEqual(nodes["sheet"].max() + 1, self.scene.sheets)
        self.assertEqual((nodes["texture"], nodes["intensity"]), (None, None))
        self.assertEqual([nodes[name].dtype for name in ("place", "normal", "sheet", "colour")],
                         [np.float64, np.float32, np.int32, np.uint8])
        with self.assertRaises(ValueError):
            nodes["place"][0, 0] = 1.0

    def test_the_mesh_is_closed_and_coloured(self):
        told = []
        mesh = self.scene.mesh(progress=lambda stage, share: told.append(stage))
        vertices, triangles = mesh["vertices"] - self.MIDDLE, mesh["triangles"]
        np.testing.assert_allclose(np.linalg.norm(vertices, axis=1), self.RADIUS, atol=2e-4)
        ways = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        self.assertEqual(len(np.unique(ways, axis=0)), len(ways))
        np.testing.assert_array_equal(np.unique(ways, axis=0), np.unique(ways[:, ::-1], axis=0))
        a, b, c = (vertices[triangles[:, k]] for k in range(3))
        np.testing.assert_allclose(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6, 4 / 3 * np.pi * self.RADIUS**3, rtol=0.01)
        np.testing.assert_allclose(mesh["colour"][:, :3], 128 + 100 * vertices / self.RADIUS, atol=100 * 2.5 * 0.0015 / self.RADIUS)
        self.assertEqual(mesh["unseen"], 0)
        self.assertIn("mesh", told)
        with self.assertRaisesRegex(sparsha.UsageError, "holes is 'open'"):
            self.scene.mesh(holes="open")
        front = sparsha.build(sparsha.Cloud(self.MIDDLE + self.RADIUS * np.random.default_rng(3).random((9000, 3)) * [1, 1, 0]),
                              config={"grid": {"spacing_mm": 1}})
        for ask in (front.nodes, front.mesh):
            with self.assertRaisesRegex(sparsha.UsageError, "no whole object"):
                ask()

    def test_the_front_view_of_a_whole_object_takes_the_scan_frame_too(self):
        hip = self.MIDDLE + 0.96 * self.RADIUS * TOWARDS
        renderer = sparsha.Renderer(self.scene, frame="scan", around=False, stiffness=STIFFNESS, friction=False)
        proxy, force = renderer.step(hip)
        np.testing.assert_allclose(force, [0, 0, STIFFNESS * 2 * 0.04 * self.RADIUS], atol=0.1)
        np.testing.assert_allclose(homogeneous(self.scene.scan_from_grid, proxy), self.MIDDLE + self.RADIUS * TOWARDS, atol=2e-4)


class Unrolled(unittest.TestCase):
    """A column about a line along y, with five soft flutes."""
    X, Z = 7.0, -2.0

    @staticmethod
    def radius(turn):
        return 0.1 + 0.003 * np.cos(5 * turn)

    @classmethod
    def place(cls, turn, y, outwards=0.0):
        radius = cls.radius(turn) + outwards
        return np.stack([cls.X + radius * np.sin(turn), np.broadcast_to(y, np.shape(turn)), cls.Z + radius * np.cos(turn)], -1)

    @classmethod
    def setUpClass(cls):
        warnings.simplefilter("ignore", sparsha.Warning)
        rng = np.random.default_rng(4)
        points = cls.place(2 * np.pi * rng.random(24000), 0.3 * rng.random(24000))
        cls.scene = sparsha.build(sparsha.Cloud(points), config={"unroll": {"axis": "auto"}, "check": {}})

    def path(self):
        """Two and a half turns, 2 mm below the surface but for the beginning."""
        turn = 2 * np.pi * np.arange(2501) / 1000
        return turn, self.place(turn, 0.15, np.where(np.arange(2501) < 10, 0.002, -0.002))

    def test_a_path_goes_around_over_the_seam(self):
        turn, path = self.path()
        path[20] = np.nan
        trace = sparsha.Renderer(self.scene, frame="scan", friction=False, stiffness=1000).trace(path)
        np.testing.assert_array_equal(trace.hip, path)
        touched = np.arange(2501) > 30
        self.assertTrue(trace.contact[touched].all())
        self.assertTrue((trace.force[20] == 0).all())
        across = trace.proxy[touched] - [self.X, 0, self.Z]
        distance = np.hypot(across[:, 0], across[:, 2])
        np.testing.assert_allclose(distance, self.radius(np.arctan2(across[:, 0], across[:, 2])), atol=6e-4)
        np.testing.assert_allclose(trace.proxy[touched, 1], 0.15, atol=2e-3)
        outwards = (trace.force[touched, 0] * across[:, 0] + trace.force[touched, 2] * across[:, 2]) / distance
        np.testing.assert_allclose(outwards, 2.0, atol=0.5)
        self.assertLess(np.linalg.norm(np.diff(trace.force[touched], axis=0), axis=1).max(), 0.6)  # the seam is not felt

    @unittest.skipUnless(PROGRAM, "SPARSHA_PROGRAM names the program")
    def test_the_program_traces_the_same(self):
        _, path = self.path()
        told = by_program(self.scene, path, "--no-friction")
        np.testing.assert_array_equal(told[:, :11], columns(sparsha.Renderer(self.scene, frame="scan", friction=False).trace(path)))

    def test_numpy_agrees(self):
        code, told = second_opinion(self.scene)
        self.assertEqual((code, told.count(" pass ")), (0, 2), told)

    def test_what_has_no_scan_frame_on_an_unrolled_object_is_refused(self):
        renderer = sparsha.Renderer(self.scene, frame="scan")
        with self.assertRaisesRegex(sparsha.UsageError, "unrolled.*trace"):
            renderer.step((7.0, 0.1, -1.9))
        self.assertEqual(renderer.scale, 1.0)
        for window in ({"level": 0}, {"centre": (0, 0)}):
            with self.assertRaisesRegex(sparsha.UsageError, "unrolled"):
                sparsha.Renderer(self.scene, frame="scan", **window)
        with self.assertRaisesRegex(sparsha.UsageError, "around too often"):
            renderer.trace(self.place(np.arange(0, 2e6, 2.0), 0.15))

    def test_the_picture_itself_is_touched_step_by_step(self):
        renderer = sparsha.Renderer(self.scene, friction=False, stiffness=1000)
        x0, y0, z0 = self.scene.origin
        ny, nx = self.scene.shape()
        at = np.array([x0 + self.scene.spacing() * (nx // 2), y0 + self.scene.spacing() * (ny // 2)])
        height = z0 + float(self.scene.heights()[ny // 2, nx // 2])
        proxy, force = renderer.step((*at, height - 0.001))
        self.assertTrue(renderer.contact)
        self.assertAlmostEqual(np.linalg.norm(force), 1.0, delta=0.1)


if __name__ == "__main__":
    unittest.main()
