#!/usr/bin/env python3
"""The measured price of each effect on two scenes, with it and without it: rewrites the tables of doc/effects.md.

    effects.py BUILD_DIR [--backend NAME] [--rounds N] [--results FILE] [--doc FILE]
    effects.py --from FILE                     rows that another host measured, with --results there

Rows are kept in results/effects.csv beside this script, by backend, so that a run on a host with a GPU
(--backend cuda) fills the GPU's columns and leaves the CPU's. On a CPU one thread runs: effects are compared,
not machines.
"""
import argparse
import csv
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
RESULTS = os.path.join(HERE, 'results', 'effects.csv')
# scene: steps before it is measured, steps measured, what the scene does not call for by itself
SCENES = {
    'towel_on_table': ('config/scenes/towel_on_table.yaml', 40, 2, ['air_density=1.2', 'wind=1 0 0']),
    'flag': ('config/scenes/flag.yaml', 40, 2, []),
    'gravity_and_pins': ('test/bench/scenes/gravity_and_pins.yaml', 5, 20, []),
}
COLUMNS = ('backend', 'scene', 'removed', 'of', 'ms', 'bytes', 'vertices')
BACKENDS = ('cpu', 'cuda')


def price(program, backend, scene, rounds):
    path, warm, steps, settings = SCENES[scene]
    settings = settings + ['backend=' + backend] + (['profile=2'] if backend == 'cuda' else ['threads=1'])
    out = subprocess.run([program, str(warm), str(steps), str(rounds), os.path.join(ROOT, path)] + settings,
                         stdout=subprocess.PIPE, check=True, universal_newlines=True).stdout
    return [dict(row, backend=backend, scene=scene) for row in csv.DictReader(out.splitlines())]


def bare(program, rounds):
    out = subprocess.run([program, 'bare', '10000', str(20 * rounds)], stdout=subprocess.PIPE, check=True,
                         universal_newlines=True).stdout.split(',')
    return {'backend': 'cpu', 'scene': 'bare', 'removed': '-', 'of': 'step', 'ms': out[1], 'bytes': 0,
            'vertices': 10000}


def read_rows(path):
    if not os.path.exists(path):
        return []
    with open(path, newline='') as file:
        return list(csv.DictReader(file))


def write_rows(path, rows):
    with open(path, 'w', newline='') as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator='\n')
        writer.writeheader()
        writer.writerows(rows)


def find(rows, backend, scene, removed, of):
    for r in rows:
        if (r['backend'], r['scene'], r['removed'], r['of']) == (backend, scene, removed, of):
            return float(r['ms']), int(r['bytes'])
    return None


def cell(pair, what):
    if pair is None:
        return '-'
    if what == 'ms':
        return '%.3g' % pair[0]
    return '%.3g MiB' % (pair[1] / 2 ** 20) if pair[1] >= 2 ** 20 else '%.3g KiB' % (pair[1] / 1024)


def names(rows, scene):
    out = []
    for r in rows:
        if r['scene'] == scene and r['removed'] == '-' and r['of'] != 'step' and r['of'] not in out:
            out.append(r['of'])
    return out


def table(rows, scene):
    head = '| effect | its kernels, ms | its memory | step without it, ms | scene without it | others change by |'
    lines = []
    for backend in BACKENDS:
        whole = find(rows, backend, scene, '-', 'step')
        if whole is None:
            continue
        lines += ['**%s**: %s ms a step, %s' % (backend.upper(), cell(whole, 'ms'), cell(whole, 'bytes')), '', head,
                  '|---|---|---|---|---|---|']
        for effect in names([r for r in rows if r['backend'] == backend], scene):
            own, without = find(rows, backend, scene, '-', effect), find(rows, backend, scene, effect, 'step')
            if without is None:
                continue
            others = [(o, find(rows, backend, scene, '-', o), find(rows, backend, scene, effect, o))
                      for o in names([r for r in rows if r['backend'] == backend], scene) if o != effect]
            time = sum(b[0] for _, a, b in others if b) - sum(a[0] for _, a, b in others if b)
            memory = sum(b[1] for _, a, b in others if b) - sum(a[1] for _, a, b in others if b)
            gone = [o for o, _, b in others if b is None]
            change = '%+.2g ms, %+d B' % (time + 0.0, memory) + (' (%s gone)' % ', '.join(gone) if gone else '')
            lines.append('| %s | %s | %s | %s | %s | %s |' % (effect, cell(own, 'ms'), cell(own, 'bytes'),
                                                              cell(without, 'ms'), cell(without, 'bytes'), change))
        lines.append('')
    if not any(r['scene'] == scene and r['backend'] == 'cuda' for r in rows):
        lines += ['CUDA: not measured yet.', '']
    return lines


def flight(rows):
    pass_, step = find(rows, 'cpu', 'bare', '-', 'step'), find(rows, 'cpu', 'gravity_and_pins', '-', 'step')
    lines = ['| 10,000 vertices, double | ms | memory |', '|---|---|---|',
             '| bare pass, CPU, one thread | %.4f | 0.53 MiB |' % pass_[0],
             '| step of gravity and pins, CPU, one thread | %.4f | %s |' % (step[0], cell(step, 'bytes')),
             '| ratio | %.2f | |' % (step[0] / pass_[0])]
    cuda = find(rows, 'cuda', 'gravity_and_pins', '-', 'step')
    lines.append('| step of gravity and pins, CUDA | %s | %s |' % ((('%.4f' % cuda[0]), cell(cuda, 'bytes')) if cuda
                                                                 else ('not measured yet', '')))
    return lines + ['']


def rewrite(path, rows):
    with open(path) as file:
        text = file.read()
    for name in list(SCENES)[:2] + ['flight']:
        begin, end = '<!-- %s: by effects.py -->\n' % name, '<!-- end -->'
        at = text.index(begin) + len(begin)
        text = text[:at] + '\n'.join(flight(rows) if name == 'flight' else table(rows, name)) + text[text.index(end, at):]
    with open(path, 'w') as file:
        file.write(text)


def measure(options):
    program = os.path.join(options.build, 'test', 'effects_price')
    if not os.access(program, os.X_OK):
        sys.exit('effects.py: no %s; build with the tests first' % program)
    rows = []
    for scene in SCENES:
        rows += price(program, options.backend, scene, options.rounds)
        print(scene, 'measured', flush=True)
    if options.backend == 'cpu':
        rows.append(bare(program, options.rounds))
    return rows


def main():
    options = argparse.ArgumentParser()
    options.add_argument('build', nargs='?')
    options.add_argument('--backend', default='cpu', choices=BACKENDS)
    options.add_argument('--rounds', type=int, default=100)
    options.add_argument('--results', default=RESULTS)
    options.add_argument('--from', dest='source')
    options.add_argument('--doc', default=os.path.join(ROOT, 'doc', 'effects.md'))
    options = options.parse_args()
    if (options.build is None) == (options.source is None):
        sys.exit('effects.py: name a build folder, or --from FILE')
    new = read_rows(options.source) if options.source else measure(options)
    measured = {r['backend'] for r in new}
    rows = [r for r in read_rows(options.results) if r['backend'] not in measured] + new
    rows.sort(key=lambda r: BACKENDS.index(r['backend']))
    write_rows(options.results, rows)
    if os.path.exists(options.doc) and any(r['backend'] == 'cpu' for r in rows):
        rewrite(options.doc, rows)


if __name__ == '__main__':
    main()
