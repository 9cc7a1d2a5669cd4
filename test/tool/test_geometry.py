#!/usr/bin/env python3
"""cloth check, cloth ccd and cloth ccd-mesh from outside.

usage: test_geometry.py CLOTH [CHECK_MESHES]      prints "ok   NAME" or "FAIL NAME" for each case
"""
import csv
import glob
import math
import os
import random
import re
import struct
import subprocess
import sys
from fractions import Fraction

from test_command import CHECK_MESHES, SCENE, Skipped, check, cloth, refused, run_cases, write

SHARED = os.environ.get("CLOTH_SHARED_DATA") or os.path.join(
    os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "shared", "data")


def obj(vertices, faces):
    return "".join("v %r %r %r\n" % tuple(v) for v in vertices) + "".join(
        "f " + " ".join(str(i + 1) for i in f) + "\n" for f in faces)


def ply(vertices, faces, kind="ascii", real="double", extra=False):
    """bytes of a PLY file; `extra`: properties, a list and an element that nobody asked for"""
    order = {"binary_little_endian": "<", "binary_big_endian": ">"}.get(kind)
    head = ["ply", "format %s 1.0" % kind, "comment made by a test", "element vertex %d" % len(vertices)]
    head += ["property uchar red"] if extra else []
    head += ["property %s %s" % (real, axis) for axis in "xyz"]
    head += ["element edge 1", "property int vertex1", "property int vertex2"] if extra else []
    head += ["element face %d" % len(faces), "property list uchar int vertex_indices"]
    head += ["property list uchar float weights"] if extra else []
    out = ("\n".join(head + ["end_header", ""])).encode()

    def put(code, *numbers):
        if order:
            return struct.pack(order + code, *numbers)
        return (" ".join(repr(n) for n in numbers) + " ").encode()

    code = "d" if real == "double" else "f"
    for v in vertices:
        out += (put("B", 7) if extra else b"") + put(3 * code, *v) + (b"" if order else b"\n")
    if extra:
        out += put("ii", 0, 1) + (b"" if order else b"\n")
    for f in faces:
        out += put("B", len(f)) + put("%di" % len(f), *f)
        out += (put("B", 2) + put("ff", 0.5, 1.5) if extra else b"") + (b"" if order else b"\n")
    return out


def write_bytes(tmp, name, data):
    with open(os.path.join(tmp, name), "wb") as f:
        f.write(data)


def sheet(n, height):
    vertices = [(i / n, j / n, height(i / n, j / n)) for j in range(n + 1) for i in range(n + 1)]
    faces = []
    for j in range(n):
        for i in range(n):
            a = j * (n + 1) + i
            faces += [(a, a + 1, a + n + 2), (a, a + n + 2, a + n + 1)]
    return vertices, faces


# ---- cloth check --------------------------------------------------------------------------------

def pairs_found(tmp, *names, code=None):
    r = cloth("check", *names, cwd=tmp)
    last = re.fullmatch(r"intersecting pairs (\d+)", r.stdout.splitlines()[-1] if r.stdout else "")
    check(last, "no last line in", r.stdout, r.stderr)
    count = int(last.group(1))
    check(r.returncode == (1 if count else 0), names, "exits with", r.returncode)
    return count


