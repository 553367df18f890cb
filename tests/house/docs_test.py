#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""The documents hold: links lead somewhere, the C example compiles, options exist in pm_host, tests
exist that docs/testing.md and docs/lab/mutations.md name, tables are even, docs/parameters.md is what pm_host lists.

usage: docs_test.py C_COMPILER PM_HOST
"""
import pathlib
import re
import subprocess
import sys
import tempfile

import parameters_page

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("scenes/*/*.md")])


def broken_links():
    for document in DOCUMENTS:
        text = document.read_text(encoding="utf-8")
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", text):
            if "://" not in target and not (document.parent / target).exists():
                yield f"{document.relative_to(ROOT)}: the link {target} leads nowhere"


def broken_example(compiler):
    """The first C example of c_interface.md, as the body of a function."""
    text = (ROOT / "docs" / "c_interface.md").read_text(encoding="utf-8")
    example = re.search(r"```c\n(.*?)```", text, re.DOTALL).group(1)
    head, body = example.split("\n", 1)
    with tempfile.TemporaryDirectory() as folder:
        source = pathlib.Path(folder, "example.c")
        source.write_text(f"{head}\nint main(void) {{\n{body}\nreturn 0;\n}}\n")
        command = [compiler, "-std=c11", "-Wall", "-Werror", "-fsyntax-only",
                   f"-I{ROOT / 'plugin' / 'include'}", str(source)]  # fmt: skip
        done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        yield f"docs/c_interface.md: the example does not compile:\n{done.stderr}"


def unknown_options(host):
    known = subprocess.run([host, "--help"], capture_output=True, text=True, check=True).stdout
    for document in DOCUMENTS:
        if document.name == "CHANGELOG.md":
            continue
        for line in document.read_text(encoding="utf-8").splitlines():
            others = r"cmake|ctest|gtest|dev (?:bench|format|fuzz|install|lint|mutations|test)|pm_bench|find_package|_test\.py|munge[d.]|sinfo|slurm-option="
            is_ours = not re.search(others, line)
            for option in re.findall(r"(?<![\w-])--[a-z][a-z-]+", line) if is_ours else ():
                if option != "--prefix" and not re.search(rf"{option}\b", known):
                    yield f"{document.relative_to(ROOT)}: pm_host has no option {option}"


def uneven_tables():
    """Rows of a table have as many cells as its first."""
    for document in DOCUMENTS:
        head = 0
        for number, line in enumerate(document.read_text(encoding="utf-8").splitlines(), 1):
            cells = len(re.findall(r"(?<!\\)\|", line)) if line.startswith("|") else 0
            if head and cells and cells != head:
                yield f"{document.relative_to(ROOT)}:{number}: {cells - 1} cells of {head - 1}"
            head = (head or cells) if cells else 0


def unknown_tests():
    named = set()
    for source in ROOT.glob("tests/**/*.cpp"):
        text = source.read_text(encoding="utf-8")
        named |= set(map(".".join, re.findall(r"\bTEST(?:_[PF])?\(\s*(\w+),\s*(\w+)", text)))
    for page in ("docs/testing.md", "docs/lab/mutations.md"):
        for test in re.findall(r"`([A-Z]\w+\.[A-Z]\w+)`", (ROOT / page).read_text(encoding="utf-8")):
            if test not in named:
                yield f"{page}: there is no test {test}"


def stale_parameters(host):
    page = ROOT / "docs" / "parameters.md"
    if not page.exists() or page.read_text(encoding="utf-8") != parameters_page.page(host):
        yield "docs/parameters.md: not what pm_host lists; tests/house/parameters_page.py makes it"


def main():
    compiler, host = sys.argv[1:3]
    found = [*broken_links(), *broken_example(compiler), *unknown_tests(), *uneven_tables()]
    if pathlib.Path(host).exists():
        found += [*unknown_options(host), *stale_parameters(host)]
    else:
        found.append(f"{host} is not built")
    for line in found:
        print(line)
    print(f"documents: {len(DOCUMENTS)}, {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
