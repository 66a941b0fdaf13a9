"""Pictures of the examples, by NumPy alone: reliefs as PNG, curves as SVG, which every browser shows."""
import argparse
import html
import pathlib
import struct
import sys
import zlib

import numpy as np

COLOURS = ("#0072b2", "#d55e00", "#00805e", "#a8487f")
MARKS = ("circle", "square", "diamond", "triangle")
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 760, 420, 70, 20, 40, 60  # pixels; the last four are margins


def arguments(text):
    """What every example takes: the folder for its pictures, and fewer ticks for a quick look."""
    parser = argparse.ArgumentParser(description=text.split("\n")[0])
    parser.add_argument("--out", default="pictures", type=pathlib.Path, help="folder for pictures")
    parser.add_argument("--quick", action="store_true", help="a coarser scene and a shorter path")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    return options


def sample(name):
    """A file of the sample scans: of the sources that this file lies in, or of the package `sparsha`."""
    here = pathlib.Path(__file__).resolve()  # examples/python, or share/doc/python3-sparsha/examples
    for place in (here.parents[2], here.parents[3] / "sparsha", pathlib.Path(sys.prefix) / "share/sparsha"):
        if (place / name).exists():
            return place / name
    sys.exit(f"{name} is not there; it comes with the sources and with the package sparsha")


def write_png(file, rgb):
    """(height, width, 3) uint8, the top row first."""
    height, width, _ = rgb.shape
    rows = np.hstack([np.zeros((height, 1), np.uint8), rgb.reshape(height, -1)]).tobytes()

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    pathlib.Path(file).write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
                                   + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def shaded(heights, spacing):
    """Heights (ny, nx) lit from the upper left, white where unknown: (ny, nx, 3) uint8, the top row first."""
    dy, dx = np.gradient(heights, spacing)
    light = np.clip((-dx * -0.5 + -dy * 0.5 + 0.7) / np.sqrt(1 + dx**2 + dy**2), 0, 1)
    grey = np.where(np.isfinite(light), 230 * np.nan_to_num(light), 255).astype(np.uint8)
    return np.repeat(grey[::-1, :, None], 3, axis=2)


def ticks(low, high):
    """Five to ten round numbers from low to high."""
    step = 10 ** np.floor(np.log10((high - low) / 5))
    step *= next(factor for factor in (1, 2, 5, 10) if (high - low) / (factor * step) <= 10)
    return step * np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1) + 0.0  # no -0


def mark(kind, x, y, colour):
    if kind == "circle":
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="{colour}"/>'
    corners = {"square": ((-5, -5), (5, -5), (5, 5), (-5, 5)), "diamond": ((0, -6), (6, 0), (0, 6), (-6, 0)),
               "triangle": ((0, -6), (6, 5), (-6, 5))}[kind]
    return f'<polygon points="{" ".join(f"{x + a:.1f},{y + b:.1f}" for a, b in corners)}" fill="{colour}"/>'


def chart(file, x, curves, title, xlabel, ylabel, power=False):
    """Curves {name: values} over x: numbers, or the names of cases, whose values are marks. power: of ten, along y."""
    cases = None if np.asarray(x).dtype.kind in "fiu" else list(x)
    x = np.arange(len(cases)) if cases else np.asarray(x, float)
    values = {name: np.log10(y) if power else np.asarray(y, float) for name, y in curves.items()}
    known = np.concatenate([y[np.isfinite(y)] for y in values.values()])
    low, high = known.min(), known.max()
    low, high = low - 0.05 * (high - low or 1), high + 0.05 * (high - low or 1)
    first, last = (-0.5, len(cases) - 0.5) if cases else (x.min(), x.max())

    def across(at):
        return LEFT + (np.asarray(at) - first) / (last - first) * (WIDTH - LEFT - RIGHT)

    def down(at):
        return HEIGHT - BOTTOM - (np.asarray(at) - low) / (high - low) * (HEIGHT - TOP - BOTTOM)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" role="img" '
             f'font-family="sans-serif" font-size="12"><title>{html.escape(title)}</title><rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>']
    for at in ticks(low, high):
        y = down(at)
        label = f'10<tspan dy="-5" font-size="9">{at:.0f}</tspan>' if power else f"{at:.6g}"
        parts.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y:.1f}" y2="{y:.1f}" stroke="#ddd"/>'
                     f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{label}</text>')
    for at, label in zip(x, cases) if cases else ((t, f"{t:.6g}") for t in ticks(first, last)):
        parts.append(f'<text x="{across(at):.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{html.escape(label)}</text>')
    parts.append(f'<rect x="{LEFT}" y="{TOP}" width="{WIDTH - LEFT - RIGHT}" height="{HEIGHT - TOP - BOTTOM}" fill="none" stroke="#555"/>'
                 f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 16}" text-anchor="middle">{html.escape(xlabel)}</text>'
                 f'<text transform="translate(18 {(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)" text-anchor="middle">{html.escape(ylabel)}</text>')
    for k, (name, y) in enumerate(values.items()):
        legend = LEFT + 8 + 160 * k
        if cases:
            parts += [mark(MARKS[k], a, b, COLOURS[k]) for a, b in zip(across(x), down(y))] + [mark(MARKS[k], legend + 10, 24, COLOURS[k])]
        else:
            finite = np.isfinite(y)
            points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(across(x[finite]), down(y[finite])))
            parts.append(f'<polyline points="{points}" fill="none" stroke="{COLOURS[k]}" stroke-width="1.2"/>'
                         f'<line x1="{legend}" x2="{legend + 20}" y1="24" y2="24" stroke="{COLOURS[k]}" stroke-width="3"/>')
        parts.append(f'<text x="{legend + 26}" y="28">{html.escape(name)}</text>')
    pathlib.Path(file).write_text("\n".join([*parts, "</svg>\n"]), encoding="utf-8")
