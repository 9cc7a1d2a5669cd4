#!/usr/bin/python3
"""Runs one hard scene of config/scenes, writes every step and judges it from outside.

    run_scene.py CLOTH SCENE [--check PROGRAM] [--precision float|double ...] [--steps N] [--keep DIR] [--anyway]
                             [--full [--backend NAME] [--limit S] [--every N]]

CLOTH is the cloth command, SCENE a name of table.py, where the bounds stand. Every written step is
checked for intersecting triangles by `cloth check`, where the command has it, and by test/check_meshes
(CGAL; --check). Prints "ok   SENTENCE", "FAIL SENTENCE" or "skip SENTENCE: why", as the C tests do; exit
code 1 on a failure. A scene that needs what the engine does not have yet is skipped; --anyway runs it. --full takes
the full size instead of the small one, on any backend; the repetition in parts is left to the small size.
"""
import argparse
import csv
import math
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile

import table

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, '..', '..', 'config', 'scenes')


MEMORY_LIMIT = 4 << 30  # bytes of addresses; these scenes take a hundredth of it


def limit_memory():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_LIMIT, MEMORY_LIMIT))


class Run:
    """One run of a scene: its report, row by row, and its folder of meshes."""

    def __init__(self, cloth, scene, precision, steps, folder, more=('--mesh-every', '1'), full=False, limit=table.TIME_LIMIT):
        self.folder, self.precision = folder, precision
        variants = [name for name in scene.variant.split(',') if not (full and name == 'small')]
        command = [cloth, 'run', os.path.join(SCENES, scene.file + '.yaml'), '--precision', precision, '--out', folder,
                   '--hash', '--quiet'] + (['--variant', ','.join(variants)] if variants else []) + list(more)
        if steps:
            command += ['--steps', str(steps)]
        self.run(command, limit, None if full else limit_memory)

    def run(self, command, limit, before=limit_memory):
        """Runs `cloth run` for at most `limit` s, by default in MEMORY_LIMIT, and reads its report."""
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=limit, preexec_fn=before)
            self.code, self.message = done.returncode, done.stderr.strip()
        except subprocess.TimeoutExpired:
            self.code, self.message = -1, 'not done after %g s' % limit
        path = os.path.join(self.folder, 'report.csv')
        self.rows = []
        if os.path.exists(path):
            with open(path, newline='') as file:
                self.rows = [{key: float(value) if key != 'state_hash' else value for key, value in row.items()}
                             for row in csv.DictReader(file)]

    def column(self, name):
        return [row[name] for row in self.rows]

    def worst(self, name):
        return max(self.column(name), default=math.nan)

    def total(self, name):
        return sum(self.column(name))

    def kinds(self):
        """{file name without step: 'cloth' or 'body'}"""
        with open(os.path.join(self.folder, 'meshes.csv'), newline='') as file:
            return {row['file']: row['kind'] for row in csv.DictReader(file)}

    def written(self):
        """The steps of which meshes were written, ascending."""
        return sorted({int(name[-10:-4]) for name in os.listdir(self.folder) if name.endswith('.obj')})

    def path(self, name, step):
        return os.path.join(self.folder, '%s_%06d.obj' % (name, step))

    def positions(self, name, step):
        with open(self.path(name, step)) as file:
            return [tuple(float(word) for word in line.split()[1:4]) for line in file if line.startswith('v ')]

    def triangles(self, name):
        with open(self.path(name, 0)) as file:
            return [tuple(int(word.split('/')[0]) - 1 for word in line.split()[1:4]) for line in file if line.startswith('f ')]


# ---- the independent checks of written meshes ------------------------------------------------------------

