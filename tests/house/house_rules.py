#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Who may include whom, and what may lie where: docs/overview.md in the form of a test.

Prints one line for each breach, `file:line: what and what is allowed`, and exits 1 if there is any.

usage: house_rules.py [REPOSITORY]
"""
import hashlib
import pathlib
import re
import subprocess
import sys

PARTS = ("integrator", "scheduler", "plugin", "host_shim")
LIBRARY_PARTS = ("integrator", "scheduler", "plugin")  # what lives inside a host's process
TOP_LEVEL = {
    "CMakeLists.txt", "CMakePresets.json", "README.md", "CONTRIBUTING.md", "CHANGELOG.md",
    "LICENSE", "dev", ".ci", ".clang-format", ".gitignore", "integrator", "scheduler", "plugin",
    "host_shim", "scenes", "tests", "docs",
}  # fmt: skip
PUBLIC_HEADER = "plugin/include/pm_plugin.h"

# Part -> what it may include of ours, as beginnings of paths.
OWN = {
    "integrator": ("integrator/",),
    "scheduler": ("scheduler/", "integrator/values/"),
    "plugin": ("plugin/", "scheduler/", "integrator/"),
    "host_shim": ("host_shim/", PUBLIC_HEADER),
}
# Third party include -> the folders that may have it.
THIRD_PARTY = [
    (re.compile(r"embree\d*/"), ("integrator/rays/",)),
    (re.compile(r"opensubdiv/"), ("integrator/geometry/",)),
    (re.compile(r"OpenImageIO/"), ("plugin/", "host_shim/")),
    (re.compile(r"OpenColorIO/"), ("host_shim/",)),
    (re.compile(r"tiny_obj_loader|CLI/"), ("host_shim/",)),
]
# Pattern, where it is not allowed, why; and the folders there that may all the same.
FORBIDDEN = [
    (re.compile(r"\b(?:OIIO|OpenImageIO(?:_v\w+)?)::attribute\s*\("), PARTS,
     "sets OpenImageIO's state for the whole process"),
    # Reading it (global_control::active_value) is fine, an object of it is not.
    (re.compile(r"\bglobal_control\b(?!\s*::|\s*;|\.h)"), PARTS, "changes the host's thread pool"),
    (re.compile(r"\bSetCurrentConfig\b"), PARTS, "sets OpenColorIO's config for the whole process"),
    (re.compile(r"(?<![\w.>:])(?:std::)?(?:exit|_exit|_Exit|quick_exit|abort|terminate)\s*\("),
     LIBRARY_PARTS, "ends the host's process"),
    (re.compile(r"(?<!\w)(?:std::)?(?:printf|fprintf|puts|fputs|putchar)\s*\(|std::(?:cout|cerr)\b"),
     LIBRARY_PARTS, "prints from inside a host"),
    (re.compile(r"(?<!\w)(?:std::)?(?:setenv|putenv|signal|sigaction)\s*\("), LIBRARY_PARTS,
     "changes the host's process"),
    (re.compile(r"\b(?:strto[df]|strtold|sto[df]|stold|atof|sscanf|setlocale)\s*\("), PARTS,
     "goes through the locale; use std::from_chars or fmt"),
    (re.compile(r"\bLightKind\b|\bLight::Kind\b|\b(?:get|get_if|holds_alternative)<\w*Light>"), PARTS,
     "asks which kind of light it is; ask what it does (integrator/lights/light.h)",
     "integrator/lights/"),
]  # fmt: skip
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
COMMENT_OR_STRING = re.compile(
    r'//[^\n]*|/\*.*?\*/|(?P<s>"(?:\\.|[^"\\\n])*")|\'(?:\\.|[^\'\\\n])\'', re.DOTALL
)


def sources(root, parts=PARTS, suffixes=(".h", ".c", ".cpp")):
    """Paths relative to root, sorted, of the sources in these folders."""
    for part in parts:
        for path in sorted((root / part).rglob("*")):
            if path.suffix in suffixes and path.is_file():
                yield path.relative_to(root).as_posix()


def code_lines(text):
    """The lines without comments and string contents, numbered as in the file."""
    blank = lambda m: '""' if m.group("s") else "\n" * m.group().count("\n") or " "
    return COMMENT_OR_STRING.sub(blank, text).splitlines()


def includes(root, name):
    """(line number, is it in quotes, what) of each #include of a file."""
    text = (root / name).read_text(encoding="utf-8")
    for number, line in enumerate(text.splitlines(), 1):
        match = INCLUDE.match(line)
        if match:
            yield number, match.group(1) == '"', match.group(2)


