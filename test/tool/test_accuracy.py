#!/usr/bin/env python3
"""`cloth accuracy` and presets from outside.

usage: test_accuracy.py CLOTH      prints "ok   NAME" or "FAIL NAME" for each case
"""
import csv
import math
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

CLOTH = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else "cloth"
TOP = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..")
PLOT = os.path.join(TOP, "src", "tool", "plot_accuracy.py")

# a strip of soft cloth between two held ends sags: smooth, and the solver is not in the way
SMOOTH = """\
params: {time_step: 0.002, pcg_tolerance: 1.0e-8, newton_iterations_max: 20, newton_tolerance: 1.0e-6}
effects: {self_contact: off}
materials:
  soft: {density: 0.2, stretch_warp: 20, stretch_weft: 20, shear: 5, bend_warp: 1.0e-5, bend_weft: 1.0e-5, damping_stretch: 0.01}
cloths:
  - name: strip
    grid: {size: [0.2, 0.05], resolution: [9, 3]}
    material: soft
    pose: {position: [0, 0, 1]}
    groups: {ends: [{side: left}, {side: right}]}
    pins: [{group: ends}]
"""


class Failed(Exception):
    pass


def check(condition, *what):
    if not condition:
        raise Failed(" ".join(str(w) for w in what))


def cloth(*args, cwd):
    return subprocess.run([CLOTH, *args], cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True, timeout=240)


def write(folder, name, text):
    with open(os.path.join(folder, name), "w") as f:
        f.write(text)


def rows_of(path):
    with open(path, newline="") as f:
        return list(csv.DictReader(f))


def timeless(rows):
    return [{k: v for k, v in r.items() if not re.search("wall|cpu|ms_per", k)} for r in rows]


def refused(tmp, args, *words):
    before = set(os.listdir(tmp))
    r = cloth(*args, cwd=tmp)
    check(r.returncode == 2, args, "exits with", r.returncode, r.stderr)
    for word in words:
        check(word in r.stderr, args, "does not say", repr(word), "but:", r.stderr)
    check(set(os.listdir(tmp)) == before, args, "leaves something behind")


def sweep(tmp, out="out", scene="s.yaml"):
    r = cloth("accuracy", scene, "--quick", "--threads", "1", "--out", out, cwd=tmp)
    check(r.returncode == 0, r.returncode, r.stderr)
    return r


# ---- cases --------------------------------------------------------------------------------------

def errors_fall_with_the_step_at_order_one(tmp):
    write(tmp, "s.yaml", SMOOTH)
    r = sweep(tmp)
    rows = rows_of(os.path.join(tmp, "out", "accuracy.csv"))
    by = {(x["varied"], x["setting"]): x for x in rows}
    # against a reference of step / 16, an error of order one is C (h - h / 16)
    e = [float(by[k]["error_rms_same_mesh"]) for k in
         (("time_step", "x 2"), ("standard", "as in the file"), ("time_step", "/ 2"), ("time_step", "/ 4"))]
    h = [2, 1, 1 / 2, 1 / 4]
    for i in range(3):
        order = math.log(e[i] / e[i + 1]) / math.log((h[i] - 1 / 16) / (h[i + 1] - 1 / 16))
        check(0.75 < order < 1.25, "order", order, "between", h[i], "and", h[i + 1], "errors", e)
    check(float(by["reference", "step / 16"]["error_rms_same_mesh"]) == 0)
    check(float(by["reference", "step / 16; mesh x 1.5"]["error_rms"]) == 0)
    check(float(by["resolution", "/ 2"]["vertices"]) == 5 * 2, by["resolution", "/ 2"]["vertices"])
    check(by["contact", "off"]["contact"] == "off")
    check("Pareto front" in r.stdout and "cheapest for 0.1 %" in r.stdout, r.stdout)
    times = {round(float(x["simulated"]), 9) for x in rows}
    check(len(times) == 1, "runs end at different times", times)


def what_was_done_is_not_done_again(tmp):
    write(tmp, "s.yaml", SMOOTH)
    sweep(tmp)
    path = os.path.join(tmp, "out", "accuracy.csv")
    with open(path) as f:
        whole = f.read()
    sweep(tmp)
    with open(path) as f:
        check(f.read() == whole, "a second run changes the file")
    # interrupted in the middle of a row: the rest is computed to the same numbers
    lines = whole.splitlines(True)
    write(os.path.join(tmp, "out"), "accuracy.csv", "".join(lines[:6]) + lines[6][:40])
    sweep(tmp)
    with open(path) as f:
        text = f.read()
    check(text.startswith("".join(lines[:6])), "rows that were there are not kept")
    write(tmp, "whole.csv", whole)
    check(timeless(rows_of(path)) == timeless(rows_of(os.path.join(tmp, "whole.csv"))), "other rows than at once")


