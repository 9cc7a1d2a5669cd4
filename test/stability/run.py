#!/usr/bin/python3
"""Runs the stability catalogue and the random scenes, with progress, and goes on where it was.

    run.py CLOTH [--out DIR] [--jobs N] [--only WORD ...] [--quick] [--seeds N] [--doc FILE]
    run.py CLOTH --seed N --keep DIR       one random scene, its files left in DIR
    run.py CLOTH --only NAME --keep DIR    an entry, likewise
    run.py CLOTH --out DIR --doc FILE --rest      only writes the tables, from the rows there are

CLOTH is the cloth command. A row of DIR/stability.csv is one run: written as soon as it is done, and kept for as
long as engine, scene and judgement are those of the row. --doc writes the tables of doc/stability.md from it. Exit code: 0;
1 something failed; 130 interrupted. What an entry does not hold yet (`open`) is told and fails nothing.
"""
import argparse
import concurrent.futures
import csv
import glob
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time

import catalogue
import judge
import random_scene
import report

COLUMNS = ['version', 'entry', 'case', 'precision', 'digest', 'result', 'missed', 'seconds', 'steps'] + \
    list(judge.COUNTED + judge.WORST) + ['energy_bound']


def version_of(cloth):
    """What the command says, and the bytes of engine and command."""
    said = subprocess.run([cloth, '--version'], capture_output=True, text=True, check=True).stdout.split()[-1]
    digest = hashlib.sha256()
    for path in [cloth] + sorted(glob.glob(os.path.join(os.path.dirname(os.path.abspath(cloth)), 'libcloth*.so'))):
        with open(path, 'rb') as file:
            digest.update(file.read())
    return '%s-%s' % (said, digest.hexdigest()[:8])


def judgement():
    text = ''
    for path in (judge.__file__, os.path.join(judge.HERE, '..', 'scenes', 'run_scene.py')):
        with open(path) as file:
            text += file.read()
    return text


JUDGEMENT = judgement()


class Task:
    """One run: of a case of an entry, in one precision."""

    def __init__(self, entry, case, precision):
        self.entry, self.case, self.precision = entry, case, precision
        scene = case.scene
        if isinstance(scene, str):
            with open(os.path.join(judge.PACKAGE, scene)) as file:
                scene = file.read()
        judged = [
            scene, case.files, case.options, case.seconds, case.written, case.energy or entry.energy, case.refused, case.tells,
            entry.no_room, entry.driven, entry.tangled, entry.particles,
            sorted(entry.open), JUDGEMENT
        ]
        self.digest = hashlib.sha256(repr(judged).encode()).hexdigest()[:8]

    def key(self):
        return self.entry.name, self.case.label, self.precision

    def run(self, cloth, keep):
        folder = os.path.join(keep, self.entry.name, self.case.label.replace('/', '_').replace(' ', '_'), self.precision) if keep \
            else tempfile.mkdtemp(prefix='cloth_stability_')
        start = time.monotonic()
        try:
            run = judge.CaseRun(cloth, self.case, self.precision, folder)
            verdicts = judge.judge(self.entry, self.case, run, cloth)
            row = judge.figures(run, self.case, self.entry)
        finally:
            if not keep:
                shutil.rmtree(folder, ignore_errors=True)
        row = {name: '%.6g' % value for name, value in row.items()}
        missed = '; '.join('%s: %s' % pair if pair[1] else pair[0] for pair in verdicts.missed).replace('\n', ' ')
        return dict(row,
                    entry=self.entry.name,
                    case=self.case.label,
                    precision=self.precision,
                    digest=self.digest,
                    result=verdicts.result(),
                    missed=missed,
                    seconds='%.2f' % (time.monotonic() - start))


