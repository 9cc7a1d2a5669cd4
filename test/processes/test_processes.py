#!/usr/bin/env python3
"""One process per part (devices: mpi), from outside: the same state as one process, one voice, one end.

usage: test_processes.py CLOTH [MPIRUN]      prints "ok   NAME", "skip NAME" or "FAIL NAME" for each case;
without MPIRUN (a build without MPI) only that the command says so
"""
import csv
import filecmp
import os
import re
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tool"))
from test_command import Failed, Skipped, check, run_cases, summary, write  # noqa: E402

CLOTH = os.path.abspath(sys.argv[1])
MPIRUN = sys.argv[2] if len(sys.argv) > 2 else None
SCENES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "config", "scenes")
LIMIT = 60  # s

# a sheet that slides down a slope onto another one, more than one chunk of vertices for each of three
# parts: friction, cloth on cloth, pins
SHEETS = """\
name: sheets
duration: 0.2
params: {time_step: 0.01, friction: 0.3}
bodies:
  - name: table
    box: {size: [0.5, 0.5, 0.04]}
    pose: {position: [0, 0, -0.02]}
cloths:
  - name: lower
    grid: {size: [0.2, 0.2], resolution: [13, 13]}
    pose: {position: [0, 0, 0.004]}
  - name: upper
    grid: {size: [0.2, 0.2], resolution: [13, 13]}
    pose: {position: [0.03, 0.02, 0.02], rpy: [0.3, 0.1, 0]}
    velocity: [0.3, 0, -2]
    groups: {corner: {vertices: [0]}}
    pins:
      - {group: corner}
"""
HANGING = SHEETS[:SHEETS.index("bodies:")] + SHEETS[SHEETS.index("cloths:"):]

# what is run, and with what beside it
RUNS = {
    "contact": (SHEETS, []),
    "contact_float_two_level": (SHEETS, ["--precision", "float", "--set", "preconditioner=two_level"]),
    "order_two": (HANGING, ["--set", "integrator=bdf2", "--set", "effects.self_contact=off"]),
    "mass_spring": (None, ["--resolution", "0.4", "--steps", "5"]),
    "free_flight": (HANGING, ["--set", "effects.membrane=off", "--set", "effects.bending=off",
                              "--set", "effects.self_contact=off"]),
}


def environment():
    more = {"OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive", "ASAN_OPTIONS": "detect_leaks=0",
            "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_btl_vader_single_copy_mechanism": "none"}
    return dict(os.environ, **more)


def start(*programs):
    """programs: (count, arguments of cloth); the processes of one run."""
    command = [MPIRUN]
    version = subprocess.run([MPIRUN, "--version"], stdout=subprocess.PIPE, universal_newlines=True).stdout
    if "Open MPI" in version or "open-mpi" in version:
        command += ["--oversubscribe", "--bind-to", "none"] + (["--allow-run-as-root"] if os.geteuid() == 0 else [])
    for i, (count, args) in enumerate(programs):
        command += ([":"] if i else []) + ["-n", str(count), CLOTH] + args
    return command


def processes(*programs, cwd):
    return subprocess.run(start(*programs), cwd=cwd, env=environment(), stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, universal_newlines=True, timeout=LIMIT)


def alone(args, cwd):
    return subprocess.run([CLOTH, *args], cwd=cwd, env=environment(), stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, universal_newlines=True, timeout=LIMIT)


def rows(path):
    with open(path) as f:
        return list(csv.DictReader(f))


def is_time(column):
    return column.startswith("ms_") or column == "wall_ms"


