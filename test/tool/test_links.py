#!/usr/bin/env python3
"""cloth links from outside: what it predicts is what can be worked out by hand.

usage: test_links.py CLOTH      prints "ok   NAME" or "FAIL NAME" for each case
"""
import glob
import os
import re
import sys
import xml.dom.minidom

from test_command import check, cloth, refused, run_cases, write

MODELS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "config", "links")

MODEL = """
name: two
parts: 2
links: {bandwidth: 1e9, latency: 1e-5}
product: {rows: 1000, blocks: 10, memory_bandwidth: 1e9, own: 0.5, precision: float}
"""


def figure(text, name):
    return float(re.search(r"^%s +([0-9.]+) us" % name, text, re.M).group(1))


def two_parts_are_as_worked_out(tmp):
    write(tmp, "m.yaml", MODEL)
    r = cloth("links", "--model", "m.yaml", cwd=tmp)
    check(r.returncode == 0, r.stderr)
    single = 1000 * (10 * 40 + 28) / 1e9 * 1e6  # us: 9 floats and a column a block; x, y, a place a row
    exchange = 10 + 500 * 12 / 1e9 * 1e6
    own = other = single / 4
    for name, want in (("on one part", single), ("exchange", exchange),
                       ("straightforward", exchange + own + other),
                       ("pipelined", max(own, exchange) + other)):
        got = figure(r.stdout, name)
        check(abs(got - want) < 0.06, name, "is", got, "not", want)


def every_model_of_the_package_is_read_and_pipelining_never_loses(tmp):
    files = glob.glob(os.path.join(MODELS, "*.yaml"))
    check(len(files) >= 4, files)
    for path in files:
        r = cloth("links", "--model", path, cwd=tmp)
        check(r.returncode == 0, path, r.stderr)
        check(figure(r.stdout, "pipelined") <= figure(r.stdout, "straightforward"), path)


def the_timeline_is_a_picture_with_a_row_for_each_part(tmp):
    write(tmp, "m.yaml", MODEL.replace("parts: 2", "parts: 5"))
    r = cloth("links", "--model", "m.yaml", "--svg", "t.svg", cwd=tmp)
    check(r.returncode == 0, r.stderr)
    svg = xml.dom.minidom.parse(os.path.join(tmp, "t.svg"))
    text = [t.firstChild.data for t in svg.getElementsByTagName("text")]
    for part in range(5):
        check("part %d" % part in text, text)
    check(len(svg.getElementsByTagName("rect")) >= 1 + 5 + 2 * 20)


def bad_models_are_refused(tmp):
    refused(tmp, ["links"], "--model")
    refused(tmp, ["links", "--model", "none.yaml"], "none.yaml")
    cases = (("parts: 2", "parts: 0", "parts", "0"),
             ("parts: 2", "parts: 65", "parts", "65"),
             ("1e9, latency", "0, latency", "bandwidth"),
             ("bandwidth: 1e9, latency", "tree: [0, 0], bandwidth: 1e9, latency", "twice"),
             ("bandwidth: 1e9, latency", "tree: [[0]], bandwidth: 1e9, latency", "part 1"),
             ("bandwidth: 1e9, latency", "tree: ring, bandwidth: 1e9, latency", "ring"),
             ("own: 0.5", "own: 1.5", "own", "1.5"),
             ("rows: 1000, ", "", "rows"),
             ("blocks", "block", "blocks"))
    for old, new, *words in cases:
        write(tmp, "bad.yaml", MODEL.replace(old, new))
        refused(tmp, ["links", "--model", "bad.yaml"], "bad.yaml", *words)


if __name__ == "__main__":
    sys.exit(run_cases([two_parts_are_as_worked_out,
                        every_model_of_the_package_is_read_and_pipelining_never_loses,
                        the_timeline_is_a_picture_with_a_row_for_each_part,
                        bad_models_are_refused]))
