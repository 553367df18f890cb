#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""scenes/: each file is what its script makes, lamps face down, meshes are sound and well wound."""
import math
import pathlib
import re
import runpy
import subprocess
import sys
import tempfile
import unittest

BOXES = ("cornell_box", "caustic_glass", "water_basin")
SCENES = pathlib.Path(__file__).resolve().parents[2] / "scenes"


class Obj:
    """Positions, normals and faces by group of an OBJ file of ours; indices from 0."""

    def __init__(self, path):
        self.positions, self.normals, self.groups, self.materials = [], [], {}, {}
        group = material = None
        for line in path.read_text(encoding="ascii").splitlines():
            key, *words = line.split() or ["#"]
            if key == "v":
                self.positions.append(tuple(map(float, words)))
            elif key == "vn":
                self.normals.append(tuple(map(float, words)))
            elif key == "g":
                group = words[0]
            elif key == "usemtl":
                material = words[0]
            elif key == "f":
                corners = [[int(i) - 1 if i else None for i in w.split("/")] for w in words]
                self.groups.setdefault(group, []).append(corners)
                self.materials[group] = material

    def corners(self, group):
        return [[self.positions[c[0]] for c in face] for face in self.groups[group]]

    def all_edges(self, group):
        """How often each directed edge occurs in a group."""
        count = {}
        for face in self.groups[group]:
            for a, b in zip(face, face[1:] + face[:1]):
                count[a[0], b[0]] = count.get((a[0], b[0]), 0) + 1
        return count


def area_vector(corners):
    """Newell's normal of a polygon; its length is the area."""
    total = [0.0, 0.0, 0.0]
    for a, b in zip(corners, corners[1:] + corners[:1]):
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            total[k] += 0.5 * (a[i] * b[j] - a[j] * b[i])
    return total


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def centre(corners):
    return [sum(p[k] for p in corners) / len(corners) for k in range(3)]


def direct_light(polygon, point, normal):
    """Irradiance of a polygon of unit radiance at a point that sees all of it (Lambert 1760)."""
    corners = [[a - b for a, b in zip(p, point)] for p in polygon]
    directions = [[c / math.sqrt(dot(v, v)) for c in v] for v in corners]
    total = 0.0
    for a, b in zip(directions, directions[1:] + directions[:1]):
        edge = [a[i] * b[j] - a[j] * b[i] for i, j in ((1, 2), (2, 0), (0, 1))]
        total += math.acos(dot(a, b)) * dot(edge, normal) / math.sqrt(dot(edge, edge))
    return abs(total) / 2


def sphere_flux(lamp, middle, radius, steps=40):
    """Flux of a rectangle of unit radiance onto a sphere in its hemisphere, midpoint rule."""
    (a, b, _, d), total = lamp, 0.0
    for i in range(steps):
        for j in range(steps):
            u, v = (i + 0.5) / steps, (j + 0.5) / steps
            p = [a[k] + u * (b[k] - a[k]) + v * (d[k] - a[k]) for k in range(3)]
            way = [m - x for m, x in zip(middle, p)]
            distance = math.sqrt(dot(way, way))
            total += math.pi * radius**2 * -way[1] / distance**3
    return total * math.sqrt(dot(area_vector(lamp), area_vector(lamp))) / steps**2


def load(name):
    return Obj(SCENES / name / f"{name}.obj")


