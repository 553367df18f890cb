# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""A host in Python: the same box as box_scene.c through ctypes, and the same hash.

Usage: box_host.py LIBRARY
"""
import ctypes as c
import sys

WIDTH, HEIGHT = 40, 24
u64, u32, i32, f32, f64, ptr = (c.c_uint64, c.c_uint32, c.c_int32, c.c_float, c.c_double,
                                c.c_void_p)

# The members of PmrApi after its head, in order.
FUNCTIONS = """versionText statusText settingCount settingInfo layerCount layerInfo createContext
releaseContext lastError createMesh createCage createSphere retainMesh releaseMesh createTexture
retainTexture releaseTexture createMaterial retainMaterial releaseMaterial createScene retainScene
releaseScene addInstance addLight setEnvironment setCamera commitScene sceneBounds createRender
setSettingInteger setSettingNumber setSettingText settingText explainRender startRender pollRender
waitRender cancelRender renderState destroyRender renderLayerCount renderLayerInfo readPixels
renderStatistics""".split()


def struct(name, *fields):
    return type(name, (c.Structure,), {"_fields_": [("size", u64), *fields]})


Mesh = struct("Mesh", ("positions", ptr), ("positionCount", u64), ("faceSizes", ptr),
              ("faceCount", u64), ("indices", ptr), ("indexCount", u64), ("normals", ptr),
              ("normalCount", u64), ("normalIndices", ptr), ("uvs", ptr), ("uvCount", u64),
              ("uvIndices", ptr), ("materialSlots", ptr), ("slotCount", u64))
Sphere = struct("Sphere", ("centre", f64 * 3), ("radius", f64))
Material = struct("Material", ("name", c.c_char_p), ("kind", i32), ("fresnel", i32),
                  ("diffuse", f32 * 3), ("glossy", f32 * 3), ("glossyExponent", f32), ("ior", f32),
                  ("transmission", f32 * 3), ("emission", f32 * 3), ("transparency", f32),
                  ("reserved", f32), ("textures", ptr * 6))
Instance = struct("Instance", ("mesh", ptr), ("transforms", ptr), ("transformCount", u64),
                  ("materials", ptr), ("materialCount", u64), ("name", c.c_char_p), ("id", u32),
                  ("reserved", u32))
Camera = struct("Camera", ("kind", i32), ("reserved", i32), ("transforms", ptr),
                ("transformCount", u64), ("fieldOfView", f64), ("height", f64),
                ("lensRadius", f64), ("focusDistance", f64), ("pixelAspect", f64))
FINISHED = c.CFUNCTYPE(None, ptr, ptr, i32)
Render = struct("Render", ("callbackMode", i32), ("reserved", i32), ("user", ptr),
                ("message", ptr), ("progress", ptr), ("bucketStarted", ptr),
                ("bucketFinished", ptr), ("finished", FINISHED))


class Api:
    """The table; every call checks its status."""

    def __init__(self, library):
        table = ptr()
        status = c.CDLL(library).pmrGetApi(u32(1), c.byref(table))
        if status != 0:
            raise RuntimeError(f"pmrGetApi: {status}")
        self.address = table.value

    def call(self, name, *arguments):
        entry = ptr.from_address(self.address + 16 + 8 * FUNCTIONS.index(name)).value
        status = c.CFUNCTYPE(i32, *[type(a) if isinstance(a, c._SimpleCData) else ptr
                                    for a in arguments])(entry)(*arguments)
        if status != 0:
            raise RuntimeError(f"{name}: {status}")

    def make(self, name, owner, desc):
        handle = ptr()
        self.call(name, owner, pointer(desc), pointer(handle))
        return handle


def pointer(value):
    return None if value is None else c.cast(c.pointer(value), ptr)


def array(kind, values):
    return (kind * len(values))(*values)


def new(layout, **members):
    desc = layout(size=c.sizeof(layout))
    desc.keep = []  # arrays that must live as long as the struct
    for name, value in members.items():
        if isinstance(value, c.Array) and not isinstance(getattr(desc, name), c.Array):
            desc.keep.append(value)
            value = c.cast(value, ptr)
        setattr(desc, name, value)
    return desc


def make_room(api, context):
    positions = [-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1,
                 -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1]
    indices = [4, 5, 1, 0, 3, 2, 6, 7, 0, 1, 2, 3, 0, 3, 7, 4, 1, 5, 6, 2]
    return api.make("createMesh", context, new(
        Mesh, positions=array(f32, positions), positionCount=8, faceSizes=array(u32, [4] * 5),
        faceCount=5, indices=array(u32, indices), indexCount=20,
        materialSlots=array(u32, [0, 0, 0, 1, 2]), slotCount=3))


def make_block(api, context, x0, y0, z0, x1, y1, z1):
    positions = [x0, y0, z0, x1, y0, z0, x1, y1, z0, x0, y1, z0,
                 x0, y0, z1, x1, y0, z1, x1, y1, z1, x0, y1, z1]
    indices = [0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 2, 3, 7, 6, 1, 2, 6, 5, 0, 4, 7, 3]
    return api.make("createMesh", context, new(
        Mesh, positions=array(f32, positions), positionCount=8, faceSizes=array(u32, [4] * 6),
        faceCount=6, indices=array(u32, indices), indexCount=24))


def make_surface(api, context, diffuse, emission=0.0, glossy=0.0):
    return api.make("createMaterial", context, new(
        Material, diffuse=array(f32, diffuse), emission=array(f32, [emission] * 3),
        glossy=array(f32, [glossy] * 3), glossyExponent=32.0 if glossy > 0 else 0.0))


def make_specular(api, context, kind):
    return api.make("createMaterial", context, new(
        Material, kind=kind, ior=1.5, glossy=array(f32, [0.875] * 3),
        transmission=array(f32, [1.0] * 3)))


def make_ball(api, context, x, y, z):
    return api.make("createSphere", context, new(Sphere, centre=array(f64, [x, y, z]),
                                                 radius=0.375))


def make_scene(api, context):
    parts = [
        (make_room(api, context), [make_surface(api, context, [0.75, 0.75, 0.75]),
                                   make_surface(api, context, [0.625, 0.0625, 0.0625]),
                                   make_surface(api, context, [0.125, 0.5, 0.125])]),
        (make_block(api, context, -0.25, 0.96875, -0.25, 0.25, 0.984375, 0.25),
         [make_surface(api, context, [0, 0, 0], emission=8)]),
        (make_block(api, context, -0.25, -1.0, -0.75, 0.25, -0.25, -0.375),
         [make_surface(api, context, [0.25, 0.25, 0.5], glossy=0.375)]),
        (make_ball(api, context, -0.5, -0.625, -0.25), [make_specular(api, context, 1)]),
        (make_ball(api, context, 0.5, -0.625, 0.25), [make_specular(api, context, 2)]),
    ]
    scene = api.make("createScene", context, None)
    for mesh, materials in parts:
        api.call("addInstance", scene, pointer(new(
            Instance, mesh=mesh, materials=array(ptr, [m.value for m in materials]),
            materialCount=len(materials))))
    api.call("setCamera", scene, pointer(new(
        Camera, transforms=array(f64, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 3.5]), transformCount=1,
        fieldOfView=0.75)))
    api.call("commitScene", scene)
    for mesh, materials in parts:
        api.call("releaseMesh", mesh)
        for material in materials:
            api.call("releaseMaterial", material)
    return scene


def hash_bytes(data):
    value = 0xcbf29ce484222325
    for byte in data:
        value = ((value ^ byte) * 0x100000001b3) & 0xffffffffffffffff
    return value


def main():
    api = Api(sys.argv[1])
    context = ptr()
    api.call("createContext", None, pointer(context))
    scene = make_scene(api, context)
    statuses = []
    finished = FINISHED(lambda user, render, status: statuses.append(status))
    render = api.make("createRender", scene, new(Render, finished=finished))
    for name, value in {b"width": WIDTH, b"height": HEIGHT, b"passes": 2, b"photons": 5000}.items():
        api.call("setSettingInteger", render, c.c_char_p(name), c.c_int64(value))
    api.call("startRender", render)
    api.call("waitRender", render, f64(-1.0))
    pixels = (f32 * (WIDTH * HEIGHT * 4))()
    whole = (i32 * 4)(0, 0, WIDTH, HEIGHT)
    api.call("readPixels", render, c.cast(whole, ptr), c.c_char_p(b"beauty"), c.cast(pixels, ptr),
             c.c_int64(0), c.c_int64(0))
    api.call("destroyRender", render)
    api.call("releaseScene", scene)
    api.call("releaseContext", context)
    if statuses != [0]:
        raise RuntimeError(f"finished came with {statuses}")
    print(f"{hash_bytes(bytes(pixels)):016x}")


main()
