#!/usr/bin/env python3
"""Bias and spread of every feature of scenarios/blade_inspection.yaml over virtual inspections with different seeds.

    bench/inspection_features.py build/release/trueblade --trials 200 --out results/inspection/features.csv

The truth is that of the virtual part: the nominal outline of each section (from result.json) moved along its normals by the
normal part of the form errors, as the simulation moves the surface, and measured without noise by its definition."""
import argparse
import concurrent.futures
import csv
import json
import math
import pathlib
import statistics
import subprocess
import tempfile

SCENARIO = pathlib.Path(__file__).parent.parent / "scenarios" / "blade_inspection.yaml"
ROOT_MM, TIP_MM, TIP_TWIST_RAD, BOW_MM = 3.0, 68.0, math.radians(0.3), 0.05  # as in the scenario


def inspect(program, seed):
    """Section features of one inspection: {(height, feature): (nominal, deviation, uncertainty)}, and the outlines."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "inspect", SCENARIO, "--seed", str(seed), "--out", folder], stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL, check=False)  # exit code 1: the profile does not conform
        result = json.loads((pathlib.Path(folder) / "result.json").read_text())
    features = {(s["height_mm"], f["name"]): (f["nominal"], f["deviation"], f["standard_uncertainty"])
                for s in result["sections"] for f in s["features"]}
    return features, {s["height_mm"]: s["outline_x_y_normal_deviation"] for s in result["sections"]}


def displacement(height, x, y):
    t = (height - ROOT_MM) / (TIP_MM - ROOT_MM)
    angle = TIP_TWIST_RAD * t
    return (math.cos(angle) * x - math.sin(angle) * y - x, math.sin(angle) * x + math.cos(angle) * y - y + bow(height))


def bow(height):
    t = (height - ROOT_MM) / (TIP_MM - ROOT_MM)
    return 4.0 * t * (1.0 - t) * BOW_MM


def maximum_chord(points):
    left = sorted(points)[: len(points) // 4]
    right = sorted(points)[-len(points) // 4:]
    return max((math.dist(a, b), a, b) for a in left for b in right)


def truth(outlines):
    """{(height, feature): deviation from nominal} of the virtual part, where it has a closed answer."""
    known = {}
    heights = sorted(outlines)
    for height, outline in outlines.items():
        nominal = [(x, y) for x, y, _, _, _ in outline]
        moved = []
        for x, y, nx, ny, _ in outline:
            dx, dy = displacement(height, x, y)
            along = dx * nx + dy * ny
            moved.append((x + along * nx, y + along * ny))
        before, after = maximum_chord(nominal), maximum_chord(moved)
        angle = lambda c: math.atan2(c[2][1] - c[1][1], c[2][0] - c[1][0])
        known[height, "chord"] = after[0] - before[0]
        known[height, "stagger"] = angle(after) - angle(before)
        known[height, "maximum_thickness"] = 0.0  # both touching points move together, to second order in 0.3 degrees
        known[height, "twist"] = TIP_TWIST_RAD * (height - ROOT_MM) / (TIP_MM - ROOT_MM)
        known[height, "displacement_x"] = 0.0
        known[height, "displacement_y"] = bow(height)
    for height in heights[1:-1]:
        t = (height - heights[0]) / (heights[-1] - heights[0])
        known[height, "bow_x"] = 0.0
        known[height, "bow_y"] = bow(height) - (1.0 - t) * bow(heights[0]) - t * bow(heights[-1])
    return known


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--trials", type=int, default=200)
    parser.add_argument("--out", default="results/inspection/features.csv")
    options = parser.parse_args()
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        trials = list(pool.map(lambda seed: inspect(options.program, seed), range(1, options.trials + 1)))
    known = truth(trials[0][1])
    with open(options.out, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["height_mm", "feature", "trials", "true_deviation", "mean_deviation", "bias", "spread",
                        "mean_stated_uncertainty"])
        for key in sorted(trials[0][0]):
            found = [t[0][key] for t in trials if key in t[0] and t[0][key][1] is not None]
            if len(found) < 2:
                table.writerow([*key, len(found), "", "", "", "", ""])
                continue
            deviations = [f[1] for f in found]
            mean, spread = statistics.mean(deviations), statistics.stdev(deviations)
            true = known.get(key)
            table.writerow([*key, len(found), "" if true is None else f"{true:.6f}", f"{mean:.6f}",
                            "" if true is None else f"{mean - true:.6f}", f"{spread:.6f}",
                            f"{statistics.mean(f[2] for f in found):.6f}"])


if __name__ == "__main__":
    main()
