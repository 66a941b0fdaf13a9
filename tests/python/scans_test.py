"""What is read of files beside places and colours, and what is said of several together."""
import json
import os
import pathlib
import struct
import subprocess
import tempfile
import unittest
import warnings

import numpy as np

import sparsha

COUNT = 500


def rows():
    rng = np.random.default_rng(3)
    points = rng.uniform(-1, 1, (COUNT, 3)).astype(np.float32)
    normals = rng.normal(size=(COUNT, 3))
    normals = (normals / np.linalg.norm(normals, axis=1)[:, None]).astype(np.float32)
    return points, normals


def ply(points, normals, kind):
    names = "".join(f"property float {name}\n" for name in "x y z nx ny nz".split())
    header = f"ply\nformat {kind} 1.0\nelement vertex {len(points)}\n{names}end_header\n".encode()
    values = np.hstack([points, normals])
    return header + (values.astype("<f4").tobytes() if kind != "ascii" else table(values))


def table(values):
    return "".join(" ".join(f"{v:.9g}" for v in row) + "\n" for row in values).encode()


def pcd(points, normals):
    header = (f"VERSION 0.7\nFIELDS x y z normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F\n"
              f"COUNT 1 1 1 1 1 1\nWIDTH {len(points)}\nHEIGHT 1\nPOINTS {len(points)}\nDATA ascii\n")
    return header.encode() + table(np.hstack([points, normals]))


def grid():
    u, v = np.meshgrid(np.linspace(0, 1, 30), np.linspace(0, 1, 30))
    points = np.stack([u, v, 0.1 * np.sin(5 * u) * np.cos(4 * v)], -1).reshape(-1, 3).astype(np.float32)
    k = np.arange(900).reshape(30, 30)
    a, b, c, d = (part.ravel() for part in (k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]))
    return points, np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])


def stl(points, faces):
    rows = np.zeros(len(faces), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    rows["corners"] = points[faces]
    return b" " * 80 + struct.pack("<I", len(faces)) + rows.tobytes()


def glb(points, faces):
    binary = points.astype("<f4").tobytes() + faces.astype("<u4").tobytes()
    size = points.size * 4
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5125, "count": faces.size, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": size},
                        {"buffer": 0, "byteOffset": size, "byteLength": len(binary) - size}],
        "buffers": [{"byteLength": len(binary)}]}).encode()
    text += b" " * (-len(text) % 4)
    return (b"glTF" + struct.pack("<II", 2, 28 + len(text) + len(binary)) + struct.pack("<I", len(text)) + b"JSON" +
            text + struct.pack("<I", len(binary)) + b"BIN\0" + binary)