class Table:
    """The CSV: rows of earlier runs, and new ones as they come."""

    def __init__(self, path, version):
        self.path, self.version, self.lock, self.rows = path, version, threading.Lock(), {}
        if path and os.path.exists(path):
            with open(path, newline='') as file:
                for row in csv.DictReader(file):
                    if None not in row.values() and row['version'] == version:
                        self.rows[row['entry'], row['case'], row['precision']] = row

    def has(self, task):
        row = self.rows.get(task.key())
        return row is not None and row['digest'] == task.digest

    def add(self, task, row):
        with self.lock:
            self.rows[task.key()] = dict(row, version=self.version)
            if self.path:
                with open(self.path + '.part', 'w', newline='') as file:
                    writer = csv.DictWriter(file, COLUMNS, lineterminator='\n')
                    writer.writeheader()
                    writer.writerows(self.rows.values())
                os.replace(self.path + '.part', self.path)


def tasks_of(arguments):
    entries = catalogue.ENTRIES
    if arguments.quick:
        entries = [entry for entry in entries if entry.quick]
    if arguments.seed is not None:
        entries = [random_scene.entry_of(arguments.seed)]
    elif arguments.seeds:
        seeds = list(range(arguments.seeds))
        if arguments.quick:
            seeds += [seed for seed in random_scene.ONCE_FAILED if seed not in seeds]
        entries = entries + [random_scene.entry_of(seed) for seed in seeds]
    if arguments.only:
        entries = [entry for entry in entries if any(word in entry.name for word in arguments.only)]
    tasks = [Task(entry, case, precision) for entry in entries for case in entry.cases for precision in case.precisions]
    if arguments.quick:  # half of the cases in float, half in double
        tasks = [task for i, task in enumerate(tasks) if len(task.case.precisions) == 1 or (i // 2 + i) % 2 == 0]
    return tasks


def say(line):
    print(line, flush=True)


def run_all(arguments, tasks, table):
    todo = [task for task in tasks if not table.has(task)]
    if len(todo) < len(tasks):
        say('%d of %d runs are in %s already' % (len(tasks) - len(todo), len(tasks), table.path))
    done, start = 0, time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        waiting = {pool.submit(task.run, arguments.cloth, arguments.keep): task for task in todo}
        try:
            for future in concurrent.futures.as_completed(waiting):
                task, row = waiting[future], future.result()
                table.add(task, row)
                done += 1
                left = (time.monotonic() - start) / done * (len(todo) - done)
                say('%-4s %s  %s s  [%d of %d, %d min left]%s' %
                    (row['result'], ' / '.join(task.key()), row['seconds'], done, len(todo), left / 60,
                     '\n     ' + row['missed'] if row['missed'] else ''))
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            say('interrupted after %d runs; the next call goes on' % done)
            return False
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('cloth')
    parser.add_argument('--out', default='', metavar='DIR', help='where stability.csv is kept; default: nowhere')
    parser.add_argument('--jobs', type=int, default=1, help='runs at the same time')
    parser.add_argument('--only', nargs='+', metavar='WORD', help='entries whose name contains a word')
    parser.add_argument('--quick', action='store_true', help='the handful of entries that the tests run')
    parser.add_argument('--seeds', type=int, default=0, metavar='N', help='random scenes 0 to N - 1 as well')
    parser.add_argument('--seed', type=int, metavar='N', help='this random scene alone')
    parser.add_argument('--keep', default='', metavar='DIR', help='leave scenes, reports and meshes there')
    parser.add_argument('--rest', action='store_true', help='run nothing')
    parser.add_argument('--doc', default='', metavar='FILE', help='rewrite the tables in it')
    arguments = parser.parse_args()
    if arguments.out:
        os.makedirs(arguments.out, exist_ok=True)
    table = Table(os.path.join(arguments.out, 'stability.csv') if arguments.out else '', version_of(arguments.cloth))
    tasks = tasks_of(arguments)
    whole = arguments.rest or run_all(arguments, tasks, table)
    rows = [table.rows[task.key()] for task in tasks if table.has(task)]
    if arguments.doc:
        report.write(arguments.doc, table.version, catalogue.ENTRIES, rows)
    count = {result: sum(row['result'] == result for row in rows) for result in ('ok', 'open', 'FAIL')}
    say('%d runs hold, %d hold all but what is open, %d fail (engine %s)' %
        (count['ok'], count['open'], count['FAIL'], table.version))
    return 130 if not whole else 1 if count['FAIL'] else 0


if __name__ == '__main__':
    sys.exit(main())
