"""Arms of a URDF: forward kinematics of any joint tree, closed-form inverse kinematics of one arm kind.

The arm kind is the SCARA-like one of config/robots/two_arm: lift, shoulder, elbow, wrist (all about z),
then roll about the pointing axis of a horizontal gripper. Every length comes from the URDF; one that
is not such an arm is refused with the joint that does not fit. No ROS needed, no numpy.
Lengths are metres, angles radians, matrices 4 x 4 as nested lists.
"""
import math
import xml.etree.ElementTree as ElementTree

IDENTITY = [[1.0, 0, 0, 0], [0, 1.0, 0, 0], [0, 0, 1.0, 0], [0, 0, 0, 1.0]]


class BadRobot(Exception):
    """The URDF is not a robot that the demo can drive; the text says where."""


class OutOfReach(Exception):
    """A target that the arm cannot take; the text names arm, target and limit."""


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def inverse(t):
    """Inverse of a rigid transform."""
    r = [[t[j][i] for j in range(3)] for i in range(3)]
    p = [-sum(r[i][k] * t[k][3] for k in range(3)) for i in range(3)]
    return [r[i] + [p[i]] for i in range(3)] + [[0, 0, 0, 1.0]]


def rotation(axis, angle):
    """Rotation by `angle` about the unit vector `axis` (Rodrigues)."""
    x, y, z = axis
    c, s, d = math.cos(angle), math.sin(angle), 1 - math.cos(angle)
    return [[c + x * x * d, x * y * d - z * s, x * z * d + y * s, 0],
            [y * x * d + z * s, c + y * y * d, y * z * d - x * s, 0],
            [z * x * d - y * s, z * y * d + x * s, c + z * z * d, 0], [0, 0, 0, 1.0]]


def translation(x, y, z):
    return [[1.0, 0, 0, x], [0, 1.0, 0, y], [0, 0, 1.0, z], [0, 0, 0, 1.0]]


def pose(xyz, rpy):
    """Transform of a URDF <origin>: fixed axes x, y, z by roll, pitch, yaw."""
    turn = product(rotation((0, 0, 1), rpy[2]), product(rotation((0, 1, 0), rpy[1]), rotation((1, 0, 0), rpy[0])))
    return product(translation(*xyz), turn)


def quaternion(t):
    """Unit quaternion (x, y, z, w) of the rotation in `t`."""
    trace = t[0][0] + t[1][1] + t[2][2]
    if trace > 0:
        s = 2 * math.sqrt(trace + 1)
        return ((t[2][1] - t[1][2]) / s, (t[0][2] - t[2][0]) / s, (t[1][0] - t[0][1]) / s, s / 4)
    i = max(range(3), key=lambda k: t[k][k])
    j, k = (i + 1) % 3, (i + 2) % 3
    s = 2 * math.sqrt(1 + t[i][i] - t[j][j] - t[k][k])
    q = [0.0] * 4
    q[i], q[j], q[k] = s / 4, (t[j][i] + t[i][j]) / s, (t[k][i] + t[i][k]) / s
    q[3] = (t[k][j] - t[j][k]) / s
    return tuple(q)


class Joint:
    """One <joint>: origin, axis, limits, mimic. Limits are None where a joint has none."""

    def __init__(self, element):
        def vector(tag, attribute, default):
            found = element.find(tag)
            text = found.get(attribute) if found is not None else None
            return tuple(float(v) for v in text.split()) if text else default
        self.name, self.kind = element.get('name'), element.get('type')
        self.parent, self.child = element.find('parent').get('link'), element.find('child').get('link')
        self.xyz, self.rpy = vector('origin', 'xyz', (0.0,) * 3), vector('origin', 'rpy', (0.0,) * 3)
        self.axis = vector('axis', 'xyz', (1.0, 0.0, 0.0))
        self.origin = pose(self.xyz, self.rpy)
        limit, mimic = element.find('limit'), element.find('mimic')
        self.lower = self.upper = self.velocity = None
        if limit is not None:
            self.velocity = float(limit.get('velocity'))
            if self.kind != 'continuous':
                self.lower, self.upper = float(limit.get('lower', 0)), float(limit.get('upper', 0))
        self.mimics = None
        if mimic is not None:
            self.mimics = (mimic.get('joint'), float(mimic.get('multiplier', 1)), float(mimic.get('offset', 0)))

    def transform(self, position):
        if self.kind == 'fixed':
            return self.origin
        if self.kind == 'prismatic':
            return product(self.origin, translation(*(a * position for a in self.axis)))
        return product(self.origin, rotation(self.axis, position))