def hits_by_cgal(program, run):
    """{step: (cloth-cloth, cloth-body, inside)} of the steps with any, and all lines that were printed."""
    done = subprocess.run([program, run.folder, '--list', '4'], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(done.stderr)
    hits = {}
    for match in re.finditer(r'^step (\d+): (\d+) cloth-cloth, (\d+) cloth-body intersections, (\d+) pieces', done.stdout,
                             re.MULTILINE):
        step, self_, body, inside = (int(word) for word in match.groups())
        hits[step] = (self_ + inside, body)  # a piece inside a closed body never has room
    return hits, done.stdout.strip().splitlines()[-1]


def has_check(cloth):
    text = subprocess.run([cloth, '--help'], capture_output=True, text=True, check=False).stdout
    return re.search(r'^\s+(cloth )?check\b', text, re.MULTILINE) is not None


def hits_by_command(cloth, run):
    """{step: (cloth-cloth, cloth-body)} of the written steps with any. Bodies may stand in each other: not counted."""
    kinds, hits = run.kinds(), {}
    for step in run.written():
        kind_of = {run.path(name, step): kind for name, kind in kinds.items()}
        pairs = os.path.join(run.folder, 'pairs.csv')
        done = subprocess.run([cloth, 'check', '--list', pairs] + list(kind_of), capture_output=True, text=True, check=False)
        if done.returncode not in (0, 1):
            raise RuntimeError('cloth check: ' + done.stderr)
        if done.returncode == 0:
            continue
        with open(pairs, newline='') as file:
            found = [sorted((kind_of[row['mesh0']], kind_of[row['mesh1']])) for row in csv.DictReader(file)]
        hit = found.count(['cloth', 'cloth']), found.count(['body', 'cloth'])
        if any(hit):
            hits[step] = hit
    return hits


# ---- known quantities ------------------------------------------------------------------------------------

def momentum_drift(run):
    """Largest change of the momentum of all cloths together, from step to step and since the start, over the sum of
    |m v|. Mass is a third of each triangle's rest area per corner; density is the same for all."""
    names = [name for name, kind in run.kinds().items() if kind == 'cloth']
    weight = {}
    for name in names:
        x = run.positions(name, 0)
        mass = [0.0] * len(x)
        for a, b, c in run.triangles(name):
            u, v = [[x[k][i] - x[a][i] for i in range(3)] for k in (b, c)]
            area = 0.5 * math.sqrt(sum((u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3]) ** 2 for i in range(3)))
            for corner in (a, b, c):
                mass[corner] += area / 3
        weight[name] = mass
    centre, scale, before = [], None, {}
    for step in range(len(run.rows) + 1):
        sums, place = [0.0, 0.0, 0.0], {}
        for name in names:
            place[name] = run.positions(name, step)
            for m, x in zip(weight[name], place[name]):
                for i in range(3):
                    sums[i] += m * x[i]
        if step == 1:
            scale = sum(m * math.dist(x0, x1) for name in names
                        for m, x0, x1 in zip(weight[name], before[name], place[name]))
        centre.append(sums)
        before = place
    moves = [[b[i] - a[i] for i in range(3)] for a, b in zip(centre, centre[1:])]
    return max(math.dist(move, moves[0]) for move in moves) / scale


def lowest(run):
    return min(x[2] for name, kind in run.kinds().items() if kind == 'cloth' for x in run.positions(name, run.written()[-1]))


# ---- judging ---------------------------------------------------------------------------------------------

class Judge:
    """Prints the verdicts of one run."""

    def __init__(self, label, open_sentences=()):
        self.label, self.failed, self.open = label, 0, open_sentences

    def say(self, sentence, good, figures=''):
        if not good and sentence in self.open:
            print('skip %s_%s: not held yet: %s' % (self.label, sentence, figures))
            return
        self.failed += not good
        print('%s %s_%s' % ('ok  ' if good else 'FAIL', self.label, sentence))
        if not good and figures:
            print('     ' + figures)


