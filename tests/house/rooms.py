# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""The rooms of the code, and whom each may include: one line a room, held by house_rules.py.

A room is a folder with sources. A name that begins with a part's is whole; others are of the room's own
part. Each room may include itself. `house_rules.py --rooms` prints the lines as the includes are today.
"""

PARTS = ("integrator", "scheduler", "plugin", "host_shim")

# fmt: off
MAY_INCLUDE = {
    "integrator/values": "",
    "integrator/caches": "",
    "integrator/cameras": "values",
    "integrator/geometry": "values",
    "integrator/photons/map": "caches values",
    "integrator/sampling": "values",
    "integrator/materials/lobes": "sampling values",
    "integrator/shapes": "geometry sampling values",
    "integrator/materials": "materials/lobes sampling shapes values",
    "integrator/tessellation": "caches geometry values",
    "integrator/rays": "shapes tessellation values",
    "integrator/lights": "materials sampling shapes values",
    "integrator/scene": "cameras geometry lights materials rays sampling shapes tessellation values",
    "integrator/light_sampling": "lights rays sampling scene shapes values",
    "integrator/paths": "caches materials materials/lobes sampling scene shapes values",
    "integrator/photons/emission": "light_sampling lights materials photons/map sampling scene values",
    "integrator/transport/path": "light_sampling materials paths sampling scene values",
    "integrator/photons/trace": "light_sampling paths photons/emission photons/map sampling scene values",
    "integrator/transport/frame": "sampling transport/path values",
    "integrator/photons/estimate": "photons/emission photons/map photons/trace sampling scene",
    "integrator/transport/seen_lights": "light_sampling materials sampling scene shapes transport/frame transport/path values",
    "integrator/transport/gather": "light_sampling materials paths photons/emission photons/estimate photons/map sampling scene transport/path values",
    "integrator/transport/survey": "light_sampling materials photons/emission photons/trace sampling scene transport/frame transport/gather transport/path values",
    "integrator/transport/photon": "light_sampling photons/emission photons/estimate photons/map photons/trace sampling scene shapes transport/frame transport/gather transport/path transport/survey values",
    "integrator/transport/plan": "light_sampling materials photons/emission photons/estimate photons/map photons/trace scene transport/frame transport/gather transport/survey",
    "integrator/transport": "light_sampling sampling scene transport/frame transport/path transport/photon transport/plan transport/seen_lights transport/survey values",
    "scheduler/buckets": "integrator/values",
    "scheduler/film": "buckets integrator/values",
    "plugin/include": "",
    "plugin/values": "integrator/values",
    "plugin/storage": "integrator/caches integrator/photons/trace integrator/transport/plan integrator/values scheduler/film values",
    "plugin/textures": "integrator/caches integrator/materials integrator/values values",
    "plugin/parameters": "integrator/materials integrator/scene integrator/values textures values",
    "plugin/session": "integrator/caches integrator/photons/map integrator/photons/trace integrator/scene integrator/tessellation integrator/transport integrator/transport/frame integrator/transport/gather integrator/transport/plan integrator/values parameters scheduler/buckets scheduler/film storage textures values",
    "plugin/api": "include integrator/cameras integrator/geometry integrator/scene integrator/values parameters scheduler/buckets session textures values",
    "host_shim/values": "",
    "host_shim/formats": "values",
    "host_shim/pictures": "values",
    "host_shim/folders": "pictures values",
    "host_shim/colour": "pictures values",
    "host_shim/formats/mtl": "formats values",
    "host_shim/formats/json": "formats values",
    "host_shim/formats/sidecar": "formats formats/json values",
    "host_shim/look": "formats values",
    "host_shim/pictures/writers": "pictures values",
    "host_shim/process": "pictures values",
    "host_shim/cli": "colour formats formats/mtl look pictures values",
    "host_shim/formats/obj": "formats formats/mtl process values",
    "host_shim/report": "folders pictures plugin/include process",
    "host_shim/sky": "formats pictures process",
    "host_shim/textures": "colour folders pictures values",
    "host_shim/check": "cli colour folders formats/json pictures process report values",
    "host_shim/farm/job": "cli folders formats formats/json pictures process report values",
    "host_shim/formats/pov/lexer": "values",
    "host_shim/formats/pov/values": "formats/pov/lexer values",
    "host_shim/formats/pov/evaluation": "formats/pov/lexer formats/pov/values values",
    "host_shim/formats/pov/objects": "formats formats/pov/evaluation formats/pov/values values",
    "host_shim/formats/pov": "formats formats/pov/evaluation formats/pov/objects values",
    "host_shim/formats/all": "formats formats/obj formats/pov pictures values",
    "host_shim/log": "cli process values",
    "host_shim/farm/engines": "cli farm/job formats formats/json log pictures process report values",
    "host_shim/render": "cli colour formats log look pictures pictures/writers plugin/include process report textures values",
    "host_shim/session": "cli colour folders formats formats/all formats/sidecar log look pictures process render report sky",
    "host_shim/copies": "cli colour folders formats formats/json log pictures process render session textures values",
    "host_shim/farm": "cli farm/engines farm/job formats formats/json log pictures process render report session values",
    "host_shim/watch": "cli farm/job log pictures process render report session values",
    "host_shim/app": "check cli colour copies farm formats log pictures process render session values watch",
    "host_shim": "app",
}
# fmt: on


def whole(room, name):
    """The room that a word of the row of `room` names."""
    if name.split("/")[0] in PARTS:
        return name
    return f"{room.split('/')[0]}/{name}"


def allowed(room):
    """The rooms that `room` may include, itself among them; nothing when it is in no row."""
    row = MAY_INCLUDE.get(room)
    return None if row is None else {room, *(whole(room, name) for name in row.split())}
