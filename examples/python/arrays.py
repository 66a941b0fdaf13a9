"""From arrays as Open3D has them: points, colours from 0 to 1, normals and triangles, without Open3D itself.

With Open3D: pcd = open3d.io.read_point_cloud(...); points, colors = pcd.points, pcd.colors.

  PYTHONPATH=build/python /usr/bin/python3 examples/python/arrays.py --out pictures"""
import numpy as np
import sparsha

import picture

options = picture.arguments(__doc__)
rng = np.random.default_rng(7)
count = 40000 if options.quick else 200000
x, y = rng.uniform(0, 0.2, count), rng.uniform(0, 0.15, count)
wave = 0.003 * np.sin(90 * x + 4 * np.sin(40 * y))
points = np.stack([x, y, wave + rng.normal(0, 5e-5, count)], axis=-1)
colors = np.stack([0.5 + 100 * wave, np.full(count, 0.4), 0.5 - 100 * wave], axis=-1)

cloud = sparsha.Cloud(points, colour=colors)
left, steps = cloud.filtered([{"outliers": {"neighbours": 8, "sigma": 3}}])
print(cloud, "->", left, steps)
scene = sparsha.build(left, config={"grid": {"spacing_mm": 1.5 if options.quick else 0.8, "colour": True}, "fill": {"max_gap_mm": 5}, "check": {}})
rms = scene.report["check"]["cloud_to_surface"]["rms_m"]
grid_x = scene.origin[0] + scene.spacing() * np.arange(scene.shape()[1])
grid_y = scene.origin[1] + scene.spacing() * np.arange(scene.shape()[0])
truth = 0.003 * np.sin(90 * grid_x[None, :] + 4 * np.sin(40 * grid_y[:, None]))
inner = (slice(5, -5), slice(5, -5))
error = np.abs(scene.heights() + scene.origin[2] - truth)[inner]
print(f"{scene}: points {1e6 * rms:.0f} um from the surface (RMS), the surface {1e6 * np.nanmedian(error):.0f} um from the truth (median)")
renderer = sparsha.Renderer(scene, stiffness=800)
proxy, force = renderer.step((0.1, 0.07, scene.origin[2] + 0.02))
for z in np.linspace(0.02, -0.004, 200):
    proxy, force = renderer.step((0.1, 0.07, z))
print(f"a finger at 4 mm below zero is held at {1e3 * proxy[2]:.2f} mm with {np.round(force, 2)} N")
colour = scene.colour()[::-1]  # no point, no colour: filled nodes have none, and are white here
picture.write_png(options.out / "arrays-colour.png", np.where(colour[:, :, 3:] > 0, colour[:, :, :3], np.uint8(255)))
picture.write_png(options.out / "arrays-relief.png", picture.shaded(scene.heights(), scene.spacing()))
