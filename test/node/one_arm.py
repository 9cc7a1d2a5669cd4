"""The robot of the node's tests: data/one_arm.urdf driven from Python, and calls of the node's services."""
import threading
import time

import rospy
from geometry_msgs.msg import TransformStamped
from robot_cloth.msg import Event, State
from sensor_msgs.msg import JointState

JOINTS = ('slide', 'lift', 'finger')  # mimic_finger follows finger


def base_frame(x=0.1, y=0.0, z=0.275):
    """world -> base: the tool is then at the cloth that hangs over the table's edge."""
    t = TransformStamped()
    t.header.frame_id, t.child_frame_id = 'world', 'base'
    t.transform.translation.x, t.transform.translation.y, t.transform.translation.z = x, y, z
    t.transform.rotation.w = 1
    return t


def joint_state(slide=0.0, lift=0.0, finger=0.05):
    return JointState(name=list(JOINTS), position=[slide, lift, finger])


class Driver(threading.Thread):
    """Publishes joint states at 100 Hz of wall time; go() moves them linearly."""

    def __init__(self):
        super().__init__(daemon=True)
        self.publisher = rospy.Publisher('joint_states', JointState, queue_size=10)
        self.lock = threading.Lock()
        self.now = dict(slide=0.0, lift=0.0, finger=0.05)
        self.path = None
        self.running = True
        self.start()

    def run(self):
        while self.running and not rospy.is_shutdown():
            with self.lock:
                if self.path:
                    start, end, t0, duration = self.path
                    s = min(1.0, (time.monotonic() - t0) / duration)
                    self.now = {j: start[j] + s * (end[j] - start[j]) for j in JOINTS}
                message = joint_state(**self.now)
            message.header.stamp = rospy.Time.now()
            self.publisher.publish(message)
            time.sleep(0.01)

    def go(self, duration, **joints):
        with self.lock:
            self.path = (dict(self.now), {**self.now, **joints}, time.monotonic(), duration)
        time.sleep(duration)


class Listener:
    """Collects the messages of a topic; until() waits for one that fits."""

    def __init__(self, topic, kind):
        self.messages, self.arrived = [], threading.Condition()
        self.subscriber = rospy.Subscriber(topic, kind, self.take, queue_size=1000)

    def take(self, message):
        with self.arrived:
            self.messages.append(message)
            self.arrived.notify_all()

    def until(self, fits, timeout=15.0, start=0):
        """The first message from index `start` on that fits; None after the timeout."""
        end = time.monotonic() + timeout
        with self.arrived:
            while True:
                for message in self.messages[start:]:
                    if fits(message):
                        return message
                left = end - time.monotonic()
                if left <= 0:
                    return None
                self.arrived.wait(left)

    def count(self):
        with self.arrived:
            return len(self.messages)


def events():
    return Listener('cloth/events', Event)


def states():
    return Listener('cloth/state', State)


def service(name, kind, timeout=30):
    rospy.wait_for_service('cloth/' + name, timeout)
    return rospy.ServiceProxy('cloth/' + name, kind)