def touching_counts_and_sharing_does_not(tmp):
    def two(*corners, faces=((0, 1, 2), (3, 4, 5))):
        write(tmp, "m.obj", obj(corners, faces))
        return pairs_found(tmp, "m.obj")
    a = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    check(two(*a, (.2, .2, -1), (.3, .2, 1), (.2, .3, 1)) == 1, "crossing")
    check(two(*a, (.2, .2, 0), (.3, .2, 1), (.2, .3, 1)) == 1, "a corner on the face")
    check(two(*a, (.2, .2, 5e-324), (.3, .2, 1), (.2, .3, 1)) == 0, "one least number above")
    check(two(*a, (0, 0, 0), (-1, 0, 0), (0, -1, 0)) == 1, "two vertices at one place touch")
    check(two(*a, (.5, .5, 0), (1, 1, 0), (.5, 1, 0)) == 1, "coplanar, a corner on an edge")
    check(two(*a, (.5, .5000001, 0), (1, 1, 0), (.5, 1, 0)) == 0, "coplanar, beside")
    check(two(*a, (.2, .2, 0), (.3, .2, 0), (.2, .3, 0)) == 1, "coplanar, one inside the other")
    check(two(*a, (.2, .2, 0), (.2, .2, 0), (.2, .2, 0)) == 1, "a point")
    share = [(0, 0, 0), (1, 0, 0), (.5, 1, 0)]
    check(two(*share, (.5, -1, 0), faces=[(0, 1, 2), (1, 0, 3)]) == 0, "a common edge")
    check(two(*share, (.5, .8, 0), faces=[(0, 1, 2), (1, 0, 3)]) == 1, "folded onto itself")
    check(two(*share, (.5, .8, 1e-300), faces=[(0, 1, 2), (1, 0, 3)]) == 0, "folded nearly")
    check(two(*share, faces=[(0, 1, 2), (2, 1, 0)]) == 1, "the same triangle twice")
    check(two((0, 0, 0), (1, -1, 0), (1, 1, 0), (2, 0, -1), (2, 0, 1),
              faces=[(0, 1, 2), (0, 3, 4)]) == 1, "beyond the common corner")
    check(two((0, 0, 0), (1, -1, 0), (1, 1, 0), (-2, 0, -1), (-2, 0, 1),
              faces=[(0, 1, 2), (0, 3, 4)]) == 0, "in the common corner alone")


def totals_are_given_by_mesh_and_by_pair(tmp):
    write(tmp, "flat.obj", obj(*sheet(4, lambda x, y: 0.0)))
    write(tmp, "tilt.obj", obj(*sheet(4, lambda x, y: x - .4)))
    write_bytes(tmp, "far.ply", ply(*sheet(2, lambda x, y: 9.0)))
    r = cloth("check", "flat.obj", "tilt.obj", "far.ply", "--max-pairs", "2", "--list", "all.csv", cwd=tmp)
    check(r.returncode == 1 and r.stderr == "", r.stderr)
    for name in ("flat.obj: 32 triangles, 0 pairs with itself", "far.ply: 8 triangles, 0 pairs with itself",
                 "flat.obj and far.ply: 0 pairs", "more are not shown"):
        check(name in r.stdout, "no", name, "in", r.stdout)
    count = int(re.search(r"flat.obj and tilt.obj: (\d+) pairs", r.stdout).group(1))
    check(count > 2 and r.stdout.endswith("intersecting pairs %d\n" % count), r.stdout)
    check(len(re.findall("^flat.obj triangle", r.stdout, re.M)) == 2, r.stdout)
    with open(os.path.join(tmp, "all.csv")) as f:
        rows = list(csv.DictReader(f))
    check(len(rows) == count and len({tuple(row.values()) for row in rows}) == count, rows)
    # columns of the tilted sheet over x = .4: every triangle found has corners on both sides
    check(all(row["mesh0"] == "flat.obj" and row["mesh1"] == "tilt.obj" for row in rows), rows)
    check({int(row["triangle1"]) % 8 // 2 for row in rows} == {1}, "triangles of another column")


def a_raw_mesh_is_checked_as_it_is(tmp):
    # three triangles on an edge, an unused vertex, a triangle without area, a polygon
    vertices = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, -1, 0), (9, 9, 9), (2, 0, 0), (3, 1, 0), (2, 1, 0)]
    write(tmp, "raw.obj", obj(vertices, [(0, 1, 2), (0, 1, 3), (0, 1, 4), (0, 0, 3), (1, 6, 7, 8)]))
    check(pairs_found(tmp, "raw.obj") == 0, "the raw mesh")


