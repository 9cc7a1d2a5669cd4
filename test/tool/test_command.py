#!/usr/bin/env python3
"""The cloth command from outside: what it accepts, refuses, writes and says.

usage: test_command.py CLOTH [CHECK_MESHES]      prints "ok   NAME" or "FAIL NAME" for each case
"""
import csv
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time

CLOTH = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else "cloth"
CHECK_MESHES = os.path.abspath(sys.argv[2]) if len(sys.argv) > 2 else None

# a napkin that falls on a table, small enough for a sanitized build
SCENE = """\
name: napkin
duration: 0.2
params:
  time_step: 0.01
bodies:
  - name: table
    box: {size: [0.4, 0.4, 0.04]}
    pose: {position: [0, 0, -0.02]}
cloths:
  - name: napkin
    grid: {size: [0.2, 0.2], resolution: [9, 9]}
    pose: {position: [0, 0, 0.01]}
"""

FALL_OUT = SCENE.replace("duration: 0.2", "duration: 5").replace(
    "  time_step: 0.01", "  time_step: 0.01\n  bounds: 0.3").replace(
    "[0, 0, -0.02]", "[0.29, 0.29, -0.3]").replace("[0.4, 0.4, 0.04]", "[0.001, 0.001, 0.001]")


class Failed(Exception):
    pass


class Skipped(Exception):
    pass


def check(condition, *what):
    if not condition:
        raise Failed(" ".join(str(w) for w in what))


def cloth(*args, cwd, **more):
    return subprocess.run([CLOTH, *args], cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True, timeout=120, **more)


def write(folder, name, text):
    path = os.path.join(folder, name)
    with open(path, "w") as f:
        f.write(text)
    return path


def summary(result, name):
    found = re.search("^" + re.escape(name) + r"\s+(\S+)", result.stdout, re.M)
    check(found, "no", name, "in", result.stdout, result.stderr)
    return found.group(1)


def refused(tmp, args, *words, leaves=()):
    """Exit code 2, one message with all words in it, nothing new in the folder."""
    before = set(os.listdir(tmp))
    r = cloth(*args, cwd=tmp)
    check(r.returncode == 2, args, "exits with", r.returncode, r.stderr)
    for word in words:
        check(word in r.stderr, args, "does not say", repr(word), "but:", r.stderr)
    check("step" not in r.stdout, args, "prints a summary")
    new = set(os.listdir(tmp)) - before - set(leaves)
    check(not new, args, "leaves behind", new)


# ---- bad input ----------------------------------------------------------------------------------

def usage_errors_are_named_with_exit_code_2(tmp):
    write(tmp, "s.yaml", SCENE)
    refused(tmp, [])
    refused(tmp, ["rum"], "rum", "did you mean 'run'")
    refused(tmp, ["zzzzzz"], "unknown command")
    refused(tmp, ["run"], "too few", "SCENE.yaml")
    refused(tmp, ["run", "s.yaml", "t.yaml"], "too many", "t.yaml")
    refused(tmp, ["run", "s.yaml", "--step", "3"], "--step", "did you mean --steps")
    refused(tmp, ["run", "s.yaml", "--qqqqqqqqq"], "unknown option --qqqqqqqqq")
    refused(tmp, ["run", "s.yaml", "-x"], "unknown option -x")
    refused(tmp, ["run", "s.yaml", "--steps"], "--steps needs a value")
    refused(tmp, ["run", "s.yaml", "--steps", "--hash"], "--steps needs a value")
    refused(tmp, ["run", "s.yaml", "--steps", "ten"], "--steps", "ten", "whole number")
    refused(tmp, ["run", "s.yaml", "--steps", "0"], "--steps", "0", "[1,")
    refused(tmp, ["run", "s.yaml", "--steps", "99999999999999999999"], "--steps", "out of range")
    refused(tmp, ["run", "s.yaml", "--seconds", "nan"], "--seconds", "nan", "[s]")
    refused(tmp, ["run", "s.yaml", "--seconds", "-1"], "--seconds", "-1", "[s]")
    refused(tmp, ["run", "s.yaml", "--hash=yes"], "--hash takes no value")
    refused(tmp, ["run", "s.yaml", "--mesh-every", "2"], "--mesh-every", "--out")
    refused(tmp, ["run", "s.yaml", "--set", "gravity"], "--set", "NAME=VALUE")


