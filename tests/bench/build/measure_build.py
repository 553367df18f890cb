#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""What it takes to compile two states of pm, side by side.

usage: measure_build.py OLD NEW [--work DIR] [--turns N] [--jobs N] [--docs FILE] [--no-edits] [--sample N]

OLD and NEW are revisions, or folders with a checkout. Both are built in turns without ccache: library and
pm_host from nothing, plainly and together (PM_TOGETHER), and processor time of the whole build is told, the
median of the turns. Then, in the plain build, one line of one file is edited and it is timed until a test that
needs it runs: a lobe, a reader, a test (--no-edits: not). --sample N: of the files that both have, one in N
alone, plainly, each compiled by both at once after the other: minutes in place of an hour, and what else the
machine does meanwhile is no matter.
"""
import argparse
import json
import os
import pathlib
import resource
import shlex
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "run"))
import docs_page  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[3]
EDITS = {  # a file, the program that tests it, a test of it
    "a lobe": ("integrator/materials/lobes/smooth_boundary.cpp", "pm_test_surfaces", "Bsdf.IsReciprocal"),
    "a reader": ("host_shim/formats/obj/obj_keys.cpp", "pm_test_ingest", "Obj*"),
    "a test": ("tests/integrator/sampling/warps_test.cpp", "pm_test_sampling", "Warps.Triangle"),
}


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"measure_build: {' '.join(map(str, command))}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


def checkout(state, folder):
    if pathlib.Path(state).is_dir():
        return pathlib.Path(state).resolve()
    archive = subprocess.run(["git", "-C", str(ROOT), "archive", state], check=True, stdout=subprocess.PIPE)
    folder.mkdir(parents=True, exist_ok=True)
    subprocess.run(["tar", "-x", "-C", str(folder)], input=archive.stdout, check=True)
    return folder


def configure(source, build, together, tests):
    run("cmake", "--preset", "release", "-B", build, "-D", f"PM_BUILD_TESTS={'ON' if tests else 'OFF'}",
        "-D", "PM_BUILD_BENCHMARKS=OFF", "-D", "PM_CCACHE=OFF",
        "-D", f"CMAKE_UNITY_BUILD={'ON' if together else 'OFF'}", cwd=source)  # fmt: skip


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def from_nothing(source, build, together, jobs):
    """Processor and wall seconds of library and pm_host."""
    run("cmake", "-E", "rm", "-rf", build)
    configure(source, build, together, tests=False)
    before, begin = processor_seconds(), time.monotonic()
    run("ninja", "-C", build, "-j", jobs, "pm_host", "pm_plugin")
    return processor_seconds() - before, time.monotonic() - begin


def after_an_edit(source, build, what, jobs):
    file, program, test = EDITS[what]
    run("ninja", "-C", build, "-j", jobs, program)
    path = source / file
    text, times = path.read_text(), path.stat()
    try:
        path.write_text(text + "\n// An edited line.\n")
        begin = time.monotonic()
        run("ninja", "-C", build, "-j", jobs, program)
        built = next(p for p in (build / "tests").rglob(program) if p.is_file())
        run(built, f"--gtest_filter={test}")
        return time.monotonic() - begin
    finally:
        path.write_text(text)
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))


def compilers_of(source, build):
    """The call for each of the product's files, by its name from the root; nothing is written."""
    configure(source, build, together=False, tests=False)
    # A state without precompiled headers has no such targets.
    subprocess.run(["ninja", "-C", str(build), "pm_headers", "pm_cold_headers"], capture_output=True, check=False)
    calls = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        file, call = pathlib.Path(entry["file"]), shlex.split(entry["command"])
        if file.is_relative_to(source) and not file.is_relative_to(build):
            call[call.index("-o") + 1] = os.devnull
            calls[str(file.relative_to(source))] = call
    return calls


def sampled(sources, builds, one_in):
    """A row of the table: processor seconds of one file in so many."""
    calls = [compilers_of(source, build) for source, build in zip(sources, builds)]
    files = sorted(set(calls[0]) & set(calls[1]))[one_in // 2 :: one_in]
    seconds = [0.0, 0.0]
    for k, file in enumerate(files):
        for i in (0, 1) if k % 2 == 0 else (1, 0):
            before = processor_seconds()
            run(*calls[i][file], cwd=builds[i])
            seconds[i] += processor_seconds() - before
        print(f"measure_build: {file}: {seconds[1] / seconds[0]:.2f} so far", file=sys.stderr)
    return f"{len(files)} files, one in {one_in}, plainly, processor seconds", [seconds[0]], [seconds[1]]


def spread(values):
    middle = statistics.median(values)
    return f"{middle:.0f}" if len(values) == 1 else f"{middle:.0f} ({min(values):.0f} to {max(values):.0f})"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("states", nargs=2, metavar=("OLD", "NEW"))
    parser.add_argument("--work", type=pathlib.Path)
    parser.add_argument("--turns", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--docs", type=pathlib.Path)
    parser.add_argument("--no-edits", action="store_true")
    parser.add_argument("--sample", type=int)
    options = parser.parse_args()
    folder = options.work or pathlib.Path(tempfile.mkdtemp(prefix="pm-build-"))
    sources = [checkout(state, folder / f"source{i}") for i, state in enumerate(options.states)]
    rows = []
    if options.sample:
        rows.append(sampled(sources, [folder / "build0", folder / "build1"], options.sample))
    for together in () if options.sample else (True, False):
        taken = [[], []]
        for turn in range(options.turns):
            for i in (0, 1) if turn % 2 == 0 else (1, 0):
                build = folder / f"build{i}"
                taken[i].append(from_nothing(sources[i], build, together, options.jobs))
                print(f"measure_build: {options.states[i]} together={together}: "
                      f"{taken[i][-1][0]:.0f} s of processors, {taken[i][-1][1]:.0f} s", file=sys.stderr)  # fmt: skip
        for k, unit in ((0, "processor seconds"), (1, f"seconds, {options.jobs} at once")):
            old, new = ([t[k] for t in side] for side in taken)
            rows.append((f"library and pm_host, {'together' if together else 'plainly'}, {unit}", old, new))
    if not options.no_edits and not options.sample:
        for i in (0, 1):
            configure(sources[i], folder / f"build{i}", together=False, tests=True)
        for what in EDITS:
            old, new = ([after_an_edit(sources[i], folder / f"build{i}", what, options.jobs)
                         for _ in range(options.turns)] for i in (0, 1))  # fmt: skip
            rows.append((f"a line of {what} to its running test, seconds", old, new))
    table = ["| what | before | after | ratio |", "|---|---|---|---|"]
    for what, old, new in rows:
        table.append(f"| {what} | {spread(old)} | {spread(new)} | "
                     f"{statistics.median(new) / statistics.median(old):.2f} |")  # fmt: skip
    text = "\n".join(table) + "\n"
    print(text, end="")
    if options.docs:
        docs_page.put(options.docs, "build", text)


if __name__ == "__main__":
    main()
