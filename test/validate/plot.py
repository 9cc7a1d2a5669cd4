#!/usr/bin/env python3
"""Figures and tables of doc/validation.md from the results of cloth_validate.

    plot.py RESULTS.csv DOC_FOLDER

Writes DOC_FOLDER/figures/validation_*.svg (matplotlib), and puts the table of results between the marks
`<!-- results -->` and `<!-- end -->` of DOC_FOLDER/validation.md.
"""
import csv
import math
import os
import sys


def cantilever(gamma, load, steps=400):
    """(drop, reach) over L of the elastica clamped level: shooting from the free end, as reference.c does."""

    def shoot(eps):
        y, h = [eps, 0.0, 0.0, 0.0], 1.0 / steps

        def rate(s, y):
            return [y[1], (load + gamma * s) * math.sin(y[0]), math.cos(y[0]), math.sin(y[0])]

        for i in range(steps):
            if y[0] > math.pi:
                break
            k = [rate(i * h, y)]
            for step in (h / 2, h / 2, h):
                k.append(rate(i * h + step, [a + step * b for a, b in zip(y, k[-1])]))
            y = [a + h / 6 * (p + 2 * q + 2 * r + s) for a, p, q, r, s in zip(y, *k)]
        return y

    low, high = math.log(1e-30), math.log(math.pi / 2)
    for _ in range(80):
        middle = (low + high) / 2
        if shoot(math.exp(middle))[0] < math.pi / 2:
            low = middle
        else:
            high = middle
    end = shoot(math.exp(low))
    return end[2], end[3]


MARKS = {"grid, one way": "s", "grid, alternating": "D", "unstructured": "o", "uneven": "^"}


def draw(rows, test, curve, xlabel, ylabel, path, logarithmic):
    import matplotlib
    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "cloth"  # the same file from the same numbers
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(figsize=(5.2, 3.4))
    axes.plot([p[0] for p in curve], [p[1] for p in curve], color="0.5", lw=1, label="elastica")
    for mesh, mark in MARKS.items():
        points = [(float(r["parameter"]), float(r["measured"])) for r in rows
                  if r["test"].startswith(test) and r["mesh"] == mesh and r["quantity"] == ylabel]
        if points:
            axes.plot([p[0] for p in points], [p[1] for p in points], mark, ms=5, mfc="none", label=mesh)
    if logarithmic:
        axes.set_xscale("log"), axes.set_yscale("log")
    axes.set_xlabel(xlabel), axes.set_ylabel(ylabel), axes.legend(frameon=False, fontsize=8)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def table(rows):
    lines = ["| test | mesh | quantity | at | measured | expected | error | reach |", "|---|---|---|---|---|---|---|---|"]
    for r in rows:
        error = float(r["error"])
        missed = "" if abs(error) <= float(r["reach"]) else " **missed**"
        lines.append("| %s | %s | %s | %.4g | %.5g | %.5g | %+.2f %%%s | %.3g %% |" % (
            r["test"], r["mesh"], r["quantity"], float(r["parameter"]), float(r["measured"]), float(r["expected"]),
            100 * error, missed, 100 * float(r["reach"])))
    return "\n".join(lines)


def main(results, folder):
    with open(results) as file:
        rows = list(csv.DictReader(file))
    figures = os.path.join(folder, "figures")
    gammas = [10 ** (-1 + 4 * i / 40) for i in range(41)]
    curve = [(g, d / r) for g, (d, r) in ((g, cantilever(g, 0)) for g in gammas)]
    try:
        draw(rows, "cantilever", curve, "density g L^3 / D", "H/W",
             os.path.join(figures, "validation_cantilever.svg"), True)
        loads = [0.25 * i for i in range(1, 45)]
        curve = [(a, cantilever(0, a)[0]) for a in loads]
        draw(rows, "tip load", curve, "P L^2 / D", "deflection/L",
             os.path.join(figures, "validation_tip_load.svg"), False)
    except ImportError:
        print("matplotlib is not there: no figures (Debian: python3-matplotlib)")
    page = os.path.join(folder, "validation.md")
    with open(page) as file:
        text = file.read()
    begin, end = text.index("<!-- results -->") + 17, text.index("<!-- end -->")
    with open(page, "w") as file:
        file.write(text[:begin] + table(rows) + "\n" + text[end:])


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
