"""The tables of doc/stability.md, from the rows of stability.csv."""
import math

BEGIN, END = '<!-- stability: from test/stability/run.py --doc -->', '<!-- end -->'
TOLD = (('step_halvings', 'substeps halved'), ('pcg_unconverged', 'solves given up'), ('held_back', 'pairs held back'),
        ('teleports', 'bodies placed'), ('grasps_broken', 'grasps broken'))
WORST = (('impacts_left', 'passing through'), ('tangles', 'intersecting'), ('bodies_blocking', 'bodies that leave no room'),
         ('holds_blocking', 'holds that leave no room'))


def number(value):
    return '%d' % value if value == int(value) and abs(value) < 1e6 else '%.3g' % value


def told(rows):
    """What the reports of all runs of an entry say was cut or given up."""
    cut = sum(float(row['substeps']) - float(row['steps']) for row in rows)
    parts = ['%s extra substeps' % number(cut)] if cut > 0 else []
    for name, words in TOLD:
        count = sum(float(row[name]) for row in rows)
        parts += ['%s %s' % (number(count), words)] if count else []
    for name, words in WORST:
        count = max(float(row[name]) for row in rows)
        parts += ['at most %s %s in a step' % (number(count), words)] if count else []
    return ', '.join(parts) or 'nothing'


def result(entry, rows, wanted):
    if len(rows) < wanted:
        return '%d of %d runs' % (len(rows), wanted)
    failed = sorted({part.split(':')[0] for row in rows if row['result'] == 'FAIL' for part in row['missed'].split('; ')})
    if failed:
        return '**fails**: ' + ', '.join(failed)
    missed = {row['case'] + ', ' + row['precision'] for row in rows if row['result'] == 'open'}
    return 'open in %d of %d runs' % (len(missed), len(rows)) if missed else 'ok'


def energy(entry, rows):
    """The run that comes nearest to its bound."""
    row = max(rows, key=lambda row: float(row['energy_kinetic']) / float(row['energy_bound']))
    bound = float(row['energy_bound'])
    if math.isinf(bound):
        return '-'
    return '%.2g of %.2g: %s' % (float(row['energy_kinetic']), bound, entry.energy[1])


def table_of(entries, rows):
    lines = [
        '| entry | what makes it hard | what it adds to what must hold | J seen, of J allowed: why | worst stretch | cut or given up, as reported | result |',
        '|---|---|---|---|---|---|---|'
    ]
    for entry in entries:
        mine = [row for row in rows if row['entry'] == entry.name]
        if not mine:
            continue
        wanted = sum(len(case.precisions) for case in entry.cases)
        stretch = max(float(row['stretch_max']) for row in mine)
        lines.append('| `%s` (%d) | %s | %s | %s | %.3g %% | %s | %s |' %
                     (entry.name, len(mine), entry.hard, entry.must, energy(
                         entry, mine), 100 * stretch, told(mine), result(entry, mine, wanted)))
    return lines


def open_of(entries):
    lines = ['| entry | not held yet | why |', '|---|---|---|']
    for entry in entries:
        lines += ['| `%s` | `%s` | %s |' % (entry.name, sentence, why) for sentence, why in entry.open.items()]
    return lines if len(lines) > 2 else ['Nothing is open.']


def random_of(rows):
    mine = [row for row in rows if row['entry'].startswith('seed_')]
    if not mine:
        return ['Not run.']
    bad = [row['entry'] for row in mine if row['result'] == 'FAIL']
    total = lambda name: number(sum(float(row[name]) for row in mine))
    return [
        '%d scenes, %s steps in %s substeps (%s halvings), %s impacts answered, %s solves given up, %s bodies placed; %s.' %
        (len(mine), total('steps'), total('substeps'), total('step_halvings'), total('impacts'), total('pcg_unconverged'),
         total('teleports'), 'no violation' if not bad else '**violations** in ' + ', '.join(bad))
    ]


def write(path, version, entries, rows):
    """Rewrite what stands between the markers of the page."""
    with open(path) as file:
        text = file.read()
    before, rest = text.split(BEGIN)
    after = rest.split(END, 1)[1]
    runs = [row for row in rows if not row['entry'].startswith('seed_')]
    lines = [
        '',
        'Engine %s, %d entries, %d runs, %.0f minutes of one core.' %
        (version, len({row['entry']
                       for row in runs}), len(runs), sum(float(row['seconds']) for row in rows) / 60), ''
    ]
    lines += table_of(entries, rows) + ['', '### Open', ''] + open_of(entries) + ['', '### Random scenes', ''
                                                                                  ] + random_of(rows) + ['']
    with open(path, 'w') as file:
        file.write(before + BEGIN + '\n'.join(lines) + '\n' + END + after)