class Robot:
    """The joint tree of a URDF text."""

    def __init__(self, urdf):
        try:
            root = ElementTree.fromstring(urdf)
            joints = [Joint(element) for element in root.findall('joint')]
        except (ElementTree.ParseError, AttributeError, TypeError, ValueError) as error:
            raise BadRobot('robot_description is not a usable URDF: %s' % error)
        self.joints = {joint.name: joint for joint in joints}
        self.by_child = {joint.child: joint for joint in joints}
        roots = [link.get('name') for link in root.findall('link') if link.get('name') not in self.by_child]
        if len(roots) != 1:
            raise BadRobot('robot_description has %d root links (%s), needs one' % (len(roots), ', '.join(roots)))
        self.root = roots[0]

    def joint(self, name):
        if name not in self.joints:
            raise BadRobot('robot_description has no joint "%s"' % name)
        return self.joints[name]

    def position(self, joint, positions):
        """Position of a joint, followed through <mimic>; 0 where `positions` does not say."""
        if joint.mimics:
            name, multiplier, offset = joint.mimics
            return multiplier * self.position(self.joint(name), positions) + offset
        return positions.get(joint.name, 0.0)

    def link_pose(self, link, positions):
        """Pose of a link in the root link, `positions` {joint name: m or rad}."""
        t = IDENTITY
        while link != self.root:
            joint = self.by_child.get(link)
            if joint is None:
                raise BadRobot('robot_description has no link "%s"' % link)
            t = product(joint.transform(self.position(joint, positions)), t)
            link = joint.parent
        return t


class Arm:
    """Inverse kinematics of SIDE_{lift,shoulder,elbow,wrist,roll,finger}_joint to the frame SIDE_tool.

    elbow: +1 bends the elbow so that the elbow joint is positive, -1 negative.
    """
    JOINTS = ('lift', 'shoulder', 'elbow', 'wrist', 'roll', 'finger')

    def __init__(self, robot, side, elbow):
        self.robot, self.side, self.elbow_sign = robot, side, elbow
        self.tool = side + '_tool'
        self.joints = {part: robot.joint('%s_%s_joint' % (side, part)) for part in self.JOINTS}
        kinds = dict(lift='prismatic', finger='prismatic')
        for part, joint in self.joints.items():
            axis = (1.0, 0.0, 0.0) if part == 'roll' else (0.0, 0.0, 1.0)
            if joint.kind != kinds.get(part, 'revolute') or joint.axis != axis:
                raise BadRobot('joint "%s" is %s about %s, needs %s about %s'
                               % (joint.name, joint.kind, joint.axis, kinds.get(part, 'revolute'), axis))
            if part != 'lift' and part != 'finger' and any(joint.rpy):
                raise BadRobot('joint "%s" has a turned origin, needs rpy="0 0 0"' % joint.name)
            if part in ('elbow', 'wrist') and joint.xyz[1] != 0:
                raise BadRobot('joint "%s" has its origin off the x axis of the link before it' % joint.name)
        zero = robot.link_pose(self.joints['shoulder'].child, {})
        self.shoulder = zero  # pose of the shoulder axis in the root link, lift at zero
        if abs(zero[2][2] - 1) > 1e-9:
            raise BadRobot('the column of the %s arm is not upright' % side)
        self.upper, self.fore = self.joints['elbow'].xyz[0], self.joints['wrist'].xyz[0]
        in_wrist = product(inverse(robot.link_pose(self.joints['wrist'].child, {})),
                           robot.link_pose(self.tool, {}))
        self.reach = in_wrist[0][3]  # wrist axis to tool, along the pointing axis
        self.drop = robot.link_pose(self.tool, {})[2][3] - zero[2][3]

    def solve(self, target, roll, half_gap):
        """Joint positions {name: value} that bring the tool to `target` (x, y, z) in the root link.

        The gripper points along the arm's zero direction (horizontal), turned by `roll` about it, its
        pads `half_gap` from the tool frame. OutOfReach where a limit would be exceeded.
        """
        local = product(inverse(self.shoulder), translation(*target))
        x, y, z = local[0][3] - self.reach, local[1][3], local[2][3]
        square = x * x + y * y
        cosine = (square - self.upper ** 2 - self.fore ** 2) / (2 * self.upper * self.fore)
        if not -1 <= cosine <= 1:
            raise OutOfReach('%s arm: (%.3f, %.3f, %.3f) m is %.3f m from the shoulder, reach is %.3f to %.3f m'
                             % ((self.side,) + tuple(target) + (math.sqrt(square), abs(self.upper - self.fore),
                                                                self.upper + self.fore)))
        elbow = self.elbow_sign * math.acos(cosine)
        shoulder = math.atan2(y, x) - math.atan2(self.fore * math.sin(elbow), self.upper + self.fore * cosine)
        shoulder = math.atan2(math.sin(shoulder), math.cos(shoulder))
        values = dict(lift=z - self.drop, shoulder=shoulder, elbow=elbow, wrist=-shoulder - elbow,
                      roll=roll, finger=half_gap)
        out = {}
        for part, value in values.items():
            joint = self.joints[part]
            if not joint.lower - 1e-9 <= value <= joint.upper + 1e-9:
                raise OutOfReach('%s arm: (%.3f, %.3f, %.3f) m needs %s at %.4f, its limits are %g to %g'
                                 % ((self.side,) + tuple(target) + (joint.name, value, joint.lower, joint.upper)))
            out[joint.name] = value
        return out
