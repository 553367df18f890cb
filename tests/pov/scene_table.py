#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""All scenes of Debian's povray-examples: how many are read, wait for shapes or patterns, or are refused.

usage: scene_table.py PM_HOST [--docs FILE]

Fails where fewer than 340 are read or wait, where one crashes or takes over 20 s, or where nothing says why one is
refused. Skips, with a line, where the package is not installed. --docs writes the table.
"""
import concurrent.futures
import pathlib
import re
import subprocess
import sys
import time

EXAMPLES = pathlib.Path("/usr/share/doc/povray/examples")
MOST_SECONDS = 20
LEAST_READ = 340


def read(host, file):
    """(kind, why, seconds): kind is read, waits or refused, or what went wrong."""
    begun = time.monotonic()
    command = [host, file, "--explain", "-q", "--threads", "1"]
    try:
        done = subprocess.run(command, capture_output=True, timeout=60, cwd=file.parent)
    except subprocess.TimeoutExpired:
        return "no end", "", 60.0
    seconds = time.monotonic() - begun
    said = done.stderr.decode(errors="replace").strip().splitlines()
    errors = [line for line in said if line.startswith("pm_host: ") and "warning: " not in line and " more of " not in line]
    last = errors[-1] if errors else ""
    if done.returncode == 0 or "nothing that can be rendered" in last:
        return "read", "", seconds
    if done.returncode != 3:
        return f"exit {done.returncode}", last, seconds
    if "waits for" in last:
        return "waits", re.search(r"(\S+(?: of an? \w+)?):? waits for \w+", last)[0], seconds
    return "refused", last.split(": ", 2)[-1], seconds


def table(results):
    counts = {}
    for kind, _, _ in results.values():
        counts[kind] = counts.get(kind, 0) + 1
    lines = ["# POV-Ray's example scenes", "",
             "Made by `tests/pov/scene_table.py` of Debian's povray-examples. Read: the language was evaluated to its end.",
             "Waits: the scene asks a shape or a pattern while it is read.", "",
             ", ".join(f"{kind}: {count}" for kind, count in sorted(counts.items())) + f"; of {len(results)}.", "",
             "| scene | | why |", "|---|---|---|"]
    for name, (kind, why, _) in sorted(results.items()):
        lines.append(f"| {name} | {kind} | {why.replace('|', '/')} |")
    return "\n".join(lines) + "\n"


def main():
    host = pathlib.Path(sys.argv[1]).resolve()
    if not EXAMPLES.is_dir():
        print("povray-examples is not installed: skipped")
        return 77
    files = sorted(EXAMPLES.rglob("*.pov"))
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        results = dict(zip((str(f.relative_to(EXAMPLES)) for f in files), pool.map(lambda f: read(host, f), files)))
    bad = {name: r for name, r in results.items() if r[0] not in ("read", "waits", "refused")}
    slow = {name: r for name, r in results.items() if r[2] > MOST_SECONDS}
    silent = {name: r for name, r in results.items() if r[0] == "refused" and not r[1]}
    count = sum(r[0] == "read" for r in results.values())
    print(f"{count} of {len(results)} are read, {sum(r[0] == 'waits' for r in results.values())} wait; "
          f"the slowest takes {max(r[2] for r in results.values()):.1f} s")
    for what, which in (("crashed", bad), ("took too long", slow), ("was refused without a word", silent)):
        for name, result in which.items():
            print(f"{name} {what}: {result}")
    if "--docs" in sys.argv:
        pathlib.Path(sys.argv[sys.argv.index("--docs") + 1]).write_text(table(results))
    return int(bool(bad or slow or silent or (len(files) == 396 and count < LEAST_READ)))


if __name__ == "__main__":
    sys.exit(main())