def a_signal_stops_it_and_it_goes_on(tmp):
    write(tmp, "s.yaml", SMOOTH.replace("[9, 3]", "[33, 9]"))
    p = subprocess.Popen([CLOTH, "accuracy", "s.yaml", "--threads", "1", "--out", "out"], cwd=tmp,
                         stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, universal_newlines=True)
    path = os.path.join(tmp, "out", "accuracy.csv")
    for _ in range(600):
        if os.path.exists(path):
            break
        time.sleep(0.05)
    p.send_signal(signal.SIGTERM)
    _, err = p.communicate(timeout=60)
    check(p.returncode == 128 + signal.SIGTERM, p.returncode, err)
    check("goes on from" in err, err)
    rows_of(path)


def rows_of_another_scene_are_refused(tmp):
    write(tmp, "s.yaml", SMOOTH)
    sweep(tmp)
    write(tmp, "s.yaml", SMOOTH.replace("density: 0.2", "density: 0.3"))
    refused(tmp, ["accuracy", "s.yaml", "--quick", "--threads", "1", "--out", "out"], "another version", "s")


def bad_input_is_refused(tmp):
    write(tmp, "s.yaml", SMOOTH)
    write(tmp, "bad.csv", "a,b\n1,2\n")
    write(tmp, "wrong.yaml", SMOOTH.replace("density: 0.2", "densitty: 0.2"))
    os.mkdir(os.path.join(tmp, "d"))
    write(os.path.join(tmp, "d"), "s.yaml", SMOOTH)
    refused(tmp, ["accuracy"], "name scenes")
    refused(tmp, ["accuracy", "s.yaml"], "--out DIR")
    refused(tmp, ["accuracy", "none.yaml", "--out", "o"], "none.yaml")
    refused(tmp, ["accuracy", "wrong.yaml", "--out", "o"], "wrong.yaml", "densitty")
    refused(tmp, ["accuracy", "s.yaml", "d/s.yaml", "--out", "o"], "same name")
    refused(tmp, ["accuracy", "s.yaml", "--out", "o", "--cost", "euro"], "--cost", "euro")
    refused(tmp, ["accuracy", "--from", "bad.csv"], "bad.csv:1", "heading")
    refused(tmp, ["accuracy", "--from", "none.csv"], "none.csv")
    refused(tmp, ["accuracy", "s.yaml", "--from", "bad.csv"], "--from")


def made_up_table(tmp):
    """Costs and errors of which the front is known."""
    write(tmp, "s.yaml", SMOOTH)
    sweep(tmp)
    with open(os.path.join(tmp, "out", "accuracy.csv")) as f:
        heading = f.readline().strip().split(",")
    points = [("a", 1, 0.5), ("b", 2, 0.6), ("c", 3, 0.08), ("d", 3, 0.07), ("e", 4, 0.07), ("f", 9, 0.009),
              ("g", 5, "nan"), ("h", 0.1, 0.0001)]
    with open(os.path.join(tmp, "made.csv"), "w") as f:
        f.write(",".join(heading) + "\n")
        for name, cost, error in points:
            row = {"scene": "x", "digest": "0", "varied": "time_step", "setting": name, "status": "ok",
                   "precision": "double", "contact": "off", "preconditioner": "two_level", "integrator": "backward_euler", "bending_model": "hinge", "error_rms": error,
                   "wall_per_second": cost, "cpu_per_second": 10 - cost, "work": 1}
            if name == "h":
                row["status"] = "unstable"
            f.write(",".join(str(row.get(h, 1)) for h in heading) + "\n")


def front(text):
    return re.findall(r"time_step: (\w)", text.split("Pareto front:")[1].split("cheapest")[0])


def the_pareto_front_is_right(tmp):
    made_up_table(tmp)
    r = cloth("accuracy", "--from", "made.csv", cwd=tmp)
    check(r.returncode == 0, r.stderr)
    check(front(r.stdout) == ["a", "d", "f"], r.stdout)
    cheapest = r.stdout.split("cheapest for")[1:]
    check("time_step: d" in cheapest[0] and "time_step: f" in cheapest[1], r.stdout)
    check("none reached it" in cheapest[2], r.stdout)
    # counted the other way round
    r = cloth("accuracy", "--from", "made.csv", "--cost", "cpu", cwd=tmp)
    check(front(r.stdout) == ["f"], r.stdout)


