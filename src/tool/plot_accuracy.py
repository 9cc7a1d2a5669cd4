#!/usr/bin/python3
"""Work-precision plots of what `cloth accuracy` measured: error against cost, log-log, a figure for each scene.

usage: plot_accuracy.py accuracy.csv [--out DIR] [--cost wall|cpu|work]

Writes DIR/accuracy_SCENE.svg and .png (default: beside the CSV file). A line joins the runs in which one thing was
varied, with the setting of the file among them; circles mark the Pareto front. Needs matplotlib.
"""
import argparse
import csv
import math
import os
import sys

COSTS = {
    'wall': ('wall_per_second', 'wall time per simulated second [s]'),
    'cpu': ('cpu_per_second', 'processor time per simulated second [s]'),
    'work': ('work', 'iterations x vertices per simulated second'),
}


def read(path):
    """Rows of the file as dictionaries, numbers as float; a line that was cut off does not count."""
    with open(path, newline='') as f:
        lines = f.read().split('\n')[:-1]
    rows = list(csv.DictReader(lines))
    for row in rows:
        for key, value in row.items():
            try:
                row[key] = float(value)
            except (TypeError, ValueError):
                pass
    return rows


def candidates(rows, scene, cost):
    """Runs of a scene that ended well, the cheapest first; references are no candidates."""
    good = [r for r in rows if r['scene'] == scene and r['status'] == 'ok' and r['varied'] != 'reference'
            and 0 < r['error_rms'] < 1 and r[cost] > 0]
    return sorted(good, key=lambda r: (r[cost], r['error_rms']))


def pareto(good):
    """Of runs in order of cost, those that are better than every cheaper one."""
    front, best = [], math.inf
    for row in good:
        if row['error_rms'] < best:
            best = row['error_rms']
            front.append(row)
    return front


def plot(plt, rows, scene, cost, folder):
    column, label = COSTS[cost]
    good = candidates(rows, scene, column)
    if not good:
        print('plot_accuracy: %s: no run to show' % scene, file=sys.stderr)
        return
    figure, axes = plt.subplots(figsize=(7.2, 4.6))
    standard = [r for r in good if r['varied'] == 'standard']
    varied = []
    for row in rows:
        if row['scene'] == scene and row['varied'] not in varied + ['standard', 'reference']:
            varied.append(row['varied'])
    markers = 'osD^v<>ph*'
    for i, name in enumerate(varied):
        line = [r for r in good if r['varied'] == name]
        joined = name not in ('combined', 'preset', 'accuracy', 'mass_spring')
        line = sorted(line + (standard if joined else []), key=lambda r: r[column])
        axes.plot([r[column] for r in line], [100 * r['error_rms'] for r in line], marker=markers[i % len(markers)],
                  linestyle='-' if joined else 'none', color='C%d' % (i % 10), markersize=5, linewidth=1, label=name)
        if name == 'preset':
            for r in line:
                axes.annotate(r['setting'], (r[column], 100 * r['error_rms']), xytext=(5, 4), textcoords='offset points',
                              fontsize=7)
    for r in standard:
        axes.plot(r[column], 100 * r['error_rms'], 'k*', markersize=11, label='as in the file')
    front = pareto(good)
    axes.plot([r[column] for r in front], [100 * r['error_rms'] for r in front], 'ko', markersize=12,
              markerfacecolor='none', markeredgewidth=0.8, label='Pareto front')
    for percent in (10, 1, 0.1):
        axes.axhline(percent, color='0.8', linewidth=0.6, zorder=0)
    axes.set(xscale='log', yscale='log', xlabel=label, ylabel='error: RMS distance / size of the cloth [%]',
             title=scene.replace('_', ' '))
    axes.legend(fontsize=7, ncol=2)
    figure.tight_layout()
    for ending in ('svg', 'png'):
        figure.savefig(os.path.join(folder, 'accuracy_%s.%s' % (scene, ending)), dpi=110,
                       metadata={'Date': None} if ending == 'svg' else None)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('csv')
    parser.add_argument('--out', help='folder for the figures')
    parser.add_argument('--cost', choices=sorted(COSTS), default='wall')
    args = parser.parse_args()
    try:
        rows = read(args.csv)
        scenes = list(dict.fromkeys(r['scene'] for r in rows))
    except (OSError, KeyError) as e:
        sys.exit('plot_accuracy: cannot read %s: %s' % (args.csv, e))
    try:
        import matplotlib
        matplotlib.use('Agg')
        import matplotlib.pyplot as plt
    except ImportError:
        sys.exit('plot_accuracy: matplotlib is missing (Debian: python3-matplotlib)')
    plt.rcParams['svg.fonttype'] = 'none'  # text as text: small files
    plt.rcParams['svg.hashsalt'] = 'cloth'  # the same file for the same rows
    folder = args.out or os.path.dirname(os.path.abspath(args.csv))
    os.makedirs(folder, exist_ok=True)
    for scene in scenes:
        plot(plt, rows, scene, args.cost, folder)


if __name__ == '__main__':
    main()
