"""Runs one case and judges it from outside: what must hold for every case of the catalogue and every random scene.

- it ends: every step ends, or where a refusal is asked for, it is refused with the words asked for;
- everything is finite, in the report and in the last written meshes;
- from a start without intersections no triangle intersects another at any written step, and none a body, by exact
  predicates on the written meshes (`cloth check`, which shares no code with contact). Where bodies leave no room: none
  of cloth with cloth, unless holds drive cloth, and only in steps whose report names them;
- no vertex ends inside a convex body or below a floor: what passes through between two written steps shows here;
- from a start that intersects, no pair is added, or (worked out) none is left;
- the kinetic energy keeps below its bound;
- whatever intersects at a written step is counted by the report of that step.
"""
import math
import os
import random
import re
import sys

import shapes

HERE = os.path.dirname(os.path.abspath(__file__))
PACKAGE = os.path.join(HERE, '..', '..')
sys.path.insert(0, os.path.join(HERE, '..', 'scenes'))
from run_scene import Run, hits_by_command  # noqa: E402

TIME_LIMIT = 900  # s, of one run: a stall
CONVEX = ('box', 'sphere', 'cylinder', 'cone', 'plane')
COUNTED = ('substeps', 'step_halvings', 'pcg_unconverged', 'impacts', 'held_back', 'teleports', 'grasps_broken')
WORST = ('impacts_left', 'tangles', 'bodies_blocking', 'holds_blocking', 'stretch_max', 'speed_max', 'energy_kinetic')