def written_meshes_agree_with_check_meshes(tmp):
    if not CHECK_MESHES:
        raise Skipped("check_meshes is not built")
    waves = (lambda x, y: .2 * math.sin(9 * x + 5 * y), lambda x, y: .2 * math.cos(7 * y - x), lambda x, y: .1)
    for i, wave in enumerate(waves):
        write(tmp, "%d.obj" % i, obj(*sheet(12, wave)))
    ours = pairs_found(tmp, "0.obj", "1.obj", "2.obj")
    r = subprocess.run([CHECK_MESHES, "--cloth", "0.obj", "1.obj", "2.obj"], cwd=tmp, stdout=subprocess.PIPE,
                       universal_newlines=True, timeout=120)
    theirs = int(re.search(r"intersections: (\d+) cloth-cloth", r.stdout).group(1))
    check(ours == theirs and ours > 100, ours, theirs)


def bad_meshes_are_refused(tmp):
    write(tmp, "good.obj", obj(*sheet(2, lambda x, y: 0.0)))
    write(tmp, "bad.obj", "v 0 0 0\nv 1 0\n")
    write(tmp, "nan.obj", "v 0 0 nan\n")
    write(tmp, "index.obj", "v 0 0 0\nf 1 2 3\n")
    write_bytes(tmp, "short.ply", ply(*sheet(3, lambda x, y: 0.0), kind="binary_big_endian")[:-5])
    refused(tmp, ["check"], "too few")
    refused(tmp, ["check", "none.obj"], "none.obj")
    refused(tmp, ["check", "good.obj", "bad.obj"], "bad.obj:2")
    refused(tmp, ["check", "nan.obj"], "nan.obj:1", "nan")
    refused(tmp, ["check", "index.obj"], "index.obj:2")
    refused(tmp, ["check", "short.ply"], "short.ply", "too early")
    refused(tmp, ["check", "good.obj", "--max-pairs", "-1"], "--max-pairs")
    refused(tmp, ["check", "good.obj", "--list", "none/x.csv"], "none/x.csv")


# ---- cloth ccd ----------------------------------------------------------------------------------

FALL = [(.25, .25, 1), (0, 0, 0), (1, 0, 0), (0, 1, 0), (.25, .25, -1), (0, 0, 0), (1, 0, 0), (0, 1, 0)]
PASS = [(-.25, .25, 1)] + FALL[1:4] + [(-.25, .25, -1)] + FALL[5:]


def rows(points, truth, end="\n"):
    out = ""
    for p in points:
        for x in p:
            f = Fraction(x)
            out += "%d,%d," % (f.numerator, f.denominator)
        out += "%d%s" % (truth, end)
    return out


def figures(r, which="total"):
    found = re.search(re.escape(which) + r": queries (\d+), contacts (\d+), missed (\d+), extra (\d+), "
                      r"worst lateness (\S+), (\d+) ns per query", r.stdout)
    check(found, "no figures in", r.stdout, r.stderr)
    return [int(n) for n in found.groups()[:4]] + [float(found.group(5))]


def queries_are_counted_per_file_and_in_total(tmp):
    os.makedirs(os.path.join(tmp, "set/vertex-face"))
    # blank lines, blanks around numbers, ends of lines of all kinds, no end on the last
    text = "\n  \n" + rows(FALL, 1, " \t\r\n") + "\r\n" + rows(PASS, 0).replace(",", " , ")
    write(tmp, "set/vertex-face/a.csv", text.rstrip("\n"))
    write(tmp, "set/vertex-face/b.csv", rows(PASS, 1))  # a lie: what is not there is missed
    write(tmp, "b.csv", rows(FALL, 0))
    for precision in ("float", "double"):
        r = cloth("ccd", "set/vertex-face/a.csv", "--precision", precision, cwd=tmp)
        check(r.returncode == 0 and figures(r) == [2, 1, 0, 0, 0], r.stdout, r.stderr)
        r = cloth("ccd", "set/vertex-face/a.csv", "set/vertex-face/b.csv", "--precision", precision, cwd=tmp)
        check(r.returncode == 1, "a missed contact exits with", r.returncode)
        check(figures(r) == [3, 2, 1, 0, 0] and figures(r, "set/vertex-face/b.csv") == [1, 1, 1, 0, 0], r.stdout)
        r = cloth("ccd", "b.csv", "--type", "vf", "--precision", precision, cwd=tmp)
        check(r.returncode == 0 and figures(r) == [1, 0, 0, 1, 0], r.stdout, r.stderr)
    write_bytes(tmp, "mark.csv", b"\xef\xbb\xbf" + rows(FALL, 1).encode())  # as spreadsheets write it
    r = cloth("ccd", "mark.csv", "--type", "vf", cwd=tmp)
    check(r.returncode == 0 and figures(r) == [1, 1, 0, 0, 0], r.stdout, r.stderr)
    # from inside the folder the path has no such word; where it is does
    r = cloth("ccd", "a.csv", cwd=os.path.join(tmp, "set/vertex-face"))
    check(r.returncode == 0, r.stderr)


