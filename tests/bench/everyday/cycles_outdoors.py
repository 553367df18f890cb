# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""The outdoor scene of everyday_scenes.py in Blender's Cycles, for measure_everyday.py --cycles.

usage: blender -b --factory-startup -noaudio -P cycles_outdoors.py --
           outdoors.obj night.hdr EYE LOOK_AT FOV WxH SAMPLES SEED OUT.exr

Prints "cycles PROCESSOR_SECONDS" of the render call; Blender's own start and reading the file are not in it.
"""
import math
import sys
import time

import bpy
from mathutils import Vector


def point(text):
    """Blender has z up."""
    x, y, z = (float(v) for v in text.split(","))
    return Vector((x, -z, y))


def add_camera(scene, eye, look_at, fov):
    camera = bpy.data.cameras.new("camera")
    thing = bpy.data.objects.new("camera", camera)
    scene.collection.objects.link(thing)
    thing.location = point(eye)
    thing.rotation_euler = (point(look_at) - point(eye)).to_track_quat("-Z", "Y").to_euler()
    camera.sensor_fit = "VERTICAL"
    camera.angle = math.radians(float(fov))
    scene.camera = thing


def add_sky(scene, picture):
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    nodes = scene.world.node_tree.nodes
    texture = nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(picture)
    scene.world.node_tree.links.new(texture.outputs[0], nodes["Background"].inputs[0])


def main():
    obj, picture, eye, look_at, fov, size, samples, seed, out = sys.argv[sys.argv.index("--") + 1 :]
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    bpy.ops.wm.obj_import(filepath=obj, forward_axis="NEGATIVE_Z", up_axis="Y")
    scene = bpy.context.scene
    add_camera(scene, eye, look_at, fov)
    add_sky(scene, picture)
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples, cycles.seed = int(samples), int(seed)
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    # Nothing is clamped, blurred or cut short.
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = 12
    render = scene.render
    render.resolution_x, render.resolution_y = (int(v) for v in size.split("x"))
    render.resolution_percentage = 100
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    render.filepath = out
    begun = time.process_time()
    bpy.ops.render.render(write_still=True)
    print("cycles", time.process_time() - begun, flush=True)


main()
