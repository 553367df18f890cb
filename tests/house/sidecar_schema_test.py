#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""docs/sidecar.schema.json lets pass what pm_host reads and writes, and refuses what it refuses; and the
example of docs/sidecar.md renders.

usage: sidecar_schema_test.py PM_HOST_FORKS PLUGIN
"""
import copy
import json
import pathlib
import re
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "run"))
from forks import Forks  # noqa: E402

SKIPPED = 77
NUMBERS = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]

# What is put at a place of the example, and whether that is still a sidecar. A place without a value is
# taken out.
CHANGES = [
    ([], ["lights"], None, True),
    ([], ["schema"], None, False),
    ([], ["schema"], "pm-sidecar/0", False),
    ([], ["$schema"], "sidecar.schema.json", True),
    ([], ["lamps"], [], False),
    (["instances", 0], ["of"], None, True),
    (["instances", 0], ["of"], "", False),
    (["instances", 0], ["matrix"], NUMBERS, False),  # beside translate
    (["instances", 0], ["scale"], [1, 2, -3], True),
    (["instances", 0], ["scale"], 0, False),
    (["instances", 0], ["scale"], [1, 0, 1], False),
    (["instances", 0], ["rotate"], [1, 2], False),
    (["instances", 0], ["hiddenFrom"], ["camera", "shadow", "reflection"], True),
    (["instances", 0], ["hiddenFrom"], ["eye"], False),
    (["instances", 0], ["hiddenFrom"], "camera", False),
    (["instances", 0], ["materials"], "glass", True),
    (["instances", 0], ["materials"], ["glass"], False),
    (["instances", 0], ["colour"], 1, False),
    (["spheres", 0], ["radius"], -1, False),
    (["spheres", 0], ["radius"], None, False),
    (["spheres", 0], ["material"], None, False),
    (["spheres", 0], ["centre"], None, True),
    (["spheres", 0], ["matrix"], NUMBERS, True),
    (["spheres", 0], ["matrix"], NUMBERS[:11], False),
    (["lights", 0], ["angle"], 180, True),
    (["lights", 0], ["angle"], 0, False),
    (["lights", 0], ["angle"], 181, False),
    (["lights", 0], ["angle"], None, False),
    (["lights", 0], ["falloff"], -1, False),
    (["lights", 0], ["intensity"], 3, True),
    (["lights", 0], ["intensity"], [1, 2], False),
    (["lights", 0], ["intensity"], -3, False),
    (["lights", 0], ["lookAt"], None, False),
    (["lights", 0], ["matrix"], NUMBERS, False),  # beside position
    (["lights", 0], ["colourSpace"], "rendering", True),
    (["lights", 0], ["colourSpace"], "sRGB", False),
    (["lights", 0], ["type"], "point", False),  # it has an angle
    (["lights"], [0], {"type": "point", "position": [0, 3, 0], "intensity": 4}, True),
    (["lights"], [0], {"type": "point", "intensity": 4}, False),
    (["lights"], [0], {"type": "directional", "direction": [0, -1, 0], "irradiance": 1}, True),
    (["lights"], [0], {"type": "directional", "matrix": NUMBERS, "irradiance": 1, "angle": 90}, True),
    (["lights"], [0], {"type": "directional", "matrix": NUMBERS, "irradiance": 1, "angle": 91}, False),
    (["lights"], [0], {"type": "directional", "irradiance": 1}, False),
    (["lights"], [0], {"type": "area"}, False),
    (["environment"], ["radiance"], None, False),
    (["environment"], ["rotate"], [0, 90, 0], True),
    (["environment"], ["strength"], 1, False),
    (["cameras", 0], ["position"], None, False),
    (["cameras", 0], ["matrix"], NUMBERS, False),
    (["cameras", 0], ["fieldOfView"], 180, False),
    (["cameras", 0], ["fieldOfView"], "40", False),
    (["cameras", 0], ["pixelAspect"], 2, True),
    (["cameras", 0], ["up"], [0, 0, 1], True),
    (["cameras"], [0], {"matrix": NUMBERS}, True),
    (["cameras"], [0], {"matrix": NUMBERS, "up": [0, 0, 1]}, False),
]  # fmt: skip


def examples():
    """The files of the example, by their endings."""
    text = (ROOT / "docs" / "sidecar.md").read_text(encoding="utf-8")
    return {kind: body for kind, body in re.findall(r"```(obj|mtl|json)\n(.*?)```", text, re.DOTALL)}


def changed(sidecar, way, key, value):
    sidecar = copy.deepcopy(sidecar)
    at = sidecar
    for step in way:
        at = at[step]
    if value is None:
        del at[key[0]]
    else:
        at[key[0]] = value
    return sidecar


def written(host, folder, validator):
    """What --write-sidecar writes is a sidecar too."""
    (folder / "lawn.pm.json").unlink()
    code, said = host.said(folder, ["lawn.obj", "--write-sidecar", "--explain"])
    if code != 0:
        return [f"--write-sidecar: {said}"]
    text = json.loads((folder / "lawn.pm.json").read_text(encoding="utf-8"))
    return [f"what is written: {e.message}" for e in validator.iter_errors(text)]


def main():
    try:
        import jsonschema
    except ImportError:
        print("skipped: Python's jsonschema is not installed (python3-jsonschema)")
        return SKIPPED
    host = Forks(sys.argv[1], sys.argv[2])
    schema = json.loads((ROOT / "docs" / "sidecar.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    files = examples()
    example = json.loads(files["json"])
    found = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for kind, ending in (("obj", ".obj"), ("mtl", ".mtl"), ("json", ".pm.json")):
            (folder / f"lawn{ending}").write_text(files[kind], encoding="utf-8")
        for more in ([], ["--camera", "above"]):
            code, said = host.said(folder, ["lawn.obj", "--size", "32x24", "--photons", "1000", "-o", "x.png", *more])
            if code != 0 or "warning" in said:
                found.append(f"the example of docs/sidecar.md: {said}")
        for way, key, value, isGood in [([], ["schema"], "pm-sidecar/1", True), *CHANGES]:
            case = changed(example, way, key, value)
            what = f"{[*way, *key]} = {json.dumps(value)}"
            if validator.is_valid(case) != isGood:
                found.append(f"the schema {'refuses' if isGood else 'lets pass'} {what}")
            (folder / "lawn.pm.json").write_text(json.dumps(case), encoding="utf-8")
            code, said = host.said(folder, ["lawn.obj", "--explain"])
            if code != (0 if isGood else 3):
                found.append(f"pm_host ends with {code} of {what}: {said}")
        found += written(host, folder, validator)
    host.close()
    for line in found:
        print(line)
    print(f"sidecars: {len(CHANGES) + 1} cases, {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