class Scans(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.points, self.normals = rows()

    def write(self, name, data):
        (self.folder / name).write_bytes(data)
        return str(self.folder / name)

    def test_normals_are_those_that_the_file_states(self):
        values = np.hstack([self.points, self.normals])
        for name, data in [("binary.ply", ply(self.points, self.normals, "binary_little_endian")),
                           ("ascii.ply", ply(self.points, self.normals, "ascii")),
                           ("a.pcd", pcd(self.points, self.normals)),
                           ("a.xyz", b"# x y z nx ny nz\n" + table(values)), ("unnamed.xyz", table(values))]:
            with self.subTest(name):
                cloud = sparsha.read(self.write(name, data), units="m")
                self.assertIsNotNone(cloud.normals)
                np.testing.assert_allclose(cloud.normals, self.normals, atol=1e-6)
        self.assertIsNone(sparsha.read(self.write("bare.xyz", table(self.points)), units="m").normals)

    def test_normals_turn_with_the_scan_and_are_zero_where_a_file_has_none(self):
        turned = {"file": self.write("a.ply", ply(self.points, self.normals, "binary_little_endian")), "units": "cm",
                  "pose": {"euler_deg": [0, 0, 90]}}
        bare = self.write("bare.xyz", table(self.points + 0.5))
        cloud = sparsha.read([turned, bare], units="m")
        x, y, z = self.normals.T
        np.testing.assert_allclose(cloud.normals[:COUNT], np.stack([-y, x, z], -1), atol=1e-6)
        np.testing.assert_array_equal(cloud.normals[COUNT:], 0)

    def test_a_cloud_with_normals_as_fields_too_is_built(self):
        u, v = np.meshgrid(np.linspace(-1, 1, 40), np.linspace(-1, 1, 40))
        points = np.stack([u, v, 0.1 * np.sin(3 * u)], -1).reshape(-1, 3).astype(np.float32)
        normals = np.tile(np.float32([0, 0, 1]), (len(points), 1))
        cloud = sparsha.read(self.write("a.ply", ply(points, normals, "ascii")), units="m", fields=["nx", "nz"])
        np.testing.assert_array_equal(cloud.fields["nz"], 1)
        scene = sparsha.build(cloud, grid={"size": 40})
        self.assertGreater(np.mean(scene.mask(0) == 1), 0.8)

    def test_a_field_that_no_file_has_is_an_error_that_names_those_that_there_are(self):
        confident = self.write("a.csv", b"x,y,z,confidence,age\n" +
                               b"".join(b"%.4f,%.4f,%.4f,%d,7\n" % (*p, n % 5) for n, p in enumerate(self.points)))
        bare = self.write("bare.xyz", table(self.points + 0.5))
        with self.assertRaisesRegex(sparsha.InputError, r"a\.csv.*'worth'.*confidence, age"):
            sparsha.read(confident, units="m", fields=["confidence", "worth"])
        with self.assertRaisesRegex(sparsha.InputError, r"'worth'"):
            sparsha.read(bare, units="m", fields=["worth"])
        # Of several files one is enough.
        both = sparsha.read([confident, bare], units="m", fields=["Confidence"])
        np.testing.assert_array_equal(both.fields["confidence"][:COUNT], np.arange(COUNT) % 5)
        self.assertTrue(np.isnan(both.fields["confidence"][COUNT:]).all())

    def test_intensity_is_a_field_as_well(self):
        cloud = sparsha.read(self.write("a.csv", b"x,y,z,intensity\n" + table(np.hstack(
            [self.points, np.arange(COUNT)[:, None]])).replace(b" ", b",")), units="m", fields=["intensity"])
        np.testing.assert_array_equal(cloud.fields["intensity"], cloud.intensity)
        np.testing.assert_array_equal(cloud.intensity, np.arange(COUNT))

    @unittest.skipUnless(os.environ.get("SPARSHA_PROGRAM"), "SPARSHA_PROGRAM names the program")
    def test_formats_with_different_axes_up_are_said_by_all_until_a_pose_turns_one(self):
        points, faces = grid()
        z_up = self.write("z.stl", stl(points, faces))
        y_up = self.write("y.glb", glb(points[:, [0, 2, 1]] * [1, 1, -1], faces))
        said = "z is up in z.stl and y is up in y.glb"

        def told(*arguments):
            done = subprocess.run([os.environ["SPARSHA_PROGRAM"], *arguments], cwd=self.folder, capture_output=True,
                                  text=True, timeout=120)
            self.assertEqual(done.returncode, 0, done.stderr)
            return done.stdout + done.stderr

        self.assertIn(said, told("info", "z.stl", "y.glb"))
        self.assertIn(said, told("new", "z.stl", "y.glb", "-o", "c.yaml"))
        self.assertIn(said, (self.folder / "c.yaml").read_text())
        self.assertNotIn(said, told("info", "z.stl", "z.stl"))
        with self.assertWarnsRegex(sparsha.Warning, "y is up in"):
            sparsha.read([z_up, y_up], units="m")
        with warnings.catch_warnings():
            warnings.simplefilter("error", sparsha.Warning)
            turned = sparsha.read([z_up, {"file": y_up, "pose": {"euler_deg": [90, 0, 0]}}], units="m")
        xyz = turned.points.astype(float) + turned.origin
        apart = np.linalg.norm(xyz[len(points):, None] - xyz[None, :len(points)], axis=2).min(1)
        self.assertLess(apart.max(), 1e-6)


if __name__ == "__main__":
    unittest.main()
