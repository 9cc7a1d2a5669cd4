"""The catalogue: the world, the solver, the effects."""
import math

from entry import Case, add, TOWEL_MASS, drape, DRAPE
from shapes import GRAVITY, ball, both, falls, floor, hung, moves, rod, scene, sheet

add('gravity_flipped', 'a hanging towel is pulled upwards, and aside by ten times its weight', '',
    falls(TOWEL_MASS, 3.5, '0.35 m at ten g'), [
        Case(
            'up',
            scene([
                sheet(0.3,
                      14, (0, 0, 0.2), (math.pi / 2 - 0.01, 0, 0),
                      groups={'held': {'side': 'top'}},
                      pins=[{'group': 'held'}])
            ], [floor()],
                  gravity=[0, 0, GRAVITY]), 1.5),
        Case('10 g aside', scene([hung(at=(0, 0, 0.2))], [floor()], gravity=[0, 10 * GRAVITY, 0]), 1.5),
        Case('1000 m/s^2',
             scene([sheet(0.3, 12, (0, 0, 0.2))], [ball(0.08, (0, 0, 0.1)), floor()], gravity=[0, 0, -1000]),
             0.5,
             energy=(TOWEL_MASS * 1000 * 0.25, 'm g h'))
    ])
add('wind_of_40_mps', 'gusts of 40 m/s on a flag, on a towel over a ball, and on the membrane of a closed frame', '',
    moves(TOWEL_MASS, 60, 'all of it as fast as the strongest gust'), [
        Case('flag', scene([hung(at=(0, 0, 0.2))], air_density=1.2, wind=[0, 40, 0], gust=0.5, gust_period=0.3), 1, written=30),
        Case('over a ball',
             scene([sheet(0.3, 14, (0, 0, 0.22))], [ball(0.08, (0, 0, 0.1)), floor()],
                   air_density=1.2,
                   wind=[40, 0, -5],
                   gust=0.5,
                   gust_period=0.3),
             1,
             written=30),
        Case('held at four corners',
             scene([
                 sheet(0.3,
                       14, (0, 0, 0.2),
                       groups={'c': {'nearest': [[x, y, 0] for x in (-0.15, 0.15) for y in (-0.15, 0.15)]}},
                       pins=[{'group': 'c'}])
             ],
                   air_density=1.2,
                   wind=[0, 0, 40],
                   gust=0.5,
                   gust_period=0.3),
             1,
             written=30)
    ])
add(
    'far_from_the_origin', '1 km from the origin, where a float is 0.06 mm', '',
    both(falls(TOWEL_MASS, 0.25, 'falls to the floor'),
         moves(TOWEL_MASS, 0.2, 'rounding of positions over a step: 0.06 mm in 1/60 s, and as much again for the knots')), [
             Case(label, scene([cloth], bodies, bounds=5000), 1) for label, cloth, bodies in (
                 ('drape', sheet(0.3, 14, (1000.02, 0.01, 0.22)),
                  [ball(0.08, (1000, 0, 0.1)), dict(floor(), pose={'position': [1000, 0, 0]})]),
                 ('hanging', hung(at=(707, 707, 0.2)), []))
         ])
add('solver_starved_stiff',
    'five iterations of the linear solver for cloth of 1e6 N/m, of which they see nothing',
    'the report counts the solves that gave up',
    DRAPE, [
        Case('stiff',
             drape({'stretch_warp': 1e6, 'stretch_weft': 1e6, 'shear': 1e5}, pcg_iterations_max=5, pcg_tolerance=1e-6),
             1,
             tells=('pcg_unconverged', )),
    ],
    quick=True)
add('solver_starved',
    'five iterations of the linear solver, one Newton iteration',
    'the report counts the solves that gave up',
    DRAPE, [
        Case('drape', drape(pcg_iterations_max=5, pcg_tolerance=1e-6, newton_iterations_max=1), 1, tells=('pcg_unconverged', )),
        Case('Jacobi',
             drape(pcg_iterations_max=5, pcg_tolerance=1e-6, preconditioner='block_jacobi'),
             1,
             tells=('pcg_unconverged', )),
        Case('1 iteration',
             drape(pcg_iterations_max=1, pcg_tolerance=1e-6, newton_iterations_max=1),
             1,
             tells=('pcg_unconverged', ))
    ],
    quick=True)
add('contact_starved', 'no contact rounds, no impact zones, one pass of the failsafe, no halving, no substeps', '', DRAPE, [
    Case('drape',
         drape(contact_rounds_max=0, zone_iterations_max=0, failsafe_iterations_max=1, step_halvings_max=0, substeps_max=1), 1),
    Case(
        '1/20 s',
        drape(contact_rounds_max=0,
              zone_iterations_max=0,
              failsafe_iterations_max=1,
              step_halvings_max=0,
              substeps_max=1,
              time_step=0.05), 1)
])
add('explosion_refused',
    'a velocity that leaves the bounds within one step',
    'refused by name; nothing that is not finite is written', (math.inf, 'refused'),
    [Case('1000 m/s', scene([sheet(0.3, 8, velocity=[1000, 0, 0])], bounds=10), 0.5, refused=('10 m', 'before the step'))],
    quick=True)
