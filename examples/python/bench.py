"""The bench judged from Python: forces of one's own renderer against the truth of the open benchmark.

  PYTHONPATH=build/python /usr/bin/python3 examples/python/bench.py --out pictures"""
import csv

import numpy as np
import sparsha
from sparsha import opinion

import picture

options = picture.arguments(__doc__)
folder = options.out / "bench"
sparsha.bench_export(folder)


def straight_down(spline, hands, stiffness):
    """A renderer of one's own, as many are written first: the spring pulls straight up to the surface."""
    depth = np.maximum(spline(hands[:, 0], hands[:, 1])[0] - hands[:, 2], 0)
    return stiffness * depth[:, None] * [0, 0, 1]


errors = {}
for name, renderer in (("nearest point", opinion.forces), ("straight down", straight_down)):
    results = options.out / f"{name.replace(' ', '-')}.csv"
    with open(folder / "cases.csv", encoding="ascii") as file, open(results, "w", encoding="ascii") as out:
        out.write("case,t_s,force_x_n,force_y_n,force_z_n\n")
        for case in csv.DictReader(file):
            spline = opinion.Spline(opinion.read_nodes(folder / "surfaces" / f"{case['surface']}.ply"))
            path = np.loadtxt(folder / "paths" / f"{case['case']}.csv", delimiter=",", skiprows=1)
            for time, force in zip(path[:, 0], renderer(spline, path[:, 1:], float(case["stiffness_n_per_m"]))):
                out.write(f"{case['case']},{time:.17g},{force[0]:.17g},{force[1]:.17g},{force[2]:.17g}\n")
    verdict = sparsha.bench_judge(folder, results)
    errors[name] = [case["error_median"] for case in verdict]
    print(f"{name}: {sum(case['pass'] for case in verdict)} of {len(verdict)} cases pass")
    for case in verdict:
        print(f"  {case['case']:14} median error {case['error_median']:.1e}; an error can be felt in {100 * case['felt']:.1f} % of the ticks")
picture.chart(options.out / "bench.svg", [case["case"] for case in verdict], errors, "Two renderers judged by the open benchmark",
              "case", "median error of the force, as a share", power=True)