def settings_are_refused_with_value_unit_and_range(tmp):
    write(tmp, "s.yaml", SCENE)
    refused(tmp, ["run", "s.yaml", "--set", "time_step=7"], "time_step", "7", "[s]", "0.1")
    refused(tmp, ["run", "s.yaml", "--set", "time_step=nan"], "time_step", "nan")
    refused(tmp, ["run", "s.yaml", "--set", "thicknes=1e-3"], "thicknes", "thickness")
    refused(tmp, ["run", "s.yaml", "--set", "mesh_defects=repair"], "mesh_defects", "params:")
    refused(tmp, ["run", "s.yaml", "--precision", "half"], "half", "float", "double")
    refused(tmp, ["run", "s.yaml", "--backend", "gpu"], "gpu", "cpu")
    refused(tmp, ["run", "s.yaml", "--devices", "cpu,tpu"], "tpu")
    refused(tmp, ["run", "s.yaml", "--threads", "-1"], "threads", "-1")


def scene_errors_name_file_line_and_key(tmp):
    refused(tmp, ["run", "none.yaml"], "none.yaml")
    refused(tmp, ["info", "none.yaml"], "none.yaml")
    write(tmp, "empty.yaml", "")
    refused(tmp, ["run", "empty.yaml"], "empty.yaml")
    write(tmp, "broken.yaml", "cloths: [\n  {name: a\n")
    refused(tmp, ["run", "broken.yaml"], "broken.yaml:")
    write(tmp, "key.yaml", SCENE.replace("time_step", "time_stepp"))
    refused(tmp, ["run", "key.yaml"], "key.yaml:4", "time_stepp", "time_step")
    write(tmp, "value.yaml", SCENE.replace("0.01\nbodies", "-3\nbodies"))
    refused(tmp, ["run", "value.yaml"], "value.yaml:4", "time_step", "-3", "0.1")
    write(tmp, "type.yaml", SCENE.replace("0.01\nbodies", "fast\nbodies"))
    refused(tmp, ["run", "type.yaml"], "type.yaml:4", "time_step", "fast")
    write(tmp, "mesh.yaml", SCENE.replace("grid: {size: [0.2, 0.2], resolution: [9, 9]}", "mesh: gone.obj"))
    refused(tmp, ["run", "mesh.yaml"], "mesh.yaml:11", "gone.obj")
    write(tmp, "nothing.yaml", SCENE[:SCENE.index("cloths:")])
    refused(tmp, ["run", "nothing.yaml"], "nothing.yaml", "no cloth")
    write(tmp, "endless.yaml", SCENE.replace("duration: 0.2\n", ""))
    refused(tmp, ["run", "endless.yaml"], "--steps", "--seconds")


def a_bad_mesh_is_refused_or_repaired_with_a_count(tmp):
    write(tmp, "bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\nf 1 2 2\n")
    scene = SCENE.replace("grid: {size: [0.2, 0.2], resolution: [9, 9]}", "mesh: bad.obj")
    write(tmp, "bad.yaml", scene)
    refused(tmp, ["info", "bad.yaml"], "bad.yaml:10", "napkin", "no area", "repair")
    write(tmp, "bad.yaml", scene.replace("params:\n", "params:\n  mesh_defects: repair\n"))
    r = cloth("info", "bad.yaml", cwd=tmp)
    check(r.returncode == 0, r.stderr)
    check("repaired: 1 triangles without area" in r.stdout, r.stdout)


