#!/usr/bin/env python3
"""Figures of doc/multi_gpu.md, like figures 3, 5, 7, 10, 13, 14 and 17 of P-Cloth, from the committed tables.

    plots.py CLOTH RESULTS_FOLDER DOC_FOLDER

CLOTH is the command, for `cloth links --model`: what the model says of numbers of GPUs that were not at hand is drawn
beside what was measured. RESULTS_FOLDER is test/bench/results. Writes DOC_FOLDER/figures/multi_gpu_*.svg (matplotlib).
"""
import csv
import os
import re
import subprocess
import sys
import tempfile

COUNTS = (1, 2, 4, 8, 16)
ROWS, OWN, HALO = 2054700, 0.999, 0.002  # block rows of the flag of 4.1 M triangles; of its blocks; of a sub-vector
MARKS = {'flag_8000k': ('p', 'flag 8 M'), 'flag_4100k': ('o', 'flag 4.1 M'), 'flag_1200k': ('s', 'flag 1.2 M'),
         'sphere_1650k': ('D', 'sphere 1.65 M'), 'sphere_1000k': ('^', 'sphere 1 M'), 'sheets_700k': ('v', 'three sheets 700 K')}
BEFORE = {'flag_1200k --resolution 1.85': 'flag_4100k', 'flag_1200k': 'flag_1200k', 'sheets_700k': 'sheets_700k'}
ASSEMBLY, COLLISION = ('ms_effects', 'ms_assemble'), ('ms_pairs', 'ms_contact', 'ms_ccd')


def table(path):
    with open(path, newline='', encoding='utf-8') as file:
        return list(csv.DictReader(file))


def measured(results):
    """{scene: {devices: row}} of today's tables, and of the four GPUs before there were hats."""
    today, before = {}, {}
    for folder in sorted(os.listdir(results)):
        path = os.path.join(results, folder, 'scaling.csv')
        for row in table(path) if os.path.exists(path) else ():
            today.setdefault(row['scene'], {})[int(row['devices'])] = row
    for row in table(os.path.join(results, '4-nvidia-h200', 'before_hats.csv')):
        plain = (row['exchange'], row['overlap'], row['alone']) == ('halo', 'on', '1')
        if plain and row['scene'] in BEFORE:
            name = BEFORE[row['scene']] + ('_stages' if row['profile'] == '1' else '')
            before.setdefault(name, {})[int(row['devices'])] = dict(row, step_ms=row['wall_ms'])
    return today, before


def model(cloth, config, kind, count, halo):
    """How many times faster the product of the flag of 4.1 M triangles is: (straightforward, pipelined)."""
    if count == 1:
        return 1.0, 1.0
    with open(os.path.join(config, '%s_%d.yaml' % (kind, count)), encoding='utf-8') as file:
        text = file.read()
    text = re.sub(r'rows: [^,}]*', 'rows: %d' % ROWS, text)
    text = re.sub(r'own: [^,}]*', 'own: %g, halo: %g' % (OWN, halo), text)
    with tempfile.NamedTemporaryFile('w', suffix='.yaml') as file:
        file.write(text)
        file.flush()
        said = subprocess.run([cloth, 'links', '--model', file.name], capture_output=True, text=True, check=True).stdout
    return tuple(float(re.search(way + r' .* ([\d.]+) times faster', said).group(1)) for way in ('straightforward', 'pipelined'))


def sum_of(row, stages):
    return sum(float(row[stage]) for stage in stages)


def faster(rows, cost):
    """[(devices, how many times faster than one)]"""
    return [(n, cost(rows[1]) / cost(rows[n])) for n in sorted(rows) if 1 in rows]


def iteration(row):
    return float(row['ms_solve']) / max(1.0, float(row['pcg_iterations']))