def coordinates_that_float_cannot_hold_are_not_missed(tmp):
    # a vertex passes a border of the face by one part in 2^40, inside or outside; far from the origin
    text = ""
    for n in range(200):
        side = Fraction(1 if n % 2 else -1, 2**40)
        far = Fraction(n * 7919, 2**20) if n % 3 == 0 else Fraction(n, 2**5)
        p = [tuple(Fraction(x) for x in q) for q in FALL]
        for k in (0, 4):
            p[k] = (side, p[k][1], p[k][2])
        text += rows([tuple(x + far for x in q) for q in p], 1 if n % 2 else 0)
    write(tmp, "q.csv", text)
    r = cloth("ccd", "q.csv", "--type=vf", "--precision=float", cwd=tmp)
    check(r.returncode == 0 and figures(r) == [200, 100, 0, 0, 0], r.stdout, r.stderr)
    r = cloth("ccd", "q.csv", "--type=vf", "--precision=float", "--float-only", cwd=tmp)
    check(figures(r)[2] == 0 and figures(r)[3] > 50, r.stdout)


def fractions_that_no_double_is_are_not_missed(tmp):
    # four points that touch at t = 2/3 with thirds and sevenths in every coordinate; then a vertex
    # that passes 1e-7 above a face that does not move
    dice = random.Random(4)

    def point(n):
        return [Fraction(dice.randint(-30, 30), n) for _ in range(3)]
    for far in (0, 1000, 10**12):
        text = ""
        for _ in range(60):
            face, speed = [point(7) for _ in range(3)], [point(21) for _ in range(4)]
            a, b = sorted(Fraction(dice.randint(0, 3), 3) for _ in range(2))
            vertex = [(1 - b) * x + (b - a) * y + a * z for x, y, z in zip(*face)]
            for t in (Fraction(-2, 3), Fraction(1, 3)):
                text += rows([[x + t * v + far for x, v in zip(p, w)] for p, w in zip([vertex] + face, speed)], 1)
        count = 60
        for k in range(20):
            above = Fraction(1, 3) + Fraction(1 if k % 2 else -1, 10**7) + far
            face = [(far, far, far + Fraction(1, 3)), (far + 7, far, far + Fraction(1, 3)), (far, far + 7, far + Fraction(1, 3))]
            if far < 10**6:
                text += rows([(far - 3 + k, far + 1, above)] + face + [(far + 2, far + Fraction(k, 7), above)] + face, 0)
                count += 1
        write(tmp, "q.csv", text)
        for precision in ("float", "double"):
            r = cloth("ccd", "q.csv", "--type=vf", "--precision", precision, cwd=tmp)
            check(r.returncode == 0 and figures(r) == [count, 60, 0, 0, 0], far, r.stdout, r.stderr)


