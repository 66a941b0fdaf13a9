"""Arrays that hide, repeat, overlap or leave their memory, and numbers of every type, at every door that takes arrays: the
right result or a clear exception."""
import math
import unittest
import warnings

import numpy as np
from numpy.lib.stride_tricks import as_strided, sliding_window_view

import sparsha
from scene_test import resident_bytes
from surfaces import wave, wave_points

TYPES = (np.int8, np.uint16, np.int64, np.uint64, np.float16, np.float32, np.longdouble, ">f4", ">f8", ">i4", ">f2")


def masked(numbers, *where):
    """The numbers with some of them hidden, and something under the mask that would be seen."""
    array = np.ma.array(numbers, dtype=float, copy=True)
    for place in where:
        array[place] = 0.77
        array[place] = np.ma.masked
    return array


class Masked(unittest.TestCase):
    def setUp(self):
        warnings.simplefilter("ignore", sparsha.Warning)
        self.points = wave_points(20, 20)
        self.cloud = sparsha.Cloud(self.points)

    def test_hidden_points_are_refused_with_their_row(self):
        for hidden in (masked(self.points, (17, 2)), masked(self.points, 17), list(masked(self.points, (17, 2))),
                       tuple(masked(self.points, (17, 2))), np.ma.array(np.asfortranarray(self.points), mask=masked(self.points, (17, 0)).mask)):
            with self.assertRaisesRegex(sparsha.UsageError, "row 17 of points is masked"):
                sparsha.Cloud(hidden)
        for shown in (np.ma.array(self.points), masked(self.points), list(np.ma.array(self.points)),
                      np.ma.array(self.points, mask=np.zeros_like(self.points, bool))):
            np.testing.assert_array_equal(sparsha.Cloud(shown).points, self.cloud.points)

    def test_hidden_colours_normals_and_faces_are_refused(self):
        colours = np.ma.array(np.zeros((400, 3), np.uint8))
        colours[5, 1] = np.ma.masked
        for name, wrong in (("colour", colours), ("colour", masked(np.zeros((400, 3)), 5)), ("normals", masked(np.ones((400, 3)), 5)),
                            ("faces", np.ma.array([[0, 1, 2]] * 6, mask=[[0, 0, 0]] * 5 + [[0, 1, 0]]))):
            with self.assertRaisesRegex(sparsha.UsageError, f"row 5 of {name} is masked"):
                sparsha.Cloud(self.points, **{name: wrong})
        with self.assertRaisesRegex(sparsha.UsageError, "origin is masked"):
            sparsha.Cloud(self.points, origin=masked(np.zeros(3), 1))

    def test_hidden_intensities_and_fields_are_unknown(self):
        values = np.arange(400)
        cloud = sparsha.Cloud(self.points, intensity=masked(values, 3), fields={"a": np.ma.masked_equal(values, 7)})
        np.testing.assert_array_equal(np.flatnonzero(np.isnan(cloud.intensity)), [3])
        np.testing.assert_array_equal(np.flatnonzero(np.isnan(cloud.fields["a"])), [7])
        self.assertEqual(cloud.intensity[4], 4)

    def test_hidden_heights_are_unknown_and_the_callers_array_stays(self):
        heights = np.zeros((9, 9), np.float32)
        heights[4, 4] = 0.05
        hidden = np.ma.array(heights, mask=heights > 0)
        expected = np.where(heights > 0, np.nan, heights)
        hand = (0.041, 0.042, -0.001)
        got, told = (sparsha.Renderer.of_heights(z, 0.01).step(hand) for z in (hidden, expected))
        np.testing.assert_array_equal(got, told)
        self.assertFalse(np.array_equal(got[0], sparsha.Renderer.of_heights(heights, 0.01).step(hand)[0]))
        self.assertEqual(heights[4, 4], np.float32(0.05))

    def test_a_hidden_hand_is_no_number(self):
        renderer = sparsha.Renderer.of_heights(np.zeros((9, 9)), 0.01)
        path = np.tile([0.04, 0.04, -0.001], (6, 1))
        trace = renderer.trace(masked(path, (3, 1)), time=masked(np.arange(6), 2))
        np.testing.assert_array_equal(np.isnan(trace.hip[:, 1]), np.arange(6) == 3)
        np.testing.assert_array_equal(trace.contact, np.arange(6) != 3)
        np.testing.assert_array_equal(np.isnan(trace.time), np.arange(6) == 2)
        np.testing.assert_array_equal(renderer.step(masked([0.04, 0.04, -0.001], 2))[1], 0)
        with self.assertRaisesRegex(sparsha.UsageError, "centre is masked"):
            sparsha.Renderer(sparsha.build(self.cloud, config={"grid": {"spacing_mm": 1}}), centre=masked([0, 0], 1))

    def test_hidden_numbers_of_a_configuration_are_refused(self):
        with self.assertRaisesRegex(TypeError, "masked"):
            sparsha.build(self.cloud, config={}, grid={"bounds_m": masked([0, 0, 1, 1], 2)})


