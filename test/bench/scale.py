#!/usr/bin/env python3
"""Large procedural scenes on a GPU: ms per step over the busiest 100 steps, as CSV.

    scale.py CLOTH OUT.csv [--backend NAME] [--set NAME=VALUE]... [SCENE=STEPS]...

CLOTH is the built command; scenes are the files of test/bench/scenes. Each scene runs twice: once as it
is (the step's time) and once with `profile` (the stages' times on the device). A scene of SETTLE goes on
from a state that it reached in longer steps, not timed: at 1/2000 s the way to the crowd would take minutes.
"""
import csv
import os
import statistics
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
DEFAULT = {'towel_5k': 150, 'towel_100k': 120, 'sheets_700k': 120, 'sphere_1000k': 280, 'flag_1200k': 100,
           'funnel_550k': 150, 'twist_550k': 150}
# phases of (steps, s); in the last one what the change of step set in motion comes to rest
SETTLE = {'funnel_550k': ((200, 0.005), (80, 0.0005)), 'twist_550k': ((200, 0.005), (80, 0.0005))}
COUNTS = ('substeps', 'newton_iterations', 'pcg_iterations', 'pcg_residual', 'vertices', 'triangles', 'pairs',
          'pair_searches', 'contacts_self', 'contacts_body', 'impacts', 'impacts_left', 'launches', 'allocations',
          'memory_bytes')


def step(cloth, scene, steps, options):
    command = [cloth, 'run', os.path.join(HERE, 'scenes', scene + '.yaml'), '--steps', str(steps)]
    done = subprocess.run(command + options, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=90)
    if done.returncode not in (0, 1):
        raise RuntimeError(done.stdout.decode())
    return done


def settle(cloth, scene, options, folder):
    """The options with which a scene starts settled."""
    if scene not in SETTLE:
        return []
    start = []
    for number, (steps, length) in enumerate(SETTLE[scene]):
        state = os.path.join(folder, 'state%d' % number)
        step(cloth, scene, steps, options + start + ['--set', 'time_step=%g' % length, '--save-state', state])
        start = ['--load-state', state]
    return start


def run(cloth, scene, steps, options):
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, 'out')
        done = step(cloth, scene, steps, options + ['--out', out])
        rows = [{k: float(int(v, 16)) if k == 'state_hash' else float(v) for k, v in row.items()}
                for row in csv.DictReader(open(os.path.join(out, 'report.csv')))]
        hash_line = [line for line in done.stdout.decode().splitlines() if line.startswith('state hash')]
        return rows, hash_line[0].split()[-1] if hash_line else ''


def busiest(rows):
    n = min(100, len(rows))
    first = max(range(len(rows) - n + 1), key=lambda i: sum(r['wall_ms'] for r in rows[i:i + n]))
    return rows[first:first + n]


def main():
    cloth, out = sys.argv[1:3]
    options, scenes, rest = ['--backend', 'cuda'], {}, sys.argv[3:]
    while rest:
        word = rest.pop(0)
        if word == '--backend':
            options[1] = rest.pop(0)
        elif word.startswith('--'):
            options += [word, rest.pop(0)]
        else:
            scenes[word.split('=')[0]] = int(word.split('=')[1])
    table = []
    for scene, steps in (scenes or DEFAULT).items():
        try:
            with tempfile.TemporaryDirectory() as folder:
                start = settle(cloth, scene, options, folder)
                plain, plain_hash = run(cloth, scene, steps, options + start)
                staged, staged_hash = run(cloth, scene, steps, options + start + ['--set', 'profile=1'])
        except (RuntimeError, subprocess.TimeoutExpired) as problem:
            print(scene, 'failed:', str(problem)[-300:], flush=True)
            continue
        window, stages = busiest(plain), busiest(staged)
        row = {'scene': scene, 'steps': steps, 'hash': plain_hash, 'same_hash': plain_hash == staged_hash}
        row['step_ms'] = '%.3f' % statistics.median(r['wall_ms'] for r in window)
        row['step_ms_worst'] = '%.3f' % max(r['wall_ms'] for r in window)
        for name in stages[0]:
            if name.startswith('ms_'):
                row[name] = '%.3f' % statistics.median(r[name] for r in stages)
        for name in COUNTS:
            row[name] = '%.6g' % statistics.median(r[name] for r in window)
        row['memory_bytes_most'] = '%d' % max(r['memory_bytes'] for r in plain)
        row['contacts_most'] = '%d' % max(r['contacts_self'] + r['contacts_body'] for r in plain)
        row['impacts_left_all'] = '%d' % sum(r['impacts_left'] for r in plain)
        row['unconverged_all'] = '%d' % sum(r['pcg_unconverged'] for r in plain)
        table.append(row)
        print(scene, row['step_ms'], 'ms;', ' '.join('%s %s' % (k, v) for k, v in row.items() if k != 'scene'), flush=True)
        with open(out, 'w', newline='') as file:
            writer = csv.DictWriter(file, table[0].keys(), lineterminator='\n')
            writer.writeheader()
            writer.writerows(table)


if __name__ == '__main__':
    main()
