#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Breaks the code by each patch of this folder and sees that the tests which it names fail.

A patch begins with lines "# ...": what is broken, then one "# Killed by: PROGRAM Suite.Name" for each
test, or "# Killed by: NAME" of ctest for a test in Python. All of them pass on the sources as they are,
and each fails where its patch is applied: neither a crash, nor a test that is not there or skips, nor
code that does not compile, counts.

The sources are a copy of what git knows, in build/mutations, and have a build of their own there.

usage: mutations.py [--jobs N] [--write FILE] [--source DIR --build DIR] [NAME...]

  --jobs N      compilers at once (1)
  --write FILE  a table of the results, as Markdown
  --source DIR --build DIR
                another checkout in place of the copy, and its build; what a patch changes is put back,
                after Ctrl-C as well
"""
import argparse
import contextlib
import dataclasses
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
LONGEST_TEST = 600  # seconds
CONFIGURE = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=OFF", "-DPM_BUILD_TESTS=ON",
             "-DPM_BUILD_BENCHMARKS=OFF"]  # fmt: skip


class Fault(Exception):
    """What ends all, as a text for people."""


@dataclasses.dataclass(frozen=True)
class Killer:
    program: str  # "" for a test in Python
    test: str  # Suite.Name, or the name that ctest knows

    def __str__(self):
        return f"{self.program} {self.test}".strip()

    @property
    def targets(self):
        return [self.program] if self.program else ["pm_host", "pm_plugin"]


@dataclasses.dataclass(frozen=True)
class Mutation:
    name: str
    what: str
    killers: tuple
    files: tuple  # that it changes
    patch: pathlib.Path

    @property
    def targets(self):
        return sorted({target for killer in self.killers for target in killer.targets})


def parse(patch):
    """The mutation of a patch. Raises Fault where its head or the diff lacks something."""
    what, killers, text = [], [], patch.read_text(encoding="utf-8")
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        named = re.fullmatch(r"# Killed by: (?:(pm_test_\w+) (\w+\.\w+)|(\w+\.\w+))", line)
        if named:
            killers.append(Killer(named[1] or "", named[2] or named[3]))
        elif "Killed by" in line or killers:
            raise Fault(f"{patch.name}: '{line}' is not '# Killed by: PROGRAM Suite.Name'")
        else:
            what.append(line.removeprefix("#").strip())
    files = tuple(re.findall(r"^\+\+\+ b/(\S+)$", text, re.M))
    if not (what and killers and files):
        raise Fault(f"{patch.name}: has not all of what is broken, 'Killed by: ' and a diff")
    return Mutation(patch.stem, " ".join(what), tuple(killers), files, patch)


def all_mutations(folder=HERE):
    """In the order of the files that they break."""
    return sorted(map(parse, folder.glob("*.patch")), key=lambda m: (m.files, m.name))


def chosen(names):
    known = {mutation.name: mutation for mutation in all_mutations()}
    for name in names:
        if name not in known:
            raise Fault(f"no mutation '{name}'; there are {', '.join(known)}")
    return [mutation for name, mutation in known.items() if not names or name in names]


def outcome_of_gtest(report):
    """What a report of GoogleTest, read from JSON, says of the tests that were asked for."""
    cases = [case for suite in report.get("testsuites", ()) for case in suite.get("testsuite", ())]
    if not cases:
        return "is not there"
    if any(case.get("failures") for case in cases):
        return "fails"
    return "passes" if any(case.get("result") == "COMPLETED" for case in cases) else "skips"


def outcome_of_ctest(said):
    """The same of what ctest says."""
    found = re.search(r"\*\*\*\s*(\w+)|(\bPassed\b)", said)
    if not found:
        return "is not there"
    return {None: "passes", "Failed": "fails", "Skipped": "skips"}.get(found[1], f"ends by {found[1]}")


def run(command, folder, **options):
    return subprocess.run(list(map(str, command)), cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          stdin=subprocess.DEVNULL, text=True, errors="replace", **options)  # fmt: skip


def apply(patch, source, *options):
    """By git, whichever repository the folder lies in, or none; what it says, "" where all is well."""
    outside = {**os.environ, "GIT_CEILING_DIRECTORIES": str(source.parent)}
    done = run(["git", "apply", *options, patch], source, env=outside)
    return (done.stdout.strip() or "git apply fails") if done.returncode else ""


class Checkout:
    def __init__(self, source, build, jobs):
        self.source, self.build_folder, self.jobs = source, build, jobs

    def configure(self):
        if not (self.build_folder / "build.ninja").exists():
            done = run(["cmake", "-S", self.source, "-B", self.build_folder, *CONFIGURE], self.source)
            if done.returncode:
                raise Fault(f"CMake could not configure:\n{done.stdout[-4000:]}")

    def build(self, targets):
        """False: does not compile."""
        done = run(["ninja", "-j", self.jobs, *targets], self.build_folder)
        if "interrupted by user" in done.stdout:
            raise KeyboardInterrupt
        if done.returncode:
            errors = [line for line in done.stdout.splitlines() if "error" in line or "FAILED" in line]
            say("\n".join(errors[:8] or done.stdout.splitlines()[-8:]))
        return done.returncode == 0

    def outcome(self, killer):
        try:
            return self.outcome_by_gtest(killer) if killer.program else self.outcome_by_ctest(killer)
        except subprocess.TimeoutExpired:
            return f"takes longer than {LONGEST_TEST} s"

    def outcome_by_gtest(self, killer):
        program = next(self.build_folder.glob(f"tests/**/{killer.program}"), None)
        if program is None:
            return "is not there"
        with tempfile.TemporaryDirectory() as folder:
            report = pathlib.Path(folder, "report.json")
            run([program, f"--gtest_filter={killer.test}:*/{killer.test}/*", f"--gtest_output=json:{report}"],
                program.parent, timeout=LONGEST_TEST)  # fmt: skip
            if not report.exists():
                return "crashes"
            return outcome_of_gtest(json.loads(report.read_text(encoding="utf-8", errors="replace")))

    def outcome_by_ctest(self, killer):
        done = run(["ctest", "--test-dir", self.build_folder, "--timeout", LONGEST_TEST, "-R",
                    f"^{re.escape(killer.test)}$"], self.build_folder)  # fmt: skip
        return outcome_of_ctest(done.stdout)

    @contextlib.contextmanager
    def broken(self, mutation):
        """The sources broken. Afterwards they are as before, times too, and objects made meanwhile are gone, so that
        nothing else is built anew."""
        paths = [self.source / name for name in mutation.files]
        before = [(path, path.read_bytes(), path.stat()) for path in paths]
        begin = self.now()
        try:
            if fault := apply(mutation.patch, self.source):
                raise Fault(f"{mutation.name}: {fault}")
            yield
        finally:
            with undisturbed():
                for ending in ("o", "gch"):
                    for made in self.build_folder.rglob(f"*.{ending}"):
                        if made.stat().st_mtime_ns >= begin:
                            made.unlink()
                for path, content, status in before:
                    path.write_bytes(content)
                    os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))

    def now(self):
        """By the clock of the file system."""
        with tempfile.NamedTemporaryFile(dir=self.build_folder) as file:
            return os.stat(file.name).st_mtime_ns


@contextlib.contextmanager
def undisturbed():
    """Ctrl-C does nothing meanwhile."""
    signals = {number: signal.signal(number, signal.SIG_IGN) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in signals.items():
            signal.signal(number, handler)


def copy_sources(root, folder):
    """What git knows, as it is in the working tree; what is alike is left alone, so that it is not built anew."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=root, check=True, capture_output=True).stdout.decode()
    names = {name for name in listed.split("\0") if name and (root / name).is_file()}
    for name in names:
        to, content = folder / name, (root / name).read_bytes()
        if to.is_file() and to.read_bytes() == content:
            continue
        to.parent.mkdir(parents=True, exist_ok=True)
        to.write_bytes(content)
        to.chmod((root / name).stat().st_mode)
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.relative_to(folder).as_posix() not in names:
            path.unlink()


