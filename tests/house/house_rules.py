#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Who may include whom, and what may lie where: docs/overview.md in the form of a test.

Prints one line for each breach, `file:line: what and what is allowed`, and exits 1 if there is any.

usage: house_rules.py [REPOSITORY]
       house_rules.py --rooms    print the table of rooms.py as the includes are today
"""
import hashlib
import pathlib
import re
import subprocess
import sys

import rooms
from rooms import PARTS

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
# Third party include -> the folders that may have it: one place in each part.
THIRD_PARTY = [
    (re.compile(r"embree\d*/"), ("integrator/rays/",)),
    (re.compile(r"opensubdiv/"), ("integrator/geometry/",)),
    (re.compile(r"(?:oneapi/)?tbb/"), ("integrator/", "scheduler/", "plugin/")),
    (re.compile(r"OpenImageIO/"),
     ("plugin/textures/", "plugin/values/version.cpp", "host_shim/pictures/", "host_shim/textures/",
      "host_shim/check/junit.cpp")),
    (re.compile(r"OpenColorIO/"), ("host_shim/colour/",)),
    (re.compile(r"tiny_obj_loader"), ("host_shim/formats/",)),
    (re.compile(r"CLI/"), ("host_shim/cli/",)),
    (re.compile(r"nlohmann/"), 
     ("plugin/", "host_shim/check/", "host_shim/copies/", "host_shim/farm/", "host_shim/formats/sidecar/", "host_shim/formats/json/", "host_shim/render/", "host_shim/session/")),
    (re.compile(r"(?:curl|openssl)/"), ("host_shim/copies/",)),
    (re.compile(r"xxhash"), ("plugin/", "host_shim/colour/", "host_shim/textures/")),
    # Programs of their own, signals and a loaded library.
    (re.compile(r"(?:spawn|signal|sys/wait)\.h"), ("host_shim/process/",)),
    (re.compile(r"dlfcn\.h"), ("host_shim/render/",)),
]
LISTS = pathlib.Path(__file__).resolve().parent
LIGHT_PATHS = ("integrator/photons/", "integrator/transport/")
# Pattern, where it is not allowed as beginnings of paths, why.
# And, where there are some, the folders among these that may all the same.
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
    (re.compile(r"\bMaterialKind\b"), LIGHT_PATHS,
     "is asked for where light is followed; ask what a material can do, material_description.h"),
    (re.compile(r"\b(?:Lambertian|Phong|Mirror|Dielectric|Pane)\b|\bmaterials/lobes/"), LIGHT_PATHS,
     "is a lobe's model; ask the Bsdf by a lobe's role"),
    (re.compile(r"[sS]cene(?:\(\))?\.(?:intersect|leftAlong)\("), LIGHT_PATHS,
     "forgets what media absorb; ask meet() or goStraight(), integrator/paths/segment.h"),
    (re.compile(r"\b(?:diffuse|reflectance)\([^()]*(?:\(\))?\)\s*\*\s*kInvPi"), LIGHT_PATHS,
     "is a Lambertian lobe's business; ask Bsdf::reflectedOf"),
    (re.compile(r"\bLightKind\b|\bLight::Kind\b|\b(?:get|get_if|holds_alternative)<\w*Light>"), PARTS,
     "asks which kind of light it is; ask what it does (integrator/lights/light.h)",
     "integrator/lights/"),
]  # fmt: skip
# Names of the C interface, and the rooms of the plugin that may use them.
INTERFACE_NAME = re.compile(r"\b(?:Pmr[A-Z]|PMR_|pmr[A-Z])\w*")
INTERFACE_ROOMS = ("plugin/api/", "plugin/include/")
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
            for pattern, places, why, *allowed in FORBIDDEN:
                match = pattern.search(line)
                if match and name.startswith(places) and not name.startswith(tuple(allowed)):
                    yield f"{name}:{number}: {match.group().strip('( ')} {why}"


def check_interface_names(root):
    """The C interface is known in few rooms of the plugin; the others have names of their own."""
    for name in sources(root, ("plugin",)):
        if name.startswith(INTERFACE_ROOMS):
            continue
        lines = code_lines((root / name).read_text(encoding="utf-8"))
        for number, line in enumerate(lines, 1):
            match = INTERFACE_NAME.search(line)
            if match:
                yield f"{name}:{number}: names {match.group()}; allowed only in {', '.join(INTERFACE_ROOMS)}"


def room_of(name):
    return name.rsplit("/", 1)[0]


def room_graph(root):
    """Room -> the other rooms that it includes, of all rooms that have sources."""
    graph = {}
    for name in sources(root):
        included = graph.setdefault(room_of(name), set())
        for _, quoted, what in includes(root, name):
            if quoted and what.split("/")[0] in PARTS and "/" in what:
                included.add(room_of(what))
        included.discard(room_of(name))
    return graph


def check_rooms(root):
    """Each room has a row, and includes what its row has."""
    rows_of = "tests/house/rooms.py"
    for room in sorted(room_graph(root)):
        if rooms.allowed(room) is None:
            yield f"{room}: is a room without a row in {rows_of}"
    for name in sources(root):
        allowed = rooms.allowed(room_of(name))
        for number, quoted, what in includes(root, name):
            ours = quoted and "/" in what and what.split("/")[0] in PARTS
            if not ours or allowed is None or room_of(what) in allowed:
                continue
            others = ", ".join(sorted(allowed - {room_of(name)})) or "no other room"
            yield (f"{name}:{number}: includes {what}; by {rows_of} {room_of(name)} may include "
                   f"{others}")  # fmt: skip


def check_rows(root):
    """No row of rooms.py is of a room that is not there, or allows what nobody does."""
    graph = room_graph(root)
    for room in sorted(rooms.MAY_INCLUDE):
        if room not in graph:
            yield f"tests/house/rooms.py: there is no room {room}"
            continue
        for other in sorted(rooms.allowed(room) - graph[room] - {room}):
            yield f"tests/house/rooms.py: {room} does not include {other}; take it out of its row"


def rings(graph):
    """One way round for each ring of a graph that a walk meets."""
    seen = set()

    def visit(node, way):
        if node in way:
            yield way[way.index(node):] + [node]
        elif node not in seen:
            seen.add(node)
            for following in sorted(graph.get(node, ())):
                yield from visit(following, way + [node])

    for node in sorted(graph):
        yield from visit(node, [])


def check_cycles(root):
    """No ring of rooms, nor of what they lie in: photons and transport, say, whatever their rooms."""
    graph = room_graph(root)
    depth = max((room.count("/") + 1 for room in graph), default=0)
    found = set()
    for length in range(depth, 0, -1):
        outer = lambda room: "/".join(room.split("/")[:length])
        short = {}
        for room, others in graph.items():
            short.setdefault(outer(room), set()).update(map(outer, others))
        for node in short:
            short[node].discard(node)
        for ring in rings(short):
            # A ring of rooms is one of their parents, too: told once, where it is narrowest.
            if not any(set(ring) <= set(map(outer, other)) for other in found):
                found.add(tuple(ring))
                yield f"{ring[0]}: folders include each other in a ring: {' -> '.join(ring)}"


def lamp_files(root):
    """Sources with the word lamp in a name, in code or their own: file's name -> its path."""
    word = re.compile(r"(?<![A-Za-z])lamps?(?![a-z])|Lamps?(?![a-z])|(?<![A-Z])LAMPS?(?![A-Z])")
    for name in sources(root):
        text = "\n".join(code_lines((root / name).read_text(encoding="utf-8")))
        if word.search(name.rsplit("/", 1)[1]) or word.search(text):
            yield name.rsplit("/", 1)[1], name


