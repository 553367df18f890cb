#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Instructions that two builds of pm_host take for the same pictures, and their ratio.

They tell a change of a per cent where seconds on a busy machine don't. By perf where the machine counts
instructions of user space, else by valgrind, some fifty times as slow. The two take turns; one thread, given
passes, so that the work is the same each time. What a start takes (--help) is counted once and taken
off: it is most of a small picture's, and no rendering.

The change's cost in seconds is another matter: instructions do not know of caches, or of what runs at once.
"""
import argparse
import dataclasses
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

SCENES = pathlib.Path(__file__).resolve().parents[3] / "scenes"
OWN = ("cornell_box/cornell_box.obj", "caustic_glass/caustic_glass.obj", "regression/many_lamps.obj")
# libhwy, which libraries of pictures come with, reads a clock when it is loaded by an instruction that
# valgrind 3.19 has not; it goes on with this in its place.
NO_CLOCK = 'extern "C" unsigned long _ZN3hwy8platform15TimerResolutionEv() { return 1; }\n'


class NotCounted(Exception):
    """No number came of a run; says why."""


@dataclasses.dataclass
class Perf:
    name = "perf"

    def count(self, command, folder):
        written = folder / "perf.txt"
        run(["perf", "stat", "-x", ",", "-e", "instructions:u", "-o", str(written), *command], folder)
        found = re.search(r"^(\d+),[^,]*,instructions", written.read_text(), re.MULTILINE)
        if not found:
            raise NotCounted("perf counts no instructions on this machine")
        return int(found.group(1))


@dataclasses.dataclass
class Valgrind:
    name = "valgrind"
    preload: str = ""

    def prepare(self, folder):
        source, library = folder / "no_clock.cpp", folder / "no_clock.so"
        source.write_text(NO_CLOCK)
        run(["c++", "-shared", "-fPIC", str(source), "-o", str(library)], folder)
        self.preload = str(library)

    def count(self, command, folder):
        said = run(["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null",
                    *command], folder, LD_PRELOAD=self.preload)  # fmt: skip
        found = re.search(r"I\s+refs:\s+([\d,]+)", said)
        if not found:
            raise NotCounted(f"valgrind told no number: {said[-300:]}")
        return int(found.group(1).replace(",", ""))


def run(command, folder, **environment):
    """What a command says on both of its outputs; NotCounted when it fails or is not there."""
    try:
        done = subprocess.run(command, cwd=folder, env=dict(os.environ, **environment), text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)  # fmt: skip
    except FileNotFoundError:
        raise NotCounted(f"{command[0]} is not installed") from None
    if done.returncode != 0:
        raise NotCounted(f"{' '.join(command)} ended with {done.returncode}: {done.stdout[-300:]}")
    return done.stdout


def counter(wanted, folder):
    """perf where it counts, else valgrind; or the one that is wanted."""
    if wanted in ("auto", "perf"):
        try:
            Perf().count(["true"], folder)
            return Perf()
        except NotCounted:
            if wanted == "perf":
                raise
    valgrind = Valgrind()
    valgrind.prepare(folder)
    return valgrind


def render(host, scene, options):
    return [str(host), str(scene), "--size", options.size, "--passes", str(options.passes), "--threads", "1",
            "--seed", "1", "-o", "picture.exr"]  # fmt: skip


def measure(count, hosts, scene, options, starts):
    """[turn][host] instructions of a render, without those of a start; hosts in turns."""
    turns = []
    for turn in range(options.turns):
        counts = [0, 0]
        for which in ((0, 1) if turn % 2 == 0 else (1, 0)):
            counts[which] = count(render(hosts[which], scene, options)) - starts[which]
        if min(counts) <= 0:
            raise NotCounted(f"{scene} takes no more than a start: choose a larger --size")
        turns.append(counts)
    return turns


def row(scene, turns):
    """A line of the table, and the median ratio."""
    ratios = sorted(new / old for old, new in turns)
    old, new = (statistics.median(counts[which] for counts in turns) / 1e9 for which in (0, 1))
    ratio = statistics.median(ratios)
    name = pathlib.Path(scene).stem
    return f"| {name} | {old:.4f} | {new:.4f} | {ratio:.4f} | {ratios[0]:.4f} to {ratios[-1]:.4f} |", ratio


def compare(options, folder):
    """Prints the table; the largest ratio of a scene."""
    hosts = [path.resolve() for path in (options.old, options.new)]
    way = counter(options.counter, folder)
    count = lambda command: way.count(command, folder)
    starts = [count([str(host), "--help"]) for host in hosts]
    print(f"by {way.name}, {options.size} pixels, {options.passes} passes, {options.turns} turns; a start takes "
          f"{starts[0] / 1e9:.4f} and {starts[1] / 1e9:.4f}, taken off\n")  # fmt: skip
    print("| scene | old, 10^9 | new, 10^9 | new / old | of the turns |\n|---|---|---|---|---|")
    largest = 0
    for scene in options.scenes or [SCENES / name for name in OWN]:
        line, ratio = row(scene, measure(count, hosts, pathlib.Path(scene).resolve(), options, starts))
        print(line, flush=True)
        largest = max(largest, ratio)
    return largest


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=pathlib.Path, help="a pm_host, its library beside it")
    parser.add_argument("new", type=pathlib.Path, help="another")
    parser.add_argument("scenes", nargs="*", help="scene files (three of our own)")
    parser.add_argument("--size", default="24x18", help="pixels (24x18)")
    parser.add_argument("--passes", type=int, default=2, help="of each render (2)")
    parser.add_argument("--turns", type=int, default=2, help="renders of each host (2)")
    parser.add_argument("--limit", type=float, help="per cent; fails where a scene takes more than so much more")
    parser.add_argument("--counter", choices=("auto", "perf", "valgrind"), default="auto")
    return parser.parse_args()


def main():
    options = arguments()
    try:
        with tempfile.TemporaryDirectory() as folder:
            largest = compare(options, pathlib.Path(folder))
    except NotCounted as error:
        print(f"count_instructions: {error}", file=sys.stderr)
        return 2
    if options.limit is not None and largest > 1 + options.limit / 100:
        print(f"\na scene takes {largest:.4f} times as many; at most {1 + options.limit / 100:.4f} is allowed")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
