#!/usr/bin/env python3
"""Bias and spread of the section features and the airfoil's offset of scenarios/blade_inspection.yaml over virtual
inspections with different seeds.

    bench/inspection_features.py build/release/trueblade --trials 200 --spacing 0.3 --out results/inspection/features.csv

The truth is that of accuracy studies (inspection/known_section.h for sections): what an inspection finds less the error that
a study states for the same inspection, taken once from a dense scan without noise, where every feature has a number."""
import argparse
import concurrent.futures
import csv
import json
import pathlib
import re
import statistics
import subprocess
import tempfile

SCENARIO = pathlib.Path(__file__).resolve().parent.parent / "scenarios" / "blade_inspection.yaml"
NOISE_FREE = "    sensor: {noise_scale: 0, spot_noise: 0, spot_scale: 0}\n"
STUDY = """name: truth
description: One inspection and its errors
scenario: {scenario}
seed: {seed}
trials: 1
cases: [{{name: all}}]
headline: section_35_twist_error_rad
"""


def run(*command):
    subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)  # 1: does not conform


def write_scenario(file, spacing, noise_free=False):
    text = re.sub(r"spacing_mm: .*", f"spacing_mm: {spacing:g}", SCENARIO.read_text())
    if noise_free:
        text = text.replace("  simulation:\n", "  simulation:\n" + NOISE_FREE)
    file.write_text(text)


def inspect(program, scenario, seed):
    """One inspection: {(place, feature): (deviation, standard uncertainty)}; place is a height or a group of surfaces."""
    with tempfile.TemporaryDirectory() as folder:
        run(program, "inspect", scenario, "--seed", str(seed), "--out", folder)
        result = json.loads((pathlib.Path(folder) / "result.json").read_text())
    found = {(f"{s['height_mm']:g}", f"{f['name']}_{f['unit']}"): (f["deviation"], f["standard_uncertainty"])
             for s in result["sections"] for f in s["features"]}
    for offset in result["offsets"]:
        for name, component in offset["components"].items():
            found[offset["of"], name] = (component["value"], component["standard_uncertainty"])
    return found


def truth(program, folder):
    scenario, study, seed = folder / "dense.yaml", folder / "truth.yaml", 1
    write_scenario(scenario, 0.15, noise_free=True)
    study.write_text(STUDY.format(scenario=scenario, seed=seed))
    run(program, "study", study, "--csv", "--out", folder / "truth")
    with open(folder / "truth" / "trials.csv", newline="") as file:
        errors = next(csv.DictReader(file))
    known = {}
    for (place, feature), (deviation, _) in inspect(program, scenario, seed).items():
        name, unit = feature.rsplit("_", 1)
        kind = f"section_{place}" if place[0].isdigit() else f"offset_{place}"
        error = errors.get(f"part.{kind}_{name}_error_{unit}")
        if error and deviation is not None:
            known[place, feature] = deviation - float(error)
    return known


def write_table(out, trials, known):
    with open(out, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["place", "feature", "trials", "true", "mean", "bias", "spread", "mean_stated_uncertainty"])
        for key in trials[0]:
            found = [trial[key] for trial in trials if trial.get(key, (None,))[0] is not None]
            if len(found) < 2:
                table.writerow([*key, len(found), "", "", "", "", ""])
                continue
            values = [value for value, _ in found]
            mean, spread = statistics.mean(values), statistics.stdev(values)
            true = known.get(key)
            table.writerow([*key, len(found), "" if true is None else f"{true:.6f}", f"{mean:.6f}",
                            "" if true is None else f"{mean - true:.6f}", f"{spread:.6f}",
                            f"{statistics.mean(u for _, u in found):.6f}"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument("--trials", type=int, default=200)
    parser.add_argument("--spacing", type=float, default=0.3, help="mm between the points of all views")
    parser.add_argument("--out", default="results/inspection/features.csv")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name, concurrent.futures.ThreadPoolExecutor(2) as pool:
        folder = pathlib.Path(name)
        known = truth(options.program, folder)
        write_scenario(folder / "scenario.yaml", options.spacing)
        trials = []
        for trial in pool.map(lambda seed: inspect(options.program, folder / "scenario.yaml", seed),
                              range(1, options.trials + 1)):
            trials.append(trial)
            write_table(options.out, trials, known)  # so far: a long run can be read while it goes on


if __name__ == "__main__":
    main()
