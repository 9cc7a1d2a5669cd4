#!/usr/bin/python3
"""One mesh on 1, 2, 4, ... devices: steps, stages, memory per device, and whether the state hash stays the same.

    scaling.py CLOTH OUT_DIR [--devices 1,2,4,8] [--budget S] [--scene NAME ...] [--backend cuda|cpu] [--shrink F]

Writes OUT_DIR/scaling.csv (a line a run) and OUT_DIR/topology.txt (as the driver reports it), and prints each line as it
comes. The scenes are those of this folder's scenes/, sized by --resolution; ways to exchange (doc/multi_gpu.md) are
compared on the flag. Stops starting runs after the budget (default 540 s): what comes first matters most. Exit code 1 where
a hash differs between numbers of devices, or a run fails. With `--backend cpu` the devices are parts of the CPU and --shrink
makes the meshes smaller: a dry run.
"""
import argparse
import csv
import os
import statistics
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
# name: scene, factor on its resolution, steps, options, the name it is a variant of. Triangles grow with the square of the
# factor. Ways to exchange mean nothing on one device: their variants run on several only.
SCENES = {
    'flag_1200k': ('flag_1200k', 1.0, 25, (), None),
    'flag_4100k': ('flag_1200k', 1.85, 12, (), None),
    'sphere_1650k': ('sphere_1000k', 1.285, 30, (), None),
    'flag_8000k': ('flag_1200k', 2.58, 8, (), None),
    'sheets_700k': ('sheets_700k', 1.0, 50, (), None),
    'sphere_1000k': ('sphere_1000k', 1.0, 50, (), None),
    # with profile: stages by the devices' clocks, and the products A p by themselves
    'flag_1200k_stages': ('flag_1200k', 1.0, 25, ('profile=1',), None),
    'flag_1200k_stages_straightforward': ('flag_1200k', 1.0, 25, ('profile=1', 'overlap=off'), 'flag_1200k_stages'),
    'flag_4100k_stages': ('flag_1200k', 1.85, 12, ('profile=1',), None),
    'flag_1200k_straightforward': ('flag_1200k', 1.0, 25, ('overlap=off',), 'flag_1200k'),
    'flag_1200k_whole': ('flag_1200k', 1.0, 25, ('exchange=whole',), 'flag_1200k'),
    'flag_1200k_launches': ('flag_1200k', 1.0, 25, ('exchange=launches',), 'flag_1200k'),
}
STAGES = ('predict', 'pairs', 'contact', 'effects', 'assemble', 'solve', 'ccd', 'commit')
FIELDS = (['scene', 'devices', 'triangles', 'steps', 'hash', 'step_ms', 'speedup', 'pcg_iterations', 'solve_us_per_iteration',
           'product_us', 'bytes_per_device'] + ['ms_' + stage for stage in STAGES])


def devices_of(count, backend):
    return ','.join('cpu' if backend == 'cpu' else str(i) for i in range(count))


def run(cloth, name, count, backend, shrink):
    """One run, as a line of the table; medians leave the first third of the steps out."""
    scene, factor, steps, options, _ = SCENES[name]
    with tempfile.TemporaryDirectory() as folder:
        command = [cloth, 'run', os.path.join(HERE, 'scenes', scene + '.yaml'), '--steps', str(steps), '--backend', backend,
                   '--devices', devices_of(count, backend), '--resolution', str(factor * shrink), '--hash', '--quiet',
                   '--force', '--out', folder]
        for option in options:
            command += ['--set', option]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode not in (0, 1):
            raise RuntimeError('%s on %d: exit code %d: %s' % (name, count, done.returncode, done.stderr.strip()[-300:]))
        with open(os.path.join(folder, 'report.csv'), newline='') as file:
            rows = list(csv.DictReader(file))
    late = rows[len(rows) // 3:]

    def median(key):
        return statistics.median(float(row[key]) for row in late)

    line = {'scene': name, 'devices': count, 'triangles': int(rows[-1]['triangles']), 'steps': len(rows),
            'hash': next(text.split()[-1] for text in done.stdout.splitlines() if text.startswith('state hash')),
            'step_ms': median('wall_ms'), 'pcg_iterations': median('pcg_iterations'),
            'bytes_per_device': median('memory_bytes') / count}
    line.update({'ms_' + stage: median('ms_' + stage) for stage in STAGES})
    line['solve_us_per_iteration'] = 1e3 * line['ms_solve'] / max(1, line['pcg_iterations'])
    line['product_us'] = 1e3 * median('product_ms') / max(1, line['pcg_iterations'])
    return line


def topology(path):
    with open(path, 'w', encoding='utf-8') as file:
        for command in (['nvidia-smi', '-L'], ['nvidia-smi', 'topo', '-m']):
            try:
                file.write(subprocess.run(command, capture_output=True, text=True, check=False).stdout + '\n')
            except FileNotFoundError:
                file.write('no nvidia-smi\n')


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('cloth')
    parser.add_argument('out')
    parser.add_argument('--devices', default='1,2,4,8', help='numbers of devices')
    parser.add_argument('--budget', type=float, default=540, help='s')
    parser.add_argument('--scene', action='append', choices=sorted(SCENES))
    parser.add_argument('--backend', default='cuda', choices=('cuda', 'cpu'))
    parser.add_argument('--shrink', type=float, default=1.0, help='factor on the resolution of every scene')
    a = parser.parse_args()
    os.makedirs(a.out, exist_ok=True)
    topology(os.path.join(a.out, 'topology.txt'))
    start, failed, firsts = time.monotonic(), 0, {}
    with open(os.path.join(a.out, 'scaling.csv'), 'w', newline='') as file:
        table = csv.DictWriter(file, FIELDS)
        table.writeheader()
        for name in a.scene or SCENES:
            variant_of = SCENES[name][4]
            for count in (int(text) for text in a.devices.split(',')):
                if variant_of and count == 1:
                    continue
                if time.monotonic() - start > a.budget:
                    print('%s on %d: not run, the budget of %g s is used up' % (name, count, a.budget))
                    continue
                try:
                    line = run(a.cloth, name, count, a.backend, a.shrink)
                except (RuntimeError, OSError) as error:
                    print(error)
                    failed += 1
                    continue
                first = firsts.get(variant_of) or firsts.setdefault(name, line)
                line['speedup'] = first['step_ms'] / line['step_ms'] * first['devices']
                if line['hash'] != first['hash']:
                    print('%s: the state hash on %d devices differs from that on %d' % (name, count, first['devices']))
                    failed += 1
                table.writerow({key: '%.6g' % line[key] if isinstance(line[key], float) else line[key] for key in FIELDS})
                file.flush()
                print('%-34s %2d devices  %8.3f ms a step, %5.2f times, %6.1f us an iteration, %6.1f of it the product, '
                      '%6.3f GB a device  %s' %
                      (name, count, line['step_ms'], line['speedup'], line['solve_us_per_iteration'], line['product_us'],
                       line['bytes_per_device'] / 1e9, line['hash']), flush=True)
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