def coordinates_of_any_length_are_read_for_what_they_are(tmp):
    # the least denormal (its denominator has 324 digits), and a fraction that 400 digits of both hide
    least = Fraction(5e-324)
    r = None
    for unit, long in ((least, 1), (least * 3, 1), (Fraction(1), 10**400), (Fraction(2**60 + 1), 1), (Fraction(1, 3**80), 1)):
        text = ""
        for p, truth in ((FALL, 1), (PASS, 0)):
            for q in p:
                for x in q:
                    f = Fraction(x) * 4 * unit
                    text += "%d,%d," % (f.numerator * long, f.denominator * long)
                text += "%d\n" % truth
        write(tmp, "q.csv", text)
        for precision in ("float", "double"):
            r = cloth("ccd", "q.csv", "--type=vf", "--precision", precision, cwd=tmp)
            check(r.returncode == 0 and figures(r) == [2, 1, 0, 0, 0], unit, r.stdout, r.stderr)
    check("2 with coordinates that no double is" in r.stdout, r.stdout)
    # what is exact stays so: a vertex that slides 1e-25 above the face
    text = ""
    for p in [(-1, 1, 1e-25)] + FALL[1:4] + [(3, 1, 1e-25)] + FALL[1:4]:
        text += "".join("%d,%d," % (Fraction(x).numerator * 3**40, Fraction(x).denominator * 3**40) for x in p) + "0\n"
    write(tmp, "q.csv", text)
    for precision in ("float", "double"):
        r = cloth("ccd", "q.csv", "--type=vf", "--precision", precision, cwd=tmp)
        check(figures(r) == [1, 0, 0, 0, 0] and "no double" not in r.stdout, r.stdout, r.stderr)


def lateness_is_measured_against_the_bracket(tmp):
    write(tmp, "data_3_1.csv", rows(FALL, 1) + rows(PASS, 0) + rows(FALL, 1))
    write(tmp, "toi_3_1.json", '[[0.49, 0.5], null,\n "coplanar"]')
    r = cloth("ccd", "data_3_1.csv", "--type=vf", cwd=tmp)
    check(figures(r) == [3, 2, 0, 0, 0] and "(1 with exact times)" in r.stdout, r.stdout)
    write(tmp, "toi_3_1.json", "[[0.1, 0.25], null, null]")  # a lie: it is a quarter late
    r = cloth("ccd", "data_3_1.csv", "--type=vf", cwd=tmp)
    check(abs(figures(r)[4] - 0.25) < 1e-3, r.stdout)
    write(tmp, "toi_3_1.json", "[null]")
    refused(tmp, ["ccd", "data_3_1.csv", "--type=vf"], "data_3_1.csv", "1 times")
    write(tmp, "toi_3_1.json", "[null, [1, 2, 3], null]")
    refused(tmp, ["ccd", "data_3_1.csv", "--type=vf"], "toi_3_1.json", "entry 2")


def broken_query_files_are_refused_with_their_line(tmp):
    good = rows(FALL, 1)
    lines = good.splitlines()

    def file(name, text):
        write(tmp, name, text)
        return ["ccd", name, "--type=ee"]
    refused(tmp, file("q.csv", good)[:2], "q.csv", "edge-edge or vertex-face", "--type")
    refused(tmp, file("q.csv", good)[:2] + ["--type", "xx"], "xx")
    refused(tmp, file("six.csv", "\n".join(lines[:2] + ["1,1,1,1,1,1"] + lines[3:])), "six.csv:3", "6 columns")
    refused(tmp, file("eight.csv", good.replace("\n", ",5\n", 1)), "eight.csv:1", "8 columns")
    refused(tmp, file("word.csv", good.replace("1,4", "1,x", 1)), "word.csv:1", "column 2", "'x'")
    refused(tmp, file("gap.csv", good.replace("1,4", "1,4 4", 1)), "gap.csv:1", "column 2", "'4 4'")
    refused(tmp, file("real.csv", good.replace("1,4", "1.5,4", 1)), "real.csv:1", "column 1", "1.5")
    refused(tmp, file("long.csv", good.replace("1,4", "1" * 1001 + ",4", 1)), "long.csv:1", "column 1", "1000 digits")
    refused(tmp, file("zero.csv", good.replace("1,4", "1,0", 1)), "zero.csv:1", "denominator")
    refused(tmp, file("cut.csv", "\n".join(lines[:5])), "cut.csv:5", "row 5 of query 1")
    refused(tmp, file("truth.csv", "\n".join(lines[:7] + [lines[7][:-1] + "0"])), "truth.csv:8", "truth")
    refused(tmp, file("two.csv", good.replace(",1\n", ",2\n")), "two.csv:1", "neither 0 nor 1")
    refused(tmp, file("empty.csv", "\n\n"), "empty.csv", "no queries")
    refused(tmp, ["ccd", "none.csv", "--type=ee"], "none.csv")
    refused(tmp, ["ccd", "q.csv", "--type=ee", "--precision", "half"], "half", "float", "double")


