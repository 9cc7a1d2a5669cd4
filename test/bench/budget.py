#!/usr/bin/env python3
"""Which share of its deadlines a step misses, with all that is asked for and with a budget, as CSV.

    budget.py CLOTH OUT.csv [--sides N,N,...] [--repeats N] [--threads N]

CLOTH is the built command. The towel of scenes/fold_by_hand.yaml has N x N vertices; a step that takes longer by the
wall clock than the time it simulates has missed. So run it on a quiet machine: stalls from outside count, too.
"""
import argparse
import csv
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
SCENE = os.path.join(HERE, 'scenes', 'fold_by_hand.yaml')
SIDES = '37,39,41,45,51,53,55,56,57'
BUDGETS = {'none': [], 'real_time': ['--set', 'time_budget=real_time']}
COLUMNS = ('vertices', 'budget', 'run', 'threads', 'steps', 'missed', 'missed_share', 'ms_p50', 'ms_p99', 'ms_worst',
           'stretch_max', 'pcg_residual_worst', 'impacts_left')


def run(cloth, side, settings, threads):
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, 'out')
        done = subprocess.run([cloth, 'run', SCENE, '--variant', 'n=%d' % side, '--backend', 'cpu', '--quiet', '--out', out,
                               '--threads', str(threads)] + settings, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if done.returncode not in (0, 1):
            sys.exit('budget.py: %s' % done.stdout.decode())
        with open(os.path.join(out, 'report.csv'), newline='') as file:
            return list(csv.DictReader(file))


def measure(steps):
    wall = [float(s['wall_ms']) for s in steps]
    missed = sum(1 for s, w in zip(steps, wall) if w > 1000 * float(s['step_size']))
    ordered = sorted(wall)
    return {'steps': len(wall), 'missed': missed, 'missed_share': '%.4f' % (missed / len(wall)),
            'ms_p50': '%.2f' % ordered[len(wall) // 2], 'ms_p99': '%.2f' % ordered[len(wall) * 99 // 100],
            'ms_worst': '%.2f' % ordered[-1], 'stretch_max': '%.4f' % max(float(s['stretch_max']) for s in steps),
            'pcg_residual_worst': '%.3g' % max(float(s['pcg_residual']) for s in steps),
            'impacts_left': sum(int(s['impacts_left']) for s in steps)}


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument('cloth')
    options.add_argument('out')
    options.add_argument('--sides', default=SIDES)
    options.add_argument('--repeats', type=int, default=3)
    options.add_argument('--threads', type=int, default=2)
    options = options.parse_args()
    with open(options.out, 'w', newline='') as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator='\n')
        table.writeheader()
        for side in [int(s) for s in options.sides.split(',')]:
            for name, settings in BUDGETS.items():
                for number in range(options.repeats):
                    row = dict(vertices=side * side, budget=name, run=number, threads=options.threads,
                               **measure(run(options.cloth, side, settings, options.threads)))
                    table.writerow(row)
                    file.flush()
                    print('%(vertices)5d vertices, budget %(budget)-9s: %(missed)3d of %(steps)d missed, median '
                          '%(ms_p50)s ms, 99 %% %(ms_p99)s, worst %(ms_worst)s; stretch %(stretch_max)s' % row, flush=True)


if __name__ == '__main__':
    main()