def check_includes(root):
    for name in sources(root):
        part = name.split("/")[0]
        for number, quoted, what in includes(root, name):
            where = f"{name}:{number}"
            if quoted and not (root / what).is_file():
                yield f"{where}: includes \"{what}\"; ours are named from the repository's root"
            elif what.split("/")[0] in PARTS and not what.startswith(OWN[part]):
                yield f"{where}: includes {what}; {part} may see only {', '.join(OWN[part])}"
            for pattern, folders in THIRD_PARTY:
                if pattern.match(what) and not name.startswith(folders):
                    yield f"{where}: includes {what}; allowed only in {', '.join(folders)}"


def check_forbidden(root):
    for name in sources(root):
        lines = code_lines((root / name).read_text(encoding="utf-8"))
        for number, line in enumerate(lines, 1):
            for pattern, parts, why, *allowed in FORBIDDEN:
                match = pattern.search(line)
                if name.startswith(tuple(allowed)):
                    continue
                if match and name.split("/")[0] in parts:
                    yield f"{name}:{number}: {match.group().strip('( ')} {why}"


def check_cycles(root):
    """Folders that include each other in a ring, each ring once."""
    graph = {}
    for name in sources(root):
        folder = name.rsplit("/", 1)[0]
        for _, _, what in includes(root, name):
            if what.split("/")[0] in PARTS and "/" in what and what.rsplit("/", 1)[0] != folder:
                graph.setdefault(folder, set()).add(what.rsplit("/", 1)[0])
    seen = set()

    def visit(folder, way):
        if folder in way:
            ring = way[way.index(folder):] + [folder]
            yield f"{folder}: folders include each other in a ring: {' -> '.join(ring)}"
        elif folder not in seen:
            seen.add(folder)
            for following in sorted(graph.get(folder, ())):
                yield from visit(following, way + [folder])

    for folder in sorted(graph):
        yield from visit(folder, [])


def check_heads(root):
    """Two SPDX lines at the head of each file that has comments, and #pragma once in headers."""
    suffixes = (".h", ".c", ".cpp", ".py", ".cmake", ".in", ".obj", ".mtl")
    names = list(sources(root, PARTS + ("scenes", "tests"), suffixes))
    for folder in PARTS + ("tests",):
        names += [p.relative_to(root).as_posix() for p in (root / folder).rglob("CMakeLists.txt")]
    names += [n for n in ("CMakeLists.txt", "dev", ".ci/run") if (root / n).is_file()]
    for name in names:
        text = (root / name).read_text(encoding="utf-8", errors="replace")
        head = "\n".join(text.splitlines()[:4])
        data = name.endswith((".obj", ".mtl")) and not name.startswith("scenes/")
        if not data and not ("SPDX-License-Identifier: Apache-2.0" in head
                             and "SPDX-FileCopyrightText: The pm authors" in head):
            yield f"{name}:1: the two SPDX lines are not at the head"
        if name.endswith(".h") and name != PUBLIC_HEADER and "#pragma once" not in text:
            yield f"{name}:1: no #pragma once"


def repository_files(root):
    """The files git knows or would add; without git all but build/."""
    command = ["git", "-C", str(root), "ls-files", "-z", "--cached", "--others",
               "--exclude-standard"]  # fmt: skip
    try:
        listed = subprocess.run(command, capture_output=True, check=True).stdout.decode()
        names = [n for n in listed.split("\0") if n]
    except (OSError, subprocess.CalledProcessError):
        names = [p.relative_to(root).as_posix() for p in root.rglob("*")]
        names = [n for n in names if n.split("/")[0] not in (".git", "build")]
    return [n for n in names if (root / n).is_file()]


def check_top_level(root):
    for top in sorted({name.split("/")[0] for name in repository_files(root)} - TOP_LEVEL):
        yield f"{top}: does not belong at the top level; allowed: {', '.join(sorted(TOP_LEVEL))}"


def check_shared(root):
    """No file of ../shared is a file of ours, but for the licence's text."""
    shared = root.parent / "shared"
    if not shared.is_dir():
        return
    digest = lambda path: hashlib.sha256(path.read_bytes()).hexdigest()
    ours = {}
    for name in repository_files(root):
        size = (root / name).stat().st_size
        if size > 64 and name != "LICENSE":
            ours.setdefault(size, []).append(name)
    for path in shared.rglob("*"):
        for name in ours.get(path.stat().st_size, ()) if path.is_file() else ():
            if digest(path) == digest(root / name):
                yield f"{name}: is a copy of ../shared/{path.relative_to(shared)}"


CHECKS = (check_includes, check_forbidden, check_cycles, check_heads, check_top_level, check_shared)


def breaches(root):
    return [line for check in CHECKS for line in check(root)]


def main():
    default = pathlib.Path(__file__).resolve().parents[2]
    root = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else default
    found = breaches(root)
    for line in found:
        print(line)
    count = len(list(sources(root)))
    if count == 0:
        found.append("no sources")
    print(f"house rules: {count} sources, {len(found)} breaches")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