def judge_repetition(judge, scene, run, cloth, folder):
    """The first half again, in three parts on two threads: the same bits?"""
    again = Run(cloth, scene, run.precision, (len(run.rows) + 1) // 2, folder, ('--devices', 'cpu,cpu,cpu', '--threads', '2'))
    hashes = [[row['state_hash'] for row in r.rows[:len(again.rows)]] for r in (run, again)]
    differ = [i + 1 for i, (a, b) in enumerate(zip(*hashes)) if a != b]
    judge.say('three_parts_give_the_same_bits', again.rows and not differ and int(hashes[0][0], 16) != 0,
              'from step %s of %d on' % (differ[:1], len(again.rows)))


def in_pinch(scene, time):
    return scene.no_room and scene.no_room[0] <= time <= scene.no_room[1]


def judge_report(judge, scene, run):
    finite = all(math.isfinite(value) for row in run.rows for value in row.values() if isinstance(value, float))
    judge.say('every_step_ends', run.code == 0, run.message[-300:])
    judge.say('everything_is_finite', bool(run.rows) and finite)
    if not run.rows:
        return
    left = [int(row['step']) for row in run.rows if row['impacts_left'] > 0 and not in_pinch(scene, row['time'])]
    judge.say('nothing_is_left_passing_through', not left, 'impacts left in %d steps: %s' % (len(left), left[:10]))
    worst = max(run.rows, key=lambda row: row['stretch_max'])
    judge.say('stretch_is_bounded', worst['stretch_max'] <= scene.stretch,
              'worst stretch %.3f in step %d, bound %.3f' % (worst['stretch_max'], worst['step'], scene.stretch))
    judge.say('energy_is_bounded', run.worst('energy_kinetic') <= scene.energy,
              'kinetic energy up to %.4g J, bound %.4g J' % (run.worst('energy_kinetic'), scene.energy))
    if scene.work:  # counted, not timed
        solves = sorted(run.column('newton_iterations'))
        usual = max(3, solves[len(solves) // 2])  # a step at rest takes one
        judge.say('no_step_is_many_times_the_usual_work', solves[-1] <= scene.work * usual,
                  'linear systems: %d in the worst step, usually %d' % (solves[-1], usual))
    if scene.speed_reached:
        judge.say('it_is_as_fast_as_it_says', run.worst('speed_max') >= scene.speed_reached,
                  'fastest %.2f m/s of %.2f' % (run.worst('speed_max'), scene.speed_reached))


def judge_hits(judge, scene, run, by, hits, summary=''):
    bad = {step: hit for step, hit in hits.items()
           if hit[0] or not in_pinch(scene, run.rows[step - 1]['time'] if step else 0)}
    first = 'step %d: %d cloth-cloth, %d cloth-body' % ((min(bad),) + bad[min(bad)]) if bad else ''
    judge.say('no_triangles_intersect_by_' + by, not bad, '%d steps, first %s; %s' % (len(bad), first, summary))


def judge_meshes(judge, scene, run, cloth, check):
    if has_check(cloth):
        judge_hits(judge, scene, run, 'cloth_check', hits_by_command(cloth, run))
    if check:
        judge_hits(judge, scene, run, 'cgal', *hits_by_cgal(check, run))
    if run.precision in (scene.momentum or {}):
        drift, most = momentum_drift(run), scene.momentum[run.precision]
        judge.say('momentum_stays', drift <= most, 'drift %.2e, bound %.0e' % (drift, most))
    if scene.floor is not None:
        z = lowest(run)
        judge.say('nothing_is_below_the_floor', z >= scene.floor, 'lowest vertex at %.4f m, floor at %.4f m' % (z, scene.floor))


def figures(run):
    median = sorted(run.column('wall_ms'))[len(run.rows) // 2]
    return ('steps %d, substeps %d, halvings %d, impacts %d, left %d, stretch %.1f %%, kinetic %.3g J, speed %.2f m/s, '
            'pcg %d (worst step %d, unconverged %d), contacts %d + %d, ms %.1f median %.1f worst'
            % (len(run.rows), run.total('substeps'), run.total('step_halvings'), run.total('impacts'), run.worst('impacts_left'),
               100 * run.worst('stretch_max'), run.worst('energy_kinetic'), run.worst('speed_max'), run.total('pcg_iterations'),
               run.worst('pcg_iterations'), run.total('pcg_unconverged'), run.worst('contacts_self'), run.worst('contacts_body'),
               median, run.worst('wall_ms')))


def run_and_judge(arguments, precision, folder):
    scene = table.SCENES[arguments.scene]
    more = ['--mesh-every', str(arguments.every)] + (['--backend', arguments.backend] if arguments.backend else [])
    run = Run(arguments.cloth, scene, precision, arguments.steps, folder, more, arguments.full, arguments.limit)
    judge = Judge('%s_%s' % (arguments.scene, precision), scene.open)
    judge_report(judge, scene, run)
    if run.rows:
        judge_meshes(judge, scene, run, arguments.cloth, arguments.check)
        if precision == 'float' and not arguments.steps and not arguments.full:
            judge_repetition(judge, scene, run, arguments.cloth, folder + '_again')
        print('     ' + figures(run))
    return judge.failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('cloth')
    parser.add_argument('scene', choices=sorted(table.SCENES))
    parser.add_argument('--check', default='', help='the program check_meshes')
    parser.add_argument('--precision', nargs='+', choices=['double', 'float'], default=['double', 'float'])
    parser.add_argument('--steps', type=int, default=0, help='default: the scene\'s duration')
    parser.add_argument('--keep', default='', metavar='DIR', help='leave report and meshes in DIR/double, DIR/float')
    parser.add_argument('--anyway', action='store_true', help='run it though the engine lacks what it needs')
    parser.add_argument('--full', action='store_true', help='the full size instead of the small one')
    parser.add_argument('--backend', default='', help='with --full: where it runs; default: the scene file\'s')
    parser.add_argument('--every', type=int, default=1, metavar='N', help='write and check every Nth step')
    parser.add_argument('--limit', type=float, default=table.TIME_LIMIT, metavar='S', help='a run that takes longer is stopped')
    arguments = parser.parse_args()
    needs = table.SCENES[arguments.scene].needs
    if needs and not arguments.anyway:
        print('skip %s: needs: %s' % (arguments.scene, needs))
        return 0
    failed = 0
    for precision in arguments.precision:
        folder = arguments.keep or tempfile.mkdtemp(prefix='cloth_scene_')
        try:
            failed += run_and_judge(arguments, precision, os.path.join(folder, precision))
        finally:
            if not arguments.keep:
                shutil.rmtree(folder, ignore_errors=True)
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