class AllScenes(unittest.TestCase):
    def test_files_are_what_their_script_makes(self):
        scripts = sorted(SCENES.glob("*/make_*.py"))
        self.assertGreaterEqual(len(scripts), 2)
        for script in scripts:
            with tempfile.TemporaryDirectory() as folder:
                subprocess.run([sys.executable, "-B", str(script), folder], check=True)
                made = sorted(pathlib.Path(folder).iterdir())
                self.assertLessEqual({".mtl", ".obj"}, {p.suffix for p in made})
                for path in made:
                    ours = script.parent / path.name
                    self.assertEqual(ours.read_bytes(), path.read_bytes(), f"{ours}: run {script}")

    def test_each_scene_has_its_readme_and_materials(self):
        for folder in sorted(p for p in SCENES.iterdir() if p.is_dir()):
            self.assertTrue((folder / "README.md").is_file(), folder)
            for path in folder.glob("*.obj"):
                self.assertLess(path.stat().st_size, 1_500_000, path)
                library = re.search(r"^mtllib (.+)$", path.read_text(), re.MULTILINE).group(1)
                known = {line.split()[1] for line in (folder / library).read_text().splitlines()
                         if line.startswith("newmtl ")}  # fmt: skip
                self.assertLessEqual(set(Obj(path).materials.values()), known, path)

    def test_faces_of_the_box_look_into_it(self):
        for name in BOXES:
            obj = load(name)
            low = [min(p[k] for p in obj.positions) for k in range(3)]
            high = [max(p[k] for p in obj.positions) for k in range(3)]
            middle = [(a + b) / 2 for a, b in zip(low, high)]
            for group in ("lamp", "ceiling", "floor", "back_wall", "red_wall", "green_wall"):
                for face in obj.corners(group):
                    inward = [m - c for m, c in zip(middle, centre(face))]
                    self.assertGreater(dot(area_vector(face), inward), 0, f"{name} {group}")

    def test_box_is_closed_but_for_its_front(self):
        for name in BOXES:
            obj = load(name)
            edges = {}
            for group in ("lamp", "ceiling", "floor", "back_wall", "red_wall", "green_wall"):
                for edge, count in obj.all_edges(group).items():
                    edges[edge] = edges.get(edge, 0) + count
            self.assertEqual(set(edges.values()), {1}, name)
            front = max(p[2] for p in obj.positions)
            for a, b in edges:
                open_edge = (b, a) not in edges
                at_front = obj.positions[a][2] == obj.positions[b][2] == front
                self.assertEqual(open_edge, at_front, f"{name}: edge {a + 1} {b + 1}")

    def test_red_is_left_of_green_for_a_camera_in_front(self):
        for name in BOXES:
            obj = load(name)
            mean_x = {g: centre(sum(obj.corners(g), []))[0] for g in ("red_wall", "green_wall")}
            self.assertLess(mean_x["red_wall"], mean_x["green_wall"])


class CornellBox(unittest.TestCase):
    def test_lamp(self):
        (lamp,) = load("cornell_box").corners("lamp")
        self.assertEqual(area_vector(lamp), [0.0, -130.0 * 105.0, 0.0])  # mm^2, facing down
        self.assertEqual({p[1] for p in lamp}, {548.8})

    def test_expected_values_of_the_readme(self):
        (lamp,) = load("cornell_box").corners("lamp")
        ke, kd = (17, 12, 4), (0.725, 0.71, 0.68)
        wall = direct_light(lamp, (0, 400, -559.2), (0, 0, 1))
        floor = direct_light(lamp, (-100, 0, -50), (0, 1, 0))
        rows = [[math.pi * l * -area_vector(lamp)[1] for l in ke], ke]
        rows += [[e * l * r / math.pi for l, r in zip(ke, kd)] for e in (wall, floor)]
        readme = (SCENES / "cornell_box" / "README.md").read_text()
        for row in rows:
            self.assertIn("| " + " | ".join(f"{x:#.6g}".rstrip(".") if x > 1e3 else
                          f"{x:#.6g}" if x < 1 else str(x) for x in row) + " |", readme)  # fmt: skip

    def test_measurements(self):
        obj = load("cornell_box")
        tops = {g: max(p[1] for face in obj.corners(g) for p in face)
                for g in ("short_block", "tall_block")}  # fmt: skip
        self.assertEqual(tops, {"short_block": 165.0, "tall_block": 330.0})
        self.assertEqual(min(p[2] for p in obj.positions), -559.2)
        floor = area_vector(obj.corners("floor")[0])[1]
        self.assertAlmostEqual(floor, (552.8 + 549.6) / 2 * 559.2, places=6)
        # In the published pictures the tall block stands behind, left of the short one.
        tall, short = (centre(sum(obj.corners(g), [])) for g in ("tall_block", "short_block"))
        self.assertTrue(tall[0] < short[0] and tall[2] < short[2])

    def test_blocks_face_outwards(self):
        obj = load("cornell_box")
        for group in ("short_block", "tall_block"):
            middle = centre(sum(obj.corners(group), []))
            for face in obj.corners(group):
                outward = [c - m for m, c in zip(middle, centre(face))]
                self.assertGreater(dot(area_vector(face), outward), 0, group)