class Strides(unittest.TestCase):
    def doors(self, rows):
        """Every door that takes rows of three."""
        yield lambda: sparsha.Cloud(rows)
        yield lambda: sparsha.Renderer.of_heights(np.zeros((9, 9)), 0.01).trace(rows)

    def test_rows_that_share_numbers_are_read_as_they_stand(self):
        numbers = np.sin(np.arange(500.0))
        for shared in (sliding_window_view(numbers, 3), as_strided(numbers, (498, 3), (8, 8)), as_strided(numbers, (166, 3), (24, 0)),
                       as_strided(numbers[::-1], (400, 3), (-8, -8)), as_strided(numbers[1::2], (200, 3), (8, 16))):
            own = np.array([[value for value in row] for row in shared])
            np.testing.assert_array_equal(sparsha.Cloud(shared).points, sparsha.Cloud(own).points)
            renderer = sparsha.Renderer.of_heights(np.zeros((9, 9)), 0.01)
            np.testing.assert_array_equal(renderer.trace(shared).hip, own)

    def test_rows_outside_of_their_memory_are_refused(self):
        numbers = np.zeros(300)
        inner = numbers[100:200]
        for shape, strides, start in (((100, 3), (24, 9), inner), ((68, 3), (24, 8), inner), ((101, 3), (24, 8), numbers),
                                      ((14, 3), (-24, 8), numbers[30:]), ((40000, 3), (8, 8), numbers)):
            for door in self.doors(as_strided(start, shape, strides)):
                with self.assertRaisesRegex(sparsha.UsageError, "beyond the memory"):
                    door()

    def test_a_hand_outside_of_its_memory_is_refused(self):
        hand = np.array([0.04, 0.04, -0.001])
        renderer = sparsha.Renderer.of_heights(np.zeros((9, 9)), 0.01)
        expected = renderer.step(hand)
        path = np.tile(hand, (4, 1))
        for same in (path[2], np.ascontiguousarray(path.T)[:, 1], as_strided(path, (3,), (8,)), hand[::-1][::-1]):
            renderer.reset()
            np.testing.assert_array_equal(renderer.step(same), expected)
        for start, stride in ((np.zeros(3), 1 << 40), (np.zeros(2), 8), (np.zeros(3), -8)):
            wild = as_strided(start, (3,), (stride,))
            for hip in (wild, wild[:]):
                with self.assertRaisesRegex(sparsha.UsageError, "beyond the memory"):
                    renderer.step(hip)

    def test_rows_within_one_number_and_rows_that_are_not_there_are_refused_at_once(self):
        before = resident_bytes()
        for rows, told in ((as_strided(np.zeros(30), (100, 3), (1, 8)), "1 bytes apart"),
                           (np.broadcast_to(np.zeros(3), (10**9, 3)), "one row repeated"),
                           (np.broadcast_to(0.0, (10**9, 3)), "one row repeated"),
                           (np.ma.array(np.broadcast_to(np.zeros(3), (10**9, 3))), "one row repeated"),
                           (np.broadcast_to(np.float16(0), (10**9, 3)), "one row repeated")):
            for door in self.doors(rows):
                with self.assertRaisesRegex(sparsha.UsageError, told):
                    door()
        with self.assertRaisesRegex(sparsha.UsageError, "time.*one row repeated"):
            sparsha.Renderer.of_heights(np.zeros((9, 9)), 0.01).trace(np.zeros((4, 3)), time=np.broadcast_to(0.0, (10**9,)))
        for name in ("intensity", "colour", "normals", "faces"):
            wrong = np.broadcast_to(np.uint8(0), (10**9,) if name == "intensity" else (10**9, 3))
            with self.assertRaisesRegex(sparsha.UsageError, "one row repeated"):
                sparsha.Cloud(np.zeros((4, 3)), **{name: wrong})
        self.assertLess(resident_bytes() - before, 50e6)