def an_out_that_cannot_be_used_is_refused(tmp):
    write(tmp, "s.yaml", SCENE)
    write(tmp, "file", "")
    refused(tmp, ["run", "s.yaml", "--out", "file"], "file", "directory")
    refused(tmp, ["run", "s.yaml", "--out", "file/below"], "file")
    refused(tmp, ["run", "s.yaml", "--out", ""], "--out")
    os.mkdir(os.path.join(tmp, "full"))
    write(tmp, "full/mine.txt", "precious")
    refused(tmp, ["run", "s.yaml", "--out", "full"], "full", "not empty", "--force")
    check(os.listdir(os.path.join(tmp, "full")) == ["mine.txt"], "something was written")
    if os.geteuid() != 0:  # root may write anywhere
        os.mkdir(os.path.join(tmp, "locked"), 0o500)
        refused(tmp, ["run", "s.yaml", "--out", "locked"], "locked")
    refused(tmp, ["run", "s.yaml", "--out", "o", "--record", "none/r.txt"], "none/r.txt")


# ---- runs ---------------------------------------------------------------------------------------

def run_writes_what_it_says(tmp):
    write(tmp, "s.yaml", SCENE)
    r = cloth("run", "s.yaml", "--steps", "5", "--mesh-every", "2", "--out", "a/b", "--hash", cwd=tmp)
    check(r.returncode == 0, r.stderr)
    out = os.path.join(tmp, "a/b")
    expected = {"report.csv", "meshes.csv"} | {
        "%s_%06d.obj" % (name, step) for name in ("napkin", "table") for step in (0, 2, 4, 5)}
    check(set(os.listdir(out)) == expected, sorted(os.listdir(out)))
    with open(os.path.join(out, "report.csv")) as f:
        rows = list(csv.DictReader(f))
    check([int(row["step"]) for row in rows] == [1, 2, 3, 4, 5], rows)
    check(all(abs(float(row["step_size"]) - 0.01) < 1e-12 for row in rows), "step_size")
    for key in ("pcg_iterations", "stretch_max", "impacts_left", "ms_solve", "ms_commit"):
        check(key in rows[0], "no", key)
    check(len({row["state_hash"] for row in rows}) == 5, "hashes repeat")
    check(summary(r, "state hash") == rows[-1]["state_hash"], "the summary has another hash")
    check(summary(r, "steps") == "5", r.stdout)
    vertices = [line for line in open(os.path.join(out, "napkin_000005.obj")) if line.startswith("v ")]
    faces = [line for line in open(os.path.join(out, "napkin_000005.obj")) if line.startswith("f ")]
    check(len(vertices) == 81 and len(faces) == 128, len(vertices), len(faces))
    # the table stands where the scene says: a box of 4 cm below z = 0
    z = [float(line.split()[3]) for line in open(os.path.join(out, "table_000005.obj")) if line[0] == "v"]
    check(abs(min(z) + 0.04) < 1e-12 and abs(max(z)) < 1e-12, z)


def the_napkin_falls_as_gravity_says(tmp):
    # 3 steps of backward Euler from rest: g h^2 (1 + 2 + 3), whatever the cloth is made of
    write(tmp, "s.yaml", SCENE.replace("0, 0, 0.01", "0, 0, 1"))
    r = cloth("run", "s.yaml", "--steps", "3", "--mesh-every", "3", "--out", "o", cwd=tmp)
    check(r.returncode == 0, r.stderr)
    for line in open(os.path.join(tmp, "o", "napkin_000003.obj")):
        if line.startswith("v "):
            z = float(line.split()[3])
            check(abs(z - (1 - 9.81 * 1e-4 * 6)) < 1e-6, "z =", z)  # float precision at 1 m: 6e-8


def a_second_run_into_the_same_place_needs_force(tmp):
    write(tmp, "s.yaml", SCENE)
    args = ["run", "s.yaml", "--mesh-every", "1", "--out", "o"]
    check(cloth(*args, "--steps", "4", cwd=tmp).returncode == 0, "first run")
    check(cloth(*args, "--steps", "2", cwd=tmp).returncode == 2, "second run is not refused")
    write(tmp, "o/mine.txt", "precious")
    r = cloth(*args, "--steps", "2", "--force", cwd=tmp)
    check(r.returncode == 0, r.stderr)
    left = set(os.listdir(os.path.join(tmp, "o")))
    check("napkin_000004.obj" not in left, "steps of the first run are still there")
    check("mine.txt" in left, "a file of somebody else is gone")


