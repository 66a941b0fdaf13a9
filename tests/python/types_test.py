"""The stubs, the docstrings and the compiled module say the same."""
import ast
import inspect
import pathlib
import re
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
        names = {n.name for n in self.tree.body if isinstance(n, (ast.ClassDef, ast.FunctionDef))}
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
            if not isinstance(node, ast.ClassDef):
                continue
            kind = getattr(_core, node.name)
            stated = {m.name: m for m in node.body if isinstance(m, ast.FunctionDef)}
            own = {n for n in vars(kind) if not n.startswith("_")} | (SHOWN_SPECIAL & set(vars(kind)))
            if node.name in ("Scene", "Trace"):
                own.discard("__init__")  # of pybind11, for a class that Python does not make
            self.assertEqual(set(stated), own, node.name)
            for name, member in stated.items():
                is_property = any(getattr(d, "id", "") == "property" for d in member.decorator_list)
                compiled = vars(kind)[name]
                self.assertEqual(is_property, isinstance(compiled, property), name)
                if is_property or name == "step":
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


if __name__ == "__main__":
    unittest.main()
