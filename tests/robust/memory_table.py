#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""The smallest --memory-limit that a refusal tells is one that works: of each scene of a table the limit is asked
for twice, in an empty texture cache and in a filled one, 5 % less is refused, and a render at that limit ends
well and holds less.

usage: memory_table.py [--all] [--write] [--only WORD] PM_HOST

--all: all scenes of the regression suite, and 100,000 lights, triangles, materials and instances; else few and
smaller ones. --write: that, and docs/lab/memory_limit.md is written, of the rows that came out right.
"""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import memory_scenes
from memory_runs import MIB, Runs

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
PAGE = SOURCE / "docs" / "lab" / "memory_limit.md"
SUITE = SOURCE / "scenes" / "regression"
QUICK = ("textured",)
HEAD = """# The smallest memory limit

Written by `tests/robust/memory_table.py --write`. Of each scene: the smallest limit that `--memory-limit 0.001` tells, with
an empty texture cache and with a filled one; the most resident memory of a render at that limit; and that 5 %
less is refused. {threads} threads of {processors} processors.

| scene | told, MiB | took at most, MiB | of it |
|---|---|---|---|
"""


def suite_rows(is_full):
    suite = json.loads((SUITE / "suite.json").read_text(encoding="utf-8"))
    for scene in suite["scenes"]:
        if not is_full and scene["name"] not in QUICK:
            continue
        options = [str(SUITE / o) if (SUITE / o).is_file() else o
                   for o in suite["options"] + scene.get("options", [])]  # fmt: skip
        if not is_full:
            options[options.index("--passes") + 1] = "2"
        yield scene["name"], (SUITE / scene["scene"]).resolve(), options


def made_rows(is_full, folder):
    for make, many, few in memory_scenes.MADE:
        count, name = many if is_full else few, make.__name__
        if count == 0:
            continue
        # By another process: what this one ever held counts as its children's.
        subprocess.run([sys.executable, HERE / "memory_scenes.py", name, folder / name, str(count)], check=True)
        options = [*memory_scenes.VIEW, "--size", "48x32", "--passes", "2", "--aa", "1"]
        yield f"{count} {name}".replace("_", " "), folder / name / "scene.obj", options
        shutil.rmtree(folder / name)


def row_of(runs, name, scene, options):
    """What is told and what was taken, MiB; None where something is wrong."""
    shutil.rmtree(runs.cache, ignore_errors=True)
    faults = runs.faults
    told = runs.smallest(str(scene), *options)
    if told is None:
        return None
    again = runs.smallest(str(scene), *options, limit="0.01")
    runs.check(again == told, f"{name}: {told} GiB is told, then {again}")
    code, text, _, _ = runs.run(str(scene), *options, "--memory-limit", f"{float(told) * .95:.4f}")
    runs.check(code == 5, f"{name}: 5 % less than {told} GiB is refused")
    shutil.rmtree(runs.cache, ignore_errors=True)
    most = 0
    for cache in ("an empty", "a filled"):
        code, text, _, taken = runs.run(str(scene), *options, "--memory-limit", told)
        runs.check(code == 0 and taken <= float(told) * 1024 * MIB,
                   f"{name}: {taken / MIB:.0f} MiB within {float(told) * 1024:.0f}, with {cache} cache"
                   + (f": exit {code}: {text.strip()[-300:]}" if code else ""))  # fmt: skip
        most = max(most, taken / MIB)
    return (name, float(told) * 1024, most) if runs.faults == faults else None


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("host")
    asked = parser.parse_args()
    is_full = asked.write or asked.all
    with tempfile.TemporaryDirectory(prefix="pm_memory.") as name:
        runs = Runs(os.path.abspath(asked.host), pathlib.Path(name))
        rows = [row_of(runs, *row)
                for all_rows in (suite_rows(is_full), made_rows(is_full, runs.folder))
                for row in all_rows if asked.only in row[0]]  # fmt: skip
    if asked.write:
        table = "".join(f"| {name} | {told:.0f} | {most:.0f} | {100 * most / told:.0f} % |\n" for name, told, most in filter(None, rows))
        PAGE.write_text(HEAD.format(threads=2, processors=os.cpu_count()) + table, encoding="utf-8")
    return 1 if runs.faults else 0


if __name__ == "__main__":
    sys.exit(main())
