# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""One of the neutral scenes in Blender's Cycles at rising sample counts, one EXR for each.

Usage: blender -b --factory-startup -noaudio -P cycles_scene.py --
           scenes.json KEY FOLDER THREADS SECONDS SEED

Prints a line "cycles SAMPLES WALL_SECONDS PROCESSOR_SECONDS FILE" after each picture. The seconds
are those of the render call: Blender's own start is not in it, handing the scene to Cycles and
building its tree are. Sample counts double until the next render would take more
than SECONDS times THREADS of processor time.

Two things differ from the scene's definition, since Cycles has no others: spheres are icospheres
with smooth normals, and the lamp is an area light (which Cycles samples by solid angle)
with a black square just above it, since an area light of Cycles stops no rays.
"""
import json
import math
import os
import sys
import time

import bpy
from mathutils import Matrix, Vector

ICOSPHERE_LEVELS = 8  # as Blender counts: 20 * 4^7 triangles
LAMP_GAP = 1e-4  # scene units between the lamp and the black square above it


def add_object(name, data):
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def material(name, make_shader):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.clear()
    shader = make_shader(nodes)
    output = nodes.new("ShaderNodeOutputMaterial")
    made.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return made


def diffuse(rgb):
    def make(nodes):
        node = nodes.new("ShaderNodeBsdfDiffuse")
        node.inputs["Color"].default_value = (*rgb, 1.0)
        node.inputs["Roughness"].default_value = 0.0
        return node

    return make


def mirror(nodes):
    node = nodes.new("ShaderNodeBsdfGlossy")
    node.distribution = "SHARP"
    node.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    return node


def glass(nodes):
    node = nodes.new("ShaderNodeBsdfGlass")
    node.distribution = "SHARP"
    node.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    node.inputs["IOR"].default_value = 1.5
    return node


def add_quad(name, p, e0, e1, surface):
    p, e0, e1 = Vector(p), Vector(e0), Vector(e1)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([p, p + e0, p + e0 + e1, p + e1], [], [(0, 1, 2, 3)])
    mesh.materials.append(surface)
    add_object(name, mesh)


def add_sphere(name, centre, radius, surface):
    bpy.ops.mesh.primitive_ico_sphere_add(
        subdivisions=ICOSPHERE_LEVELS, radius=radius, location=centre
    )
    sphere = bpy.context.object
    sphere.data.polygons.foreach_set("use_smooth", [True] * len(sphere.data.polygons))
    sphere.data.materials.append(surface)


def add_lamp(p, e0, e1, radiance, black):
    p, e0, e1 = Vector(p), Vector(e0), Vector(e1)
    normal = e0.cross(e1).normalized()
    light = bpy.data.lights.new("lamp", "AREA")
    light.shape = "RECTANGLE"
    light.size, light.size_y = e0.length, e1.length
    largest = max(radiance)
    light.color = [value / largest for value in radiance]
    # Cycles takes the radiance of an area light as energy / (4 area), whatever watts may mean.
    light.energy = 4.0 * e0.length * e1.length * largest
    light.cycles.max_bounces = 1024
    lamp = add_object("lamp", light)
    # An area light shines along its -z.
    axes = Matrix((e0.normalized(), -normal.cross(e0).normalized(), -normal)).transposed()
    lamp.matrix_world = Matrix.Translation(p + (e0 + e1) / 2) @ axes.to_4x4()
    lamp.visible_camera = True
    add_quad("lamp_back", p - normal * LAMP_GAP, e0, e1, black)


def add_camera(description):
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "VERTICAL"
    camera.angle = math.radians(description["vfov"])
    camera.clip_start, camera.clip_end = 1e-3, 1e3
    thing = add_object("camera", camera)
    back = (Vector(description["pos"]) - Vector(description["look"])).normalized()
    right = Vector(description["up"]).cross(back).normalized()
    axes = Matrix((right, back.cross(right), back)).transposed()
    thing.matrix_world = Matrix.Translation(description["pos"]) @ axes.to_4x4()
    bpy.context.scene.camera = thing


def build(scene):
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    surfaces = {name: material(name, diffuse(rgb)) for name, rgb in scene["mat"].items()}
    surfaces["mirror"] = material("mirror", mirror)
    surfaces["glass"] = material("glass", glass)
    for name, p, e0, e1, surface in scene["quads"]:
        add_quad(name, p, e0, e1, surfaces[surface])
    for name, centre, radius, surface in scene["spheres"]:
        add_sphere(name, centre, radius, surfaces[surface])
    add_lamp(*scene["light"], scene["L"], material("black", diffuse((0.0, 0.0, 0.0))))
    add_camera(scene["cam"])


def set_up(size, threads, seed):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.threads_mode = "FIXED"
    scene.render.threads = threads
    scene.render.use_persistent_data = False
    scene.render.dither_intensity = 0.0
    scene.view_settings.view_transform = "Raw"
    image = scene.render.image_settings
    image.file_format, image.color_mode, image.color_depth = "OPEN_EXR", "RGB", "32"
    scene.world = bpy.data.worlds.new("black")
    scene.world.color = (0.0, 0.0, 0.0)
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.use_auto_tile = False
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = 0.0
    cycles.light_sampling_threshold = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = 64
    cycles.transmission_bounces = cycles.transparent_max_bounces = 64
    cycles.seed = seed


def main():
    file, key, folder, threads, limit, seed = sys.argv[sys.argv.index("--") + 1 :]
    with open(file, encoding="utf-8") as opened:
        scene = json.load(opened)[key]
    build(scene)
    set_up(scene["res"], int(threads), int(seed))
    samples, expected = 4, 0.0
    while expected <= float(limit):
        output = os.path.join(folder, f"cycles_{key}_{samples}.exr")
        bpy.context.scene.cycles.samples = samples
        start, processor_start = time.perf_counter(), time.process_time()
        bpy.ops.render.render()
        seconds = time.perf_counter() - start
        processor_seconds = time.process_time() - processor_start
        bpy.data.images["Render Result"].save_render(output)
        print("cycles", samples, f"{seconds:.4f}", f"{processor_seconds:.4f}", output, flush=True)
        samples, expected = 2 * samples, 2 * processor_seconds / int(threads)


main()