class CaseRun(Run):
    """One run of a case: its scene and meshes beside the folder of its output."""

    def __init__(self, cloth, case, precision, folder, steps_most=0):
        self.folder, self.precision = os.path.join(folder, 'out'), precision
        os.makedirs(folder, exist_ok=True)
        for name, text in case.files.items():
            with open(os.path.join(folder, name), 'w') as file:
                file.write(text)
        if isinstance(case.scene, dict):
            scene = os.path.join(folder, 'scene.yaml')
            with open(scene, 'w') as file:
                file.write(shapes.text_of(case.scene))
        else:
            scene = os.path.join(PACKAGE, case.scene)
        step = time_step_of(case)
        steps = max(1, round(case.seconds / step))
        if steps_most:
            steps = min(steps, steps_most)
        self.run([
            cloth, 'run', scene, '--precision', precision, '--threads', '1', '--out', self.folder, '--force', '--quiet',
            '--steps',
            str(steps), '--mesh-every',
            str(max(1, steps // case.written))
        ] + case.options, TIME_LIMIT)
        self.case, self.steps = case, steps


def time_step_of(case):
    for option in case.options:
        if option.startswith('time_step='):
            return float(option.split('=')[1])
    if isinstance(case.scene, dict):
        return case.scene['params'].get('time_step', 1 / 60)
    with open(os.path.join(PACKAGE, case.scene)) as file:
        return float(re.search(r'time_step: ([0-9.e-]+)', file.read()).group(1))


def read(path):
    points, faces = [], []
    with open(path) as file:
        for line in file:
            word = line.split()
            if line.startswith('v '):
                points.append(tuple(map(float, word[1:4])))
            elif line.startswith('f '):
                faces.append([int(w.split('/')[0]) - 1 for w in word[1:4]])
    return points, faces


def planes(points, faces):
    """Outward planes (n, d) of a convex body, in an order in which a point outside soon fails."""
    out = {}
    for a, b, c in faces:
        u, v = [[points[k][i] - points[a][i] for i in range(3)] for k in (b, c)]
        n = [u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3] for i in range(3)]
        length = math.hypot(*n)
        if length > 0:
            n = [x / length for x in n]
            out[tuple(round(x, 5) for x in n)] = (n, sum(x * y for x, y in zip(n, points[a])))
    out = [out[key] for key in sorted(out)]
    random.Random(1).shuffle(out)
    return out


def inside(run, step, tolerance):
    """How many vertices of cloth are deeper than `tolerance` [m] in a convex body."""
    kinds, count = run.kinds(), 0
    convex = {body['name'] for body in run.case.scene['bodies'] if any(key in body for key in CONVEX)}
    points = [x for name, kind in kinds.items() if kind == 'cloth' for x in run.positions(name, step)]
    for name, kind in kinds.items():
        if kind == 'body' and name in convex:
            walls = planes(*read(run.path(name, step)))
            count += sum(all(n[0] * x[0] + n[1] * x[1] + n[2] * x[2] - d < -tolerance for n, d in walls) for x in points)
    return count


class Verdicts:
    """Sentences with whether they hold and their figures."""

    def __init__(self, open_sentences=()):
        self.open, self.missed, self.said = open_sentences, [], []

    def say(self, sentence, good, figures=''):
        self.said.append(sentence)
        if not good:
            self.missed.append((sentence, figures))

    def result(self):
        if any(sentence not in self.open for sentence, _ in self.missed):
            return 'FAIL'
        return 'open' if self.missed else 'ok'


def judge_refusal(say, case, run):
    say('it_is_refused', run.code in (1, 2) and all(word in run.message for word in case.refused or case.may_refuse),
        'exit code %d: %s' % (run.code, run.message[-300:]))


def judge_finite(say, run):
    good = all(math.isfinite(value) for row in run.rows for value in row.values() if isinstance(value, float))
    last = run.written()[-1:]
    for name, kind in run.kinds().items():
        for step in last:
            good = good and all(math.isfinite(value) for x in run.positions(name, step) for value in x)
    say('everything_is_finite', good)


def judge_meshes(say, entry, run, cloth):
    hits = hits_by_command(cloth, run)
    start = hits.pop(0, (0, 0))
    first = lambda bad: '%d written steps, first step %d: %d cloth-cloth, %d cloth-body' % (
        (len(bad), min(bad)) + bad[min(bad)])
    untold = {step: hit for step, hit in hits.items() if step <= len(run.rows) and run.rows[step - 1]['tangles'] == 0}
    say('what_intersects_is_told', not untold, untold and first(untold))
    if entry.tangled == 'kept':
        worse = {step: hit for step, hit in hits.items() if sum(hit) > sum(start)}
        say('it_gets_no_worse', any(start) and not worse, worse and 'start %d + %d; %s' % (start + (first(worse), )))
    elif entry.tangled:
        last = hits.get(run.written()[-1], (0, 0))
        say('it_is_worked_out', any(start) and not any(last), 'start %d + %d, end %d + %d' % (start + last))
    else:
        named = {int(row['step']) for row in run.rows if entry.driven and row['holds_blocking'] > 0}
        bad = {step: hit for step, hit in hits.items() if hit[0] and step not in named or not entry.no_room}
        say('the_start_is_free', not any(start), 'start: %d cloth-cloth, %d cloth-body' % start)
        say('nothing_intersects', not bad, bad and first(bad))
    return start, hits


def judge(entry, case, run, cloth):
    """Verdicts of one run."""
    verdicts = Verdicts(entry.open)
    say = verdicts.say
    if case.refused or case.may_refuse and all(word in run.message for word in case.may_refuse):
        judge_refusal(say, case, run)
    else:
        say('every_step_ends', run.code == 0 and len(run.rows) == run.steps,
            'exit code %d after %d of %d steps: %s' % (run.code, len(run.rows), run.steps, run.message[-300:]))
    if not os.path.isdir(run.folder) or not run.written():
        return verdicts
    judge_finite(say, run)
    if not entry.particles:
        judge_meshes(say, entry, run, cloth)
        if isinstance(case.scene, dict) and not entry.no_room and not entry.tangled:
            step = run.written()[-1]
            far = max(abs(value) for cloth in case.scene['cloths'] for value in cloth['pose']['position'])
            deep = inside(run, step, 1e-6 + 1e-7 * far)
            say('nothing_ends_inside_a_body', not deep, '%d vertices at step %d' % (deep, step))
    bound, why = case.energy or entry.energy
    say('energy_is_bounded', not run.worst('energy_kinetic') > bound,
        'kinetic energy %.4g J, bound %.4g J' % (run.worst('energy_kinetic'), bound))
    silent = [name for name in case.tells if not run.total(name) > 0]
    say('the_report_tells', not silent, 'never told: ' + ', '.join(silent))
    if case.also:
        for sentence, good, figures in case.also(run):
            say(sentence, good, figures)
    return verdicts


def figures(run, case, entry):
    """The figures of a run, for the CSV."""
    out = {name: run.total(name) for name in COUNTED}
    out.update({name: run.worst(name) if run.rows else 0 for name in WORST})
    return dict(out, steps=len(run.rows), energy_bound=(case.energy or entry.energy)[0])
