# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Scenes whose geometry is much, or odd."""
import math

from inputs.row import QUAD, Row, text

TITLE = "Geometry"


def points(name, values):
    return "".join(f"{name} {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in values)


def write(folder, content):
    (folder / "a.obj").write_text(content, encoding="utf-8")


def face_of(corners):
    return "f " + " ".join(str(i + 1) for i in range(corners)) + "\n"


def polygon(shape):
    def make(folder, is_full):
        n = 65535 if is_full else 6000
        write(folder, points("v", [shape(i, n) for i in range(n)]) + face_of(n))

    return make


def comb(i, n):
    if i == n - 1:
        return (n / 2, -1, 0)
    return (i / 2, i % 2, 0)


def star(i, n):
    radius = 1 if i % 2 else 0.01
    return (radius * math.cos(math.tau * i / n), radius * math.sin(math.tau * i / n), 0)


def spiral(i, n):
    """Out along one side of a band and back along the other."""
    half = n // 2
    along, width = (i, 0) if i < half else (n - 1 - i, 0.4)
    angle = 40 * math.tau * along / half
    radius = 1 + angle / math.tau + width
    return (radius * math.cos(angle), radius * math.sin(angle), 0)


def repeated(text_once, times):
    def make(folder, is_full):
        count = times if is_full else times // 10
        write(folder, text_once[0] + text_once[1] * count)

    return make


TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"

ROWS = [
    Row("a face like a comb", polygon(comb)),
    Row("a face like a star", polygon(star)),
    Row("a face like a spiral", polygon(spiral)),
    Row("one triangle again and again", repeated((TRIANGLE, "f 1 2 3\n"), 300_000)),
    Row("a file of comments", text(a__obj="# nothing\n" * 10_000), code=3,
        says=("a.obj: no geometry",)),  # fmt: skip
    Row("a face that names a vertex that is not there", text(a__obj=TRIANGLE + "f 1 2 9001\n"),
        code=3, says=("a.obj:4: face refers to vertex 9001 of 3",)),  # fmt: skip
    Row("a coordinate that is no number", text(a__obj="v 0 nan 0\n" + TRIANGLE + "f 1 2 3\n"),
        code=3, says=("a.obj:1: vertex coordinate 'nan'",)),  # fmt: skip
    Row("a material library that is a device", text(a__obj="mtllib /dev/zero\n" + QUAD),
        says=("/dev/zero: can't be read",)),  # fmt: skip
]
