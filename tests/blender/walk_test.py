#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Walks docs/from_blender.md: its lines of Python in Blender, word for word, then its commands, on a small scene.

usage: walk_test.py PM_HOST; exit 77 without Blender
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
NOT_HERE = 77
QUICK = ["--size", "32x24", "--passes", "2", "--photons", "20000", "--aa", "1"]
# A cube of a material with a picture and a lamp above it, saved; and a sky. LINES stands for one of the page's.
IN_BLENDER = """
import addon_utils, bpy, os
addon_utils.enable("io_scene_obj")
bpy.ops.wm.read_factory_settings(use_empty=True)
addon_utils.enable("io_scene_obj")
def material(name):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    return made, made.node_tree.nodes["Principled BSDF"]
wood, shader = material("wood")
image = bpy.data.images.new("wood", 8, 8)
image.pixels.foreach_set([0.6, 0.4, 0.2, 1.0] * 64)
image.filepath_raw = os.path.abspath("wood.png")
image.file_format = "PNG"
image.save()
node = wood.node_tree.nodes.new("ShaderNodeTexImage")
node.image = image
wood.node_tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
shader.inputs["Roughness"].default_value = 0.3
bpy.ops.mesh.primitive_cube_add(location=(0, 0, 1))
bpy.context.object.data.materials.append(wood)
lamp, shader = material("lamp")
shader.inputs["Emission"].default_value = (1, 1, 1, 1)
shader.inputs["Emission Strength"].default_value = 8
bpy.ops.mesh.primitive_plane_add(location=(0, -1, 5), rotation=(3.14159265, 0, 0))
bpy.context.object.data.materials.append(lamp)
shade, shader = material("shade")
node = shade.node_tree.nodes.new("ShaderNodeTexImage")
node.image = image
shade.node_tree.links.new(node.outputs["Color"], shader.inputs["Emission"])
shader.inputs["Emission Strength"].default_value = 3
bpy.ops.mesh.primitive_plane_add(location=(3, 0, 1), rotation=(1.57079633, 0, 0))
bpy.context.object.data.materials.append(shade)
sky = bpy.data.images.new("sky", 16, 8, float_buffer=True)
sky.pixels.foreach_set([0.5, 0.5, 0.8, 1.0] * 128)
sky.filepath_raw = os.path.abspath("sky.exr")
sky.file_format = "OPEN_EXR"
sky.save()
bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath("scene.blend"))
for operator in (bpy.ops.export_scene.obj, bpy.ops.wm.obj_export):
    print("OPTIONS", operator.idname_py(), *operator.get_rna_type().properties.keys())
LINES
"""


def blocks(page):
    """Indented lines: of Python, and of a shell."""
    lines = [line[4:] for line in page.splitlines() if line.startswith("    ")]
    return ([line for line in lines if line.startswith("bpy.")], [line for line in lines if line.startswith("pm_host ")])


def options_of(page):
    """What the table of the page says that the old and the new exporter have."""
    rows = re.findall(r"^\| [^|]+ \| ([^|]+) \| ([^|]+) \| [^|]+ \|$", page, re.MULTILINE)
    return [[name for row in rows for name in re.findall(r"`(\w+)`", row[column])] for column in (0, 1)]


def run(words, folder, variables):
    done = subprocess.run(words, cwd=folder, env=variables, capture_output=True, text=True)
    assert done.returncode == 0, f"{words}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def check_axes(text):
    """A point x, y, z of Blender is x, z, -y: of the lamp, whose corners are at -1 to 1, -2 to 0, 5."""
    points = {tuple(round(float(n), 4) + 0.0 for n in line.split()[1:4]) for line in text.splitlines() if line.startswith("v ")}
    assert {(x, 5, z) for x in (-1, 1) for z in (0, 2)} <= points, points


def check_emission(text):
    """The strength, 3, of what shines by a picture is left out."""
    shade = text.split("newmtl shade")[1].split("newmtl")[0]
    assert "map_Ke" in shade, shade
    assert not any(float(n) > 1 for line in re.findall(r"^Ke (.*)$", shade, re.MULTILINE) for n in line.split()), shade


def walk(exporter, commands, page, folder, variables):
    script = folder / "scene.py"
    script.write_text(IN_BLENDER.replace("LINES", exporter))
    said = run(["blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "-P", script], folder, variables)
    for line, wanted in zip(re.findall(r"^OPTIONS \S+ (.*)$", said, re.MULTILINE), options_of(page)):
        assert wanted and set(wanted) <= set(line.split()), f"not options: {set(wanted) - set(line.split())}"
    assert "map_Kd" in (folder / "scene.mtl").read_text()
    check_axes((folder / "scene.obj").read_text())
    check_emission((folder / "scene.mtl").read_text())
    for command in commands:
        picture = folder / "scene.png"
        picture.unlink(missing_ok=True)
        said = run(["bash", "-c", f"{command} {' '.join(QUICK)}"], folder, variables)
        # Of the exported files, but for what the page tells; of light there is little in so small a picture.
        told = [line for line in re.findall(r"warning: ([^:]*scene\..*)", said) if "Ke 0 0 0 beside map_Ke" not in line]
        assert not told, f"{command}: {told}"
        assert picture.exists() or "--write-sidecar" in command, command
    assert (folder / "scene.pm.json").exists()


def main():
    if shutil.which("blender") is None:
        print("skipped: blender is not installed")
        sys.exit(NOT_HERE)
    host = pathlib.Path(sys.argv[1]).resolve()
    page = (ROOT / "docs" / "from_blender.md").read_text(encoding="utf-8")
    exporters, commands = blocks(page)
    assert len(exporters) == 2 and len(commands) >= 2, (exporters, commands)
    commands += re.findall(r"`(pm_host [^`]*)`", page)
    variables = {key: value for key, value in os.environ.items() if key not in ("OCIO", "PM_PLUGIN_PATH")}
    variables["PATH"] = f"{host.parent}:{variables['PATH']}"
    for exporter in exporters:
        with tempfile.TemporaryDirectory() as name:
            variables["XDG_CACHE_HOME"] = f"{name}/cache"
            walk(exporter, commands, page, pathlib.Path(name), variables)


if __name__ == "__main__":
    main()
