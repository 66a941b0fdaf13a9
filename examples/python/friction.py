"""Friction laws compared: one relief, one stroke, and what each law holds against the finger.

  PYTHONPATH=build/python /usr/bin/python3 examples/python/friction.py --out pictures"""
import numpy as np
import sparsha

import picture

options = picture.arguments(__doc__)
config = picture.sample("data/relief/sparsha.yaml")
size = 200 if options.quick else 400
laws = {"frictionless": None, "constant": {"law": "constant", "mu_0": 0.3},
        "curvature": {"law": "curvature", "mu_0": 0.2, "mu_max": 0.5}, "paper": {"law": "paper", "mu_max": 0.5}}
along, curves = None, {}
for name, friction in laws.items():
    scene = sparsha.build(config, grid={"size": size}, texture={"sigma_space_mm": 4, "sigma_range_mm": 1},
                          **({"friction": friction} if friction else {}))
    ny, nx = scene.shape()
    x0, y0, z0 = scene.origin
    # A stroke of 45 mm along the middle row, 1 mm below the surface.
    row = scene.heights()[ny // 2]
    known = np.flatnonzero(np.isfinite(row))
    count = 4000 if options.quick else 20000
    x = x0 + scene.spacing() * nx / 2 + np.linspace(-0.0225, 0.0225, count)
    ground = np.interp(x, x0 + scene.spacing() * known, row[known])
    path = np.stack([x, np.full(count, y0 + scene.spacing() * (ny // 2)), z0 + ground - 0.001], axis=-1)
    trace = sparsha.Renderer(scene, friction=friction is not None, stiffness=500).trace(path)
    along = x - x[0]
    curves[name] = -trace.force[:, 0]
    held = np.abs(trace.force[:, 0]).mean() / np.linalg.norm(trace.force, axis=1).mean()
    drawn = "no coefficients" if scene.friction() is None else "mu_dynamic {:.2f} to {:.2f}".format(
        *np.nanpercentile(scene.friction()[0][scene.mask() > 0], [5, 95]))
    print(f"{name:13} {held:5.2f} of the force is along the stroke; {drawn}")
picture.chart(options.out / "friction.svg", 1e3 * along, curves, "One stroke over a relief under four laws of friction",
              "along the stroke, mm", "force against the stroke, N")
