"""The fold of a towel as a function of time: gripper path -> joint positions. No ROS needed.

Both grippers do the same, mirrored at the plane y = 0 of the scene. So a moment of the fold is one
Grip: where the left tool is, how far it is turned and opened. `segments()` is the story; read it first.
Every segment starts and ends at rest (minimum jerk), so the whole is smooth.
"""
import math
from collections import namedtuple

import arm

# y: distance of each tool from the mid plane; roll: turn about the pointing axis, such that 0 -> pi
# turns what is held over towards +x; half_gap: pads to tool frame. Metres, radians, scene frame.
Grip = namedtuple('Grip', 'x y z roll half_gap')
# speed: the fastest that tool or fingers go in it, m/s
Segment = namedtuple('Segment', 'name start end arc duration')

# What a towel needs of the fold. All lengths in metres, speeds in m/s, times in s.
FoldTask = namedtuple('FoldTask', 'edge_x far_x side_y table_z')
FOLD = dict(
    inset_x=0.0145,       # tool to the edge of the towel that is lifted
    inset_y=0.017,        # tool to the edge at its side, before the corner droops
    open_half_gap=0.040,  # before the grasp
    held_half_gap=0.004,  # 8 mm between the pads: more than two layers' thickness, cloth is not squeezed
    laid_half_gap=0.014,  # to let go: little, for the lower finger is between two layers
    grasp_height=-0.008,  # of the tool over the table top; the overhanging corner droops
    laid_height=0.025,    # of the tool over the table top when letting go
    laid_beyond=0.014,    # how far beyond the far edge the edge is laid down; it draws back when let go
    arc_height=0.200,     # of the swing over the line from grasp to lay down: less than half the towel
    arc_shape=1.4,        # of the swing: 1 is half an ellipse, 2 a parabola
    arc_hang=0.5,         # how long the gripper stays turned by about pi / 2, where the cloth hangs; 0 to 1
    slack=0.005,          # grippers come closer to each other by this much after the grasp, each
    home_y=0.40, home_height=0.16,
    retract_y=0.36,
    speed_free=0.35, speed_reach=0.15, speed_fingers=0.05, speed_lift=0.30, speed_swing=0.55,
    speed_lay=0.15, speed_retract=0.08,
    settle=0.4,
    shortest=0.3,         # duration of a segment, s
)
PEAK = 1.875  # peak over mean speed of a minimum-jerk segment


def ease(u):
    """Minimum jerk from 0 to 1 (Flash and Hogan 1985)."""
    u = min(max(u, 0.0), 1.0)
    return u * u * u * (10 + u * (6 * u - 15))


def between(a, b, s):
    return Grip(*(p + (q - p) * s for p, q in zip(a, b)))