class Figure:
    def __init__(self, plt, ylabel, title):
        self.plt = plt
        self.figure, self.axes = plt.subplots(figsize=(5.6, 3.8))
        self.axes.set_xscale('log', base=2)
        self.axes.set_xticks(COUNTS, [str(n) for n in COUNTS])
        self.axes.set_xlabel('GPUs'), self.axes.set_ylabel(ylabel), self.axes.set_title(title, fontsize=10)

    def speeds(self):
        self.axes.set_yscale('log', base=2)
        self.axes.set_yticks(COUNTS, [str(n) for n in COUNTS])
        self.axes.plot(COUNTS, COUNTS, color='0.8', lw=1, zorder=0)
        return self

    def scenes(self, today, before, value):
        """value(rows) -> points. Lines: today; open marks, dotted: four GPUs before hats."""
        for name, (mark, label) in MARKS.items():
            for rows, style in ((today, '-'), (before, ':')):
                points = value(rows.get(name, {})) if len(rows.get(name, {})) > 1 else []
                if points:
                    self.axes.plot(*zip(*points), mark + style, color='C%d' % list(MARKS).index(name), lw=1, ms=5,
                                   mfc=None if style == '-' else 'none',
                                   label=label + ('' if style == '-' else ', before hats'))
        return self

    def model(self, points, style, label):
        self.axes.plot(*zip(*points), style, color='0.3', lw=1, label='model: ' + label)
        return self

    def save(self, path):
        self.axes.legend(fontsize=7, frameon=False)
        self.figure.tight_layout()
        self.figure.savefig(path, metadata={'Date': None})
        self.plt.close(self.figure)


def step_model(row, n, product):
    """A step on n devices [ms]: the solve as the model's product, collision and assembly shared, the rest as on one."""
    solve, shared = float(row['ms_solve']), sum_of(row, ASSEMBLY + COLLISION)
    return solve / product + shared / n + float(row['step_ms']) - solve - shared


def main():
    cloth, results, doc = sys.argv[1:4]
    import matplotlib
    matplotlib.use('Agg')
    matplotlib.rcParams['svg.hashsalt'] = 'cloth'  # the same file from the same numbers
    import matplotlib.pyplot as plt
    config = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'config', 'links')
    today, before = measured(results)
    # a stage's share of the device is known only where stages were timed on it
    staged = [{name[:-len('_stages')]: rows for name, rows in all_of.items() if name.endswith('_stages')}
              for all_of in (today, before)]
    whole = {n: model(cloth, config, 'nvswitch', n, 1) for n in COUNTS}
    halo = {n: model(cloth, config, 'nvswitch', n, HALO) for n in COUNTS}
    tree = {n: model(cloth, config, 'pcie_tree', n, 1) for n in (1, 4, 8)}

    def path(name):
        return os.path.join(doc, 'figures', 'multi_gpu_%s.svg' % name)

    figure = Figure(plt, 'times faster', 'An iteration of the solver (P-Cloth, figure 5)').speeds()
    figure.scenes(today, before, lambda rows: faster(rows, iteration))
    figure.model([(n, halo[n][1]) for n in COUNTS], '-', 'product, halo')
    figure.model([(n, whole[n][1]) for n in COUNTS], '--', 'product, whole, pipelined')
    figure.model([(n, whole[n][0]) for n in COUNTS], ':', 'product, whole, straightforward')
    figure.model([(n, tree[n][1]) for n in tree], '-.', 'PCIe tree, whole, pipelined')
    figure.save(path('iteration'))

    figure = Figure(plt, 'times faster', 'Forces and assembly, timed on the device (figure 7)').speeds()
    figure.scenes(*staged, lambda rows: faster(rows, lambda row: sum_of(row, ASSEMBLY))).save(path('assembly'))
    figure = Figure(plt, 'times faster', 'Collision: pairs, contacts, impacts (figure 10)').speeds()
    figure.scenes(today, before, lambda rows: faster(rows, lambda row: sum_of(row, COLLISION))).save(path('collision'))

    figure = Figure(plt, 'GB per GPU', 'Memory (figure 13)')
    figure.scenes(today, {}, lambda rows: [(n, float(rows[n]['bytes_per_device']) / 1e9) for n in sorted(rows)])
    figure.scenes({}, before, lambda rows: [(n, float(rows[n]['memory_bytes']) / n / 1e9) for n in sorted(rows)])
    figure.axes.set_ylim(bottom=0)
    figure.save(path('memory'))

    figure = Figure(plt, 'times faster', 'A whole step (figures 14 and 17)').speeds()
    figure.scenes(today, before, lambda rows: faster(rows, lambda row: float(row['step_ms'])))
    row = today['flag_4100k'][1]
    figure.model([(n, float(row['step_ms']) / step_model(row, n, halo[n][1])) for n in COUNTS], '-', 'flag 4.1 M')
    figure.save(path('step'))

    subprocess.run([cloth, 'links', '--model', os.path.join(config, 'pcie_tree_8.yaml'), '--svg', path('timeline')],
                   stdout=subprocess.DEVNULL, check=True)


if __name__ == '__main__':
    main()
