"""A statue from scan to force: eight stations become a whole object, and a finger goes once around it.

  PYTHONPATH=build/python /usr/bin/python3 examples/python/statue.py --out pictures"""
import numpy as np
import sparsha

import picture

options = picture.arguments(__doc__)
config = picture.sample("configs/statue.yaml")
told = set()


def progress(stage, share):
    if stage not in told:
        told.add(stage)
        print(f"  {stage}")


scene = sparsha.build(config, progress=progress)
print(scene, "with", scene.sheets, "sheets")
check = scene.report["check"]["cloud_to_surface"]
print(f"front: the points lie {1e3 * check['median_m']:.3f} mm from the surface in the median")

# Once around at half the height of the points, from 4 mm outside of them to 1 mm inside.
cloud = sparsha.read(config)
points = cloud.points + cloud.origin
middle = np.median(points, axis=0)
ring = points[np.abs(points[:, 2] - middle[2]) < 0.004] - middle
angle = np.arctan2(ring[:, 1], ring[:, 0])
count = 3000 if options.quick else 20000
turn = np.linspace(-np.pi, np.pi, count)
bins = np.linspace(-np.pi, np.pi, 121)
radius = np.array([np.max(np.hypot(*ring[(angle >= a) & (angle < b), :2].T), initial=0) for a, b in zip(bins[:-1], bins[1:])])
radius = np.where(radius > 0, radius, np.median(radius[radius > 0]))
radius = np.interp(turn, 0.5 * (bins[:-1] + bins[1:]), radius, period=2 * np.pi) + 0.001 - np.clip(0.002 * np.linspace(0, 60, count), 0, 0.002)
path = middle + np.stack([radius * np.cos(turn), radius * np.sin(turn), np.zeros(count)], axis=-1)
trace = sparsha.Renderer(scene, frame="scan").trace(path)
print(f"{trace.contact.sum()} of {count} ticks touch, on {trace.summary['sheets_touched']} sheets, at most "
      f"{np.linalg.norm(trace.force, axis=1).max():.2f} N; a tick takes {trace.summary['ns_median']:.0f} ns in the median")

picture.write_png(options.out / "statue-front.png", picture.shaded(scene.heights(), scene.spacing()))
picture.chart(options.out / "statue-force.svg", np.degrees(turn), {"force": np.linalg.norm(trace.force, axis=1)},
              "The force on a finger that goes once around a statue", "around the statue, degrees", "force, newtons")
