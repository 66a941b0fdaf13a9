"""The examples run without Matplotlib and without Open3D, and their pictures are whole; the two longer ones by night."""
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

EXAMPLES = pathlib.Path(os.environ["SPARSHA_SOURCE_DIR"]) / "examples/python"
PICTURES = {"arrays": ["arrays-colour", "arrays-relief"], "bench": ["bench"], "friction": ["friction"],
            "statue": ["statue-front", "statue-force"]}
LONG = {"friction", "statue"}


def pixels(file):
    """Width, height and the bytes of a PNG's rows."""
    data = file.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    rows, at, size = b"", 8, None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0] == zlib.crc32(kind + body)
        size = struct.unpack(">II", body[:8]) if kind == b"IHDR" else size
        rows += body if kind == b"IDAT" else b""
        at += 12 + length
    return (*size, zlib.decompress(rows))


class Examples(unittest.TestCase):
    def test_each_runs_and_leaves_its_pictures(self):
        self.assertEqual({f.stem for f in EXAMPLES.glob("*.py")} - {"picture"}, set(PICTURES))
        for name, pictures in PICTURES.items():
            if name in LONG and os.environ.get("SPARSHA_NIGHTLY") != "1":
                continue
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                done = subprocess.run([sys.executable, "-W", "ignore", EXAMPLES / f"{name}.py", "--quick", "--out", folder],
                                      capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertTrue(done.stdout)
                for picture in pictures:
                    width, height, rows = pixels(pathlib.Path(folder) / f"{picture}.png")
                    self.assertGreater(min(width, height), 100)
                    self.assertGreater(len(set(rows)), 3)


if __name__ == "__main__":
    unittest.main()