class CausticGlass(unittest.TestCase):
    def test_lamp(self):
        (lamp,) = load("caustic_glass").corners("lamp")
        down = area_vector(lamp)
        self.assertAlmostEqual(down[1], -0.09, places=12)
        self.assertAlmostEqual(abs(down[0]) + abs(down[2]), 0.0, places=12)

    def test_expected_values_of_the_readme(self):
        (lamp,) = load("caustic_glass").corners("lamp")
        script = runpy.run_path(str(SCENES / "caustic_glass" / "make_caustic_glass.py"))
        values = [f"{math.pi * 100 * 0.09:.6g} W"]
        values += [f"{100 * sphere_flux(lamp, m, r):.3f} W" for _, m, r in script["SPHERES"]]
        for point, normal in (((0, 1.5, -1), (0, 0, 1)), ((0, 0, 0.9), (0, 1, 0))):
            values.append(f"{direct_light(lamp, point, normal) * 100 * 0.7 / math.pi:.6f}")
        readme = (SCENES / "caustic_glass" / "README.md").read_text()
        for value in values:
            self.assertIn(f"| {value} |", readme)

    def test_spheres(self):
        script = runpy.run_path(str(SCENES / "caustic_glass" / "make_caustic_glass.py"))
        obj = load("caustic_glass")
        for name, middle, radius in script["SPHERES"]:
            self.assertEqual(obj.materials[name], name)
            edges = obj.all_edges(name)
            self.assertTrue(all(edges[e] == 1 and (e[1], e[0]) in edges for e in edges), "closed")
            volume = 0.0
            for face, corners in zip(obj.groups[name], obj.corners(name)):
                relative = [[c - m for c, m in zip(p, middle)] for p in corners]
                self.assertGreater(dot(area_vector(relative), centre(relative)), 0, "outwards")
                volume += dot(area_vector(relative), centre(relative)) / 3
                for (_, _, n), p in zip(face, relative):
                    self.assertAlmostEqual(math.sqrt(dot(p, p)), radius, delta=2e-6)
                    self.assertGreater(dot(p, obj.normals[n]) / radius, 1 - 1e-5, "normals")
            self.assertAlmostEqual(volume / (4 / 3 * math.pi * radius**3), 1, delta=2e-3)


class WaterBasin(unittest.TestCase):
    def test_expected_values_of_the_readme(self):
        (lamp,) = load("water_basin").corners("lamp")
        self.assertLess(area_vector(lamp)[1], 0)
        values = [f"{math.pi * 3000 * -area_vector(lamp)[1]:.6g} W"]
        for point in ((0, 1.5, -1), (0, 1.2, -1)):
            values.append(f"{direct_light(lamp, point, (0, 0, 1)) * 3000 * 0.7 / math.pi:.6f}")
        readme = (SCENES / "water_basin" / "README.md").read_text()
        for value in values:
            self.assertIn(f"| {value} |", readme)

    def test_the_water_is_a_closed_block(self):
        obj = load("water_basin")
        edges = obj.all_edges("water")
        self.assertTrue(all(edges[e] == 1 and (e[1], e[0]) in edges for e in edges), "closed")
        volume = sum(dot(area_vector(c), centre(c)) / 3 for c in obj.corners("water"))
        self.assertAlmostEqual(volume, 2.04 * 2 * 0.82, delta=5e-3)
        for face, corners in zip(obj.groups["water"], obj.corners("water")):
            for _, _, n in (c for c in face if len(c) == 3):
                self.assertGreater(dot(area_vector(corners), obj.normals[n]), 0, "normals")


if __name__ == "__main__":
    unittest.main()