def shared_queries_are_neither_missed_nor_late(tmp):
    files = sorted(glob.glob(os.path.join(SHARED, "ccd", "*", "*", "data_*.csv")))
    if not files:
        raise Skipped("no queries here; set CLOTH_SHARED_DATA to the folder that has ccd/")
    for precision in ("float", "double"):
        r = cloth("ccd", *files, "--precision", precision, cwd=tmp)
        check(r.returncode == 0, r.stdout, r.stderr)
        for name in files + ["total"]:
            queries, contacts, missed, extra, late = figures(r, name)
            check(missed == 0 and late == 0 and extra * 50 <= queries, precision, name, r.stdout)


# ---- cloth ccd-mesh -----------------------------------------------------------------------------

def counts(r):
    check(r.returncode == 0, r.stdout, r.stderr)
    found = re.findall(r"^(?:candidate|colliding) pairs: edge-edge (\d+), vertex-face (\d+)$", r.stdout, re.M)
    check(len(found) == 2, r.stdout)
    first = re.search(r"^earliest time of impact: (\S+)", r.stdout, re.M).group(1)
    return [int(n) for pair in found for n in pair] + [first]


def brute_force(x0, x1, faces, inflate):
    def box(feature):
        points = [p[v] for p in (x0, x1) for v in feature]
        return [(min(p[k] for p in points) - inflate, max(p[k] for p in points) + inflate) for k in range(3)]
    edges = sorted({tuple(sorted((f[i], f[(i + 1) % 3]))) for f in faces for i in range(3)})
    edges = [(e, box(e)) for e in edges if e[0] != e[1]]
    faces = [(f, box(f)) for f in faces]

    def meet(a, b):
        return not set(a[0]) & set(b[0]) and all(p[0] <= q[1] and q[0] <= p[1] for p, q in zip(a[1], b[1]))
    ee = sum(meet(edges[i], edges[j]) for i in range(len(edges)) for j in range(i))
    points = [((v,), box((v,))) for v in range(len(x0))]
    return [ee, sum(meet(p, f) for p in points for f in faces)]


def candidates_are_those_of_all_boxes_in_every_encoding(tmp):
    random.seed(4)
    x0, faces = sheet(6, lambda x, y: 0.0)
    x1 = [(x + random.uniform(-.2, .2), y + random.uniform(-.2, .2), random.choice((-.1, 0, .1))) for x, y, z in x0]
    x0, x1 = x0 + [(.5, .5, .05)], x1 + [(.5, .5, -.05)]  # of no triangle
    faces = faces + [(0, 1, 9), (0, 1, 9), (3, 3, 20), (5, 6, 7)]  # repeated, without area, not manifold
    for inflate in (0, 0.03):
        for real in ("double", "float"):
            exact = [[tuple(struct.unpack("f", struct.pack("f", c))[0] if real == "float" else c for c in p)
                      for p in x] for x in (x0, x1)]
            expected = brute_force(*exact, faces, inflate)
            seen = set()
            for kind in ("ascii", "binary_little_endian", "binary_big_endian"):
                write_bytes(tmp, "0.ply", ply(exact[0], faces, kind, real, extra=True))
                write_bytes(tmp, "1.ply", ply(exact[1], faces, kind, real))
                r = cloth("ccd-mesh", "0.ply", "1.ply", "--inflate", str(inflate), cwd=tmp)
                check(counts(r)[:2] == expected, kind, real, counts(r), expected)
                check("1 vertices belong to no triangle" in r.stdout, r.stdout)
                seen.add(tuple(counts(r)))
            check(len(seen) == 1, seen)


