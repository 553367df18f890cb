#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Writes cornell_box.obj and .mtl from the measurements that Cornell published [1].

The published camera stands at (278, 273, -800), looks along +z and sees +x on the left. Here the
box is turned by 180 degrees about the camera's vertical, x' = 278 - x and z' = -z, so that its open
side faces +z: the camera is (0, 273, 800) and looks along -z. A turn mirrors nothing.

The published lamp lies in the plane of the ceiling. Here the ceiling has an opening of the lamp's
size: nothing coincides, and no light is caught above the lamp.

[1] Cornell University Program of Computer Graphics, "Cornell Box Data".

usage: make_cornell_box.py [FOLDER]    (the folder of this script)
"""
import pathlib
import sys

LAMP = [(343.0, 548.8, 227.0), (343.0, 548.8, 332.0), (213.0, 548.8, 332.0), (213.0, 548.8, 227.0)]
CEILING = [(556.0, 548.8, 0.0), (556.0, 548.8, 559.2), (0.0, 548.8, 559.2), (0.0, 548.8, 0.0)]
FLOOR = [(552.8, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 559.2), (549.6, 0.0, 559.2)]
BACK_WALL = [(549.6, 0.0, 559.2), (0.0, 0.0, 559.2), (0.0, 548.8, 559.2), (556.0, 548.8, 559.2)]
GREEN_WALL = [(0.0, 0.0, 559.2), (0.0, 0.0, 0.0), (0.0, 548.8, 0.0), (0.0, 548.8, 559.2)]
RED_WALL = [(552.8, 0.0, 0.0), (549.6, 0.0, 559.2), (556.0, 548.8, 559.2), (556.0, 548.8, 0.0)]
SHORT_BLOCK = (165.0, [(130.0, 65.0), (82.0, 225.0), (240.0, 272.0), (290.0, 114.0)])
TALL_BLOCK = (330.0, [(423.0, 247.0), (265.0, 296.0), (314.0, 456.0), (472.0, 406.0)])

MTL = """\
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
# Linear Rec.709 approximations of the measured spectra; Ke in W m^-2 sr^-1 per channel.
newmtl white
illum 1
Kd 0.725 0.71 0.68
newmtl red
illum 1
Kd 0.63 0.065 0.05
newmtl green
illum 1
Kd 0.14 0.45 0.091
newmtl lamp
illum 1
Kd 0.78 0.78 0.78
Ke 17 12 4
"""


def frame(outer, inner):
    """The four quads between two rectangles given in the same order, wound as the outer one."""
    return [(outer[i], outer[(i + 1) % 4], inner[(i + 1) % 4], inner[i]) for i in range(4)]


def block(height, top):
    """Top and four sides of a block on the floor, wound so that the normals point out."""
    faces = [[(x, height, z) for x, z in top]]
    for i in range(4):
        (x0, z0), (x1, z1) = top[i], top[(i + 1) % 4]
        faces.append([(x0, 0.0, z0), (x1, 0.0, z1), (x1, height, z1), (x0, height, z0)])
    return faces


GROUPS = [
    ("lamp", "lamp", [LAMP]),
    ("ceiling", "white", frame(CEILING, LAMP)),
    ("floor", "white", [FLOOR]),
    ("back_wall", "white", [BACK_WALL]),
    ("green_wall", "green", [GREEN_WALL]),
    ("red_wall", "red", [RED_WALL]),
    ("short_block", "white", block(*SHORT_BLOCK)),
    ("tall_block", "white", block(*TALL_BLOCK)),
]


def obj_lines():
    """The OBJ file's lines; a position that several faces share is written once."""
    yield "# SPDX-License-Identifier: Apache-2.0"
    yield "# SPDX-FileCopyrightText: The pm authors"
    yield "# The Cornell box in millimetres, made by make_cornell_box.py from the published data."
    yield "mtllib cornell_box.mtl"
    index = {}
    for group, material, faces in GROUPS:
        new = [p for face in faces for p in face if p not in index]
        for p in dict.fromkeys(new):
            index[p] = len(index) + 1
            yield f"v {278.0 - p[0]:.6g} {p[1]:.6g} {0.0 - p[2]:.6g}"
        yield f"g {group}"
        yield f"usemtl {material}"
        for face in faces:
            yield "f " + " ".join(str(index[p]) for p in face)


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__ + "/..").resolve()
    (folder / "cornell_box.obj").write_text("\n".join(obj_lines()) + "\n", encoding="ascii")
    (folder / "cornell_box.mtl").write_text(MTL, encoding="ascii")


if __name__ == "__main__":
    main()
