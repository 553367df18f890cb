#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Inputs that people or bad luck give to pm_host, and what has to come of each: one table, run whole.

To add a row: append a Row to a list in tests/robust/inputs/*.py; then run with --write, which
writes docs/lab/inputs.md from the rows that came out as they say.

usage: inputs_test.py [--write] [--full] [--only WORD] PM_HOST_FORKS PLUGIN

--full makes the inputs as large as they may be; else those that only cost time are smaller.
"""
import concurrent.futures
import importlib
import json
import pathlib
import queue
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PAGE = HERE.parents[1] / "docs" / "lab" / "inputs.md"
sys.path[:0] = [str(HERE), str(HERE.parent / "run")]
from forks import Forks  # noqa: E402

PARALLEL = 2


def values_fault(expected, printed):
    """What --only-pixel printed against {channel: (value, tolerance)}."""
    got = dict(line.split() for line in printed.splitlines() if len(line.split()) == 2)
    for channel, (value, tolerance) in expected.items():
        # Not "beyond the tolerance": comparisons pass over NaN.
        if not abs(float(got.get(channel, "nan")) - value) <= tolerance:
            return f"{channel} is {got.get(channel)}, not {value} +- {tolerance}"
    return None


def faults_of(row, outcome, out, err, left):
    if outcome["code"] != row.code:
        yield f"exit code {outcome['code']}, not {row.code}"
    for part in row.says:
        if part not in err:
            yield f"does not say '{part}'"
    for part in row.keeps_silent_about:
        if part in err:
            yield f"says '{part}'"
    if outcome["cpuSeconds"] > row.seconds:
        yield f"{outcome['cpuSeconds']:.1f} s of a processor, more than {row.seconds}"
    if outcome["peakKib"] > row.peak_gib * (1 << 20):
        yield f"{outcome['peakKib'] / (1 << 20):.2f} GiB, more than {row.peak_gib}"
    if row.values and (fault := values_fault(row.values, out)):
        yield fault
    yield from (f"left {name}" for name in left if ".tmp" in name)


def run_row(row, forks, is_full):
    with tempfile.TemporaryDirectory(prefix="pm_inputs.") as name:
        folder = pathlib.Path(name)
        row.make(folder, is_full)
        arguments = [*row.arguments]
        if row.values:
            arguments += ["--only-pixel", row.pixel]
        outcome = forks.run(folder, arguments, 20 if is_full else 10)
        out, err = ((folder / n).read_text(errors="replace") for n in (".out", ".err"))
        left = [path.name for path in folder.rglob("*")]
        return outcome, list(faults_of(row, outcome, out, err, left)), err


def page(sections):
    lines = [
        "# Inputs tried",
        "",
        "What pm_host makes of inputs that are odd, damaged or hostile. Made by",
        "`tests/robust/inputs_test.py --write`, from the same rows that the test runs: each has to",
        "come out as it is here, within a bound of processor time and memory and without files left.",
    ]
    for title, rows in sections:
        lines += ["", f"## {title}", "", "| input | options | what comes |", "|---|---|---|"]
        for row in rows:
            options = f"`{' '.join(row.arguments[1:])}`" if row.arguments[1:] else ""
            lines.append(f"| {row.name} | {options} | {row.outcome()} |".replace("  ", " "))
    return "\n".join(lines) + "\n"


def load_sections(only):
    for path in sorted((HERE / "inputs").glob("*.py")):
        module = importlib.import_module(f"inputs.{path.stem}")
        if hasattr(module, "ROWS"):
            yield module.TITLE, [row for row in module.ROWS if only in row.name]


def run_all(rows, program, plugin, is_full):
    idle = queue.Queue()
    for _ in range(PARALLEL):
        idle.put(Forks(program, plugin))

    def run_one(row):
        forks = idle.get()
        try:
            return run_row(row, forks, is_full)
        finally:
            idle.put(forks)

    with concurrent.futures.ThreadPoolExecutor(PARALLEL) as pool:
        results = list(pool.map(run_one, rows))
    for _ in range(PARALLEL):
        idle.get().close()
    return results


def main():
    arguments = sys.argv[1:]
    only = ""
    if "--only" in arguments:
        at = arguments.index("--only")
        only = arguments[at + 1]
        del arguments[at : at + 2]
    programs = [pathlib.Path(word).resolve() for word in arguments if not word.startswith("--")]
    sections = list(load_sections(only))
    rows = [row for _, of_section in sections for row in of_section]
    failed = 0
    results = run_all(rows, *programs, "--full" in arguments)
    for row, (outcome, faults, err) in zip(rows, results):
        print(f"{'FAILED' if faults else 'ok':6} {outcome['cpuSeconds']:5.2f} s "
              f"{outcome['peakKib'] / (1 << 20):5.2f} GiB  {row.name}")  # fmt: skip
        failed += bool(faults)
        for fault in faults:
            print(f"       {fault}")
        if faults:
            print("       " + err[-600:].replace("\n", "\n       "))
    if not only:
        text = page(sections)
        if "--write" in arguments and not failed:
            PAGE.parent.mkdir(exist_ok=True)
            PAGE.write_text(text, encoding="utf-8")
        if not PAGE.exists() or PAGE.read_text(encoding="utf-8") != text:
            print(f"{PAGE} is not what the rows say; --write writes it")
            failed += 1
    print(f"{len(rows)} inputs, {failed} faults")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
