#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Which of a target's files can't be compiled together with its others in one go.

usage: same_names.py FILE...

In an unnamed namespace files are free to call things alike. Prints the fewest files it finds that
have to be compiled alone, separated by semicolons. Reads clang-format's layout, not C++: an
overload of a function counts as the same name where it has as many parameters, or in tests always.
"""
import collections
import re
import sys

NAMESPACE = re.compile(r"^namespace \{\n(.*?)^\}  // namespace$", re.M | re.S)
TYPE = re.compile(r"^(?:struct|class|enum class|enum|using) (?:alignas\([^)]*\) )?(\w+)", re.M)
CONSTANT = re.compile(r"^(?:static |inline )?const(?:expr)? [^;]*;", re.M)
CONSTANT_NAME = re.compile(r"\b(k[A-Z]\w*)(?= ?[=\[{(;])")
MACROS = ("TEST", "TEST_F", "TEST_P")  # whose functions have the names that they are given
FUNCTION = re.compile(r"^(?![ /}#])[^=;{\n]*?\b(\w+)\(([^{;]*)\)[^(){;]*\{", re.M)


def names(text, by_count):
    """The names of a file's unnamed namespaces; by_count: of functions with the number of parameters."""
    found = set()
    for body in NAMESPACE.findall(text):
        found.update(TYPE.findall(body))
        for constants in CONSTANT.findall(body):
            found.update(CONSTANT_NAME.findall(constants))
        found.update((name, parameters.count(",") if by_count else None)
                     for name, parameters in FUNCTION.findall(body) if name not in MACROS)  # fmt: skip
    return found


def main():
    texts = {}
    for file in sys.argv[1:]:
        with open(file, encoding="utf-8") as source:
            texts[file] = source.read()
    # Helpers of tests have parameters that may be left out.
    by_count = not any(re.search(r"^TEST", text, re.M) for text in texts.values())
    files_by_name = collections.defaultdict(set)
    for file, text in texts.items():
        for name in names(text, by_count):
            files_by_name[name].add(file)
    alone = []
    while True:
        clashes = collections.Counter()
        for files in files_by_name.values():
            if len(files) > 1:
                clashes.update(sorted(files))
        if not clashes:
            break
        worst = max(sorted(clashes), key=clashes.get)
        alone.append(worst)
        for files in files_by_name.values():
            files.discard(worst)
    print(";".join(alone), end="")


if __name__ == "__main__":
    main()
