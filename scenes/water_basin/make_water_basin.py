#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Writes water_basin.obj and .mtl: a box that is filled with rippled water to less than half, under a tiny lamp.

The ripples are rings around points outside of the box. The surface is a grid of SIDE x SIDE quads with
the exact normals; below it the water is a block that reaches a little into floor and walls, so that
nothing lies between those and the water.

usage: make_water_basin.py [FOLDER]    (the folder of this script)
"""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import open_box

SIDE = 80  # quads along an edge of the water's surface
DECIMALS = 5  # at most
HALF_LAMP = 0.02  # half the side of the square lamp, scene units
LEVEL = 0.8  # of the water
LOW, HIGH = (-1.02, -0.02, -1.02), (1.02, LEVEL, 0.98)  # the block of water; its front is to be seen
RINGS = [  # x and z of the middle, radians a unit, greatest slope, phase
    (-3.1, -0.7, 13.0, 0.15, 0.3),
    (2.2, -2.6, 17.0, 0.14, 2.9),
    (0.9, 3.4, 21.0, 0.13, 1.7),
    (-2.0, 2.3, 26.0, 0.12, 4.4),
    (2.7, 1.2, 31.0, 0.1, 5.6),
]

MTL = open_box.materials(lamp=3000) + """\
newmtl water
illum 7
Kd 0 0 0
Ks 1 1 1
Tf 1 1 1
Ni 1.33
"""


def ripple(x, z):
    """Height of the water and its unit normal."""
    y, slope_x, slope_z = LEVEL, 0.0, 0.0
    for middle_x, middle_z, k, slope, phase in RINGS:
        dx, dz = x - middle_x, z - middle_z
        way = math.sqrt(dx * dx + dz * dz)
        y += slope / k * math.sin(k * way + phase)
        rise = slope * math.cos(k * way + phase) / way
        slope_x, slope_z = slope_x + rise * dx, slope_z + rise * dz
    length = math.sqrt(slope_x * slope_x + 1 + slope_z * slope_z)
    return y, (-slope_x / length, 1 / length, -slope_z / length)


def grid_place(i, j):
    step = [(high - low) / SIDE for low, high in zip(LOW, HIGH)]
    return LOW[0] + step[0] * i, LOW[2] + step[2] * j


def water_sides(first):
    """The faces below the surface, outwards; first: the vertex of the surface's grid place (0, 0)."""
    at = lambda i, j: first + j * (SIDE + 1) + i
    low = first + (SIDE + 1) ** 2  # of the bottom, in the order of `bottom_corners`
    steps = range(SIDE + 1)
    yield [low, low + 1, low + 2, low + 3]
    rims = [
        (low + 3, low + 2, [at(i, SIDE) for i in reversed(steps)]),
        (low + 1, low, [at(i, 0) for i in steps]),
        (low + 2, low + 1, [at(SIDE, j) for j in steps]),
        (low, low + 3, [at(0, j) for j in reversed(steps)]),
    ]
    half = SIDE // 2
    for begin, end, rim in rims:
        for i in range(half):
            yield [end, rim[i], rim[i + 1]]
        yield [begin, end, rim[half]]
        for i in range(half, SIDE):
            yield [begin, rim[i], rim[i + 1]]


def bottom_corners():
    return [(x, LOW[1], z) for x, z in ((LOW[0], LOW[2]), (HIGH[0], LOW[2]), (HIGH[0], HIGH[2]), (LOW[0], HIGH[2]))]


def obj_lines():
    yield "# SPDX-License-Identifier: Apache-2.0"
    yield "# SPDX-FileCopyrightText: The pm authors"
    yield "# Rippled water in a box, made by make_water_basin.py."
    yield "mtllib water_basin.mtl"
    yield from open_box.obj_lines(HALF_LAMP, DECIMALS)
    places = [grid_place(i, j) for j in range(SIDE + 1) for i in range(SIDE + 1)]
    for x, z in places:
        y, normal = ripple(x, z)
        yield f"v {open_box.numbers((x, y, z), DECIMALS)}"
        yield f"vn {open_box.numbers(normal, DECIMALS)}"
    for corner in bottom_corners():
        yield f"v {open_box.numbers(corner, DECIMALS)}"
    yield "g water"
    yield "usemtl water"
    first = open_box.vertex_count(HALF_LAMP) + 1
    for j in range(SIDE):
        for i in range(SIDE):
            n = [j * (SIDE + 1) + i, (j + 1) * (SIDE + 1) + i]
            corners = [n[0], n[1], n[1] + 1, n[0] + 1]
            yield "f " + " ".join(f"{first + c}//{1 + c}" for c in corners)
    for face in water_sides(first):
        yield "f " + " ".join(map(str, face))


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__ + "/..").resolve()
    (folder / "water_basin.obj").write_text("\n".join(obj_lines()) + "\n", encoding="ascii")
    (folder / "water_basin.mtl").write_text(MTL, encoding="ascii")


if __name__ == "__main__":
    main()
