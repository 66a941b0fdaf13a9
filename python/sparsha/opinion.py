"""A second opinion on forces: a renderer of the open benchmark (protocol.md) in NumPy alone, without a line of the core.

The surface is a bicubic spline through the nodes of surfaces/NAME.ply; the proxy of a hand below it is the nearest point,
found by Newton's method for all ticks of a path at once. It has neither grid, cells nor a path from tick to tick."""
from __future__ import annotations

import csv
import os
import pathlib
import warnings

import numpy as np
import numpy.typing as npt

_Array = npt.NDArray[np.float64]


def read_nodes(path: str | os.PathLike[str]) -> _Array:
    """The vertices of a binary little-endian PLY with double x, y, z: (n, 3)."""
    data = pathlib.Path(path).read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode("ascii").split("\n")
    if header[0] != "ply" or "format binary_little_endian 1.0" not in header:
        raise ValueError(f"{path}: no binary little-endian PLY")
    count = next((int(line.split()[2]) for line in header if line.startswith("element vertex ")), 0)
    before_faces = header[:next((n for n, line in enumerate(header) if line.startswith("element face")), len(header))]
    names = [line.split()[1:] for line in before_faces if line.startswith("property")]
    kinds = {"double": "<f8", "float": "<f4", "uchar": "u1", "int": "<i4", "uint": "<u4"}
    unknown = [" ".join(name) for name in names if len(name) != 2 or name[0] not in kinds]
    if unknown or not {"x", "y", "z"} <= {name[1] for name in names}:
        raise ValueError(f"{path}: expected x, y and z, and properties of {', '.join(kinds)}" + "".join(f"; found {n}" for n in unknown))
    if count == 0:
        raise ValueError(f"{path}: no vertices")
    rows = np.frombuffer(data, np.dtype([(name, kinds[kind]) for kind, name in names]), count, end)
    nodes: _Array = np.stack([rows["x"], rows["y"], rows["z"]], axis=-1).astype(float)
    return nodes


def read_path(file: str | os.PathLike[str]) -> _Array:
    """Time, x, y and z of a hand: (n, 4) or more columns."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of an empty file, which is refused below
        path: _Array = np.loadtxt(file, delimiter=",", skiprows=1, ndmin=2)
    if path.shape[0] == 0 or path.shape[1] < 4:
        raise ValueError(f"{file}: expected rows of a time and a place")
    return path


def read_cases(folder: str | os.PathLike[str]) -> list[dict[str, str]]:
    """The rows of cases.csv."""
    path = pathlib.Path(folder) / "cases.csv"
    with open(path, encoding="ascii") as file:
        rows = list(csv.DictReader(file))
    needed = ("case", "surface", "stiffness_n_per_m", "ticks")
    if not rows or any(row.get(name) is None for row in rows for name in needed):
        raise ValueError(f"{path}: expected cases with {', '.join(needed)}")
    return rows


def slopes(values: _Array, step: float) -> _Array:
    """Of a cubic spline through equidistant values along the first axis, whose third derivative has no jump at the
    second and the last but one of them: its slopes there."""
    count = len(values)
    matrix = np.zeros((count, count))
    right = np.zeros_like(values)
    inner = np.arange(1, count - 1)
    matrix[inner, inner - 1] = matrix[inner, inner + 1] = 1
    matrix[inner, inner] = 4
    right[1:-1] = 3 * (values[2:] - values[:-2]) / step
    matrix[0, :2] = 1, 2
    matrix[-1, -2:] = 2, 1
    right[0] = (-5 * values[0] + 4 * values[1] + values[2]) / (2 * step)
    right[-1] = (5 * values[-1] - 4 * values[-2] - values[-3]) / (2 * step)
    return np.linalg.solve(matrix, right)


class Spline:
    """z = f(x, y) and its derivatives, from nodes on a regular grid in any order."""

    def __init__(self, nodes: _Array) -> None:
        if not np.isfinite(nodes).all():
            raise ValueError("some nodes are not finite")
        x, column = np.unique(np.round(nodes[:, 0], 9), return_inverse=True)
        y, row = np.unique(np.round(nodes[:, 1], 9), return_inverse=True)
        if len(x) < 4 or len(y) < 4:
            raise ValueError("the nodes are no grid of 4 x 4 or more")
        self.x0, self.y0 = x[0], y[0]
        self.dx, self.dy = (x[-1] - x[0]) / (len(x) - 1), (y[-1] - y[0]) / (len(y) - 1)
        f = np.full((len(x), len(y)), np.nan)
        f[column, row] = nodes[:, 2]
        if np.isnan(f).any():
            raise ValueError("the nodes are no full grid")
        fx = slopes(f, self.dx)
        fy = slopes(f.T, self.dy).T
        fxy = slopes(fy, self.dx)
        self.parts = f, fx * self.dx, fy * self.dy, fxy * self.dx * self.dy

    @staticmethod
    def _basis(t: _Array) -> tuple[_Array, _Array, _Array]:
        """Hermite's polynomials (value at 0 and 1, slope at 0 and 1), their first and second derivatives."""
        return (np.stack([1 - 3 * t**2 + 2 * t**3, 3 * t**2 - 2 * t**3, t - 2 * t**2 + t**3, t**3 - t**2]),
                np.stack([-6 * t + 6 * t**2, 6 * t - 6 * t**2, 1 - 4 * t + 3 * t**2, 3 * t**2 - 2 * t]),
                np.stack([-6 + 12 * t, 6 - 12 * t, -4 + 6 * t, 6 * t - 2]))

    def __call__(self, x: _Array, y: _Array) -> tuple[_Array, ...]:
        """f, fx, fy, fxx, fxy, fyy."""
        f, fx, fy, fxy = self.parts
        u, v = (x - self.x0) / self.dx, (y - self.y0) / self.dy
        i = np.clip(np.floor(u).astype(int), 0, f.shape[0] - 2)
        j = np.clip(np.floor(v).astype(int), 0, f.shape[1] - 2)
        along, across = self._basis(u - i), self._basis(v - j)
        corner = np.empty((4, 4, *np.shape(u)))
        for a in (0, 1):
            for b in (0, 1):
                at = i + a, j + b
                corner[a, b], corner[2 + a, b] = f[at], fx[at]
                corner[a, 2 + b], corner[2 + a, 2 + b] = fy[at], fxy[at]

        def derivative(m: int, n: int) -> _Array:
            value: _Array = np.einsum("a...,ab...,b...->...", along[m], corner, across[n]) / (self.dx**m * self.dy**n)
            return value
        return (derivative(0, 0), derivative(1, 0), derivative(0, 1), derivative(2, 0), derivative(1, 1), derivative(0, 2))