def check_unbroken(checkout, mutations):
    killers = sorted({killer for mutation in mutations for killer in mutation.killers}, key=str)
    say(f"building what {len(killers)} tests need")
    if not checkout.build(sorted({target for killer in killers for target in killer.targets})):
        raise Fault("the sources as they are do not build")
    say("running them on the sources as they are")
    others = [f"{killer} {outcome}" for killer in killers if (outcome := checkout.outcome(killer)) != "passes"]
    if others:
        raise Fault("on the sources as they are " + "; ".join(others))


@dataclasses.dataclass
class Result:
    mutation: Mutation
    missed: list  # of killers that did not fail, with what they did
    seconds: float

    def __str__(self):
        how = "NOT caught by " if self.missed else "caught by "
        return (f"{self.mutation.name}: {how}{', '.join(self.missed or map(str, self.mutation.killers))} "
                f"({self.seconds:.0f} s)")  # fmt: skip


def result_of(checkout, mutation):
    begin = time.monotonic()
    with checkout.broken(mutation):
        if checkout.build(mutation.targets):
            outcomes = {killer: checkout.outcome(killer) for killer in mutation.killers}
            missed = [f"{killer}, which {outcome}" for killer, outcome in outcomes.items() if outcome != "fails"]
        else:
            missed = ["anything: it does not compile"]
        seconds = time.monotonic() - begin
    return Result(mutation, missed, seconds)


