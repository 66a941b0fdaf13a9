"""Pictures of the examples: by Matplotlib where it is, else a plain PNG of the same data."""
import argparse
import pathlib
import struct
import zlib

import numpy as np

try:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
except ImportError:
    pyplot = None


def arguments(text):
    """What every example takes: the folder for its pictures, and fewer ticks for a quick look."""
    parser = argparse.ArgumentParser(description=text.split("\n")[0])
    parser.add_argument("--out", default="pictures", type=pathlib.Path, help="folder for pictures")
    parser.add_argument("--quick", action="store_true", help="a coarser scene and a shorter path")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    return options


def write_png(file, rgb):
    """(height, width, 3) uint8, the top row first."""
    height, width, _ = rgb.shape
    rows = np.hstack([np.zeros((height, 1), np.uint8), rgb.reshape(height, -1)]).tobytes()

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    pathlib.Path(file).write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
                                   + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def shaded(heights, spacing):
    """Heights (ny, nx) lit from the upper left: (ny, nx, 3) uint8, the top row first."""
    dy, dx = np.gradient(heights, spacing)
    light = (-dx * -0.5 + -dy * 0.5 + 0.7) / np.sqrt(1 + dx**2 + dy**2)
    grey = np.nan_to_num(np.clip(light, 0, 1) * 255).astype(np.uint8)
    return np.repeat(grey[::-1, :, None], 3, axis=2)


def lines(file, x, curves, xlabel, ylabel):
    """Curves {name: y} over x."""
    if pyplot:
        figure, axes = pyplot.subplots(figsize=(7, 4))
        for name, y in curves.items():
            axes.plot(x, y, label=name, linewidth=1)
        axes.set_xlabel(xlabel)
        axes.set_ylabel(ylabel)
        axes.legend()
        figure.savefig(file, dpi=110)
        pyplot.close(figure)
        return
    colours = ((0, 114, 178), (213, 94, 0), (0, 128, 94), (168, 72, 127))
    rgb = np.full((320, 640, 3), 255, np.uint8)
    values = np.concatenate([np.asarray(y, float) for y in curves.values()])
    low, high = np.nanmin(values), np.nanmax(values)
    columns = np.clip((np.asarray(x) - x[0]) / (x[-1] - x[0]) * 639, 0, 639).astype(int)
    for colour, y in zip(colours, curves.values()):
        rows = 310 - (np.asarray(y, float) - low) / max(high - low, 1e-30) * 300
        for k in range(1, len(rows)):
            if np.isfinite(rows[k - 1:k + 1]).all():
                first, last = sorted((int(rows[k - 1]), int(rows[k])))
                rgb[first:last + 1, columns[k]] = colour
    write_png(file, rgb)
