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


def band(shapes):
    """make() of a text for each i below a number that is a tenth where the suite runs it."""

    def make(folder, is_full):
        head, count, each, tail = shapes
        n = count if is_full else count // 10
        write(folder, head + "".join(each(i) for i in range(n)) + tail)

    return make


def copies_of_a_sphere(material):
    """A ball of 800 triangles, 300 times."""

    def make(folder, is_full):
        rings, around = 20, 20
        vertices = [(math.sin(math.pi * j / rings) * math.cos(math.tau * i / around),
                     math.cos(math.pi * j / rings),
                     math.sin(math.pi * j / rings) * math.sin(math.tau * i / around))
                    for j in range(rings + 1) for i in range(around)]  # fmt: skip
        at = lambda j, i: j * around + i % around + 1
        faces = "".join(f"f {at(j, i)} {at(j, i + 1)} {at(j + 1, i + 1)}\n"
                        f"f {at(j, i)} {at(j + 1, i + 1)} {at(j + 1, i)}\n"
                        for j in range(rings) for i in range(around))  # fmt: skip
        (folder / "a.mtl").write_text("newmtl m\n" + material)
        write(folder, "mtllib a.mtl\nusemtl m\n" + points("v", vertices)
              + faces * (375 if is_full else 40))  # fmt: skip

    return make


TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"

ROWS = [
    Row("a face like a comb", polygon(comb)),
    Row("a face like a star", polygon(star)),
    Row("a face like a spiral", polygon(spiral)),
    Row("one triangle again and again", repeated((TRIANGLE, "f 1 2 3\n"), 300_000)),
    Row("a ball again and again", copies_of_a_sphere("Kd 1 1 1\n"), says=("are copies of others",)),
    Row("a ball of glass again and again", copies_of_a_sphere("illum 4\nNi 1.5\nTf 1 1 1\n"),
        says=("are copies of others",)),  # fmt: skip
    Row("a lamp again and again",
        copies_of_a_sphere("Ke 1 1 1\n"), says=("are copies of others",)),  # fmt: skip
    Row("thousands of groups with tags", band((
        "", 20_000, lambda i: f"g g{i}\nv {2 * i} 0 0\nv {2 * i + 1} 0 0\nv {2 * i + 1} 1 0\n"
        f"v {2 * i} 1 0\nf -4 -3 -2 -1\nt interpolateboundary 1/0/0 1\n", ""))),  # fmt: skip
    Row("thousands of holes", band((
        points("v", [(i % 101, i // 101, 0) for i in range(101 * 101)])
        + "".join(f"f {k} {k + 1} {k + 102} {k + 101}\n" for j in range(100)
                  for k in range(j * 101 + 1, j * 101 + 101)),
        9_000, lambda i: f"t hole 1/0/0 {i}\n", ""))),  # fmt: skip
    Row("a million empty groups", band(("", 1_000_000, lambda i: f"g g{i}\n",
                                        TRIANGLE + "f 1 2 3\n"))),  # fmt: skip
    Row("a million usemtl", band((TRIANGLE, 1_000_000, lambda i: f"usemtl m{i % 7}\n",
                                  "f 1 2 3\n"))),  # fmt: skip
    Row("100,000 materials that are not there", band((
        TRIANGLE, 100_000, lambda i: f"usemtl m{i}\nf 1 2 3\n", "")),
        says=("in no library", "more")),  # fmt: skip
    Row("thousands of material libraries that are not there", band((
        "", 20_000, lambda i: f"mtllib none{i}.mtl\n", QUAD)),
        says=("material library missing",)),  # fmt: skip
    Row("a million triangles without area", band((TRIANGLE, 1_000_000, lambda i: "f 1 1 2\n",
                                                  "f 1 2 3\n")),
        says=("triangles without area were left out",)),  # fmt: skip
    Row("a fan round one corner", band((
        "v 0 0 0\n" , 200_000,
        lambda i: f"v {math.cos(i * 1e-5):.9g} {math.sin(i * 1e-5):.9g} 0\nf 1 {i + 2} {i + 3}\n",
        "v 0 1 0\n"))),  # fmt: skip
    Row("a line of ten million bytes", band((TRIANGLE + "g ", 10_000_000, lambda i: "x",
                                            "\nf 1 2 3\n"))),  # fmt: skip
    Row("zero bytes", text(a__obj="\0" * 1000 + "\n" + TRIANGLE + "f 1 2 3\n\0\0"),
        says=("statements that are not understood",)),  # fmt: skip
    Row("an index that no number holds", text(a__obj=TRIANGLE + "f 1 2 99999999999999999999\n"),
        code=3, says=("a.obj:4:",)),  # fmt: skip
    Row("coordinates of 1e38", text(a__obj="v 1e38 0 0\nv 0 1e38 0\nv 0 0 1e38\nf 1 2 3\n"),
        code=3, says=("a.obj:1: vertex coordinate '1e38'",)),  # fmt: skip
    Row("a file of comments", text(a__obj="# nothing\n" * 10_000), code=3,
        says=("a.obj: no geometry",)),  # fmt: skip
    Row("a face that names a vertex that is not there", text(a__obj=TRIANGLE + "f 1 2 9001\n"),
        code=3, says=("a.obj:4: face refers to vertex 9001 of 3",)),  # fmt: skip
    Row("a coordinate that is no number", text(a__obj="v 0 nan 0\n" + TRIANGLE + "f 1 2 3\n"),
        code=3, says=("a.obj:1: vertex coordinate 'nan'",)),  # fmt: skip
    Row("a material library that is a device", text(a__obj="mtllib /dev/zero\n" + QUAD),
        says=("/dev/zero: can't be read",)),  # fmt: skip
]
