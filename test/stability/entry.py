"""What an entry of the stability catalogue is, and what several of them share."""
from shapes import DENSITY, ball, falls, floor, scene, sheet


class Case:
    """One run of an entry, in each precision.

    scene      a dictionary of shapes.scene(), or the path of a scene file seen from the package
    seconds    simulated
    files      {name: text} that the scene reads
    options    of `cloth run`
    written    about how many steps are written and checked
    energy     (J, why) instead of the entry's
    refused    words of the message with which the run must end instead of going through
    may_refuse  words of a message with which it may
    tells      fields of the report that must not be zero over the whole run
    also       function of the run: [(sentence, holds, figures)]
    """

    def __init__(self,
                 label,
                 scene,
                 seconds,
                 files=None,
                 options=(),
                 written=25,
                 energy=None,
                 refused=(),
                 may_refuse=(),
                 tells=(),
                 also=None,
                 precisions=('double', 'float')):
        self.label, self.scene, self.seconds, self.files = label, scene, seconds, files or {}
        self.options, self.written, self.energy = list(options), written, energy
        self.refused, self.may_refuse = refused, may_refuse
        self.tells, self.also, self.precisions = tells, also, precisions


class Entry:
    """One line of the table.

    no_room    bodies or held vertices leave the cloth no room: cloth may intersect bodies if the report says so
    driven     holds move: they may drive cloth through cloth as well, in steps whose report names them
    tangled    the start intersects: 'kept' (it does not get worse) or 'worked out' (nothing intersects at the end)
    particles  particles instead of triangles, or discrete detection: nothing is promised about intersections
    open       {sentence: why}: not held yet; told with its figures, the rest is judged
    """

    def __init__(self, name, hard, must, energy, cases, no_room=False, tangled='', particles=False, open=None, quick=False,
                 driven=False):
        self.name, self.hard, self.must, self.energy, self.cases = name, hard, must, energy, cases
        self.no_room, self.tangled, self.particles = no_room, tangled, particles
        self.open, self.quick, self.driven = open or {}, quick, driven


ENTRIES = []


def add(*args, **more):
    ENTRIES.append(Entry(*args, **more))


TOWEL_MASS = DENSITY * 0.3 * 0.3  # kg, of the sheet that most entries use


def drape(material=None, at=0.22, size=0.3, cells=14, **params):
    """A sheet falls over a ball onto a floor, off its middle."""
    return scene([sheet(size, cells, (0.02, 0.01, at), (0, 0, 0.3))], [ball(0.08, (0, 0, 0.1)), floor()], material, **params)


DRAPE = falls(TOWEL_MASS, 0.25, 'falls to the floor')
