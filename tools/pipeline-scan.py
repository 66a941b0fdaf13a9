#!/usr/bin/env python3
"""Writes a scan of a made-up statue as a PLY file: on a floor that is not level, before a wall, beside a scaffold, with
noise and stray points. docs/use/pipeline.md shows what the filters make of it."""
import math
import random
import struct
import sys

NOISE_M = 0.0015
SEED = 11
TILT = math.radians(2.5)


class Ellipsoid:
    def __init__(self, centre, radii):
        self.centre, self.radii = centre, radii

    def inside(self, p):
        return sum(((p[k] - self.centre[k]) / self.radii[k]) ** 2 for k in range(3)) < 0.998

    def area(self):
        a, b, c = self.radii
        return 4 * math.pi * (((a * b) ** 1.6 + (a * c) ** 1.6 + (b * c) ** 1.6) / 3) ** (1 / 1.6)

    def sample(self, rng):
        d = [rng.gauss(0, 1) for _ in range(3)]
        n = math.sqrt(sum(v * v for v in d))
        return [self.centre[k] + self.radii[k] * d[k] / n for k in range(3)]


class Robe:
    """A cone with folds about the z axis."""

    def __init__(self, low, high, wide, narrow):
        self.low, self.high, self.wide, self.narrow = low, high, wide, narrow

    def radius(self, angle, z):
        t = (z - self.low) / (self.high - self.low)
        folds = 1 + 0.07 * (1 - t) * math.cos(11 * angle + 1.5 * t) + 0.02 * math.cos(5 * angle)
        return (self.wide + (self.narrow - self.wide) * math.sqrt(t)) * folds

    def inside(self, p):
        if not self.low < p[2] < self.high:
            return False
        return math.hypot(p[0], p[1] / 0.8) < 0.998 * self.radius(math.atan2(p[1] / 0.8, p[0]), p[2])

    def area(self):
        return math.pi * (self.wide + self.narrow) * (self.high - self.low)

    def sample(self, rng):
        angle, z = rng.uniform(-math.pi, math.pi), rng.uniform(self.low, self.high)
        r = self.radius(angle, z)
        return [r * math.cos(angle), 0.8 * r * math.sin(angle), z]


class Capsule:
    def __init__(self, a, b, radius):
        self.a, self.b, self.r = a, b, radius
        self.axis = [b[k] - a[k] for k in range(3)]
        self.length = math.sqrt(sum(v * v for v in self.axis))

    def inside(self, p):
        d = [p[k] - self.a[k] for k in range(3)]
        t = max(0.0, min(1.0, sum(d[k] * self.axis[k] for k in range(3)) / self.length**2))
        return sum((d[k] - t * self.axis[k]) ** 2 for k in range(3)) < (0.998 * self.r) ** 2

    def area(self):
        return 2 * math.pi * self.r * self.length

    def sample(self, rng):
        t = rng.random()
        d = [rng.gauss(0, 1) for _ in range(3)]
        along = sum(d[k] * self.axis[k] for k in range(3)) / self.length**2
        d = [d[k] - along * self.axis[k] for k in range(3)]
        n = math.sqrt(sum(v * v for v in d))
        return [self.a[k] + t * self.axis[k] + self.r * d[k] / n for k in range(3)]


class Box:
    def __init__(self, low, high):
        self.low, self.high = low, high

    def inside(self, p):
        return all(self.low[k] + 1e-4 < p[k] < self.high[k] - 1e-4 for k in range(3))

    def area(self):
        x, y, z = (self.high[k] - self.low[k] for k in range(3))
        return 2 * (x * y + y * z + x * z)

    def sample(self, rng):
        x, y, z = (self.high[k] - self.low[k] for k in range(3))
        p = [rng.uniform(self.low[k], self.high[k]) for k in range(3)]
        axis = rng.choices([0, 1, 2], [y * z, x * z, x * y])[0]
        p[axis] = rng.choice([self.low[axis], self.high[axis]])
        return p


def statue():
    parts = [Box([-0.27, -0.24, 0.0], [0.27, 0.24, 0.22]), Box([-0.24, -0.21, 0.22], [0.24, 0.21, 0.26])]
    parts += [Robe(0.26, 1.02, 0.235, 0.15)]
    parts += [Ellipsoid([0, 0, 1.08], [0.165, 0.115, 0.22]), Ellipsoid([0, 0, 1.23], [0.215, 0.095, 0.075])]
    parts += [Capsule([0, 0, 1.27], [0, -0.01, 1.38], 0.052)]
    parts += [Ellipsoid([0, -0.015, 1.455], [0.08, 0.098, 0.115]), Ellipsoid([0, 0.035, 1.50], [0.092, 0.09, 0.09])]
    parts += [Ellipsoid([0, -0.115, 1.445], [0.014, 0.022, 0.028])]  # nose
    parts += [Ellipsoid([0, 0.12, 1.47], [0.05, 0.05, 0.05])]
    for side in (-1, 1):
        parts += [Ellipsoid([0.2 * side, 0, 1.23], [0.058, 0.06, 0.062])]
        parts += [Capsule([0.2 * side, 0, 1.23], [0.25 * side, -0.05, 1.0], 0.047)]
        parts += [Ellipsoid([0.25 * side, -0.05, 1.0], [0.048, 0.048, 0.048])]
        parts += [Capsule([0.25 * side, -0.05, 1.0], [0.08 * side, -0.2, 1.06], 0.038)]
        parts += [Ellipsoid([0.07 * side, -0.215, 1.07], [0.035, 0.035, 0.045])]
    parts += [Ellipsoid([0, -0.225, 1.115], [0.1, 0.085, 0.06])]  # a bowl
    return parts


def scaffold():
    poles = [Capsule([x, y, -0.02], [x, y, 1.9], 0.024) for x, y in ((0.62, -0.35), (0.62, 0.45))]
    return poles + [Capsule([0.62, -0.35, 0.9], [0.62, 0.45, 0.9], 0.02), Capsule([0.62, -0.45, 1.5], [0.62, 0.55, 1.5], 0.02),
                    Capsule([0.62, -0.35, 0.1], [0.62, 0.45, 0.9], 0.02)]


def scan(rng):
    figure, poles = statue(), scaffold()
    points = []
    for part in figure + poles:
        others = [other for other in figure + poles if other is not part]
        for _ in range(int(part.area() * 75000)):
            p = part.sample(rng)
            if not any(other.inside(p) for other in others):
                points.append(p)
    for _ in range(70000):
        p = [rng.uniform(-1.4, 1.4), rng.uniform(-1.3, 1.0), 0.0]
        if not any(part.inside([p[0], p[1], 0.01]) for part in figure):
            points.append(p)
    points += [[rng.uniform(-1.4, 1.4), 1.0, rng.uniform(0.0, 1.9)] for _ in range(40000)]
    points = [[v + rng.gauss(0, NOISE_M) for v in p] for p in points]
    points += [[rng.uniform(-0.6, 0.6), rng.uniform(-0.6, 0.6), rng.uniform(0.1, 1.8)] for _ in range(250)]
    c, s = math.cos(TILT), math.sin(TILT)
    return [[x, c * y - s * z, s * y + c * z] for x, y, z in points]


def main():
    points = scan(random.Random(SEED))
    random.Random(SEED).shuffle(points)
    with open(sys.argv[1], "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(points))
        file.write(b"property float x\nproperty float y\nproperty float z\nend_header\n")
        for p in points:
            file.write(struct.pack("<3f", *p))


if __name__ == "__main__":
    main()
