"""The catalogue: holds and bodies."""
import math

from entry import Case, add, TOWEL_MASS
from shapes import ball, box, floor, hung, keys, moves, rod, scene, sheet


def gripped(left, right, **more):
    """A sheet held by its left and right sides, which move as told."""
    return sheet(0.3,
                 12, (0, 0, 0.3),
                 groups={'a': {'side': 'left'}, 'b': {'side': 'right'}},
                 pins=[dict({'group': 'a', 'motion': left}, **more),
                       dict({'group': 'b', 'motion': right}, **more)])


# Green strain (L^2 - 1) / 2 in the warp, E h = 2000 N/m
_pull = 0.5 * 2000 * 0.09 * ((2.2 ** 2 - 1) / 2) ** 2
_apart = (keys((0, (0, 0, 0)), (0.5, (-0.18, 0, 0)), (0.8, (-0.18, 0, 0)),
               (0.81, (0, 0, 0))), keys((0, (0, 0, 0)), (0.5, (0.18, 0, 0)), (0.8, (0.18, 0, 0)), (0.81, (0, 0, 0))))
add('pulled_past_twice', 'two grippers pull a towel to 2.2 times its length and snap back within 10 ms', '',
    (_pull, 'E h A / 2 times Green strain squared: what the pull stores'), [
        Case('rigid', scene([gripped(*_apart)], [floor()]), 1.2),
        Case('breaks at 20 N', scene([gripped(*_apart, break_force=20)], [floor()]), 1.2, tells=('grasps_broken', )),
        Case('springs', scene([gripped(*_apart, stiffness=500)], [floor()]), 1.2)
    ])
add('gripper_teleports', 'a held corner is told to be elsewhere in the next step: by 0.3 m, by 3 m', '',
    (0.5 * 2000 * 0.09 * ((11 ** 2 - 1) / 2) ** 2, 'E h A / 2 times Green strain squared, at 11 times its length'), [
        Case(
            '%g m' % d,
            scene([
                sheet(0.3,
                      12, (0, 0, 0.3),
                      groups={'a': {'nearest': [-0.15, -0.15, 0]}},
                      pins=[{'group': 'a', 'motion': keys((0, (0, 0, 0)), (0.3, (0, 0, 0)), (0.30001, (0, 0, d)))}])
            ], [floor()]), 1) for d in (0.3, 3)
    ])
add('gripper_swings_at_10_mps',
    'a held side swings to and fro at 10 m/s, eight times a second; a cloth hangs in its way',
    '',
    moves(3 * TOWEL_MASS, 2 * 10.1, 'all of both at twice the speed of the swing'), [
        Case('one',
             scene([hung(at=(0, 0, 0.5), pins=[{'motion': {'oscillation': {'amplitude': [0, 0.2, 0], 'period': 0.125}}}])]),
             0.6,
             written=36),
        Case('two',
             scene([
                 hung(at=(0, 0, 0.5), pins=[{'motion': {'oscillation': {'amplitude': [0, 0.2, 0], 'period': 0.125}}}]),
                 hung(at=(0, 0.25, 0.5), name='other')
             ]),
             0.6,
             written=36)
    ],
    quick=True)


def jumping(what, how, **params):
    return scene([hung(at=(0, 0, 0.35), cells=12)], [dict(what, motion=how), floor()], **params)


def jump(where):
    return keys((0, (0, 0.12, 0.3)), (0.2, (0, 0.12, 0.3)), (0.20001, where), (0.5, where), (0.50001, (0, 0.12, 0.3)))


add('body_jumps', 'a link jumps within one step, as after a lost message: through the cloth, swept', '',
    moves(TOWEL_MASS, 2 * 0.24 * 60, 'all of it at twice the speed of the jump'), [
        Case('ball', jumping(ball(0.05), jump((0, -0.12, 0.3))), 1, written=60),
        Case('box', jumping(box('link', (0.04, 0.06, 0.2)), jump((0, -0.12, 0.3))), 1, written=60)
    ])
add('body_jumps_far', 'a link jumps by more than teleport_distance to the other side: placed, not swept', '',
    moves(TOWEL_MASS, 2 * 1.0, 'all of it at 2 m/s'),
    [Case('ball', jumping(ball(0.05), jump((0, -0.6, 0.3))), 1, tells=('teleports', ))])
