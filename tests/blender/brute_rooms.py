# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Runs inside Blender: rooms of tests/integrator/brute, built from their numbers, rendered by Cycles.

Usage: blender -b --factory-startup -noaudio -P brute_rooms.py -- FOLDER SAMPLES

Writes cycles_ROOM.exr of SIZE, linear, for each room of ROOMS. Coordinates are the room's own: y is up, and
the camera looks along -z, as Blender's does where nothing turns it.
"""
import math
import os
import sys

import bpy
from mathutils import Matrix

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import cycles_reference

SIZE = (12, 8)


def material(name, kind, **values):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    shader = tree.nodes.new(kind)
    for key, value in values.items():
        if key == "distribution":
            shader.distribution = value
        else:
            shader.inputs[key].default_value = value
    tree.links.new(shader.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return made


def diffuse(colour):
    return material("diffuse", "ShaderNodeBsdfDiffuse", Color=(*colour, 1))


def glass(roughness=0.0):
    kind = "MULTI_GGX" if roughness else "SHARP"
    return material("glass", "ShaderNodeBsdfGlass", distribution=kind, Color=(1, 1, 1, 1), IOR=1.5, Roughness=roughness)


def mirror(roughness=0.0):
    kind = "MULTI_GGX" if roughness else "SHARP"
    return material("mirror", "ShaderNodeBsdfGlossy", distribution=kind, Color=(0.9, 0.9, 0.9, 1), Roughness=roughness)


def lamp(radiance):
    """That shines from its front alone, and reflects nothing."""
    made = material("lamp", "ShaderNodeEmission", Color=(1, 1, 1, 1))
    tree = made.node_tree
    facing = tree.nodes.new("ShaderNodeNewGeometry")
    front = tree.nodes.new("ShaderNodeMath")
    front.operation = "MULTIPLY_ADD"
    front.inputs[1].default_value, front.inputs[2].default_value = -radiance, radiance
    tree.links.new(facing.outputs["Backfacing"], front.inputs[0])
    tree.links.new(front.outputs[0], tree.nodes["Emission"].inputs["Strength"])
    return made


def add_quad(corner, first, second, kind, place=None):
    ends = [corner]
    for sides in ((first,), (first, second), (second,)):
        ends.append(tuple(sum(part) for part in zip(corner, *sides)))
    mesh = bpy.data.meshes.new("quad")
    mesh.from_pydata(ends, [], [(0, 1, 2, 3)])
    mesh.materials.append(kind)
    thing = bpy.data.objects.new("quad", mesh)
    if place:
        thing.matrix_world = place
    bpy.context.scene.collection.objects.link(thing)


def add_ball(centre, radius, kind):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, radius=radius, location=centre)
    mesh = bpy.context.object.data
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.materials.append(kind)


def lit_room():
    white = diffuse((0.7, 0.7, 0.7))
    add_quad((-1, -1, 1), (2, 0, 0), (0, 0, -2), white)
    add_quad((-1, 1, -1), (2, 0, 0), (0, 0, 2), white)
    add_quad((-1, -1, -1), (2, 0, 0), (0, 2, 0), white)
    add_quad((-1, -1, 1), (0, 0, -2), (0, 2, 0), diffuse((0.6, 0.1, 0.1)))
    add_quad((1, -1, -1), (0, 0, 2), (0, 2, 0), diffuse((0.1, 0.5, 0.1)))
    add_quad((-0.95, 0.95, -0.95), (1.9, 0, 0), (0, 0, 1.9), lamp(2.0))


def two_balls(left, right):
    lit_room()
    add_ball((-0.45, -0.5, -0.2), 0.4, left)
    add_ball((0.45, -0.5, 0.1), 0.4, right)


def instances():
    lit_room()
    kind = mirror(0.35)
    for angle in (0.4, 2.0, 4.5):
        c, s = math.cos(angle), math.sin(angle)
        place = Matrix(((c, 0, s, 0.5 * s), (0, 1, 0, -0.4), (-s, 0, c, 0.5 * c), (0, 0, 0, 1)))
        add_quad((-0.3, -0.3, 0), (0.6, 0, 0), (0, 0.6, 0), kind, place)


def under_sky():
    two_balls(glass(0.3), mirror(0.6))
    world = bpy.context.scene.world
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.7, 1.0, 1)


ROOMS = {
    "smooth": lambda: two_balls(glass(), mirror()),
    "rough": lambda: two_balls(glass(0.2), glass(0.5)),
    "instances": instances,
    "sky": under_sky,
}


def add_camera():
    scene = bpy.context.scene
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit, camera.angle = "VERTICAL", math.radians(36)
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.camera.location = (0, 0, 4.2)
    scene.collection.objects.link(scene.camera)


def main():
    folder, samples = sys.argv[sys.argv.index("--") + 1 :]
    for name, build in ROOMS.items():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        add_camera()
        cycles_reference.set_up(SIZE, int(samples), 64).transmission_bounces = 64
        build()
        bpy.ops.render.render()
        bpy.data.images["Render Result"].save_render(os.path.join(folder, f"cycles_{name}.exr"))


main()
