"""Known surfaces and what judges them, by NumPy alone."""
import numpy as np


def wave(x, y):
    """A height of some millimetres, metres."""
    return 0.004 * np.sin(70 * x) * np.cos(50 * y) + 0.02 * x


def wave_points(nx=150, ny=120, step=0.001, seed=1):
    """Points on the wave, uneven, (n, 3) metres."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(step * np.arange(nx), step * np.arange(ny))
    x = x + rng.uniform(-0.3, 0.3, x.shape) * step
    y = y + rng.uniform(-0.3, 0.3, y.shape) * step
    return np.stack([x, y, wave(x, y)], axis=-1).reshape(-1, 3)


WAVE = {"grid": {"spacing_mm": 1}, "texture": {"sigma_space_mm": 4, "sigma_range_mm": 1},
        "friction": {"law": "curvature"}}


def nodes(scene, level=0):
    """x and y of the nodes of a level, grid frame, metres: each (ny, nx)."""
    ny, nx = scene.shape(level)
    step = scene.spacing(level)
    return np.meshgrid(scene.origin[0] + step * np.arange(nx), scene.origin[1] + step * np.arange(ny))