def equal_runs_end_with_equal_hashes(tmp):
    write(tmp, "s.yaml", SCENE)
    hashes = set()
    for more in ([], [], ["--threads", "1"], ["--threads", "2"], ["--devices", "cpu,cpu"],
                 ["--backend", "shuffle"]):
        r = cloth("run", "s.yaml", *more, cwd=tmp)
        check(r.returncode == 0, more, r.stderr)
        hashes.add(summary(r, "state hash"))
    check(len(hashes) == 1, hashes)
    r = cloth("run", "s.yaml", "--set", "gravity=0 0 -9.8", cwd=tmp)
    check(summary(r, "state hash") not in hashes, "another gravity, the same hash")


def steps_seconds_and_duration_mean_the_same(tmp):
    write(tmp, "s.yaml", SCENE)
    for more in ([], ["--steps", "20"], ["--seconds", "0.2"], ["--seconds", "0.195"]):
        r = cloth("run", "s.yaml", *more, cwd=tmp)
        check(r.returncode == 0 and summary(r, "steps") == "20", more, r.stdout, r.stderr)


def an_unstable_scene_ends_with_exit_code_1_and_what_there_is(tmp):
    write(tmp, "s.yaml", FALL_OUT)
    r = cloth("run", "s.yaml", "--out", "o", cwd=tmp)
    check(r.returncode == 1, r.returncode, r.stdout, r.stderr)
    check("cloth run:" in r.stderr, r.stderr)
    check({"report.csv", "meshes.csv"} == set(os.listdir(os.path.join(tmp, "o"))), "files")


