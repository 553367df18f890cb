#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Lines that the compiler reads for each target: a ratchet on what builds cost.

usage: lines_read.py BUILD [--write]

Adds up, over a target's objects, the lines of its source and of every file that it includes, once an object
(what was precompiled counts where it is compiled). The same sources and packages give the same numbers.
lines_read.txt has what is allowed, in thousands, where files are compiled together (PM_TOGETHER, as .ci/run does);
a target may read 5 % more. Whoever raises a number writes why into its line. --write prints the lines as they
are today, of any build.
"""
import collections
import functools
import pathlib
import re
import subprocess
import sys

TABLE = pathlib.Path(__file__).with_name("lines_read.txt")
ALLOWED = 1.05
OURS = re.compile(r"^(?:integrator|scheduler|plugin|host_shim|)(?:/[\w/]*)?/?CMakeFiles/(pm_\w+)\.dir/")


def lines_read(build):
    @functools.lru_cache(None)
    def lines(file):
        with open(build / file, "rb") as source:
            return sum(1 for _ in source)

    total = collections.Counter()
    deps = subprocess.run(["ninja", "-C", str(build), "-t", "deps"], capture_output=True, text=True, check=True)
    target = None
    for line in deps.stdout.splitlines():
        if line and not line.startswith(" "):
            found = OURS.match(line) if line.rstrip().endswith("(VALID)") else None
            target = found[1] if found else None
        elif line.startswith("    ") and target and not line.endswith(".gch"):
            total[target] += lines(line.strip())
    return total


def main():
    build = pathlib.Path(sys.argv[1])
    cache = (build / "CMakeCache.txt").read_text()
    if re.search(r"^PM_SANITIZE:\w+=(?!OFF)", cache, re.M):
        print("lines_read: not of builds with sanitizers")
        return 77
    together = re.search(r"^CMAKE_UNITY_BUILD:\w+=(ON|1|TRUE)$", cache, re.M) is not None
    read = lines_read(build)
    if "--write" in sys.argv:
        print("\n".join(f"{name} {count / 1000:.0f}" for name, count in sorted(read.items())))
        return 0
    if not together:
        print("lines_read: only of builds together; see --write")
        return 77
    faults = 0
    for line in TABLE.read_text().splitlines():
        if not line or line.startswith("#"):
            continue
        name, thousands, *_ = line.split()
        allowed = 1000 * int(thousands)
        if name not in read:
            print(f"lines_read: {name} was not built; nothing is known of it")
        elif read[name] > ALLOWED * allowed:
            print(f"lines_read: the files of {name} read {read[name] / 1000:.0f} thousand lines; {TABLE.name} allows "
                  f"{allowed / 1000:.0f} and 5 %. A header that is dear belongs in a .cpp; where it can't be helped, "
                  f"raise the number and write why")  # fmt: skip
            faults += 1
    unknown = sorted(set(read) - set(re.findall(r"^(pm_\w+)", TABLE.read_text(), re.M)))
    for name in unknown:
        print(f"lines_read: {name} has no line in {TABLE.name}")
    return 1 if faults or unknown else 0


if __name__ == "__main__":
    sys.exit(main())
