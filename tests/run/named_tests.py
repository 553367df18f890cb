#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""What has to be built, and what run, for tests that somebody names.

usage: named_tests.py PROGRAMS NAME...

PROGRAMS is the list that CMake writes, a line each: NAME;TARGETS;SHARES;SOURCES, with blanks between targets
and between sources; SHARES is empty where ctest knows each case by its name. A NAME is a program
(pm_test_sampling, or sampling), a script (house.docs_test, or docs_test), or a regular expression that is
looked for in PROGRAM.SUITE.CASE as ctest has it.

Prints lines: "build TARGET...", then "ctest EXPRESSION", or "run PROGRAM FILTER" where the cases of a program
share one process. Exit 2, with a line, where nothing has the name.
"""
import pathlib
import re
import sys

CASE = re.compile(r"^(?:TYPED_)?TEST(_F|_P)?\(\s*(\w+),\s*(\w+)\)", re.M)


class Program:
    def __init__(self, line):
        self.name, targets, shares, sources = line.split(";")
        self.targets, self.shares, self.sources = targets.split(), shares, sources.split()
        self._cases = None

    def cases(self):
        """Suite.Case of all tests in its sources, as they are written."""
        if self._cases is None:
            texts = [pathlib.Path(s).read_text(encoding="utf-8") for s in self.sources if pathlib.Path(s).is_file()]
            self._cases = [f"{m[2]}.{m[3]}" for text in texts for m in CASE.finditer(text)]
        return self._cases

    def is_called(self, name):
        return name in (self.name, self.name.removeprefix("pm_test_"), self.name.split(".", 1)[-1])


def chosen(programs, name):
    """Programs with the cases that a name means; None stands for all cases."""
    whole = [(program, None) for program in programs if program.is_called(name)]
    if whole:
        return whole
    wanted = re.compile(name)
    found = []
    for program in programs:
        cases = [case for case in program.cases() if wanted.search(f"{program.name}.{case}")]
        # Cases that take parameters have names that are not in the source.
        if cases or wanted.search(program.name):
            found.append((program, cases or None))
    return found


def main():
    programs = [Program(line) for line in pathlib.Path(sys.argv[1]).read_text().splitlines() if line]
    targets, expressions, runs = [], [], []
    for name in sys.argv[2:]:
        found = chosen(programs, name)
        if not found:
            print(f"no test is called '{name}'; programs: "
                  + " ".join(p.name for p in programs), file=sys.stderr)  # fmt: skip
            return 2
        for program, cases in found:
            targets += [t for t in program.targets if t not in targets]
            prefix = "^" + re.escape(program.name)
            if cases is None:
                expressions.append(prefix + (r"\." if program.sources else "$"))
            elif program.shares:
                runs.append(f"run {program.name} {':'.join(f'*{case}*' for case in cases)}")
            else:
                expressions += [prefix + r"\.(.*/)?" + re.escape(case) for case in cases]
    print("build", *targets)
    if expressions:
        print("ctest", "|".join(expressions))
    print(*runs, sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