add('body_turns_over', 'a link turns by half a turn within one step, in contact', '',
    moves(TOWEL_MASS, 2 * 0.1 * math.pi * 60, 'all of it at twice the speed of its corners'), [
        Case(
            'box',
            scene([sheet(0.3, 12, (0, 0, 0.2))], [
                box('link', (0.2, 0.05, 0.03), (0, 0, 0.15),
                    motion={'keys': [{'time': 0}, {'time': 0.4}, {'time': 0.40001, 'rotation': [1, 0, 0, 0]}]}),
                floor()
            ]), 1)
    ])
for _untangle in (False, True):
    add('body_spawned_inside_' + ('untangled' if _untangle else 'kept'),
        'at the start a ball, a box, a rod stands in a hanging cloth',
        'nothing intersects at the end' if _untangle else 'no more pairs intersect than at the start',
        moves(TOWEL_MASS, 2, 'all of it at 2 m/s: far above the 0.15 m/s at which it is worked out'), [
            Case(label, scene([hung(at=(0, 0, 0.35))], [what, floor()], untangle=_untangle), 1)
            for label, what in (('ball', ball(0.04, (0.0031, 0.0103, 0.3017))),
                                ('box', box('link', (0.06, 0.06, 0.06), (0.01, 0.01, 0.3))),
                                ('board at the rim', box('link', (0.08, 0.06, 0.06), (0.15, 0.008, 0.3))),
                                ('rod', rod(0.02, 0.1, (0.01, 0.005, 0.33))))
        ],
        tangled='worked out' if _untangle else 'kept',
        no_room=True,
        quick=_untangle)
def crossing(first, bodies=()):
    """A sheet, and another that crosses it at the start."""
    return scene([first, sheet(0.2, 10, (0.007, 0.003, 0.25), (0.2, 0.1, 1.3), name='other', velocity=first.get('velocity', [0, 0, 0]))],
                 list(bodies) + [floor()])


def to_and_fro(amplitude, period):
    return {'motion': {'oscillation': {'amplitude': amplitude, 'period': period}}}


add('kept_in_hard_motion',
    'cloth that intersects at the start is swung at 2.5 m/s, thrown at 10 m/s, hit, shaken by the box in it',
    'no more pairs intersect than at the start',
    moves(2 * TOWEL_MASS, 20, 'all of it at twice the fastest of these'), [
        Case('swung', crossing(hung(at=(0, 0, 0.35), pins=[to_and_fro([0, 0.1, 0], 0.25)])), 1),
        Case('hit', crossing(hung(at=(0, 0, 0.35)), [ball(0.05, (0, -0.3, 0.3), motion={'velocity': [0, 3, 0]})]), 1),
        Case('thrown', crossing(sheet(0.3, 12, (0, 0, 0.25), (0, 0.9, 0), velocity=[0, 0, -10])), 1),
        Case('shaken',
             scene([hung(at=(0, 0, 0.35))],
                   [box('link', (0.06, 0.06, 0.06), (0.01, 0.01, 0.3), **to_and_fro([0.05, 0.1, 0.02], 0.2)),
                    floor()]), 1)
    ],
    tangled='kept',
    no_room=True)
add('cube_spawned_askew_untangled',
    'at the start a cube that stands on a corner is in a hanging cloth: all that hangs below has to be lifted off it',
    'nothing intersects at the end',
    moves(TOWEL_MASS, 2, 'all of it at 2 m/s'), [
        Case(
            label,
            scene([hung(at=(0, 0, 0.35))],
                  [box('link', (0.06, 0.06, 0.06), pose={'position': at, 'rpy': rpy}), floor()],
                  untangle=True), 2)
        for label, at, rpy in (
            ('leaning', [0.01, 0.01, 0.3], [0.4, 0.5, 0.6]),
            ('a corner through the cloth', [0.01, 0.002, 0.3], [math.acos(1 / math.sqrt(3)), 0, math.pi / 4]))
    ],
    tangled='worked out',
    no_room=True,
    quick=True)