add('every_effect_at_once',
    'gravity, membrane, bending, damping, air, pins, contact and friction; with particles: springs',
    '',
    both(moves(2 * TOWEL_MASS, 12 + 2, 'as fast as the gusts and the ball'), falls(2 * TOWEL_MASS, 0.5, 'falls to the floor')),
    [
        Case(label,
             scene(
                 [hung(at=(0, 0, 0.4), pins=[{'end': 1.2}]),
                  hung(at=(0, 0.03, 0.4), name='second', pins=[{'break_force': 2}])], [
                      ball(0.06, (0, -0.2, 0.35), motion={'oscillation': {'amplitude': [0, 0.3, 0], 'period': 1.5}}),
                      floor(),
                      rod(0.02, 0.6, (0, 0.1, 0.1))
                  ], {'damping_mass': 0.1},
                 air_density=1.2,
                 wind=[1, 8, 0],
                 gust=0.5,
                 friction=0.4,
                 untangle=True,
                 bending_model=model,
                 preconditioner='multilevel'),
             2,
             written=40) for label, model in (('shape', 'shape'), ('hinge', 'hinge'), ('quadratic', 'quadratic'))
    ],
    quick=True)
add('particles_every_effect',
    'the same by particles and springs',
    '',
    both(moves(2 * TOWEL_MASS, 12 + 2, 'as fast as the gusts and the ball'), falls(2 * TOWEL_MASS, 0.5, 'falls to the floor')),
    [
        Case(
            'mass_spring',
            scene(
                [hung(at=(0, 0, 0.4), pins=[{'end': 1.2}]),
                 hung(at=(0, 0.04, 0.4), name='second', pins=[{'break_force': 2}])],
                [ball(0.06, (0, -0.2, 0.35), motion={'oscillation': {'amplitude': [0, 0.3, 0], 'period': 1.5}}),
                 floor()], {'damping_mass': 0.1, 'stretch_warp': 200, 'stretch_weft': 200, 'shear': 40},
                air_density=1.2,
                wind=[1, 8, 0],
                gust=0.5,
                integrator='mass_spring',
                spring_step=0), 2)
    ],
    particles=True)
add('particles_too_long_a_step',
    'a sub-step above the stable limit',
    'refused by name', (math.inf, 'refused'), [
        Case('1e6 N/m',
             scene([sheet()], material={'stretch_warp': 1e6, 'stretch_weft': 1e6}, integrator='mass_spring', spring_step=0.001),
             0.5,
             refused=('spring_step', ))
    ],
    particles=True)
add('particles_too_many_sub_steps',
    'damping that asks for a sub-step of a nanosecond: a step would take hours',
    'refused by name', (math.inf, 'refused'), [
        Case('damping 10 s',
             scene([sheet()], material={'damping_stretch': 10}, integrator='mass_spring', spring_step=0), 0.5,
             refused=('at most 1000000', 'sub-steps'))
    ],
    particles=True,
    quick=True)

EFFECTS = ('gravity', 'membrane', 'bending', 'damping', 'air', 'pins', 'self_contact', 'body_contact', 'friction')


def alone(effect):
    """One effect on a cloth that moves at 1 m/s towards a ball, with a second cloth behind it; friction with contact."""
    kept = {effect} | ({'body_contact', 'self_contact'}
                       if effect == 'friction' else set()) | ({'membrane'} if effect == 'damping' else set())
    return scene([hung(at=(0, 0, 0.4), cells=10, velocity=[0, 1, 0]),
                  hung(at=(0, 0.05, 0.4), cells=10, name='second')],
                 [] if effect == 'self_contact' else [ball(0.06, (0, 0.2, 0.4)), floor()],
                 air_density=1.2,
                 wind=[0, 3, 0],
                 bounds=1000,
                 effects={name: 'auto' if name in kept else 'off'
                          for name in EFFECTS})


for _effect in EFFECTS:
    _blind = _effect not in ('self_contact', 'friction')  # nothing keeps the cloths apart
    add('only_' + _effect,
        'all other effects are off' +
        ('; friction needs contact' if _effect == 'friction' else '; damping needs a membrane' if _effect == 'damping' else ''),
        '',
        both(moves(2 * TOWEL_MASS, 1 + 3 + 0.1, 'what it starts with, and the wind'),
             falls(2 * TOWEL_MASS, 5, 'free fall for 1 s')), [Case(_effect, alone(_effect), 1)],
        particles=_blind,
        quick=_effect == 'self_contact')