def table(results):
    """As Markdown."""
    lines = ["# Mutations", "",
             f"Written by `./dev mutations --write`: {len(results)} mutations, "
             f"{sum(not result.missed for result in results)} caught, "
             f"{sum(result.seconds for result in results) / 60:.0f} minutes in all. Each is a patch of",
             "[tests/mutations](../../tests/mutations) and was made in a copy of the sources; the tests that are named",
             "failed with it and pass without. The seconds are those of building and running them.", "",
             "| mutation | broken so | in | killed by | s |", "|---|---|---|---|---|"]  # fmt: skip
    for result in results:
        mutation = result.mutation
        rooms = ", ".join(sorted({name.rsplit("/", 1)[0] for name in mutation.files}))
        killers = "; ".join(result.missed) if result.missed else ", ".join(f"`{k.test}`" for k in mutation.killers)
        lines.append(f"| `{mutation.name}` | {mutation.what} | `{rooms}` | {'NOT by ' if result.missed else ''}{killers} "
                     f"| {result.seconds:.0f} |")  # fmt: skip
    return "\n".join(lines) + "\n"


def say(text):
    print(text, file=sys.stderr, flush=True)


def arguments(words):
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--write", type=pathlib.Path)
    parser.add_argument("--source", type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path)
    given = parser.parse_args(words)
    if (given.source is None) != (given.build is None):
        parser.error("--source and --build go together")
    return given


def main(words):
    given = arguments(words)
    mutations = chosen(given.names)
    if given.source:
        checkout = Checkout(given.source.resolve(), given.build.resolve(), given.jobs)
    else:
        work = ROOT / "build" / "mutations"
        checkout = Checkout(work / "source", work / "build", given.jobs)
        copy_sources(ROOT, checkout.source)
        checkout.configure()
    check_unbroken(checkout, mutations)
    results = []
    for mutation in mutations:
        results.append(result_of(checkout, mutation))
        print(results[-1], flush=True)
    missed = [result.mutation.name for result in results if result.missed]
    say(f"{len(results) - len(missed)} of {len(results)} caught")
    if given.write:
        given.write.write_text(table(results), encoding="utf-8")
    return 1 if missed else 0


def interrupt(*_):
    raise KeyboardInterrupt


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, interrupt)
    try:
        sys.exit(main(sys.argv[1:]))
    except Fault as fault:
        sys.exit(f"mutations: {fault}")
    except KeyboardInterrupt:
        sys.exit("mutations: interrupted; the sources are as before")