def check_light(root):
    """A light is called light. files_with_lamp.txt has the files that still call it otherwise."""
    known = set((LISTS / "files_with_lamp.txt").read_text(encoding="utf-8").split())
    found = dict(lamp_files(root))
    for name in sorted(set(found) - known):
        yield f"{found[name]}: has the word lamp in a name; a light is called light"
    if (root / "tests/house/files_with_lamp.txt").is_file():
        for name in sorted(known - set(found)):
            yield f"tests/house/files_with_lamp.txt: {name} has no lamp any more; take it out"


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


def check_brute_force(root):
    """The path tracer of the tests shares no way of following light with what it judges."""
    allowed = ("integrator/materials/", "integrator/scene/", "integrator/shapes/", "integrator/values/", "tests/integrator/brute/")
    for name in ("brute_force.h", "brute_force.cpp"):
        name = f"tests/integrator/brute/{name}"
        for number, _, included in includes(root, name) if (root / name).exists() else ():
            if "/" in included and not included.startswith(allowed):
                yield f"{name}:{number}: includes {included}; a reference shares no more than {', '.join(allowed)}"


CHECKS = (check_includes, check_rooms, check_rows, check_forbidden, check_interface_names, check_cycles, check_light, check_heads, check_brute_force,
          check_top_level, check_shared)  # fmt: skip


def breaches(root):
    return [line for check in CHECKS for line in check(root)]


def ranked(graph):
    """The rooms by part, in each those that include no others first; names where they are alike."""
    def rank(room):
        part = room.split("/")[0]
        return 1 + max((rank(other) for other in graph[room] if other.split("/")[0] == part), default=0)

    return sorted(graph, key=lambda room: (PARTS.index(room.split("/")[0]), rank(room), room))


def print_rooms(root):
    """The rows of rooms.py as the includes are."""
    graph = room_graph(root)
    for room in ranked(graph):
        part = room.split("/")[0] + "/"
        names = " ".join(sorted(other.removeprefix(part) for other in graph[room]))
        print(f'    "{room}": "{names}",')


def main():
    default = pathlib.Path(__file__).resolve().parents[2]
    if sys.argv[1:] == ["--rooms"]:
        print_rooms(default)
        return 0
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