def compare(tmp, name, counts, steps=10):
    """Reports of n processes equal those of n parts of one process but for times, meshes byte for byte, and
    all hashes those of one part."""
    text, more = RUNS[name]
    scene = write(tmp, "s.yaml", text) if text else os.path.join(SCENES, name + ".yaml")
    args = ["run", scene, "--backend", "cpu", "--hash", "--mesh-every", "5", "--steps", str(steps)] + more
    one = alone(args + ["--out", "one"], tmp)
    check(one.returncode == 0, one.stderr)
    for n in counts:
        parts = alone(args + ["--out", "parts%d" % n, "--devices", ",".join(["cpu"] * n), "--set", "exchange=launches"],
                      tmp)
        check(parts.returncode == 0, parts.stderr)
        many = processes((n, args + ["--out", "many%d" % n, "--devices", "mpi"]), cwd=tmp)
        check(many.returncode == 0, many.stdout, many.stderr)
        check(many.stdout.count("state hash") == 1, "printed more than once:", many.stdout)
        check(re.search(r"^processes +%d, rows by mpi$" % n, many.stdout, re.M), many.stdout)
        check(summary(many, "state hash") == summary(one, "state hash"), n, "processes end elsewhere than one")
        a, b = rows(tmp + "/parts%d/report.csv" % n), rows(tmp + "/many%d/report.csv" % n)
        check(len(a) == len(b) == len(rows(tmp + "/one/report.csv")), "rows")
        for i, (x, y, z) in enumerate(zip(a, b, rows(tmp + "/one/report.csv"))):
            for column in x:
                check(is_time(column) or x[column] == y[column], "step", i + 1, column, x[column], y[column])
            check(y["state_hash"] == z["state_hash"], "step", i + 1, "hash")
        meshes = [f for f in os.listdir(tmp + "/one") if f.endswith(".obj")]
        check(meshes, "no meshes")
        for f in meshes:
            check(filecmp.cmp(tmp + "/one/" + f, tmp + "/many%d/" % n + f, shallow=False), f, "differs")
    return rows(tmp + "/one/report.csv")


def total(report, column):
    return sum(float(r[column]) for r in report)


def contacts_and_impact_zones_are_the_same_on_two_and_three_processes(tmp):
    report = compare(tmp, "contact", (2, 3))
    check(total(report, "zones") > 0, "no impact zone was there")
    check(total(report, "contacts_self") > 0 and total(report, "contacts_body") > 0, "nothing touched")


def float_with_two_levels_is_the_same(tmp):
    compare(tmp, "contact_float_two_level", (2,))


def order_two_is_the_same(tmp):
    check(total(compare(tmp, "order_two", (2,)), "bdf2_substeps") > 0, "none was of order 2")


def mass_spring_is_the_same(tmp):
    compare(tmp, "mass_spring", (3,))


def free_flight_is_the_same(tmp):
    compare(tmp, "free_flight", (2,))


def more_processes_than_chunks_is_the_same(tmp):
    RUNS["small"] = (SHEETS.replace("[13, 13]", "[4, 4]"), [])
    compare(tmp, "small", (4,))


def parts_are_cut_anew_in_all_processes_alike(tmp):
    # what lies in layers is in the first parts, and what falls, without contacts, in the last
    layers = "".join("""\
  - name: layer%d
    grid: {size: [0.2, 0.2], resolution: [13, 13]}
    pose: {position: [0, 0, %g]}
""" % (i, 0.003 * i) for i in (1, 2, 3)) + """\
  - name: apart
    grid: {size: [0.2, 0.2], resolution: [19, 19]}
    pose: {position: [0, 0, 10]}
"""
    apart = SHEETS[:SHEETS.index("cloths:")] + "cloths:\n" + layers
    RUNS["drifting"] = (apart, [])
    report = compare(tmp, "drifting", (2, 3), steps=30)
    check(all(r["recuts"] == "0" and float(r["work_worst"]) == 1 for r in report), "one part was cut anew")
    for n in (2, 3):
        parts = rows(tmp + "/parts%d/report.csv" % n)
        check(total(parts, "recuts") > 0, [r["work_worst"] for r in parts])


