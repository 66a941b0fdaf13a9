"""python3 -m sparsha [FOLDER]: a second opinion, by NumPy alone, on the forces of the open benchmark or of a scene.

FOLDER is what `sparsha bench export` wrote; without it the benchmark is exported to a folder that goes afterwards. Its cases
are rendered by NumPy and by the core, and judged. Of a scene's folder the core's proxies are judged by NumPy.
Exit code 0 when all passes, 1 when not, 2 for wrong arguments, 3 for files that cannot be read."""
from __future__ import annotations

import argparse
import os
import pathlib
import sys
import tempfile
from typing import Any

import numpy as np
import numpy.typing as npt

from . import Error, Renderer, bench_export, bench_judge, on_scene, opinion
from . import open as open_scene

_Array = npt.NDArray[np.float64]
_Surfaces = dict[str, tuple[_Array, float, tuple[float, float, float]]]  # heights, spacing and origin by name


def core_forces(folder: pathlib.Path, case: dict[str, str], surfaces: _Surfaces) -> tuple[_Array, _Array]:
    """The core's forces on bicubic patches through the case's nodes; (n, 3) newtons, and the times."""
    surface = case["surface"]
    if surface not in surfaces:
        nodes = opinion.read_nodes(folder / "surfaces" / f"{surface}.ply")
        x, y = np.unique(nodes[:, 0]), np.unique(nodes[:, 1])
        heights = np.empty((len(y), len(x)))
        heights[np.searchsorted(y, nodes[:, 1]), np.searchsorted(x, nodes[:, 0])] = nodes[:, 2]
        surfaces[surface] = heights, (x[-1] - x[0]) / (len(x) - 1), (x[0], y[0], 0)
    heights, spacing, origin = surfaces[surface]
    renderer = Renderer.of_heights(heights, spacing, origin=origin, surface="c1", stiffness=float(case["stiffness_n_per_m"]))
    path = opinion.read_path(folder / "paths" / f"{case['case']}.csv")
    return path[:, 0], renderer.trace(path[:, 1:4], time=path[:, 0]).force


def compare(folder: str | os.PathLike[str], work: str | os.PathLike[str]) -> list[tuple[dict[str, Any], dict[str, Any], float]]:
    """One row a case: the verdicts on NumPy's and the core's forces, and how far these are apart."""
    folder, work = pathlib.Path(folder), pathlib.Path(work)
    cases = opinion.render(folder, work / "numpy.csv")
    surfaces: _Surfaces = {}
    with open(work / "core.csv", "w", encoding="ascii") as out:
        out.write("case,t_s,force_x_n,force_y_n,force_z_n\n")
        for case in cases:
            for time, force in zip(*core_forces(folder, case, surfaces)):
                out.write(f"{case['case']},{time:.17g},{force[0]:.17g},{force[1]:.17g},{force[2]:.17g}\n")
    columns = (2, 3, 4)
    forces = [np.loadtxt(work / name, delimiter=",", skiprows=1, usecols=columns) for name in ("numpy.csv", "core.csv")]
    rows, first = [], 0
    for by_numpy, by_core, case in zip(bench_judge(folder, work / "numpy.csv"), bench_judge(folder, work / "core.csv"), cases):
        last = first + int(case["ticks"])
        one, other = (force[first:last] for force in forces)
        size = np.linalg.norm(one, axis=1)
        apart = np.linalg.norm(one - other, axis=1)[size > 0.5 * np.median(size[size > 0])]
        rows.append((by_numpy, by_core, float(np.median(apart / np.median(size[size > 0])))))
        first = last
    return rows


def scene_passes(folder: pathlib.Path, work: str) -> bool:
    """Judges the core's proxies on a scene and prints what was found; whether all of them pass."""
    scene = open_scene(folder)
    print(scene)
    view = on_scene.judge_view(scene)
    print(f"{'view':16} {'pass' if view['pass'] else 'no':5} {view['touching']} of {view['hands']} hands touch, {100 * view['at_rest']:.2f} % of "
          f"their proxies are at rest, {view['off_surface']:.1e} spacings from the surface at most")
    if not scene.sheets and "unroll:" not in scene.config:
        return bool(view["pass"])
    scan = on_scene.judge_scan_frame(scene, work)
    print(f"{'frame of scans':16} {'pass' if scan['pass'] else 'no':5} {scan['touching']} of {scan['hands']} hands touch, {scan['farthest']:.2f} "
          "spacings from their proxies to exported nodes at most")
    return bool(view["pass"] and scan["pass"])


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python3 -m sparsha", description=__doc__.split("\n")[0])
    parser.add_argument("folder", nargs="?", type=pathlib.Path,
                        help="of `sparsha bench export` (default: a new one that goes afterwards), or a scene")
    parser.add_argument("--out", help="the forces of NumPy as a results.csv for `sparsha bench judge`; nothing else is done")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as work:
        folder = options.folder
        if folder and (folder / "scene.yaml").exists():
            if options.out:
                parser.error("--out is of the benchmark; a scene has no results.csv")
            return 0 if scene_passes(folder, work) else 1
        if folder and not (folder / "cases.csv").exists():
            raise ValueError(f"{folder}: neither cases.csv nor scene.yaml is there; expected what `sparsha bench export` or `sparsha build` wrote")
        if folder is None:
            folder = pathlib.Path(work) / "bench"
            bench_export(folder)
        if options.out:
            opinion.render(folder, options.out)
            return 0
        rows = compare(folder, work)
    print(f"{'case':14} {'NumPy':7} {'median':>9} {'99 %':>9}   {'core':7} {'median':>9} {'99 %':>9}   apart")
    for by_numpy, by_core, apart in rows:
        print(by_numpy["case"].ljust(14), *(
            f"{'pass' if one['pass'] else 'no':7} {one['error_median']:9.2e} {one['error_p99']:9.2e}  "
            for one in (by_numpy, by_core)), f"{apart:.2e}")
    return 0 if all(by_numpy["pass"] for by_numpy, _, _ in rows) else 1


def run() -> int:
    """main(), and in place of a traceback a sentence of what cannot be read."""
    try:
        return main()
    except (Error, OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 3


if __name__ == "__main__":
    sys.exit(run())
