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

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import open_box

SIDE = 32  # quads along an edge of the cube; even, so that a vertex is the lowest point
DECIMALS = 6  # at most
HALF_LAMP = 0.15  # half the side of the square lamp, scene units
SPHERES = [  # name, centre, radius; both hang 0.01 above the floor
    ("mirror", (-0.45, 0.41, -0.35), 0.40),
    ("glass", (0.42, 0.41, 0.25), 0.40),
]

MTL = open_box.materials(lamp=100) + """\
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


def obj_lines():
    yield "# SPDX-License-Identifier: Apache-2.0"
    yield "# SPDX-FileCopyrightText: The pm authors"
    yield "# A glass and a mirror sphere in a box, made by make_caustic_glass.py."
    yield "mtllib caustic_glass.mtl"
    yield from open_box.obj_lines(HALF_LAMP, DECIMALS)
    count = open_box.vertex_count(HALF_LAMP)
    quads = list(sphere_quads())
    grid = list(dict.fromkeys(p for quad in quads for p in quad))
    normals = [on_unit_sphere(p) for p in grid]
    normal_index = {p: i + 1 for i, p in enumerate(grid)}  # both spheres share the normals
    for n in normals:
        yield f"vn {open_box.numbers(n, DECIMALS)}"
    for name, centre, radius in SPHERES:
        for n in normals:
            yield "v " + open_box.numbers((c + radius * d for c, d in zip(centre, n)), DECIMALS)
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