def the_plots_know_the_same_front(tmp):
    made_up_table(tmp)
    sys.path.insert(0, os.path.dirname(PLOT))
    import plot_accuracy
    rows = plot_accuracy.read(os.path.join(tmp, "made.csv"))
    for cost, expected in (("wall_per_second", "adf"), ("cpu_per_second", "f")):
        found = "".join(r["setting"] for r in plot_accuracy.pareto(plot_accuracy.candidates(rows, "x", cost)))
        check(found == expected, cost, found)


def a_preset_gives_way_to_what_the_scene_says(tmp):
    write(tmp, "my.yaml", "precision: float\nparams: {pcg_tolerance: 0.05, substeps: 3, newton_iterations_max: 2}\n")
    write(tmp, "s.yaml", "preset: my.yaml\n" + SMOOTH.replace("newton_iterations_max: 20, ", ""))
    write(tmp, "plain.yaml", SMOOTH)

    def heading(*args):
        r = cloth("run", *args, "--steps", "1", "--record", "r.txt", "--force", cwd=tmp)
        check(r.returncode == 0, r.stderr)
        with open(os.path.join(tmp, "r.txt")) as f:
            text = f.read()
        found = {m[0]: float.fromhex(m[1]) for m in re.findall(r"^param (\w+) (\S+)$", text, re.M)}
        found["precision"] = re.search(r"^precision (\w+)", text, re.M).group(1)
        return found

    p = heading("s.yaml")
    check(p["pcg_tolerance"] == 1e-8 and p["substeps"] == 3 and p["newton_iterations_max"] == 2, p)
    check(p["precision"] == "float", p)
    # the command's in place of the file's; --set wins over both
    p = heading("s.yaml", "--preset", "reference", "--set", "newton_iterations_max=4")
    check(p["precision"] == "double" and p["newton_iterations_max"] == 4 and p["pcg_tolerance"] == 1e-8, p)
    for name in ("fast", "balanced", "accurate", "reference"):
        heading("plain.yaml", "--preset", name)
    refused(tmp, ["run", "plain.yaml", "--preset", "fats"], "fats", "fast")
    refused(tmp, ["run", "plain.yaml", "--preset", "none.yaml"], "none.yaml")
    write(tmp, "bad.yaml", "params: {pcg_tolerence: 0.05}\n")
    refused(tmp, ["run", "plain.yaml", "--preset", "bad.yaml"], "bad.yaml:1", "pcg_tolerence", "pcg_tolerance")
    write(tmp, "t.yaml", "preset: fats\n" + SMOOTH)
    refused(tmp, ["run", "t.yaml"], "t.yaml:1", "preset", "fast")


def a_resolution_is_a_factor_on_the_cells(tmp):
    write(tmp, "s.yaml", SMOOTH)
    r = cloth("info", "s.yaml", "--resolution", "2", cwd=tmp)
    check(r.returncode == 0 and re.search(r"\b85\b", r.stdout), r.stdout, r.stderr)  # 17 x 5
    refused(tmp, ["run", "s.yaml", "--steps", "1", "--resolution", "0"], "resolution", "0")
    write(tmp, "n.yaml", SMOOTH.replace("{side: left}", "{vertices: [0, 1]}"))
    refused(tmp, ["run", "n.yaml", "--steps", "1", "--resolution", "2"], "n.yaml", "vertices", "resolution")


def a_budget_is_told_in_the_summary(tmp):
    write(tmp, "s.yaml", SMOOTH.replace("time_step: 0.002", "time_step: 0.002, time_budget: real_time"))
    r = cloth("run", "s.yaml", "--steps", "5", cwd=tmp)
    check(r.returncode == 0, r.stderr)
    check(re.search(r"^budget +2 ms a step", r.stdout, re.M), r.stdout)
    check("not deterministic" in r.stdout, r.stdout)
    refused(tmp, ["run", "s.yaml", "--set", "time_budget=reel_time"], "time_budget", "reel_time")


CASES = [errors_fall_with_the_step_at_order_one, what_was_done_is_not_done_again, a_signal_stops_it_and_it_goes_on,
         rows_of_another_scene_are_refused, bad_input_is_refused, the_pareto_front_is_right,
         the_plots_know_the_same_front, a_preset_gives_way_to_what_the_scene_says,
         a_resolution_is_a_factor_on_the_cells, a_budget_is_told_in_the_summary]


def main():
    failures = 0
    for case in CASES:
        if len(sys.argv) > 2 and case.__name__ != sys.argv[2]:
            continue
        with tempfile.TemporaryDirectory() as tmp:
            try:
                case(tmp)
                print("ok  ", case.__name__)
            except Exception as e:  # any fault is this case's, the others still run
                failures += 1
                print("FAIL", case.__name__, "\n    ", e)
        sys.stdout.flush()
    return failures != 0


if __name__ == "__main__":
    sys.exit(main())
