# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Runs inside Blender: six scenes with textures, exported by both OBJ exporters, rendered by Cycles.

Usage: blender -b --factory-startup -noaudio -P textured_scenes.py -- FOLDER SAMPLES SCENE...

Of each SCENE FOLDER gets SCENE_old.obj, SCENE_new.obj (with their .mtl), the pictures that they name and
cycles_SCENE.exr of SIZE, linear. The camera is that of CAMERA in Blender's axes.
"""
import math
import os
import sys

import addon_utils
import bpy
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import cycles_reference

SIZE = (64, 48)
CAMERA = {"position": (0.0, -5.0, 2.2), "look_at": (0.0, 0.3, 0.6), "field_of_view": 40.0}
PICTURE = 256  # texels on a side, so that few pixels see where two mix


def save_picture(folder, name, texel, space="sRGB", has_alpha=False):
    """A PNG of 8 bits; texel(u, v) gives three or four numbers as they are stored."""
    image = bpy.data.images.new(name, PICTURE, PICTURE, alpha=has_alpha)
    image.colorspace_settings.name = space
    image.alpha_mode = "STRAIGHT"
    pixels = []
    for row in range(PICTURE):
        for column in range(PICTURE):
            values = texel((column + 0.5) / PICTURE, (row + 0.5) / PICTURE)
            pixels += [*values, 1.0][:4]
    image.pixels.foreach_set(pixels)
    image.filepath_raw = os.path.join(folder, f"{name}.png")
    image.file_format = "PNG"
    image.save()
    return image


def principled(name, **values):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.distribution = "MULTI_GGX"  # nothing is lost between facets, as in pm
    for key, value in values.items():
        shader.inputs[key.replace("_", " ")].default_value = value
    return made


def link_picture(material, image, key, output="Color"):
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    shader = tree.nodes["Principled BSDF"]
    if key == "Normal":
        turned = tree.nodes.new("ShaderNodeNormalMap")
        tree.links.new(node.outputs[output], turned.inputs["Color"])
        tree.links.new(turned.outputs["Normal"], shader.inputs[key])
    else:
        tree.links.new(node.outputs[output], shader.inputs[key])
    return node


def add_quad(name, corners, material):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([Vector(corner) for corner in corners], [], [(0, 1, 2, 3)])
    layer = mesh.uv_layers.new()
    for loop, uv in zip(layer.data, ((0, 0), (1, 0), (1, 1), (0, 1))):
        loop.uv = uv
    mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def add_ball(material):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.8, location=(0, 0.2, 0.8))
    ball = bpy.context.object
    ball.data.polygons.foreach_set("use_smooth", [True] * len(ball.data.polygons))
    ball.data.materials.append(material)


def black(name, **values):
    return principled(name, Base_Color=(0, 0, 0, 1), Specular=0.0, **values)


def add_lamp(material=None):
    material = material or black("lamp", Emission=(1, 1, 1, 1), Emission_Strength=8.0)
    add_quad("lamp", [(-1, -2, 4), (-1, 0, 4), (1, 0, 4), (1, -2, 4)], material)


def add_room(material=None):
    plain = material or principled("plain", Base_Color=(0.6, 0.6, 0.6, 1), Specular=0.0, Roughness=0.5)
    add_quad("floor", [(-6, -6, 0), (6, -6, 0), (6, 3, 0), (-6, 3, 0)], plain)
    add_quad("wall", [(-6, 3, 0), (6, 3, 0), (6, 3, 6), (-6, 3, 6)], plain)


def stripes(u, v):
    return (0.9, 0.3 + 0.5 * u, 0.2) if int(8 * u) % 2 else (0.2, 0.4, 0.9 - 0.5 * v)


def plastic(folder):
    """Pictures of base colours below what a surface reflects: the exporters keep different numbers."""
    picture = save_picture(folder, "stripes", stripes)
    material = principled("plastic", Roughness=0.5)
    link_picture(material, picture, "Base Color")
    wall = principled("paper", Specular=0.0, Roughness=0.5, Base_Color=(0.1, 0.1, 0.1, 1))
    link_picture(wall, picture, "Base Color")
    add_room(wall)
    add_ball(material)
    add_lamp()


def metal(folder):
    """A metal whose roughness is a picture."""
    rough = save_picture(folder, "rough", lambda u, v: (0.25 + 0.5 * v,) * 3, "Non-Color")
    material = principled("gold", Base_Color=(0.9, 0.6, 0.3, 1), Metallic=1.0, Roughness=0.1)
    link_picture(material, rough, "Roughness")
    add_room()
    add_ball(material)
    add_lamp()


def squares(u, v):
    return float((int(8 * u) + int(4 * v)) % 2)


def helmet(folder):
    """What is metal by a picture, as glTF has it, with another of the colour."""
    material = principled("helmet", Roughness=0.5, Specular=0.0)
    link_picture(material, save_picture(folder, "stripes", stripes), "Base Color")
    link_picture(material, save_picture(folder, "metal", lambda u, v: (squares(u, v),) * 3, "Non-Color"), "Metallic")
    add_room()
    add_ball(material)
    add_lamp()


def barrel(folder):
    """Roughness and what is metal in channels of one picture; no exporter writes it, export() does."""
    orm = save_picture(folder, "orm", lambda u, v: (1.0, 0.35 + 0.3 * v, squares(u, v)), "Non-Color")
    material = principled("barrel", Base_Color=(0.8, 0.5, 0.3, 1), Specular=0.0)
    tree = material.node_tree
    picture, parted = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeSeparateColor")
    picture.image = orm
    tree.links.new(picture.outputs["Color"], parted.inputs["Color"])
    shader = tree.nodes["Principled BSDF"]
    tree.links.new(parted.outputs["Green"], shader.inputs["Roughness"])
    tree.links.new(parted.outputs["Blue"], shader.inputs["Metallic"])
    add_room()
    add_ball(material)
    add_lamp()


def add_channels(file):
    """To the material 'barrel' of an MTL file, in place of the numbers that stand there."""
    lines, is_in = [], False
    for line in open(file, encoding="utf-8").read().splitlines():
        if line.startswith("newmtl"):
            is_in = line.split() == ["newmtl", "barrel"]
            lines.append(line)
            if is_in:
                lines += ["map_Pr -imfchan g orm.png", "map_Pm -imfchan b orm.png"]
        elif not (is_in and line.split()[:1] in (["Ns"], ["Pr"], ["Pm"], ["Ka"])):
            lines.append(line)
    open(file, "w", encoding="utf-8").write("\n".join(lines) + "\n")


def screen(folder):
    """A picture that shines."""
    material = black("screen", Emission_Strength=1.0)
    link_picture(material, save_picture(folder, "stripes", stripes), "Emission")
    add_room()
    add_quad("screen", [(-1.5, 1.5, 0.7), (1.5, 1.5, 0.7), (1.5, 0.2, 2.0), (-1.5, 0.2, 2.0)], material)


def leaves(folder):
    """Leaves cut out by the alpha of their picture, before a wall with a normal map."""

    def leaf(u, v):
        return (*stripes(u, v)[:3], 1.0 if (2 * u - 1) ** 2 + (2 * v - 1) ** 2 < 0.7 else 0.0)

    def bent(u, v):
        x, y = 0.15 * math.sin(6 * math.pi * u), 0.15 * math.sin(4 * math.pi * v)
        z = math.sqrt(1 - x * x - y * y)
        return (0.5 + 0.5 * x, 0.5 + 0.5 * y, 0.5 + 0.5 * z)

    picture = save_picture(folder, "leaf", leaf, has_alpha=True)
    material = principled("leaf", Specular=0.0, Roughness=0.5)
    node = link_picture(material, picture, "Base Color")
    material.node_tree.links.new(node.outputs["Alpha"], material.node_tree.nodes["Principled BSDF"].inputs["Alpha"])
    material.blend_method = "CLIP"
    bumpy = principled("bumpy", Base_Color=(0.6, 0.6, 0.6, 1), Specular=0.0, Roughness=0.5)
    link_picture(bumpy, save_picture(folder, "bent", bent, "Non-Color"), "Normal")
    add_room(bumpy)
    add_quad("left", [(-1.6, 0, 0.2), (-0.1, 0.6, 0.2), (-0.1, 0.6, 1.8), (-1.6, 0, 1.8)], material)
    add_quad("right", [(0.1, 0.6, 0.2), (1.6, 0, 0.2), (1.6, 0, 1.8), (0.1, 0.6, 1.8)], material)
    add_lamp()


SCENES = {"plastic": plastic, "metal": metal, "screen": screen, "leaves": leaves, "helmet": helmet, "barrel": barrel}


def add_camera():
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "VERTICAL"
    camera.angle = math.radians(CAMERA["field_of_view"])
    thing = bpy.data.objects.new("camera", camera)
    bpy.context.scene.collection.objects.link(thing)
    thing.location = CAMERA["position"]
    way = Vector(CAMERA["look_at"]) - Vector(CAMERA["position"])
    thing.rotation_euler = way.to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.camera = thing


def export(folder, name):
    bpy.ops.export_scene.obj(filepath=os.path.join(folder, f"{name}_old.obj"), path_mode="RELATIVE")
    bpy.ops.wm.obj_export(filepath=os.path.join(folder, f"{name}_new.obj"), path_mode="RELATIVE")
    if name == "barrel":
        for exporter in ("old", "new"):
            add_channels(os.path.join(folder, f"{name}_{exporter}.mtl"))


def main():
    folder, samples, *names = sys.argv[sys.argv.index("--") + 1 :]
    addon_utils.enable("io_scene_obj")
    for name in names:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        addon_utils.enable("io_scene_obj")
        SCENES[name](folder)
        add_camera()
        cycles_reference.set_up(SIZE, int(samples), 32).transparent_max_bounces = 32
        export(folder, name)
        bpy.ops.render.render()
        bpy.data.images["Render Result"].save_render(os.path.join(folder, f"cycles_{name}.exr"))


main()