add('body_placed_inside',
    'a ball jumps from 1 m away into the middle of a hanging cloth, and away again',
    'the report counts it; nothing intersects once the ball is gone',
    moves(TOWEL_MASS, 2, 'all of it at 2 m/s'), [
        Case('ball',
             scene([hung(at=(0, 0, 0.35))], [
                 ball(0.04,
                      motion=keys((0, (0, 1, 0.3)), (0.2, (0, 1, 0.3)), (0.20001, (0, 0.01, 0.3)), (0.8, (0, 0.01, 0.3)),
                                  (0.80001, (0, 1, 0.3)))),
                 floor()
             ]),
             1.5,
             written=30,
             tells=('teleports', 'tangles'))
    ],
    no_room=True)


def fingers(gap, **more):
    """Two fingers on a hanging towel that close from 4 cm to `gap` and open again."""
    out = []
    for name, side in (('front', -1), ('back', 1)):
        near = side * (0.01 + gap / 2)
        out.append(
            box('finger_' + name, (0.03, 0.02, 0.06),
                friction=0.8,
                motion=keys((0, (0, side * 0.05, 0.1)), (0.3, (0, near, 0.1)), (0.6, (0, near, 0.1)),
                            (0.8, (0, side * 0.05, 0.1)))))
    return scene([hung((0.2, 0.3), (12, 18), (0, 0, 0.15))], out, **more)


add('closed_to_a_gap',
    'fingers close on a towel to just the room it needs',
    '',
    moves(0.018, 0.5, 'all of it at three times the speed of the fingers'), [Case('6.6 mm', fingers(0.0066), 1.2, written=36)],
    quick=True)
add('closed_to_zero',
    'fingers close on a towel to no gap, and 4 mm into each other',
    'the report names the fingers; nothing intersects cloth later',
    moves(0.018, 0.5, 'all of it at three times the speed of the fingers'), [
        Case('%g mm' % (1e3 * gap), fingers(gap), 1.2, written=36, tells=('impacts_left', 'bodies_blocking'))
        for gap in (0.0, -0.004)
    ],
    no_room=True)
add('pressed_on_a_table',
    'a plate presses a towel into the table it lies on, and lifts off',
    '',
    moves(TOWEL_MASS, 0.6, 'all of it at three times the speed of the plate'), [
        Case('zero gap',
             scene([sheet(0.3, 12, (0, 0, 0.003))], [
                 floor(),
                 box('plate', (0.1, 0.1, 0.04),
                     motion=keys((0, (0, 0, 0.1)), (0.4, (0, 0, 0.02)), (0.6, (0, 0, 0.02)), (0.9, (0, 0, 0.1))))
             ]),
             1.2,
             tells=('impacts_left', 'bodies_blocking'))
    ],
    no_room=True)


def corner_down(*motion):
    """A sheet whose two front corners are held and moved."""
    return sheet(0.3,
                 12, (0, 0, 0.2),
                 groups={'a': {'nearest': [[-0.15, -0.15, 0], [0.15, -0.15, 0]]}},
                 pins=[{'group': 'a', 'motion': keys(*motion)}])


def recovers(run):
    """Of a hold that came back: nothing is told at the end."""
    last = run.rows[-1]
    left = [last[name] for name in ('impacts_left', 'tangles', 'bodies_blocking', 'holds_blocking')]
    return [('it_recovers', not any(left), 'at the end: %s' % left)]


_told = ('impacts_left', 'tangles', 'bodies_blocking', 'holds_blocking')
add('pinned_into_a_body',
    'the held corners of a towel are driven through a table, into a ball; and back',
    'the report counts it and names body and hold; nothing is left once the hold is out again',
    moves(TOWEL_MASS, 2, 'all of it at four times the speed of the hold'), [
        Case('0.5 m/s',
             scene([corner_down((0, (0, 0, 0)), (0.5, (0, 0, -0.25)))],
                   [box('table', (0.5, 0.5, 0.03), (0, 0, 0.1)), floor(-0.3)]),
             1,
             tells=_told),
        Case('and back',
             scene([corner_down((0, (0, 0, 0)), (0.3, (0, 0, -0.15)), (0.4, (0, 0, -0.15)), (0.7, (0, 0, 0)))],
                   [box('table', (0.5, 0.5, 0.03), (0, 0, 0.1)), floor(-0.3)]),
             1,
             tells=_told,
             also=recovers),
        Case('a ball, and back',
             scene([corner_down((0, (0, 0, 0)), (0.3, (0, 0, -0.15)), (0.4, (0, 0, -0.15)), (0.7, (0, 0, 0)))],
                   [ball(0.06, (-0.14, -0.14, 0.1)), floor(-0.3)]),
             1,
             tells=_told,
             also=recovers)
    ],
    no_room=True,
    quick=True)