class Types(unittest.TestCase):
    def test_every_type_of_real_numbers_gives_the_same_hand_heights_and_points(self):
        path = np.array([[4, 4, 3], [4, 4, 0], [5, 4, 0], [6, 5, 1]])
        z = np.array([[0, 1, 2, 3, 2, 1, 1, 1, 1]] * 9)
        expected = sparsha.Renderer.of_heights(z.astype(np.float32), 1.0).trace(path.astype(float))
        self.assertTrue(expected.contact.any())
        for kind in TYPES:
            renderer = sparsha.Renderer.of_heights(z.astype(kind), 1.0)
            trace = renderer.trace(path.astype(kind), time=np.arange(4).astype(kind))
            np.testing.assert_array_equal(trace.force, expected.force, str(kind))
            np.testing.assert_array_equal(trace.proxy, expected.proxy)
            np.testing.assert_array_equal(trace.time, np.arange(4))
            np.testing.assert_array_equal(renderer.step(path[0].astype(kind))[0], expected.proxy[0])
            np.testing.assert_array_equal(sparsha.Cloud(path.astype(kind)).points, sparsha.Cloud(path).points)

    def test_what_holds_no_real_numbers_is_refused_empty_or_not(self):
        renderer = sparsha.Renderer.of_heights(np.zeros((9, 9)), 0.01)
        for kind in (object, complex, bool, str, "datetime64[s]", [("x", "f8")]):
            for rows in (4, 0):
                wrong = np.zeros((rows, 3), kind) if kind != "datetime64[s]" else np.zeros((rows, 3), "i8").view("M8[s]")
                for name, door in (("points", sparsha.Cloud), ("path", renderer.trace),
                                   ("heights", lambda a: sparsha.Renderer.of_heights(a, 1.0)),
                                   ("normals", lambda a: sparsha.Cloud(np.zeros((rows or 1, 3)), normals=a)),
                                   ("intensity", lambda a: sparsha.Cloud(np.zeros((rows or 1, 3)), intensity=a[:, 0])),
                                   ("time", lambda a: renderer.trace(np.zeros((rows, 3)), time=a[:, 0]))):
                    with self.assertRaisesRegex(TypeError, f"^{name} holds .*expected real numbers", msg=f"{kind} {rows}"):
                        door(wrong)
        for wrong in (object(), "x", b"xyz", {}, [[1, 2, 3], [4, 5]], [masked([1, 2, 3]), [1]], lambda: 0):
            with self.assertRaises((TypeError, sparsha.UsageError)):
                sparsha.Cloud(wrong)

    def test_half_precision_and_infinite_heights(self):
        half = wave_points(20, 20).astype(np.float16)
        np.testing.assert_array_equal(sparsha.Cloud(half).points, sparsha.Cloud(half.astype(float)).points)
        with self.assertRaisesRegex(sparsha.UsageError, "infinite"):
            sparsha.Renderer.of_heights(np.full((5, 5), np.inf, np.float16), 1.0)
        x, y = np.meshgrid(np.arange(30) / 1000, np.arange(20) / 1000)
        hand = (0.011, 0.008, float(wave(0.011, 0.008)) - 0.002)
        forces = [sparsha.Renderer.of_heights(wave(x, y).astype(kind), 0.001).step(hand)[1] for kind in (">f8", np.float64)]
        np.testing.assert_array_equal(*forces)
        self.assertFalse(math.isclose(np.linalg.norm(forces[0]), 0))


if __name__ == "__main__":
    unittest.main()
