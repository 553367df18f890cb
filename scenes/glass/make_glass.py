#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Writes glass.obj, .mtl and .pm.json: a glass of water, blocks that absorb, and balls: clear, frosted, a bubble.

usage: make_glass.py [FOLDER]    (the folder of this script)
"""
import json
import math
import pathlib
import sys

HEAD = "# SPDX-License-Identifier: Apache-2.0\n# SPDX-FileCopyrightText: The pm authors\n"
SEGMENTS = 48
# Radius and height, from the middle of the bottom outside over the rim to the middle inside.
INSIDE = ((0.505, 1.15), (0.49, 0.85), (0.44, 0.12), (0.4, 0.08), (0.0, 0.08))
OUTSIDE = ((0.0, 0.002), (0.44, 0.002), (0.48, 0.04), (0.545, 1.15), (0.525, 1.165))
# Touches the glass inside, up to .85.
WATER = ((0.0, 0.08), (0.4, 0.08), (0.44, 0.12), (0.49, 0.85), (0.0, 0.85))
MTL = HEAD + """\
# Linear Rec.709; Ke in W m^-2 sr^-1 per channel. What absorbs is said in glass.pm.json.
newmtl floor
illum 1
Kd 0.62 0.6 0.56
newmtl wall
illum 1
Kd 0.5 0.55 0.6
newmtl lamp
illum 1
Kd 0 0 0
Ke 30 28 25
newmtl glass
illum 7
Tf 1 1 1
Ni 1.5
newmtl water
illum 7
Tf 1 1 1
Ni 1.33
newmtl bottle
illum 7
Tf 1 1 1
Ni 1.5
newmtl frosted
illum 7
Tf 1 1 1
Ni 1.5
Pr 0.3
newmtl bubble
illum 7
Tf 1 1 1
Ni 1.33
"""


class Mesh:
    def __init__(self):
        self.text = HEAD + "mtllib glass.mtl\n"
        self.count = 0

    def group(self, name, material):
        self.text += f"g {name}\nusemtl {material}\n"

    def vertex(self, x, y, z):
        self.text += f"v {x:.6g} {y:.6g} {z:.6g}\n"
        self.count += 1
        return self.count

    def face(self, *corners):
        self.text += "f " + " ".join(str(c) for c in corners) + "\n"

    def quad(self, *places):
        self.face(*[self.vertex(*p) for p in places])

    def box(self, lo, hi):
        at = {}
        for i in range(8):
            at[i] = self.vertex(*[(hi if i >> axis & 1 else lo)[axis] for axis in range(3)])
        for a, b, c, d in ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)):
            self.face(at[a], at[b], at[c], at[d])

    def lathe(self, profile, x, z):
        """Turned about the upright axis through x and z; fronts are outside of a profile that goes up outside."""
        rings = []
        for radius, height in profile:
            if radius == 0:
                rings.append([self.vertex(x, height, z)] * SEGMENTS)
                continue
            turns = [2 * math.pi * i / SEGMENTS for i in range(SEGMENTS)]
            rings.append(
                [self.vertex(x + radius * math.sin(t), height, z + radius * math.cos(t)) for t in turns]
            )
        for low, high in zip(rings, rings[1:]):
            for i in range(SEGMENTS):
                j = (i + 1) % SEGMENTS
                corners = [low[i], low[j], high[j], high[i]]
                self.face(*dict.fromkeys(corners))


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent)
    mesh = Mesh()
    mesh.group("floor", "floor")
    mesh.quad((-5, 0, 6), (5, 0, 6), (5, 0, -3), (-5, 0, -3))
    mesh.group("back_wall", "wall")
    mesh.quad((-5, 0, -3), (5, 0, -3), (5, 5, -3), (-5, 5, -3))
    mesh.group("lamp", "lamp")
    mesh.quad((-3.2, 4.5, -0.6), (-2, 4.5, -0.6), (-2, 4.5, 0.6), (-3.2, 4.5, 0.6))
    mesh.group("tumbler", "glass")
    mesh.lathe(OUTSIDE + INSIDE, -0.9, 0.3)
    mesh.group("drink", "water")
    mesh.lathe(WATER, -0.9, 0.3)
    mesh.group("blocks", "bottle")
    for size, x in ((0.25, 0.35), (0.45, 0.95), (0.75, 1.85)):
        mesh.box((x - size / 2, 0.001, -0.6 - size / 2), (x + size / 2, 0.001 + size, -0.6 + size / 2))
    sidecar = {
        "schema": "pm-sidecar/1",
        "materials": {
            "water": {"attenuationColour": [0.35, 0.75, 0.9], "attenuationDistance": 1.5},
            "bottle": {"attenuationColour": [0.12, 0.6, 0.25], "attenuationDistance": 0.5},
            "bubble": {"thinWalled": 1},
        },
        "spheres": [
            {"name": "clear", "centre": [0.1, 0.36, 1.1], "radius": 0.35, "material": "glass"},
            {"name": "frosted", "centre": [1.0, 0.36, 0.9], "radius": 0.35, "material": "frosted"},
            {"name": "bubble", "centre": [1.75, 0.42, 0.7], "radius": 0.35, "material": "bubble"},
        ],
        "cameras": [{"name": "front", "position": [0.3, 2.0, 5.6], "lookAt": [0.35, 0.42, 0], "fieldOfView": 32}],
    }
    (folder / "glass.obj").write_text(mesh.text, encoding="ascii")
    (folder / "glass.mtl").write_text(MTL, encoding="ascii")
    (folder / "glass.pm.json").write_text(json.dumps(sidecar, indent=1) + "\n", encoding="ascii")


if __name__ == "__main__":
    main()
