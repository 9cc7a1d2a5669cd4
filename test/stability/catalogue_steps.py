"""The catalogue: steps from 1/2000 to 1/20 s on every scene of config/."""
import os
import sys

from entry import Case, add
from shapes import both, falls, moves

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scenes'))
import table  # noqa: E402  (the hard scenes and their bounds)


def steps_on(path, energy, seconds, options=(), no_room=False, particles=False, open=None, quick=False):
    """From 1/2000 s, for 120 steps, to 1/20 s, over the scene's story."""
    cases = [
        Case('1/%d s' % n,
             path,
             min(seconds, 120 / n),
             written=12,
             options=list(options) + ['--set', 'time_step=%.17g' % (1 / n)]) for n in (2000, 400, 60, 20)
    ]
    cases[-1].seconds = seconds
    name = path.split('/')[1] + '_' + os.path.splitext(os.path.basename(path))[0]
    add('steps_' + name.replace('scenes_', ''),
        'its own step is another: 1/2000 to 1/20 s',
        '',
        energy,
        cases,
        no_room=no_room,
        particles=particles,
        open=open,
        quick=quick)


SMALL = ('--variant', 'small')
for _name in ('twisted_cylinder', 'five_turns', 'rotating_sphere', 'funnel', 'tablecloth_pull', 'needles', 'mat_on_knives',
              'sphere_sheets', 'flag_two_corners', 'towel_rolled', 'hand_on_crumpled_towel', 'towel_whipped', 'link_sweep',
              'towel_on_towel', 'pinched', 'towels_clash'):
    _bound = table.SCENES.get(_name) or table.SCENES[_name + '_1']
    steps_on('config/scenes/%s.yaml' % _name,
             (3 * _bound.energy, 'three times that of test/scenes/table.py: short steps damp less'),
             0.6 if _name in ('twisted_cylinder', 'five_turns', 'funnel') else 1.5,
             SMALL,
             no_room=_name == 'pinched')
COARSE = ('--resolution', '0.4')
steps_on('config/scenes/drape_sphere.yaml', falls(0.108, 0.35, 'falls to the floor'), 1.5, COARSE)
steps_on('config/scenes/flag.yaml', moves(0.065, 6.1 * 1.3, 'all of it as fast as the strongest gust'), 1.5, COARSE)
steps_on('config/scenes/fold.yaml', falls(0.075, 0.405, 'falls as deep as the table is high'), 1, COARSE)
steps_on('config/scenes/hanging_towel.yaml', falls(0.075, 0.5, 'swings down by its height'), 1.5, COARSE, quick=True)
steps_on('config/scenes/towel_on_table.yaml', falls(0.075, 0.3, 'falls 2 cm, its rim by half its size'), 1, COARSE)
steps_on('config/scenes/slide_distance.yaml', moves(0.012, 2.02, 'what it starts with, and falls by a thickness'), 1)
steps_on('config/scenes/slope_slide.yaml', falls(0.012, 0.1, 'slides down by less'), 1)
steps_on('config/scenes/slope_stick.yaml', falls(0.012, 0.1, 'slides down by less'), 1)
steps_on('config/scenes/mass_spring.yaml',
         both(falls(0.6084, 0.65, 'falls to the floor'), moves(0.6084, 0.5, 'wind')),
         1.5, ('--variant', 'side=20,size=0.38'),
         particles=True)
steps_on('config/accuracy/cantilever.yaml', falls(0.03, 0.2, 'swings down by its length'), 1, particles=True)  # its contact is off
steps_on('config/accuracy/drape_sphere.yaml', falls(0.108, 0.35, 'falls to the floor'), 1)
steps_on('config/accuracy/fold.yaml', falls(0.075, 0.41, 'falls as deep as the table is high'), 2)
steps_on('config/accuracy/hanging_towel.yaml', falls(0.075, 0.5, 'swings down by its height'), 1)
steps_on('config/accuracy/slope_slide.yaml', falls(0.012, 0.2, 'slides down by less'), 1)
steps_on('config/accuracy/twisted_cylinder.yaml', (0.06, 'the rim all over, twice'), 1)