def what_passes_through_is_found_with_its_time(tmp):
    # two triangles, one falls through the other: tip on face at 1/2, then the edges
    faces = [(0, 1, 2), (3, 4, 5)]
    x0 = [(0, 0, 0), (4, 0, 0), (0, 4, 0), (1, 1, 1), (1, 1.5, 3), (1.5, 1, 3)]
    x1 = x0[:3] + [(x, y, z - 2) for x, y, z in x0[3:]]
    write(tmp, "0.obj", obj(x0, faces))
    write(tmp, "1.obj", obj(x1, faces))
    for precision in ("float", "double"):
        r = cloth("ccd-mesh", "0.obj", "1.obj", "--precision", precision, cwd=tmp)
        ee0, vf0, ee, vf, first = counts(r)
        check([ee, vf] == [0, 1] and abs(float(first) - .5) < 1e-6 and float(first) <= .5, r.stdout)
        check("vertex 3 and face 0-1-2" in r.stdout, r.stdout)
    r = cloth("ccd-mesh", "0.obj", "0.obj", "--inflate", "9", cwd=tmp)
    check(counts(r) == [9, 6, 0, 0, "none"], r.stdout)  # boxes only: nothing comes near
    r = cloth("ccd-mesh", "0.obj", "0.obj", cwd=tmp)
    check(counts(r) == [0, 0, 0, 0, "none"], r.stdout)


def a_step_of_the_engine_is_free_of_impacts(tmp):
    write(tmp, "s.yaml", SCENE)
    r = cloth("run", "s.yaml", "--steps", "12", "--mesh-every", "1", "--out", "o", cwd=tmp)
    check(r.returncode == 0, r.stderr)
    for step in (4, 11):
        names = ["o/napkin_%06d.obj" % (step + k) for k in (0, 1)]
        for precision in ("float", "double"):
            found = counts(cloth("ccd-mesh", *names, "--precision", precision, cwd=tmp))
            check(found[2:] == [0, 0, "none"], found)
        check(pairs_found(tmp, names[1], "o/table_%06d.obj" % (step + 1)) == 0, "step", step + 1)


def meshes_that_differ_are_refused(tmp):
    x, faces = sheet(2, lambda x, y: 0.0)
    write(tmp, "0.obj", obj(x, faces))
    write(tmp, "more.obj", obj(x + [(0, 0, 1)], faces))
    write(tmp, "other.obj", obj(x, faces[:3] + [faces[3][1:] + faces[3][:1]] + faces[4:]))
    refused(tmp, ["ccd-mesh", "0.obj"], "too few")
    refused(tmp, ["ccd-mesh", "0.obj", "more.obj"], "more.obj", "9 vertices", "10")
    refused(tmp, ["ccd-mesh", "0.obj", "other.obj"], "triangle 3", "other.obj")
    refused(tmp, ["ccd-mesh", "0.obj", "none.ply"], "none.ply")
    refused(tmp, ["ccd-mesh", "0.obj", "0.obj", "--inflate", "-1"], "--inflate", "-1")
    refused(tmp, ["ccd-mesh", "0.obj", "0.obj", "--precision", "half"], "half")


if __name__ == "__main__":
    sys.exit(run_cases([
        touching_counts_and_sharing_does_not,
        totals_are_given_by_mesh_and_by_pair,
        a_raw_mesh_is_checked_as_it_is,
        written_meshes_agree_with_check_meshes,
        bad_meshes_are_refused,
        queries_are_counted_per_file_and_in_total,
        coordinates_that_float_cannot_hold_are_not_missed,
        fractions_that_no_double_is_are_not_missed,
        coordinates_of_any_length_are_read_for_what_they_are,
        lateness_is_measured_against_the_bracket,
        broken_query_files_are_refused_with_their_line,
        shared_queries_are_neither_missed_nor_late,
        candidates_are_those_of_all_boxes_in_every_encoding,
        what_passes_through_is_found_with_its_time,
        a_step_of_the_engine_is_free_of_impacts,
        meshes_that_differ_are_refused,
    ]))
