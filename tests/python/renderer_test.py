"""Forces of the Python module: judged by planes and spheres whose forces are known, and by the program `sparsha trace`."""
import gc
import os
import pathlib
import subprocess
import tempfile
import threading
import unittest
import warnings

import numpy as np

import sparsha
from scene_test import resident_bytes
from surfaces import WAVE, wave_points

PROGRAM = os.environ.get("SPARSHA_PROGRAM")
STIFFNESS = 500.0


def stroke(count=4000):
    """A hand that goes in and out of the wave."""
    t = np.arange(count) / 1000
    return np.stack([0.075 + 0.06 * np.sin(2.1 * t), 0.06 + 0.05 * np.sin(1.7 * t + 1), 0.002 + 0.004 * np.sin(9 * t)], -1)


class OnAView(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        warnings.simplefilter("ignore", sparsha.Warning)
        cls.scene = sparsha.build(sparsha.Cloud(wave_points()), config=WAVE)
        slope = wave_points() * [1, 1, 0]
        slope[:, 2] = 0.25 * slope[:, 0]
        cls.slope = sparsha.build(sparsha.Cloud(slope), config={"grid": {"spacing_mm": 1}, "friction": {"law": "constant", "mu_0": 0.0}})

    def test_on_a_frictionless_plane_the_force_is_the_way_to_the_plane(self):
        renderer = sparsha.Renderer(self.slope, friction=False, stiffness=STIFFNESS)
        normal = np.array([-0.25, 0, 1]) / np.sqrt(1.0625)
        for x, depth in ((0.05, 0.001), (0.06, 0.004), (0.0601, -0.002), (0.09, 0.003)):
            foot = np.array([x, 0.06, 0.25 * x])
            proxy, force = renderer.step(foot - depth * normal)
            self.assertEqual(renderer.contact, depth > 0)
            np.testing.assert_allclose(force, STIFFNESS * max(depth, 0) * normal, atol=2e-4)
            np.testing.assert_allclose(proxy, foot if depth > 0 else foot - depth * normal, atol=1e-6)

    def test_heights_of_ones_own_are_touched_as_they_are(self):
        x, y = np.meshgrid(0.01 * np.arange(31), 0.01 * np.arange(21))
        heights = 0.2 * x - 0.1 * y
        normal = np.array([-0.2, 0.1, 1]) / np.sqrt(1.05)
        for surface in ("bilinear", "c1"):
            renderer = sparsha.Renderer.of_heights(heights, 0.01, origin=(1, 2, 3), stiffness=STIFFNESS, surface=surface)
            foot = np.array([1.123, 2.077, 3 + 0.2 * 0.123 - 0.1 * 0.077])
            proxy, force = renderer.step(foot - 0.002 * normal)
            np.testing.assert_allclose(force, STIFFNESS * 0.002 * normal, atol=1e-5)
            np.testing.assert_allclose(proxy, foot, atol=1e-7)
            trace = renderer.trace([foot - 0.002 * normal])
            np.testing.assert_array_equal(trace.force[0], force)
        rough = sparsha.Renderer.of_heights(np.zeros((5, 5)), 0.01, mu_dynamic=0.5, stiffness=STIFFNESS)
        rough.step((0.01, 0.02, 0.01))
        rough.step((0.01, 0.02, -0.002))
        proxy, force = rough.step((0.03, 0.02, -0.002))
        np.testing.assert_allclose(-force[0] / force[2], 0.5, rtol=1e-6)  # Coulomb's cone
        nan = heights.copy()
        nan[3, 4] = np.nan
        self.assertTrue(np.isfinite(sparsha.Renderer.of_heights(nan, 0.01).step((0.04, 0.03, -0.01))).all())
        for wrong, spacing in ((np.zeros((1, 5)), 1), (np.zeros(5), 1), (np.zeros((5, 5)), 0), (np.zeros((5, 5)), np.nan),
                               (np.full((5, 5), np.inf), 1), (np.zeros((0, 0)), 1), ("x", 1), (None, 1),
                               (np.broadcast_to(0.0, (10**6, 10**6)), 1), (np.zeros((5, 5), complex), 1)):
            with self.assertRaises((TypeError, sparsha.UsageError)):
                sparsha.Renderer.of_heights(wrong, spacing)
        for options in ({"mu_dynamic": -1}, {"mu_dynamic": 0.5, "mu_static": 0.4}, {"surface": "c2"}, {"origin": (1, 2)}):
            with self.assertRaises(sparsha.UsageError):
                sparsha.Renderer.of_heights(np.zeros((5, 5)), 1, **options)

    def test_steps_and_traces_are_the_same_bits(self):
        path = stroke()
        for options in ({}, {"creases": "rounded"}, {"solver": "paper"}, {"level": 0}, {"texture": False},
                        {"centre": (0.07, 0.06)}, {"tip_radius_mm": 0.5, "level": 0, "friction": False}, {"frame": "scan"}):
            renderer = sparsha.Renderer(self.scene, **options)
            trace = renderer.trace(path)
            self.assertGreater(trace.contact.sum(), 1000)
            self.assertEqual(trace.summary["contacts"], trace.contact.sum())
            for hip, proxy, force, contact in zip(path[:1500], trace.proxy, trace.force, trace.contact):
                got = renderer.step(hip)
                np.testing.assert_array_equal(got[0], proxy)
                np.testing.assert_array_equal(got[1], force)
                self.assertEqual(renderer.contact, contact)
            renderer.reset()
            np.testing.assert_array_equal(renderer.step(tuple(path[0].tolist()))[0], trace.proxy[0])

    @unittest.skipUnless(PROGRAM, "SPARSHA_PROGRAM names the program")
    def test_the_program_traces_the_same(self):
        path = stroke()
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            self.scene.save(folder / "wave.scene")
            np.savetxt(folder / "path.csv", np.column_stack([np.arange(len(path)) / 1000, path]), delimiter=",", fmt="%.17g",
                       header="t_s,x_m,y_m,z_m", comments="")
            subprocess.run([PROGRAM, "trace", folder / "wave.scene", "--hip", folder / "path.csv", "--out", folder / "t.csv"],
                           check=True, capture_output=True)
            told = np.loadtxt(folder / "t.csv", delimiter=",", skiprows=1)
            trace = sparsha.Renderer(self.scene).trace(path)
            trace.save(folder / "own.csv")
            own = np.loadtxt(folder / "own.csv", delimiter=",", skiprows=1)
        np.testing.assert_array_equal(np.column_stack([trace.time, trace.hip, trace.proxy, trace.force, trace.contact]),
                                      told[:, :11])
        np.testing.assert_array_equal(own[:, :12], told[:, :12])

    def test_hostile_hands_and_paths(self):
        renderer = sparsha.Renderer(self.scene)
        for wrong in (None, "abc", [1, 2], np.zeros(4), np.zeros((1, 3)), object(), [1j, 0, 0], {}, np.zeros(3, bool)):
            with self.assertRaises((TypeError, sparsha.UsageError)):
                renderer.step(wrong)
        with self.assertRaises(TypeError):
            renderer.step()
        with self.assertRaises(TypeError):
            renderer.step(1.0, 2.0, 3.0)
        hand = stroke()[700]
        renderer.reset()
        expected = renderer.step(hand)
        wide = np.zeros(9)
        wide[::3] = hand
        for same in (list(hand), tuple(hand.tolist()), hand.astype(">f8"), wide[::3], hand[::-1].copy()[::-1],
                     np.asfortranarray(hand)):
            renderer.reset()
            np.testing.assert_array_equal(renderer.step(same), expected)
        renderer.reset()
        proxy, force = renderer.step([np.nan, 0, 0])
        np.testing.assert_array_equal(force, 0)
        renderer.step([1e300, -1e300, 0])
        self.assertTrue(np.isfinite(renderer.step(hand)).all())
        for path in (np.zeros((3, 2)), np.zeros(3), None, np.zeros((2, 3), complex)):
            with self.assertRaises((TypeError, sparsha.UsageError)):
                renderer.trace(path)
        with self.assertRaisesRegex(sparsha.UsageError, "repeated"):
            renderer.trace(np.broadcast_to(np.zeros(3), (10**9, 3)))
        self.assertEqual(len(renderer.trace(np.zeros((0, 3)))), 0)
        self.assertEqual(renderer.trace(np.zeros((0, 3))).proxy.shape, (0, 3))
        self.assertEqual(renderer.trace([[np.nan, 0, 0]]).summary["contacts"], 0)
        with self.assertRaises(sparsha.UsageError):
            renderer.trace(np.zeros((4, 3)), time=[1, 2, 3])
        for options in ({"level": 99}, {"level": -2}, {"solver": "best"}, {"frame": "world"}, {"centre": (1, 2, 3)}, 
                        {"centre": (np.nan, 0)}, {"tip_radius_mm": 5}, {"stiffness": -1}, {"around": True}, {"creases": ""}):
            with self.assertRaises(sparsha.UsageError, msg=str(options)):
                sparsha.Renderer(self.scene, **options)
        with self.assertRaises(TypeError):
            sparsha.Renderer("a.scene")
        with self.assertRaises(TypeError):
            sparsha.Renderer.step(3, hand)

        class Unmade(sparsha.Renderer):
            def __init__(self):
                pass
        with self.assertRaises(TypeError):
            Unmade().step(hand)

    def test_renderers_keep_their_scene_and_threads_have_their_own(self):
        scene = sparsha.build(sparsha.Cloud(wave_points()), config=WAVE)
        renderer = sparsha.Renderer(scene)
        trace = renderer.trace(stroke())
        del scene, renderer
        gc.collect()
        found = [None] * 4

        def work(index):
            own = sparsha.Renderer(self.scene)
            found[index] = np.array([own.step(hip)[1] for hip in stroke(1500)])
        threads = [threading.Thread(target=work, args=(index,)) for index in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for forces in found:
            np.testing.assert_array_equal(forces, trace.force[:1500])

    def test_nothing_is_lost_in_a_hundred_thousand_steps(self):
        renderer = sparsha.Renderer(self.scene)
        path = stroke(1000)

        def rounds(count):
            for _ in range(count):
                for hip in path:
                    renderer.step(hip)
                renderer.trace(path).force, renderer.reset()
                try:
                    renderer.step("no")
                except TypeError:
                    pass
        rounds(5)
        before = resident_bytes()
        rounds(100)
        gc.collect()
        self.assertLess(resident_bytes() - before, 4e6)


class AroundASphere(unittest.TestCase):
    RADIUS = 0.05

    @classmethod
    def setUpClass(cls):
        warnings.simplefilter("ignore", sparsha.Warning)
        count = 40000
        k = np.arange(count) + 0.5
        height = 1 - 2 * k / count
        turn = np.pi * (1 + 5**0.5) * k
        across = np.sqrt(1 - height**2)
        directions = np.stack([across * np.cos(turn), across * np.sin(turn), height], -1)
        cloud = sparsha.Cloud(cls.RADIUS * directions, normals=directions)
        cls.scene = sparsha.build(cloud, config={"grid": {"spacing_mm": 1}, "around": {}})

    def test_all_sides_push_outwards(self):
        self.assertGreater(self.scene.sheets, 0)
        renderer = sparsha.Renderer(self.scene, frame="scan", stiffness=STIFFNESS, friction=False)
        for direction in np.concatenate([np.eye(3), -np.eye(3), [[0.6, 0, 0.8], [-0.48, 0.6, -0.64]]]):
            renderer.reset()
            renderer.step(1.2 * self.RADIUS * direction)
            for share in np.linspace(1.2, 0.96, 60):
                proxy, force = renderer.step(share * self.RADIUS * direction)
            np.testing.assert_allclose(force, STIFFNESS * 0.04 * self.RADIUS * direction, atol=0.05)
            np.testing.assert_allclose(np.linalg.norm(proxy), self.RADIUS, atol=1e-4)

    def test_steps_and_traces_are_the_same_bits(self):
        t = np.arange(2000) / 1000
        path = 0.97 * self.RADIUS * np.stack([np.cos(2 * t), np.sin(2 * t) * np.cos(t), np.sin(2 * t) * np.sin(t)], -1)
        path[:20] *= np.linspace(1.2, 1.0, 20)[:, None]
        renderer = sparsha.Renderer(self.scene, frame="scan")
        trace = renderer.trace(path)
        self.assertGreater(trace.contact.sum(), 1900)
        self.assertGreaterEqual(trace.sheet.max(), 0)
        for hip, proxy, force in zip(path, trace.proxy, trace.force):
            got = renderer.step(hip)
            np.testing.assert_array_equal(got[0], proxy)
            np.testing.assert_array_equal(got[1], force)
        with self.assertRaises(sparsha.UsageError):
            sparsha.Renderer(self.scene, around=True)
        with self.assertRaises(sparsha.UsageError):
            sparsha.Renderer(self.scene, frame="scan", level=0)


if __name__ == "__main__":
    unittest.main()