def forces(spline: Spline, hands: _Array, stiffness: float) -> _Array:
    """Of a hand at the end of a spring, for all hands (n, 3) at once: (n, 3) newtons."""
    x, y = hands[:, 0].copy(), hands[:, 1].copy()
    below = hands[:, 2] < spline(x, y)[0]
    for _ in range(60):
        f, fx, fy, fxx, fxy, fyy = spline(x, y)
        away = f - hands[:, 2]
        gx, gy = x - hands[:, 0] + away * fx, y - hands[:, 1] + away * fy
        a, b, c = 1 + fx**2 + away * fxx, fx * fy + away * fxy, 1 + fy**2 + away * fyy
        # Where the distance is not convex, the part of it without second derivatives of f, which always is.
        bend = (a <= 0) | (a * c - b * b <= 1e-3)
        a, b, c = np.where(bend, 1 + fx**2, a), np.where(bend, fx * fy, b), np.where(bend, 1 + fy**2, c)
        size = a * c - b * b
        sx, sy = (c * gx - b * gy) / size, (a * gy - b * gx) / size
        most = np.maximum(np.hypot(sx, sy) / 0.01, 1)
        x, y = x - sx / most, y - sy / most
        if np.abs(np.stack([sx, sy])).max(initial=0) < 1e-13:
            break
    proxies = np.stack([x, y, spline(x, y)[0]], -1)
    return np.where(below[:, None], stiffness * (proxies - hands), 0.0)


def render(folder: str | os.PathLike[str], results: str | os.PathLike[str]) -> list[dict[str, str]]:
    """Renders every case of an exported benchmark and writes results.csv for `sparsha bench judge`."""
    folder = pathlib.Path(folder)
    splines = {}
    cases = read_cases(folder)
    with open(results, "w", encoding="ascii") as out:
        out.write("case,t_s,force_x_n,force_y_n,force_z_n\n")
        for case in cases:
            surface = case["surface"]
            if surface not in splines:
                splines[surface] = Spline(read_nodes(folder / "surfaces" / f"{surface}.ply"))
            path = read_path(folder / "paths" / f"{case['case']}.csv")
            found = forces(splines[surface], path[:, 1:4], float(case["stiffness_n_per_m"]))
            for time, force in zip(path[:, 0], found):
                out.write(f"{case['case']},{time:.17g},{force[0]:.17g},{force[1]:.17g},{force[2]:.17g}\n")
    return cases
