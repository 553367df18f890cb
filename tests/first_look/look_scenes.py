# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Scenes of the kinds that people show pm first: each a function that writes its files into a folder."""
import math

from plain_png import write_png


class Obj:
    """Gathers positions, faces and materials; write() makes NAME.obj and NAME.mtl."""

    def __init__(self):
        self.lines, self.count, self.uv = [], 0, 0

    def use(self, material):
        self.lines.append(f"usemtl {material}")

    def face(self, *corners, uv=None):
        self.lines += ["v {:.9g} {:.9g} {:.9g}".format(*c) for c in corners]
        self.lines += ["vt {:g} {:g}".format(*t) for t in uv or ()]
        words = [f"{self.count + i + 1}" + (f"/{self.uv + i + 1}" if uv else "") for i in range(len(corners))]
        self.count += len(corners)
        self.uv += len(uv or ())
        self.lines.append("f " + " ".join(words))

    def box(self, a, b, inward=False):
        (x0, y0, z0), (x1, y1, z1) = a, b
        for side in (
            ((x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0)),
            ((x1, y0, z1), (x1, y0, z0), (x1, y1, z0), (x1, y1, z1)),
            ((x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)),
            ((x0, y1, z1), (x1, y1, z1), (x1, y1, z0), (x0, y1, z0)),
            ((x1, y0, z0), (x0, y0, z0), (x0, y1, z0), (x1, y1, z0)),
            ((x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)),
        ):
            self.face(*(reversed(side) if inward else side))

    def ground(self, half, y=0.0, tiles=1):
        self.face((-half, y, half), (half, y, half), (half, y, -half), (-half, y, -half),
                  uv=((0, 0), (tiles, 0), (tiles, tiles), (0, tiles)))  # fmt: skip

    def faces_down(self, x, y, z, half):
        self.face((x - half, y, z - half), (x + half, y, z - half), (x + half, y, z + half), (x - half, y, z + half))

    def faces_up(self, x, y, z, half):
        self.face((x - half, y, z + half), (x + half, y, z + half), (x + half, y, z - half), (x - half, y, z - half))

    def ball(self, centre, radius, rows=24):
        """With the normals of a sphere."""
        around, first = 2 * rows, self.count
        for row in range(rows + 1):
            polar = math.pi * row / rows
            for i in range(around):
                turn = 2 * math.pi * i / around
                n = (math.sin(polar) * math.sin(turn), math.cos(polar), math.sin(polar) * math.cos(turn))
                self.lines.append("v {:.9g} {:.9g} {:.9g}".format(*(c + radius * d for c, d in zip(centre, n))))
                self.lines.append("vn {:.9g} {:.9g} {:.9g}".format(*n))
        back = -(rows + 1) * around
        for row in range(rows):
            for i in range(around):
                a, b = row * around + i, row * around + (i + 1) % around
                corners = (a, a + around, b + around, b)
                self.lines.append("f " + " ".join(f"{first + c + 1}//{back + c}" for c in corners))
        self.count += (rows + 1) * around

    def write(self, folder, name, mtl):
        (folder / f"{name}.mtl").write_text(mtl, encoding="ascii")
        (folder / f"{name}.obj").write_text("\n".join([f"mtllib {name}.mtl", *self.lines, ""]), encoding="ascii")


WALLS = "newmtl wall\nKd .7 .7 .7\nnewmtl red\nKd .6 .1 .08\nnewmtl blue\nKd .1 .2 .6\nnewmtl light\nKd 0 0 0\nKe 10 10 10\n"


