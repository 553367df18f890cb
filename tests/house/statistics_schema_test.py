#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""What pm_host writes as statistics is what docs/statistics.schema.json says, of a render that
succeeds and of one that fails; and the schema can refuse.

usage: statistics_schema_test.py PM_HOST
"""
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = ROOT / "scenes" / "cornell_box" / "cornell_box.obj"
SKIPPED = 77


def problems(schema, statistics):
    import jsonschema

    validator = jsonschema.Draft7Validator(schema)
    return [f"{'/'.join(map(str, e.absolute_path))}: {e.message}"
            for e in validator.iter_errors(statistics)]  # fmt: skip


def statistics_of(host, folder, scene, status):
    """The statistics of a small render, which has to end with this exit code."""
    path = pathlib.Path(folder, f"stats{status}.json")
    command = [host, str(scene), "--size", "16x12", "--stats", str(path), "-o",
               str(pathlib.Path(folder, "x.exr"))]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder)
    if done.returncode != status:
        sys.exit(f"pm_host ended with {done.returncode}, not {status}: {done.stderr}")
    if not path.exists():
        sys.exit(f"pm_host ended with {status} and wrote no statistics")
    return json.loads(path.read_text(encoding="utf-8"))


def main():
    try:
        import jsonschema
    except ImportError:
        print("skipped: Python's jsonschema is not installed (python3-jsonschema)")
        return SKIPPED
    schema = json.loads((ROOT / "docs" / "statistics.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft7Validator.check_schema(schema)
    found = []
    with tempfile.TemporaryDirectory() as folder:
        good = statistics_of(sys.argv[1], folder, SCENE, 0)
        bad = statistics_of(sys.argv[1], folder, pathlib.Path(folder, "absent.obj"), 4)
    for name, statistics in (("done", good), ("failed", bad)):
        found += [f"statistics of a render that {name}: {p}" for p in problems(schema, statistics)]
    # Every key that is written is described: nothing gets in by the back door.
    undescribed = sorted((set(good) | set(bad)) - set(schema["properties"]))
    found += [f"the schema does not describe '{key}'" for key in undescribed]
    for key in schema["required"]:
        if not problems(schema, {k: v for k, v in good.items() if k != key}):
            found.append(f"the schema lets pass statistics without '{key}'")
    if not problems(schema, dict(good, schema="pm-stats/0")):
        found.append("the schema lets pass another version")
    for line in found:
        print(line)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