def frames(motion, cells=8):
    """Two sheets, the first 25 of 81 vertices of each held; the upper one moves."""
    return [
        sheet(0.2, cells, at, name=name, groups={'held': {'vertices': list(range(25))}},
              pins=[dict({'group': 'held'}, **how)])
        for name, at, how in (('lower', (0, 0, 0.3), {}), ('upper', (0.013, 0.007, 0.353), {'motion': motion}))
    ]


add('held_cloth_into_held_cloth',
    'a sheet of which a third is held is driven through another such sheet, and back',
    'the report counts it and names both holds',
    moves(2 * TOWEL_MASS, 2, 'all of both at six times the speed of the hold'), [
        Case('0.33 m/s',
             scene(frames(keys((0, (0, 0, 0)), (0.3, (0, 0, -0.1)), (0.4, (0, 0, -0.1)), (0.7, (0, 0, 0)))), [floor()]),
             1.2,
             tells=('impacts_left', 'tangles', 'holds_blocking'),
             also=recovers)
    ],
    no_room=True,
    driven=True,
    quick=True)
add('knife_at_speed', 'a blade of 2 mm at 5 m/s through a hanging towel, 8 cm a step', '',
    moves(TOWEL_MASS, 2 * 5, 'all of it at twice the speed of the blade'), [
        Case('5 m/s',
             scene([hung(at=(0, 0, 0.35))],
                   [box('knife', (0.5, 0.002, 0.05), (0, -0.3, 0.3), motion={'velocity': [0, 5, 0], 'end': 0.3})]),
             0.5,
             written=30)
    ])


def spinning(speed):
    return scene([sheet(0.3, 14, (0, 0, 0.12))],
                 [box('link', (0.1, 0.1, 0.1), (0, 0, 0.05), friction=1, motion={'spin': [0, 0, speed]}),
                  floor()])


add('spinning_body', 'a box turns at 20 and 80 rad/s, by up to 1.3 rad a step, under a towel with friction 1', '',
    moves(TOWEL_MASS, 2 * 80 * 0.071, 'all of it at twice the speed of its corners'),
    [Case('%d rad/s' % w, spinning(w), 0.8) for w in (20, 80)])
add('spinning_too_fast',
    'the same at 100 rad/s: more than a quarter turn a step is a teleport',
    'the report counts each',
    moves(TOWEL_MASS, 2 * 100 * 0.071, 'all of it at twice the speed of its corners'),
    [Case('100 rad/s', spinning(100), 0.8, tells=('teleports', ))],
    no_room=True)
add('thrown_at_50_mps', 'a towel hits a floor, a thin rod and the edge of a box at 50 m/s, 0.8 m a step',
    'nothing below the floor', moves(TOWEL_MASS, 51, 'what it starts with, and the fall'), [
        Case('floor', scene([sheet(0.3, 12, (0, 0, 2), (0.2, 0.1, 0), velocity=[0, 0, -50])], [floor()]), 0.3, written=18),
        Case('rod',
             scene([sheet(0.3, 12, (0, 0, 2),
                          (0.2, 0.1, 0), velocity=[0, 0, -50])], [rod(0.003, 0.5,
                                                                      (0, 0, 0.5)), floor()]),
             0.3,
             written=18),
        Case('edge',
             scene([sheet(0.3, 12, (0, 0, 2), velocity=[0, 0, -50])],
                   [box('edge', (0.3, 0.3, 0.3), (0.15, 0, 0.5)), floor()]),
             0.3,
             written=18)
    ])