def without_mpirun_it_is_one_part(tmp):
    write(tmp, "s.yaml", "devices: mpi\n" + SHEETS)
    r = alone(["run", "s.yaml", "--steps", "3", "--backend", "cpu"], tmp)
    one = alone(["run", "s.yaml", "--steps", "3", "--backend", "cpu", "--devices", "cpu"], tmp)
    check(r.returncode == 0, r.stderr)
    check(summary(r, "state hash") == summary(one, "state hash"), "differs")


def a_recording_of_two_processes_replays_in_one(tmp):
    write(tmp, "s.yaml", SHEETS)
    r = processes((2, ["run", "s.yaml", "--steps", "5", "--record", "r.rec", "--devices", "mpi", "--backend", "cpu"]),
                  cwd=tmp)
    check(r.returncode == 0, r.stderr)
    again = alone(["replay", "r.rec", "s.yaml", "--backend", "cpu"], tmp)
    check(again.returncode == 0, again.stdout, again.stderr)


def a_time_budget_chooses_the_same_everywhere(tmp):
    # by its own clock each process would choose its own tolerance, and the state would be that of none of them
    write(tmp, "s.yaml", SHEETS)
    r = processes((3, ["run", "s.yaml", "--steps", "20", "--set", "time_budget=3", "--devices", "mpi", "--backend", "cpu",
                       "--out", "o", "--record", "r.rec"]), cwd=tmp)
    check(r.returncode == 0, r.stderr)
    again = alone(["replay", "r.rec", "s.yaml", "--backend", "cpu", "--set", "time_budget=3"], tmp)
    check(again.returncode == 0, again.stdout, again.stderr)
    check(len({row["chosen_pcg_tolerance"] for row in rows(tmp + "/o/report.csv")}) > 1, "the budget changed nothing")


def what_all_refuse_is_said_once(tmp):
    write(tmp, "s.yaml", SHEETS)
    os.mkdir(tmp + "/full")
    write(tmp + "/full", "x", "")
    mpi = ["--devices", "mpi", "--backend", "cpu", "--steps", "1"]
    for args, word in ((["none.yaml"], "none.yaml"), (["s.yaml", "--set", "pcg_tolerance=7"], "pcg_tolerance"),
                       (["s.yaml", "--mesh-every", "2"], "--mesh-every needs"), (["s.yaml", "--out", "full"], "not empty"),
                       (["s.yaml", "--record", "none/r"], "none/r"), (["s.yaml", "--backend", "shuffle"], "shuffle")):
        r = processes((2, ["run"] + mpi + args), cwd=tmp)
        check(r.returncode == 2, args, "exits with", r.returncode, r.stderr)
        check(r.stderr.count("cloth run:") == 1 and word in r.stderr, args, "says", r.stderr)
        check("state hash" not in r.stdout, args, "prints a summary")


def what_one_process_refuses_ends_all_with_its_message_once(tmp):
    write(tmp, "s.yaml", SHEETS)
    good = ["run", "s.yaml", "--devices", "mpi", "--backend", "cpu", "--seconds", "100"]
    for bad, word in ((["run", "none.yaml"] + good[2:], "none.yaml"), (good + ["--nonsense"], "--nonsense"),
                      (good + ["--set", "pcg_tolerance=7"], "pcg_tolerance"),
                      (good + ["--set", "friction=0.31"], "process 1 has read another scene")):
        before = time.time()
        r = processes((1, good), (1, bad), (1, good), cwd=tmp)
        check(r.returncode != 0, bad, "exits with 0")
        check(r.stderr.count("cloth run:") == 1 and word in r.stderr, bad, "says", r.stderr)
        check(time.time() - before < 60, bad, "took", time.time() - before)


