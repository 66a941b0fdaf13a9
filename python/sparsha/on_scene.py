"""A second opinion on the forces of a scene, in NumPy alone.

A proxy at rest without friction lies on the bilinear surface through the nodes, nearer to the hand than all places around
it. Hands are put below places that are known all around, and the core's proxies are judged by many places around each. Of
whole and unrolled objects, proxies in the frame of the scans are besides held against the nodes that are exported there."""
from __future__ import annotations

import os
import pathlib
from typing import Any

import numpy as np
import numpy.typing as npt

from . import Renderer, Scene, export, read

_Array = npt.NDArray[np.float64]

AROUND = 4  # cells around a hand that are to be known
TOUCHING, TOUCHING_SCANS = 0.95, 0.5  # of the hands: a hand from outside may meet another side of an object first
DEPTH = 0.3  # of the hands, in spacings
REACH, STEPS = 0.002, 21  # of the places around a proxy that are tried: spacings, and their number in each direction
REST = 1e-5  # spacings by which one of them may be nearer: a third of a degree of tilt within REACH
SHARE = 0.99  # of the rests; beyond a crease that is nearer than REACH the surface may come nearer to the hand again
FARTHEST = 1.5  # spacings from a proxy to the next exported node: half a diagonal of a cell on a slope of 60 degrees


def bilinear(z: _Array, u: _Array, v: _Array) -> _Array:
    """Height at column u and row v, in spacings from node (0, 0)."""
    i = np.clip(np.floor(u).astype(int), 0, z.shape[1] - 2)
    j = np.clip(np.floor(v).astype(int), 0, z.shape[0] - 2)
    a, b = u - i, v - j
    height: _Array = (1 - b) * ((1 - a) * z[j, i] + a * z[j, i + 1]) + b * ((1 - a) * z[j + 1, i] + a * z[j + 1, i + 1])
    return height


def hands(scene: Scene, count: int, seed: int) -> tuple[_Array, _Array]:
    """Places of the surface (grid frame) with known nodes all around, and hands below them along the normal: each (n, 3)."""
    z = np.asarray(scene.heights(), float)
    known = np.isfinite(z)
    inner = known.copy()
    for k in range(1, AROUND + 1):
        for axis in (0, 1):
            for shift in (-k, k):
                inner &= np.roll(known, shift, axis)
    inner[:AROUND], inner[-AROUND:], inner[:, :AROUND], inner[:, -AROUND:] = False, False, False, False
    rows, columns = np.nonzero(inner)
    rng = np.random.default_rng(seed)
    chosen = rng.integers(0, len(rows), count) if len(rows) else np.empty(0, int)
    u, v = columns[chosen] + rng.uniform(-0.5, 0.5, len(chosen)), rows[chosen] + rng.uniform(-0.5, 0.5, len(chosen))
    step = scene.spacing()
    slope = [(bilinear(z, u + 1e-3 * a, v + 1e-3 * b) - bilinear(z, u - 1e-3 * a, v - 1e-3 * b)) / (2e-3 * step) for a, b in ((1, 0), (0, 1))]
    normal = np.stack([-slope[0], -slope[1], np.ones(len(u))], -1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    places = scene.origin + np.stack([u * step, v * step, bilinear(z, u, v)], -1)
    return places, places - DEPTH * step * normal


def judge_view(scene: Scene, count: int = 400, seed: int = 1) -> dict[str, Any]:
    """How the core's rests on the view compare with what NumPy finds around them, as a dict."""
    if "surface: c1" in scene.config:
        raise ValueError("the scene is touched as bicubic patches (haptics: surface: c1); bilinear surfaces alone are judged")
    step, z = scene.spacing(), np.asarray(scene.heights(), float)
    renderer = Renderer(scene, friction=False, stiffness=1.0, solver="exact")
    off: list[float] = []
    excess: list[float] = []
    touching = 0
    offsets = np.linspace(-REACH, REACH, STEPS)
    du, dv = np.meshgrid(offsets, offsets)
    for hand in hands(scene, count, seed)[1]:
        renderer.reset()
        proxy, force = renderer.step(hand)
        touching += renderer.contact
        if not renderer.contact:
            continue
        u, v, _ = (proxy - scene.origin) / step
        off.append(abs(proxy[2] - scene.origin[2] - bilinear(z, u, v)))
        around = scene.origin + np.stack([(u + du) * step, (v + dv) * step, bilinear(z, u + du, v + dv)], -1)
        nearest = np.linalg.norm(around - hand, axis=-1).min()
        excess.append(max(0.0, np.linalg.norm(proxy - hand) - nearest, np.linalg.norm(force - (proxy - hand))))
    at_rest = float(np.mean(np.array(excess) < REST * step)) if excess else 0.0
    off_surface = float(np.max(off, initial=0) / step)
    return {"hands": count, "touching": int(touching), "off_surface": off_surface, "at_rest": at_rest,
            "pass": touching > TOUCHING * count and off_surface < REST and at_rest >= SHARE}


def judge_scan_frame(scene: Scene, work: str | os.PathLike[str], count: int = 400, seed: int = 2) -> dict[str, Any]:
    """How far proxies in the frame of the scans lie from the nodes that are exported there, as a dict; distances in spacings."""
    file = pathlib.Path(work) / "nodes.ply"
    export(scene, file, nodes=True)
    cloud = read(file)
    nodes = np.asarray(cloud.points, float) + cloud.origin
    scale = np.cbrt(abs(np.linalg.det(scene.scan_from_grid[:3, :3])))
    step = scene.spacing() * scale
    inside = nodes.mean(axis=0)
    rng = np.random.default_rng(seed)
    distances: list[float] = []
    touching = 0
    renderer = Renderer(scene, frame="scan", friction=False)
    for node in nodes[rng.integers(0, len(nodes), count)]:
        outwards = (node - inside) / np.linalg.norm(node - inside)
        trace = renderer.trace(node + step * np.linspace(3, -DEPTH, 12)[:, None] * outwards)
        if trace.contact[-1]:
            touching += 1
            distances.append(np.linalg.norm(nodes - trace.proxy[-1], axis=1).min() / step)
    farthest = float(np.max(distances, initial=0))
    return {"hands": count, "touching": touching, "farthest": farthest, "pass": touching > TOUCHING_SCANS * count and farthest < FARTHEST}
