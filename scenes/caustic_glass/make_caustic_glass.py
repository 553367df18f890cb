#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Writes caustic_glass.obj and .mtl: a glass and a mirror sphere in an open box under a small lamp.

The spheres are cubes of SIDE x SIDE quads a face, blown up to the sphere with equal angles, so the
quads are of nearly one size and there is no pole. Vertices lie on the sphere, normals are the exact
ones.

usage: make_caustic_glass.py [FOLDER]    (the folder of this script)
"""
import math
import pathlib
import sys

SIDE = 32  # quads along an edge of the cube; even, so that a vertex is the lowest point
HALF_LAMP = 0.15  # half the side of the square lamp, scene units
SPHERES = [  # name, centre, radius; both hang 0.01 above the floor
    ("mirror", (-0.45, 0.41, -0.35), 0.40),
    ("glass", (0.42, 0.41, 0.25), 0.40),
]

MTL = """\
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
# Linear Rec.709; Ke in W m^-2 sr^-1 per channel.
newmtl white
illum 1
Kd 0.7 0.7 0.7
newmtl red
illum 1
Kd 0.63 0.065 0.05
newmtl green
illum 1
Kd 0.14 0.45 0.091
newmtl lamp
illum 1
Kd 0 0 0
Ke 100 100 100
newmtl mirror
illum 3
Kd 0 0 0
Ks 1 1 1
newmtl glass
illum 7
Kd 0 0 0
Ks 1 1 1
Tf 1 1 1
Ni 1.5
"""


def box_groups():
    """Group, material and quads of the box and its lamp; normals point into the box."""
    top = [(-1, 2, 1), (-1, 2, -1), (1, 2, -1), (1, 2, 1)]
    h = HALF_LAMP
    lamp = [(-h, 2, h), (-h, 2, -h), (h, 2, -h), (h, 2, h)]
    frame = [(top[i], top[(i + 1) % 4], lamp[(i + 1) % 4], lamp[i]) for i in range(4)]
    return [
        ("lamp", "lamp", [lamp]),
        ("ceiling", "white", frame),
        ("floor", "white", [[(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]]),
        ("back_wall", "white", [[(-1, 0, -1), (1, 0, -1), (1, 2, -1), (-1, 2, -1)]]),
        ("red_wall", "red", [[(-1, 0, 1), (-1, 0, -1), (-1, 2, -1), (-1, 2, 1)]]),
        ("green_wall", "green", [[(1, 0, -1), (1, 0, 1), (1, 2, 1), (1, 2, -1)]]),
    ]


def sphere_quads():
    """The quads of a unit sphere as corners on the integer grid [-SIDE/2, SIDE/2]^3."""
    half = SIDE // 2
    for axis in range(3):
        for sign in (-half, half):
            for i in range(-half, half):
                for j in range(-half, half):
                    corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                    if sign < 0:
                        corners.reverse()
                    yield [cube_point(axis, sign, *corner) for corner in corners]


def cube_point(axis, sign, i, j):
    point = [0, 0, 0]
    point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3] = sign, i, j
    return tuple(point)


def on_unit_sphere(point):
    """Where a point of the cube's grid comes to lie; equal steps become equal angles."""
    p = [math.tan(math.pi / 4 * 2 * c / SIDE) for c in point]
    length = math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])
    return [c / length for c in p]


def number(x):
    """Six decimals at most, without trailing zeros and without a negative zero."""
    text = f"{x:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def numbers(xs):
    return " ".join(number(x) for x in xs)


def obj_lines():
    yield "# SPDX-License-Identifier: Apache-2.0"
    yield "# SPDX-FileCopyrightText: The pm authors"
    yield "# A glass and a mirror sphere in a box, made by make_caustic_glass.py."
    yield "mtllib caustic_glass.mtl"
    count = 0
    index = {}
    for group, material, faces in box_groups():
        for p in dict.fromkeys(p for face in faces for p in face if p not in index):
            count += 1
            index[p] = count
            yield f"v {numbers(p)}"
        yield f"g {group}"
        yield f"usemtl {material}"
        for face in faces:
            yield "f " + " ".join(str(index[p]) for p in face)
    quads = list(sphere_quads())
    grid = list(dict.fromkeys(p for quad in quads for p in quad))
    normals = [on_unit_sphere(p) for p in grid]
    normal_index = {p: i + 1 for i, p in enumerate(grid)}  # both spheres share the normals
    for n in normals:
        yield f"vn {numbers(n)}"
    for name, centre, radius in SPHERES:
        for n in normals:
            yield "v " + numbers(c + radius * d for c, d in zip(centre, n))
        yield f"g {name}"
        yield f"usemtl {name}"
        for quad in quads:
            yield "f " + " ".join(f"{count + normal_index[p]}//{normal_index[p]}" for p in quad)
        count += len(grid)


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__ + "/..").resolve()
    (folder / "caustic_glass.obj").write_text("\n".join(obj_lines()) + "\n", encoding="ascii")
    (folder / "caustic_glass.mtl").write_text(MTL, encoding="ascii")


if __name__ == "__main__":
    main()
