#!/usr/bin/python3
"""fold.test: the towel is picked up, swung, laid down folded and let go, with no intersection at any step.

Intersections are looked for by check_meshes (CGAL, exact) on the meshes of every step: the cloth as the node
says it is, the links by the demo's own kinematics and mesh reader. Nothing of the engine decides.
"""
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.realpath(__file__))
for place in '../../../../lib/robot_cloth', '../../src/demo':  # installed, or in the source tree
    sys.path.insert(0, os.path.join(HERE, place))
import fold_steps  # noqa: E402

import rospy  # noqa: E402
import rostest  # noqa: E402
from robot_cloth.msg import Topology  # noqa: E402
from robot_cloth.srv import GetState  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

NX = NY = 51  # the grid of config/scenes/fold.yaml


class Watch(fold_steps.FoldSteps):
    """The fold, keeping the towel at the end of each segment and the worst strain seen of its edges.

    Along the threads of the fabric and across them: a towel shears five times as easily as it stretches.
    """

    def __init__(self):
        super().__init__()
        self.seen, self.strain, self.name = {}, {'threads': 0.0, 'bias': 0.0}, None
        topology = rospy.wait_for_message('cloth/towel/topology', Topology, 30)
        t = topology.triangles
        self.edges = sorted({tuple(sorted((t[i + a], t[i + b]))) for i in range(0, len(t), 3) for a, b in ((0, 1), (1, 2), (2, 0))})
        rest = topology.rest_positions
        self.rest = [math.dist(rest[3 * a:3 * a + 3], rest[3 * b:3 * b + 3]) for a, b in self.edges]
        self.state = rospy.ServiceProxy('cloth/get_state', GetState, persistent=True)

    def say(self, name):
        if name != self.name and self.name is not None:
            self.look(self.name)
        self.name = name
        super().say(name)

    def look(self, name):
        answer = self.state(cloth='towel', velocities=True)
        x = answer.positions
        self.seen[name] = ([x[i:i + 3] for i in range(0, len(x), 3)], list(bytearray(answer.held)),
                           max(math.hypot(*answer.velocities[i:i + 3]) for i in range(0, len(x), 3)))
        for (a, b), length in zip(self.edges, self.rest):
            kind = 'threads' if a // NX == b // NX or a % NX == b % NX else 'bias'
            strain = math.dist(x[3 * a:3 * a + 3], x[3 * b:3 * b + 3]) / length - 1
            self.strain[kind] = max(self.strain[kind], strain)


class Fold(unittest.TestCase):
    checked = 'not run'

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix='fold_test_')
        cls.check = os.environ.get('CLOTH_CHECK_MESHES', '')
        if cls.check:
            rospy.set_param('~meshes', cls.folder)
        cls.fold = Watch()
        cls.fold.run()
        cls.fold.look('end')
        cls.hash = rospy.get_param('~state_hash')
        # and once more, without looking
        if cls.check:
            rospy.delete_param('~meshes')
        cls.was_reset = rospy.ServiceProxy('cloth/reset', Trigger)().success
        fold_steps.FoldSteps().run()
        cls.hash_again = rospy.get_param('~state_hash')

    @classmethod
    def tearDownClass(cls):
        print('\ncheck_meshes: %s\nworst stretch along the threads %.1f %%, across them %.1f %%'
              % (cls.checked, 100 * cls.fold.strain['threads'], 100 * cls.fold.strain['bias']))
        shutil.rmtree(cls.folder, ignore_errors=True)

    def towel(self, segment):
        return self.fold.seen[segment]

    def test_both_grippers_take_their_corner(self):
        _, held, _ = self.towel('hold')
        by_side = [sum(held[row * NX + column] for row in rows for column in range(6)) for rows in (range(6), range(NY - 6, NY))]
        self.assertGreaterEqual(min(by_side), 6, 'vertices held: %s' % by_side)
        self.assertEqual(sum(by_side), sum(held), 'something else is held, too')

    def test_the_edge_is_lifted_and_swung(self):
        x, held, _ = self.towel('lift')
        self.assertGreater(min(x[i][2] for i in range(len(x)) if held[i]), 0.40 + 0.10)
        x, held, _ = self.towel('swing')
        self.assertGreater(min(x[i][0] for i in range(len(x)) if held[i]), 0.10)

    def test_the_towel_is_laid_down_folded_in_half(self):
        x, held, speed = self.towel('end')
        self.assertEqual(sum(held), 0)
        # what was the near edge lies over the far one; 4 cm for the way it slips when the fingers leave
        slips = [x[row * NX][0] - x[row * NX + NX - 1][0] for row in range(NY)]
        print('the near edge lies beyond the far one by %.1f to %.1f mm' % (1e3 * min(slips[6:-6]), 1e3 * max(slips[6:-6])))
        for row in range(6, NY - 6):  # what lies on the table; the rest hangs over its sides
            near, far = x[row * NX], x[row * NX + NX - 1]
            self.assertLess(abs(near[0] - far[0]), 0.04, 'row %d' % row)
            self.assertGreater(near[2], far[2], 'row %d' % row)
        self.assertLess(max(p[2] for p in x), 0.40 + 0.06)  # nothing stands up
        self.assertLess(max(p[0] for p in x) - min(p[0] for p in x), 0.5 / 2 + 0.04)
        self.assertLess(speed, 0.05)  # m/s: at rest but for creep

    def test_the_towel_is_hardly_stretched(self):
        # 5 %: Bullet's soft body stretches by 9 to 19 % in such scenes; a towel by 1 or 2
        self.assertLess(self.fold.strain['threads'], 0.05)
        # Where the fold lies over the side of the table, one edge or two are sheared by 2 to 11 %: which is
        # decided by roundings, as friction keeps what the solver's residual of 1 % left.
        self.assertLess(self.fold.strain['bias'], 0.15)

    def test_no_triangles_intersect_at_any_step(self):
        if not self.check:
            self.skipTest('no check_meshes: built without CGAL')
        result = subprocess.run([self.check, self.folder], capture_output=True, text=True, check=False)
        Fold.checked = result.stdout.strip().split('\n')[-1]
        self.assertEqual(result.returncode, 0, result.stdout[-600:])

    def test_again_after_a_reset_it_is_the_same_fold_bit_for_bit(self):
        self.assertTrue(self.was_reset)
        self.assertEqual(self.hash_again, self.hash)


if __name__ == '__main__':
    rospy.init_node('fold_test')
    rostest.rosrun('robot_cloth', 'fold', Fold)
