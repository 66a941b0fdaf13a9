"""The stubs, the docstrings and the compiled module say the same."""
import ast
import importlib.util
import inspect
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import sparsha
from sparsha import _core

STUB = pathlib.Path(sparsha.__file__).with_name("_core.pyi")
SHOWN_SPECIAL = {"__init__", "__len__"}


def parameters(definition):
    """(name, kind, has a default) of each parameter in the stub, without self."""
    a = definition.args
    plain = [*a.posonlyargs, *a.args]
    defaults = [False] * (len(plain) - len(a.defaults)) + [True] * len(a.defaults)
    found = [(p.arg, "plain", d) for p, d in zip(plain, defaults) if p.arg != "self"]
    found += [(p.arg, "keyword", d is not None) for p, d in zip(a.kwonlyargs, a.kw_defaults)]
    return found + ([("**", "rest", False)] if a.kwarg else [])


def split_at_commas(text):
    depth, part, parts = 0, "", []
    for c in text:
        depth += (c in "([{") - (c in ")]}")
        if c == "," and depth == 0:
            parts.append(part)
            part = ""
        else:
            part += c
    return [p.strip() for p in [*parts, part] if p.strip()]


def compiled_parameters(function):
    """The same from the first line of the docstring, as pybind11 writes it."""
    line = function.__doc__.split("\n")[0]
    inside = re.match(r"\w+\((.*)\) -> ", line).group(1)
    found, kind = [], "plain"
    for part in split_at_commas(inside):
        name = part.split(":")[0].split("=")[0].strip()
        if name == "*":
            kind = "keyword"
        elif name.startswith("**"):
            found.append(("**", "rest", False))
        elif name != "self":
            found.append((name, kind, "=" in part))
    return found


class Stubs(unittest.TestCase):
    def setUp(self):
        self.tree = ast.parse(STUB.read_text(encoding="utf-8"))

    def test_the_same_names(self):
        names = {n.name for n in self.tree.body if isinstance(n, (ast.ClassDef, ast.FunctionDef)) and n.name[0] != "_"}
        compiled = {n for n in dir(_core) if not n.startswith("_")}
        self.assertEqual(names, compiled)
        self.assertEqual(names | {"__version__"} | {n for n in dir(sparsha._errors) if n[0].isupper()},
                         set(sparsha.__all__))
        for name in sparsha.__all__:
            self.assertTrue(hasattr(sparsha, name), name)
        self.assertTrue(STUB.with_name("py.typed").exists())

    def test_the_same_members_and_parameters(self):
        checked = 0
        for node in self.tree.body:
            if isinstance(node, ast.FunctionDef):
                self.assertEqual(parameters(node), compiled_parameters(getattr(_core, node.name)), node.name)
                checked += 1
            if not isinstance(node, ast.ClassDef) or node.name[0] == "_":
                continue
            kind = getattr(_core, node.name)
            stated = {m.name: m for m in node.body if isinstance(m, ast.FunctionDef)}
            own = {n for n in vars(kind) if not n.startswith("_")} | (SHOWN_SPECIAL & set(vars(kind)))
            self.assertEqual(set(stated), own, node.name)
            for name, member in stated.items():
                is_property = any(getattr(d, "id", "") == "property" for d in member.decorator_list)
                compiled = vars(kind)[name]
                self.assertEqual(is_property, isinstance(compiled, property), name)
                by_others = name == "__init__" and node.name in ("Scene", "Trace")  # which Python does not make
                if is_property or name == "step" or by_others:
                    continue
                self.assertEqual(parameters(member), compiled_parameters(getattr(kind, name)), f"{node.name}.{name}")
                checked += 1
        self.assertGreater(checked, 25)
        self.assertEqual(list(inspect.signature(_core.Renderer.step).parameters), ["self", "hip"])

    def test_everything_has_a_docstring(self):
        for name in ("Cloud", "Renderer", "Scene", "Trace"):
            kind = getattr(_core, name)
            self.assertGreater(len(kind.__doc__), 60, name)
            for member, value in vars(kind).items():
                if not member.startswith("_"):
                    text = value.__doc__
                    self.assertTrue(text and len(text.split("\n", 1)[-1]) > 8, f"{name}.{member}: {text}")
        for name in sparsha.__all__:
            if inspect.isbuiltin(getattr(sparsha, name)):
                self.assertIn("Raises", getattr(sparsha, name).__doc__, name)


@unittest.skipUnless(importlib.util.find_spec("mypy"), "mypy is of the nightly run (python3-mypy)")
class ByMypy(unittest.TestCase):
    def run_module(self, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            environment = {**os.environ, "MYPYPATH": str(STUB.parents[1]), "MYPY_CACHE_DIR": folder}
            done = subprocess.run([sys.executable, "-m", *arguments], cwd=folder, env=environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    @unittest.skipUnless(os.environ.get("SPARSHA_NIGHTLY") == "1", "of the nightly run")
    def test_stubtest_finds_nothing(self):
        with tempfile.NamedTemporaryFile("w", suffix=".txt") as allowed:
            allowed.write("sparsha.libsparsha_opencv_images  # a library that the module loads, and no module\n")
            allowed.flush()
            self.run_module("mypy.stubtest", "sparsha", "--ignore-unused-allowlist", "--allowlist", allowed.name)

    @unittest.skipUnless(os.environ.get("SPARSHA_NIGHTLY") == "1", "of the nightly run")
    def test_the_package_has_the_types_that_it_says(self):
        self.run_module("mypy", "--strict", "-p", "sparsha")

    @unittest.skipUnless(os.environ.get("SPARSHA_NIGHTLY") == "1", "of the nightly run")
    def test_a_script_of_a_user_has_the_types_that_it_expects(self):
        self.run_module("mypy", "--strict", "-c", USER)


USER = """
import numpy as np
import numpy.typing as npt
import sparsha

def touched(files: list[str]) -> npt.NDArray[np.float64]:
    cloud: sparsha.Cloud = sparsha.read(files, units="mm", progress=lambda stage, share: print(stage, share))
    scene: sparsha.Scene = sparsha.build(cloud, config={"grid": {"spacing_mm": 1}}, out="a.scene")
    heights: npt.NDArray[np.float32] = scene.heights(0)
    texture = scene.texture()
    if texture is not None:
        heights = heights - texture
    renderer = sparsha.Renderer(scene, frame="scan", stiffness=500.0)
    proxy, force = renderer.step((0.0, 0.0, 0.1))
    trace: sparsha.Trace = renderer.trace([[0, 0, 1.0]], progress=None)
    try:
        trace.save("t.csv")
    except sparsha.Error as error:
        print(error.file or "", error.expected)
    return trace.force + proxy + force
"""


if __name__ == "__main__":
    unittest.main()