class FoldPath:
    """Joint positions of both arms over time, for a robot (arm.Robot) standing at `base`.

    base: pose (4 x 4) of the robot's root link in the scene, not turned. numbers: overrides of FOLD by name.
    Raises arm.OutOfReach, naming segment and time, if any moment is outside the robot's limits.
    """

    def __init__(self, robot, task, base=None, **numbers):
        unknown = set(numbers) - set(FOLD)
        if unknown:
            raise ValueError('the fold has no number "%s"; it has %s' % (unknown.pop(), ', '.join(sorted(FOLD))))
        self.task, self.numbers = task, dict(FOLD, **numbers)
        self.to_root = arm.inverse(base or arm.IDENTITY)
        # elbows out to the same side, so that the arms mirror each other; turning over is opposite
        self.arms = ((arm.Arm(robot, 'left', -1), 1, -1), (arm.Arm(robot, 'right', 1), -1, 1))
        self.parts = self.segments()
        self.starts = [sum(p.duration for p in self.parts[:i]) for i in range(len(self.parts))]
        self.duration = sum(p.duration for p in self.parts)
        self.check()

    def segments(self):
        n, task = self.numbers, self.task
        y = task.side_y - n['inset_y']
        grasp = Grip(task.edge_x + n['inset_x'], y, task.table_z + n['grasp_height'], 0.0, n['open_half_gap'])
        home = grasp._replace(y=n['home_y'], z=task.table_z + n['home_height'])
        held = grasp._replace(half_gap=n['held_half_gap'])
        taut = held._replace(y=y - n['slack'])
        laid = taut._replace(x=task.far_x - n['inset_x'] + n['laid_beyond'], z=task.table_z + n['laid_height'],
                             roll=math.pi)
        opened = laid._replace(half_gap=n['laid_half_gap'])
        out = opened._replace(y=n['retract_y'])
        up = out._replace(y=n['home_y'], z=home.z + 0.04, half_gap=n['open_half_gap'])

        parts, here = [], home

        def go(name, to, speed, arc=None):
            """A straight segment, or with `arc` = (from, to) that share of the swing."""
            nonlocal here
            length = self.length(Segment(name, here, to, arc, 1.0))
            parts.append(Segment(name, here, to, arc, max(PEAK * length / speed, n['shortest'])))
            here = to

        def wait(name):
            parts.append(Segment(name, here, here, None, n['settle']))

        go('approach', grasp._replace(y=n['home_y']), n['speed_free'])
        go('reach', grasp, n['speed_reach'])
        go('close', held, n['speed_fingers'])
        wait('hold')
        go('gather', taut, n['speed_lay'])
        self.arc_ends = (taut, laid)
        lift_end, swing_end = 0.28, 0.80
        for name, speed, share in (('lift', n['speed_lift'], (0.0, lift_end)),
                                   ('swing', n['speed_swing'], (lift_end, swing_end)),
                                   ('lay', n['speed_lay'], (swing_end, 1.0))):
            go(name, self.on_arc(taut, laid, share[1]), speed, share)
        wait('rest')
        go('open', opened, n['speed_fingers'] / 2)
        wait('drop')
        go('retract', out, n['speed_retract'])
        go('rise', up, n['speed_free'])
        go('return', home, n['speed_free'])
        return parts

    def on_arc(self, start, end, share):
        """A point of the swing, from start (share 0) to end (share 1).

        It begins and ends upright, so that nothing is pushed along the table; in between it stays well inside
        the half circle on which the cloth would be taut, for cloth hangs from the gripper almost straight down.
        """
        n = self.numbers
        straight = between(start, end, share)
        turned = share + n['arc_hang'] * math.sin(2 * math.pi * share) / (2 * math.pi)
        return straight._replace(x=start.x + (end.x - start.x) * (1 - math.cos(math.pi * share)) / 2,
                                 z=straight.z + n['arc_height'] * max(0.0, math.sin(math.pi * share)) ** n['arc_shape'],
                                 roll=start.roll + (end.roll - start.roll) * turned)

    def length(self, part, pieces=64):
        """The longest of the ways of tool, fingers and edge of the palm in a segment, m."""
        points = [self.along(part, i / pieces) for i in range(pieces + 1)]
        way = sum(math.dist(a[:3], b[:3]) for a, b in zip(points, points[1:]))
        turn = 0.0 if part.arc else abs(part.end.roll - part.start.roll) * 0.03
        return max(way, turn, abs(part.end.half_gap - part.start.half_gap))

    def along(self, part, s):
        if part.arc is None:
            return between(part.start, part.end, s)
        low, high = part.arc
        return self.on_arc(*self.arc_ends, low + (high - low) * s)

    def segment_at(self, t):
        """The segment at time t, and the time since its start."""
        for part, start in zip(reversed(self.parts), reversed(self.starts)):
            if t >= start:
                return part, t - start
        return self.parts[0], 0.0

    def grip(self, t):
        """What both grippers are to do at time t [s]; held before the start and after the end."""
        part, since = self.segment_at(t)
        return self.along(part, ease(since / part.duration))

    def moment(self, name, share=0.5):
        """The time of a named segment, `share` of its duration after its start."""
        for part, start in zip(self.parts, self.starts):
            if part.name == name:
                return start + share * part.duration
        raise ValueError('the fold has no segment "%s"; it has %s' % (name, ', '.join(p.name for p in self.parts)))

    def target(self, grip, side):
        """The tool position in the robot's root link."""
        point = arm.product(self.to_root, arm.translation(grip.x, side * grip.y, grip.z))
        return point[0][3], point[1][3], point[2][3]

    def positions(self, t):
        """Joint positions {name: m or rad} at time t. Mimic joints are not in it, as with real drivers."""
        grip = self.grip(t)
        out = {}
        for one, side, turn in self.arms:
            out.update(one.solve(self.target(grip, side), turn * grip.roll, grip.half_gap))
        return out

    def velocities(self, t, step=1e-4):
        """Joint velocities [m/s or rad/s] at time t."""
        before, after = self.positions(t - step), self.positions(t + step)
        return {name: (after[name] - before[name]) / (2 * step) for name in after}

    def check(self, rate=50.0):
        for i in range(int(self.duration * rate) + 2):
            t = i / rate
            try:
                speeds = self.velocities(t)
            except arm.OutOfReach as error:
                raise arm.OutOfReach('%s (segment "%s", t = %.2f s)' % (error, self.segment_at(t)[0].name, t))
            for name, speed in speeds.items():
                limit = self.arms[0][0].robot.joint(name).velocity
                if abs(speed) > limit:
                    raise arm.OutOfReach('%s would turn at %.2f, its limit is %.2f (segment "%s", t = %.2f s)'
                                         % (name, speed, limit, self.segment_at(t)[0].name, t))


def task_from_scene(scene, cloth='towel', table='table'):
    """A FoldTask from a parsed scene file: a grid cloth laid flat on a box, not turned."""
    def named(list_name, name):
        for entry in scene.get(list_name) or []:
            if entry.get('name') == name:
                return entry
        raise ValueError('the scene has no "%s" named "%s"' % (list_name, name))
    towel, box = named('cloths', cloth), named('bodies', table)
    if 'grid' not in towel or 'box' not in box:
        raise ValueError('the fold needs a cloth "%s" with a grid and a body "%s" with a box' % (cloth, table))
    size = towel['grid']['size']
    place = (towel.get('pose') or {}).get('position', (0.0,) * 3)
    turned = (towel.get('pose') or {}).get('rpy', (0.0,) * 3)
    if any(abs(angle) > 1e-9 for angle in turned) or abs(place[1]) > 1e-9:
        raise ValueError('the fold needs a towel that is not turned and lies in the middle (y = 0)')
    top = (box.get('pose') or {}).get('position', (0.0,) * 3)[2] + box['box']['size'][2] / 2
    if box['box']['size'][1] / 2 > size[1] / 2 - 0.03:
        raise ValueError('the table is %.3f m wide in y; the towel of %.3f m must hang over by 0.03 m on both sides'
                         % (box['box']['size'][1], size[1]))
    return FoldTask(place[0] - size[0] / 2, place[0] + size[0] / 2, size[1] / 2, top)