def a_folder_lost_by_the_first_process_ends_all(tmp):
    write(tmp, "s.yaml", SHEETS)
    command = start((2, ["run", "s.yaml", "--devices", "mpi", "--backend", "cpu", "--seconds", "100", "--mesh-every",
                         "1", "--out", "p"]))
    run = subprocess.Popen(command, cwd=tmp, env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                           universal_newlines=True)
    for _ in range(LIMIT * 10):
        if os.path.exists(tmp + "/p/lower_000001.obj"):
            break
        time.sleep(0.1)
    os.rename(tmp + "/p", tmp + "/q")
    out, said = run.communicate(timeout=LIMIT)
    check(run.returncode == 1, "exits with", run.returncode, said)
    check(said.count("cloth run:") == 1 and "cannot be written" in said, said)
    check(out.count("state hash") == 1, out)


def alive(tmp):
    """Processes whose working folder is the test's."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            if os.path.realpath("/proc/%s/cwd" % pid) == os.path.realpath(tmp) and \
                    open("/proc/%s/stat" % pid).read().split(")")[1].split()[0] != "Z":
                found.append(int(pid))
        except OSError:
            continue
    return found


def an_interrupt_ends_all(tmp):
    write(tmp, "s.yaml", SHEETS)
    run = subprocess.Popen(start((2, ["run", "s.yaml", "--devices", "mpi", "--backend", "cpu", "--seconds", "1000",
                                      "--out", "o"])), cwd=tmp, env=environment(), stdout=subprocess.PIPE,
                           stderr=subprocess.PIPE, universal_newlines=True)
    for _ in range(LIMIT * 10):
        report = tmp + "/o/report.csv.part"
        if os.path.exists(report) and len(open(report).readlines()) > 2:
            break
        time.sleep(0.1)
    check(len(alive(tmp)) >= 3, "mpirun and two processes should run", alive(tmp))
    run.send_signal(signal.SIGINT)
    run.communicate(timeout=LIMIT)
    check(run.returncode != 0, "exits with 0")
    for _ in range(50):
        if not alive(tmp):
            return
        time.sleep(0.1)
    raise Failed("left running: %s" % alive(tmp))


def other_commands_refuse(tmp):
    write(tmp, "s.yaml", "devices: mpi\n" + SHEETS)
    for args in (["bench", "s.yaml"], ["info", "s.yaml", "--devices", "mpi"]):
        r = alone(args, tmp)
        check(r.returncode == 2 and "cloth run alone" in r.stderr, args, r.returncode, r.stderr)


def a_build_without_mpi_says_so(tmp):
    if MPIRUN:
        raise Skipped("this build has MPI")
    write(tmp, "s.yaml", SHEETS)
    r = alone(["run", "s.yaml", "--steps", "1", "--devices", "mpi"], tmp)
    check(r.returncode == 2 and "CLOTH_MPI" in r.stderr, r.returncode, r.stderr)


def needs_mpi(case):
    def run(tmp):
        if not MPIRUN:
            raise Skipped("no MPI was found when this was built")
        case(tmp)
    run.__name__ = case.__name__
    return run


CASES = [needs_mpi(case) for case in (
    contacts_and_impact_zones_are_the_same_on_two_and_three_processes,
    float_with_two_levels_is_the_same,
    order_two_is_the_same,
    mass_spring_is_the_same,
    free_flight_is_the_same,
    more_processes_than_chunks_is_the_same,
    parts_are_cut_anew_in_all_processes_alike,
    without_mpirun_it_is_one_part,
    a_recording_of_two_processes_replays_in_one,
    a_time_budget_chooses_the_same_everywhere,
    what_all_refuse_is_said_once,
    what_one_process_refuses_ends_all_with_its_message_once,
    a_folder_lost_by_the_first_process_ends_all,
    an_interrupt_ends_all,
    other_commands_refuse,
)] + [a_build_without_mpi_says_so]

SHORT = ("contacts_and_impact_zones_are_the_same_on_two_and_three_processes",
         "a_recording_of_two_processes_replays_in_one", "what_one_process_refuses_ends_all_with_its_message_once")
if os.environ.get("CLOTH_TEST_SHORT"):  # a sanitized build is slow
    CASES = [case for case in CASES if case.__name__ in SHORT]

if __name__ == "__main__":
    sys.exit(run_cases(CASES))
