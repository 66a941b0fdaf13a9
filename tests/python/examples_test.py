"""The examples run in an empty folder, without Matplotlib and Open3D, and their pictures are whole; the two longer ones by night."""
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree
import zlib

EXAMPLES = pathlib.Path(os.environ["SPARSHA_SOURCE_DIR"]) / "examples/python"
PICTURES = {"arrays": ["arrays-colour.png", "arrays-relief.png"], "bench": ["bench.svg"], "friction": ["friction.svg"],
            "statue": ["statue-front.png", "statue-force.svg"]}
CURVES = {"bench.svg": {"nearest point", "straight down"}, "friction.svg": {"frictionless", "constant", "curvature", "paper"},
          "statue-force.svg": {"force"}}
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
    def assert_drawn(self, file):
        """Every curve is named in the legend and drawn, within the picture; axes have their words and at least three numbers."""
        root = xml.etree.ElementTree.parse(file).getroot()
        width, height = float(root.get("width")), float(root.get("height"))
        tags = [(element.tag.rpartition("}")[2], element) for element in root.iter()]
        words = ["".join(element.itertext()) for tag, element in tags if tag == "text"]
        self.assertLessEqual(CURVES[file.name], set(words))
        self.assertGreater(len([word for word in words if re.fullmatch(r"(10)?-?[\d.]+", word)]), 2, words)
        self.assertNotIn("-0", words)
        places = [tuple(map(float, pair.split(","))) for _, element in tags for pair in element.get("points", "").split()]
        places += [(float(e.get("cx")), float(e.get("cy"))) for tag, e in tags if tag == "circle"]
        self.assertGreater(len(places), 15)
        for x, y in places:
            self.assertTrue(0 <= x <= width and 0 <= y <= height, (x, y))

    def test_each_runs_and_leaves_its_pictures(self):
        self.assertEqual({f.stem for f in EXAMPLES.glob("*.py")} - {"picture"}, set(PICTURES))
        for name, pictures in PICTURES.items():
            if name in LONG and os.environ.get("SPARSHA_NIGHTLY") != "1":
                continue
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                done = subprocess.run([sys.executable, "-W", "ignore", EXAMPLES / f"{name}.py", "--quick"], cwd=folder,
                                      capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertTrue(done.stdout)
                for picture in pictures:
                    file = pathlib.Path(folder) / "pictures" / picture
                    if file.suffix == ".svg":
                        self.assert_drawn(file)
                        continue
                    width, height, rows = pixels(file)
                    self.assertGreater(min(width, height), 100)
                    self.assertGreater(len(set(rows)), 3)


if __name__ == "__main__":
    unittest.main()
