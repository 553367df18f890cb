#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Which of a target's files are compiled together in one go.

usage: same_names.py FILE...

In an unnamed namespace files are free to call things alike. Prints each file's group, a number, separated
by semicolons: no two files of a group have a name in common. Reads clang-format's layout, not C++: an
overload of a function counts as the same name where it has as many parameters, or in tests always.
"""
import re
import sys

MOST_FILES = 12  # of a group: more take longer at a time, and more memory
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
    by_file = {file: names(text, by_count) for file, text in texts.items()}
    groups = []  # the files and the names of each
    number = {}
    for file in sys.argv[1:]:
        for i, (files, taken) in enumerate(groups):
            if len(files) < MOST_FILES and not taken & by_file[file]:
                break
        else:
            i = len(groups)
            groups.append(([], set()))
        groups[i][0].append(file)
        groups[i][1].update(by_file[file])
        number[file] = i
    print(";".join(str(number[file]) for file in sys.argv[1:]), end="")


if __name__ == "__main__":
    main()