def yard(folder):
    """Houses on a ground of tiles, and no light."""

    def tile(x, y):
        return (150, 140, 110) if (x // 16 + y // 16) % 2 else (90, 120, 70)

    write_png(folder / "tiles.png", 32, 32, tile)
    scene = Obj()
    scene.use("ground")
    scene.ground(20, tiles=8)
    for x, z, high, material in ((-7, -4, 5, "wall"), (3, -8, 9, "red"), (8, 3, 4, "blue"), (-3, 6, 3, "wall")):
        scene.use(material)
        scene.box((x - 2, 0, z - 2), (x + 2, high, z + 2))
    scene.write(folder, "yard", WALLS + "newmtl ground\nKd 1 1 1\nmap_Kd tiles.png\n")


def closed_room(scene):
    scene.use("wall")
    scene.box((-3, 0, -4), (3, 2.6, 4), inward=True)
    scene.use("red")
    scene.box((-2, 0, -3), (-1, 1.4, -2))
    scene.use("blue")
    scene.box((0.5, 0, -1), (2, 0.7, 0.5))


def room(folder):
    """A room and a light below its ceiling."""
    scene = Obj()
    closed_room(scene)
    scene.use("light")
    scene.faces_down(0, 2.58, 0, 0.5)
    scene.write(folder, "room", WALLS)


def cellar(folder):
    """The same room, dark."""
    scene = Obj()
    closed_room(scene)
    scene.write(folder, "cellar", WALLS)


def missed(folder):
    """Blocks on a ground, and a light that shines upwards, away from them."""
    scene = Obj()
    scene.use("wall")
    scene.ground(4)
    scene.use("red")
    scene.box((-1.5, 0, -1), (-0.2, 1.5, 0.3))
    scene.use("blue")
    scene.box((0.4, 0, 0), (1.6, 0.8, 1.2))
    scene.use("light")
    scene.faces_up(0, 3, 0, 0.5)
    scene.write(folder, "missed", WALLS)


def shelf(folder):
    """A shelf of two boards and a back, open to -z, with blocks on it."""
    scene = Obj()
    scene.use("wall")
    scene.box((-25, -5.05, -12.5), (25, -4.95, 12.5))
    scene.box((-25, 4.95, -12.5), (25, 5.05, 12.5))
    scene.box((-25, -5, 12.45), (25, 5, 12.55))
    for i, x in enumerate((-18, -6, 6, 18)):
        scene.use("red" if i % 2 else "blue")
        scene.box((x - 2, -4.9, -2), (x + 2, -0.9, 2))
    scene.write(folder, "shelf", WALLS)


def leaf(folder):
    """A dark round leaf whose picture is white and transparent around it."""

    def texel(x, y):
        r = math.hypot(x - 31.5, (y - 31.5) * 1.6) / 24
        return (30, 60, 20, 255) if r < 1 else (255, 255, 255, 0)

    write_png(folder / "leaf.png", 64, 64, texel)
    scene = Obj()
    scene.use("leaf")
    scene.face((-1, 0, 0), (1, 0, 0), (1, 2, 0), (-1, 2, 0), uv=((0, 0), (1, 0), (1, 1), (0, 1)))
    scene.write(folder, "leaf", "newmtl leaf\nKd 1 1 1\nmap_Kd leaf.png\n")


def glass(folder):
    """A ball of glass on a table below a small, very bright light that is in the picture."""
    scene = Obj()
    scene.use("wall")
    scene.ground(3)
    scene.face((-3, 0, -3), (3, 0, -3), (3, 4, -3), (-3, 4, -3))
    scene.use("glass")
    scene.ball((0, 1, 0), 1)
    scene.use("bright")
    scene.faces_down(1.5, 3.5, -1.5, 0.15)
    scene.write(folder, "glass", WALLS + "newmtl glass\nKd 0 0 0\nKs 1 1 1\nNi 1.5\nillum 7\nTf 1 1 1\n"
                "newmtl bright\nKd 0 0 0\nKe 2000 1900 1700\n")  # fmt: skip


def tiny(folder):
    """Two balls of a thousandth of a unit, far from the origin."""
    scene = Obj()
    scene.use("red")
    scene.ball((1, 2, 3), 0.5e-3)
    scene.use("wall")
    scene.ball((1.0009, 1.9998, 3), 0.3e-3)
    scene.write(folder, "tiny", WALLS)


def giant(folder):
    """Hills of 1e5 units."""
    scene, steps, size = Obj(), 32, 1e5

    def at(i, j):
        x, z = i / steps - 0.5, j / steps - 0.5
        return (size * x, size * 0.08 * math.sin(9 * x) * math.cos(7 * z + 1), size * z)

    scene.use("wall")
    for i in range(steps):
        for j in range(steps):
            scene.face(at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j))
    scene.write(folder, "giant", WALLS)


def black(folder):
    """A ball and a block that reflect nothing."""
    scene = Obj()
    scene.use("black")
    scene.ball((0, 1, 0), 1)
    scene.box((1.2, 0, -0.5), (2.2, 1, 0.5))
    scene.write(folder, "black", "newmtl black\nKd 0 0 0\n")


MADE = (yard, room, cellar, missed, shelf, leaf, glass, tiny, giant, black)
