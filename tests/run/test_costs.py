#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""What each test costs: runs all that ctest knows and tells the processor time of each.

usage: test_costs.py BUILD [--jobs N] [-L LABEL] [-R EXPRESSION] [--json FILE] [--docs FILE]

Processor time is that of the test and of all that it started. --docs writes the twenty dearest into the page,
between its marks; the last column, what a test alone catches, is kept by the test's name. Exit 1 where a test
failed, as by ctest.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import time

DEAREST = 20


class Test:
    def __init__(self, told):
        properties = {p["name"]: p["value"] for p in told.get("properties", [])}
        self.name, self.command = told["name"], told["command"]
        self.processors = int(properties.get("PROCESSORS", 1))
        self.timeout = float(properties.get("TIMEOUT", 300))
        self.skip_code = properties.get("SKIP_RETURN_CODE")
        self.labels = properties.get("LABELS", [])
        self.folder = properties.get("WORKING_DIRECTORY")
        self.environment = dict(e.split("=", 1) for e in properties.get("ENVIRONMENT", []))

    def run(self):
        """Name, state, processor and wall seconds, and what a failed one printed."""
        begin = time.monotonic()
        with tempfile.TemporaryFile() as output:
            child = subprocess.Popen(self.command, cwd=self.folder, stdin=subprocess.DEVNULL, stdout=output,
                                     stderr=subprocess.STDOUT, env={**os.environ, **self.environment})  # fmt: skip
            ending = threading.Timer(self.timeout, child.kill)
            ending.start()
            _, status, used = os.wait4(child.pid, 0)
            ending.cancel()
            child.returncode = code = os.waitstatus_to_exitcode(status)
            output.seek(0)
            text = output.read().decode(errors="replace")
        skipped = str(code) == str(self.skip_code) or "[  SKIPPED ]" in text
        state = "skipped" if skipped else "passed" if code == 0 else "FAILED"
        return {"name": self.name, "state": state, "labels": self.labels, "processor": used.ru_utime + used.ru_stime,
                "wall": time.monotonic() - begin, "text": text if state == "FAILED" else ""}  # fmt: skip


def known_tests(build, options):
    chosen = [f"-L{options.label}"] if options.label else []
    chosen += [f"-R{options.expression}"] if options.expression else []
    shown = subprocess.run(["ctest", "--test-dir", str(build), "--show-only=json-v1", *chosen],
                           capture_output=True, text=True, check=True)  # fmt: skip
    return [Test(told) for told in json.loads(shown.stdout)["tests"] if "command" in told]


def run_all(tests, jobs):
    """Those that keep all processors busy run alone, the others several at a time."""
    results = []

    def told(result):
        results.append(result)
        if result["state"] == "FAILED":
            print(f"FAILED {result['name']}\n{result['text'][-3000:]}", file=sys.stderr)

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for done in concurrent.futures.as_completed([pool.submit(t.run) for t in tests if t.processors < jobs or jobs == 1]):
            told(done.result())
    for test in (t for t in tests if t.processors >= jobs > 1):
        told(test.run())
    return results


def page_text(page, results, wall):
    begin, end = "<!-- test_costs begin -->\n", "<!-- test_costs end -->"
    head, rest = page.split(begin)
    kept = dict(re.findall(r"^\| `([^`]+)` \|.*\| ([^|]*) \|$", rest.split(end)[0], re.M))
    rows = sorted(results, key=lambda r: -r["processor"])[:DEAREST]
    total = sum(r["processor"] for r in results)
    text = (f"{len(results)} tests, {sum(r['state'] == 'skipped' for r in results)} of them skipped: "
            f"{total / 60:.1f} minutes of processor time, {wall / 60:.1f} by the clock.\n\n"
            "| test | processor seconds | label | it alone catches |\n|---|---|---|---|\n")  # fmt: skip
    for r in rows:
        text += f"| `{r['name']}` | {r['processor']:.0f} | {' '.join(r['labels'])} | {kept.get(r['name'], '')} |\n"
    return head + begin + text + end + rest.split(end)[1]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("-L", dest="label")
    parser.add_argument("-R", dest="expression")
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--docs", type=pathlib.Path)
    options = parser.parse_args()
    begin = time.monotonic()
    results = run_all(known_tests(options.build, options), options.jobs)
    wall = time.monotonic() - begin
    if options.json:
        options.json.write_text(json.dumps([{k: v for k, v in r.items() if k != "text"} for r in results]))
    if options.docs:
        options.docs.write_text(page_text(options.docs.read_text(), results, wall))
    count = {state: sum(r["state"] == state for r in results) for state in ("passed", "FAILED", "skipped")}
    print(f"{count['passed']} passed, {count['FAILED']} failed, {count['skipped']} skipped; "
          f"{sum(r['processor'] for r in results):.0f} s of processors, {wall:.0f} s")  # fmt: skip
    return 1 if count["FAILED"] else 0


if __name__ == "__main__":
    sys.exit(main())