def an_interrupted_run_finishes_its_step_and_exits_with_130(tmp):
    write(tmp, "s.yaml", SCENE)
    p = subprocess.Popen([CLOTH, "run", "s.yaml", "--steps", "100000000", "--out", "o"], cwd=tmp,
                         stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
    part = os.path.join(tmp, "o", "report.csv.part")
    for _ in range(600):  # until some steps are written
        if os.path.exists(part) and os.path.getsize(part) > 4000:
            break
        time.sleep(0.05)
    p.send_signal(signal.SIGINT)
    stdout, stderr = p.communicate(timeout=60)
    check(p.returncode == 130, p.returncode, stderr)
    with open(os.path.join(tmp, "o", "report.csv")) as f:
        rows = list(csv.reader(f))
    check(all(len(row) == len(rows[0]) for row in rows), "a row is cut off")
    check(re.search(r"^steps\s+%d\b" % (len(rows) - 1), stdout, re.M), len(rows), stdout)


def a_saved_state_goes_on_with_the_same_bits(tmp):
    write(tmp, "s.yaml", SCENE)
    whole = cloth("run", "s.yaml", "--steps", "20", cwd=tmp)
    half = cloth("run", "s.yaml", "--steps", "12", "--save-state", "half", cwd=tmp)
    rest = cloth("run", "s.yaml", "--steps", "8", "--load-state", "half", "--out", "o", cwd=tmp)
    check(half.returncode == 0 and rest.returncode == 0, half.stderr, rest.stderr)
    check(summary(half, "state hash") != summary(whole, "state hash"), "nothing moved")
    check(summary(rest, "state hash") == summary(whole, "state hash"), rest.stdout, whole.stdout)
    check(summary(rest, "simulated") == "0.08", rest.stdout)
    with open(os.path.join(tmp, "o", "report.csv")) as f:
        check([int(row["step"]) for row in csv.DictReader(f)] == list(range(13, 21)), "steps")
    # a finer step from there; what is there is not replaced; other meshes are refused
    fine = cloth("run", "s.yaml", "--steps", "3", "--load-state", "half", "--set", "time_step=0.001", cwd=tmp)
    check(fine.returncode == 0 and summary(fine, "simulated") == "0.003", fine.stdout, fine.stderr)
    refused(tmp, ["run", "s.yaml", "--save-state", "half"], "--save-state half exists", "--force")
    write(tmp, "t.yaml", SCENE.replace("[9, 9]", "[8, 9]"))
    refused(tmp, ["run", "t.yaml", "--load-state", "half"], "half")


def the_written_meshes_do_not_intersect(tmp):
    if not CHECK_MESHES:
        raise Skipped("built without CGAL")
    write(tmp, "s.yaml", SCENE)
    r = cloth("run", "s.yaml", "--seconds", "0.5", "--mesh-every", "1", "--out", "o", cwd=tmp)
    check(r.returncode == 0, r.stderr)
    r = subprocess.run([CHECK_MESHES, "o"], cwd=tmp, stdout=subprocess.PIPE, universal_newlines=True)
    check(r.returncode == 0, r.stdout)
    check(r.stdout.startswith("51 steps checked"), r.stdout)
    # and the checker looks: one vertex put through the table
    path = os.path.join(tmp, "o", "napkin_000050.obj")
    lines = open(path).read().split("\n")
    first = next(i for i, line in enumerate(lines) if line.startswith("v "))
    lines[first + 40] = "v 0 0 -0.01"
    write(tmp, "o/napkin_000050.obj", "\n".join(lines))
    r = subprocess.run([CHECK_MESHES, "o"], cwd=tmp, stdout=subprocess.PIPE, universal_newlines=True)
    check(r.returncode == 1 and "step 50" in r.stdout, r.stdout)


# ---- recordings ---------------------------------------------------------------------------------

def a_replay_matches_and_a_changed_recording_does_not(tmp):
    write(tmp, "s.yaml", SCENE)
    check(cloth("run", "s.yaml", "--record", "r.txt", cwd=tmp).returncode == 0, "run")
    r = cloth("replay", "r.txt", "s.yaml", cwd=tmp)
    check(r.returncode == 0 and "20 steps match" in r.stdout, r.stdout, r.stderr)
    text = open(os.path.join(tmp, "r.txt")).read()

    lines = text.split("\n")
    steps = [i for i, line in enumerate(lines) if line.startswith("hash ")]
    lines[steps[11]] = "hash 0123456789abcdef"
    write(tmp, "changed.txt", "\n".join(lines))
    r = cloth("replay", "changed.txt", "s.yaml", cwd=tmp)
    check(r.returncode == 1 and "step 12 differs" in r.stderr, r.returncode, r.stderr)
    check("11 steps match" in r.stdout, r.stdout)

    r = cloth("replay", "r.txt", "s.yaml", "--set", "thickness=0.002", cwd=tmp)
    check(r.returncode == 1 and "thickness" in r.stderr, r.returncode, r.stderr)
    write(tmp, "t.yaml", SCENE.replace("[9, 9]", "[10, 9]"))
    r = cloth("replay", "r.txt", "t.yaml", cwd=tmp)
    check(r.returncode == 1 and "another scene" in r.stderr, r.returncode, r.stderr)

    # one that was cut off in the middle of a line plays as far as it goes
    write(tmp, "cut.txt", text[:text.index("hash", len(text) // 2) + 9])
    r = cloth("replay", "cut.txt", "s.yaml", cwd=tmp)
    check(r.returncode == 0 and " steps match" in r.stdout, r.returncode, r.stderr)


def damaged_recordings_are_refused_with_file_and_line(tmp):
    write(tmp, "s.yaml", SCENE)
    check(cloth("run", "s.yaml", "--steps", "2", "--record", "r.txt", cwd=tmp).returncode == 0, "run")
    lines = open(os.path.join(tmp, "r.txt")).read().split("\n")
    refused(tmp, ["replay", "none.txt", "s.yaml"], "none.txt")
    refused(tmp, ["replay", "s.yaml", "s.yaml"], "s.yaml", "not a recording")
    for wrong in ("step fast", "jump 3", "move 0 1 2", "hash", "grasp 1 1 0 -1 0 0 0 0 0 0 0 0 1 999999999",
                  "positions 0 80", "positions 7 81"):
        at = next(i for i, line in enumerate(lines) if line.startswith("step"))
        write(tmp, "bad.txt", "\n".join(lines[:at] + [wrong] + lines[at:]))
        refused(tmp, ["replay", "bad.txt", "s.yaml"], "bad.txt:%d" % (at + 1), "damaged")
    r = cloth("run", "s.yaml", "--record", "r.txt", cwd=tmp)
    check(r.returncode == 2 and "r.txt" in r.stderr, "an earlier recording is overwritten")


def a_full_disk_breaks_the_recording_not_the_run(tmp):
    def small_disk():  # a file that grows beyond the limit fails as on a full disk
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192))

    write(tmp, "s.yaml", SCENE)
    r = cloth("run", "s.yaml", "--steps", "500", "--record", "r.txt", cwd=tmp, preexec_fn=small_disk)
    check(r.returncode == 1 and summary(r, "steps") == "500", r.returncode, r.stdout)
    check("r.txt broke off after" in r.stderr, r.stderr)
    r = cloth("replay", "r.txt", "s.yaml", cwd=tmp)
    check(r.returncode == 0, "what was written cannot be replayed:", r.stderr)


def a_recording_that_cannot_begin_is_refused(tmp):
    write(tmp, "s.yaml", SCENE)
    refused(tmp, ["run", "s.yaml", "--record", "none/r.txt"], "none/r.txt")
    refused(tmp, ["run", "s.yaml", "--record", tmp, "--force"], tmp)


# ---- the other commands -------------------------------------------------------------------------

def info_says_what_is_in_the_scene(tmp):
    write(tmp, "s.yaml", SCENE)
    r = cloth("info", "s.yaml", "--set", "thickness=0.002", "--set", "preconditioner=multilevel", cwd=tmp)
    check(r.returncode == 0, r.stderr)
    for words in ("81 vertices, 128 triangles", "0.04 m^2", "0.012 kg", "body table", "longest 0.03536 m",
                  "density", "membrane", "gravity", "memory of the scene after its first steps"):
        check(words in r.stdout, "no", repr(words), "in", r.stdout)
    check(re.search(r"membrane +on +[0-9.]+ KiB +[0-9.]+ ms +cloth", r.stdout), r.stdout)
    check(re.search(r"air +off +air_density", r.stdout), r.stdout)
    check(re.search(r"thickness\s+0.002 m\b", r.stdout), r.stdout)
    check(re.search(r"time_step\s+0.01 s\b", r.stdout), r.stdout)
    check(re.search(r"preconditioner\s+multilevel\b", r.stdout), r.stdout)


def params_prints_every_parameter(tmp):
    r = cloth("params", cwd=tmp)
    check(r.returncode == 0, r.stderr)
    check("| `thickness` | 0.003 | m | 1e-05 to 0.05 |" in r.stdout, r.stdout)
    check("| `mesh_defects` | refuse |  | refuse, repair |" in r.stdout, r.stdout)
    check("| `gravity` | 0 0 -9.81 | m/s^2 |" in r.stdout, r.stdout)
    check("`density`" in cloth("params", "--material", cwd=tmp).stdout, "--material")


def a_variant_changes_what_its_variables_say(tmp):
    text = ("variables: {n: 3}\nvariants: {fine: {n: 5}}\nduration: 0.1\n"
            "cloths: [{name: a, grid: {size: [1, 1], resolution: [$n, $n]}}]\n")
    with open(os.path.join(tmp, "v.yaml"), "w") as f:
        f.write(text)
    for options, vertices in (((), 9), (("--variant", "fine"), 25), (("--variant", "fine,n=4"), 16), (("--variant=n=2",), 4)):
        r = cloth("info", "v.yaml", *options, cwd=tmp)
        check(r.returncode == 0 and "%d vertices" % vertices in r.stdout, r.stdout + r.stderr)
    refused(tmp, ["info", "v.yaml", "--variant", "fin"], "no variant 'fin'; the nearest is 'fine'")
    refused(tmp, ["run", "v.yaml", "--variant", "m=3"], "no variable 'm'; the nearest is 'n'")


def bench_prints_stages_and_writes_rows(tmp):
    write(tmp, "s.yaml", SCENE)
    r = cloth("bench", "s.yaml", "--steps", "4", "--warmup", "2", "--repeat", "3", "--csv", "b.csv", cwd=tmp)
    check(r.returncode == 0, r.stdout, r.stderr)
    check("NOT DETERMINISTIC" not in r.stdout and "real-time factor" in r.stdout, r.stdout)
    with open(os.path.join(tmp, "b.csv")) as f:
        rows = list(csv.DictReader(f))
    check({"step", "step_worst", "predict", "solve", "commit"} <= {row["row"] for row in rows}, rows)
    for row in rows:
        check(float(row["min_ms"]) <= float(row["median_ms"]) <= float(row["max_ms"]), row)
        check(row["vertices"] == "81" and row["scene"] == "s", row)
    refused(tmp, ["bench", "s.yaml", "--csv", "none/b.csv"], "none/b.csv")
    refused(tmp, ["bench", "none.yaml", "--csv", "c.csv"], "none.yaml")


def every_command_has_help(tmp):
    check(cloth("--version", cwd=tmp).stdout.startswith("cloth "), "--version")
    r = cloth("--help", cwd=tmp)
    check(r.returncode == 0 and r.stderr == "", "--help")
    commands = re.findall(r"^  ([\w-]+) +\w", r.stdout, re.M)
    check({"run", "info", "replay", "bench", "params", "check", "ccd", "ccd-mesh"} <= set(commands), commands)
    for command in commands[:-2]:  # the last two are how to ask for help
        r = cloth(command, "--help", cwd=tmp)
        check(r.returncode == 0 and "usage: cloth " + command in r.stdout, command)


CASES = [
    usage_errors_are_named_with_exit_code_2,
    settings_are_refused_with_value_unit_and_range,
    scene_errors_name_file_line_and_key,
    a_bad_mesh_is_refused_or_repaired_with_a_count,
    an_out_that_cannot_be_used_is_refused,
    run_writes_what_it_says,
    the_napkin_falls_as_gravity_says,
    a_second_run_into_the_same_place_needs_force,
    equal_runs_end_with_equal_hashes,
    steps_seconds_and_duration_mean_the_same,
    an_unstable_scene_ends_with_exit_code_1_and_what_there_is,
    an_interrupted_run_finishes_its_step_and_exits_with_130,
    a_saved_state_goes_on_with_the_same_bits,
    the_written_meshes_do_not_intersect,
    a_replay_matches_and_a_changed_recording_does_not,
    damaged_recordings_are_refused_with_file_and_line,
    a_full_disk_breaks_the_recording_not_the_run,
    a_recording_that_cannot_begin_is_refused,
    info_says_what_is_in_the_scene,
    params_prints_every_parameter,
    a_variant_changes_what_its_variables_say,
    bench_prints_stages_and_writes_rows,
    every_command_has_help,
]


def run_cases(cases):
    failures = 0
    for case in cases:
        with tempfile.TemporaryDirectory() as tmp:
            try:
                case(tmp)
                print("ok  ", case.__name__)
            except Skipped as why:
                print("skip", case.__name__, "(%s)" % why)
            except (Failed, subprocess.TimeoutExpired, OSError, StopIteration, KeyError) as e:
                failures += 1
                print("FAIL", case.__name__)
                print("  " + str(e)[:2000].replace("\n", "\n  "))
        sys.stdout.flush()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(run_cases(CASES))
