#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""docs/suite.schema.json lets pass the suites that pm_host check reads and refuses those that it refuses, of pm's own
suites and of the one in docs/regression.md; and each key of it and of docs/sidecar.schema.json says what it is.

usage: suite_schema_test.py PM_HOST_FORKS PLUGIN
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
READ, REFUSED = 2, 3  # exit codes; a suite that was read has no scene of the name that is asked for
SUITE = {"schema": "pm-suite/1", "scenes": [{"name": "a", "scene": "a.obj"}]}

# What is put at a place of the suite, None to take it out, and whether that is still a suite.
CHANGES = [
    ([], "schema", "pm-suite/1", True),
    ([], "schema", "pm-suite/2", False),
    ([], "schema", None, False),
    ([], "$schema", "suite.schema.json", True),
    ([], "references", "kept", True),
    ([], "references", "", False),
    ([], "options", ["--size", "8x8"], True),
    ([], "options", "--size", False),
    ([], "options", [8], False),
    ([], "options", ["--seed", "2"], False),
    ([], "options", ["--report=x.html"], False),
    ([], "options", ["--passes"] * 1001, False),
    ([], "scenes", [], False),
    ([], "scenes", None, False),
    ([], "colour", 1, False),
    (["scenes", 0], "name", "A-1_b", True),
    (["scenes", 0], "name", "a b", False),
    (["scenes", 0], "name", "", False),
    (["scenes", 0], "name", "a" * 101, False),
    (["scenes", 0], "name", None, False),
    (["scenes", 0], "scene", None, False),
    (["scenes", 0], "scene", 1, False),
    (["scenes", 0], "options", ["-o", "a.exr"], False),
    (["scenes", 0], "options", ["--aa", "2"], True),
    (["scenes", 0], "display", True, True),
    (["scenes", 0], "display", "yes", False),
    (["scenes", 0], "codeLimit", 0.5, True),
    (["scenes", 0], "codeLimit", 256, False),
    (["scenes", 0], "codeLimit", -1, False),
    (["scenes", 0], "seed", 1, False),
    (["scenes", 0], "tags", ["night", "shot_1"], True),
    (["scenes", 0], "tags", ["two words"], False),
    (["scenes", 0], "tags", "night", False),
    (["scenes", 0], "views", [{"name": "raw", "options": ["--view", "raw", "--exposure=-1"]}], True),
    (["scenes", 0], "views", [{"name": "raw"}], True),
    (["scenes", 0], "views", [{"options": []}], False),
    (["scenes", 0], "views", [{"name": "raw", "options": ["--passes", "2"]}], False),
    (["scenes", 0], "views", [{"name": "a.b"}], False),
    (["scenes", 0], "views", {"raw": []}, False),
]  # fmt: skip


def changed(way, key, value):
    suite = copy.deepcopy(SUITE)
    at = suite
    for step in way:
        at = at[step]
    at.pop(key, None)
    if value is not None:
        at[key] = value
    return suite


def undescribed(name):
    """Keys of a schema without a word on what they are."""
    schema = json.loads((ROOT / "docs" / name).read_text(encoding="utf-8"))
    parts = {"": schema, **schema["definitions"]}
    return [f"{name}: no description of {part} {key}" for part, what in parts.items()
            for key, value in what.get("properties", {}).items() if not value.get("description")]


def known_keys(said):
    """Of a refusal that lists them."""
    return set(re.search(r"allowed are (.*)", said)[1].split(", "))


def read(host, folder, suite):
    """Exit code and words of pm_host."""
    (folder / "suite.json").write_text(json.dumps(suite), encoding="utf-8")
    return host.said(folder, ["check", "suite.json", "--only", "none"])


def main():
    try:
        import jsonschema
    except ImportError:
        print("skipped: Python's jsonschema is not installed (python3-jsonschema)")
        return SKIPPED
    host = Forks(sys.argv[1], sys.argv[2])
    schema = json.loads((ROOT / "docs" / "suite.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    found = undescribed("suite.schema.json") + undescribed("sidecar.schema.json")
    page = re.search(r"cat > suite.json <<'END'\n(.*?)\nEND", (ROOT / "docs" / "regression.md").read_text("utf-8"), re.S)
    texts = [page[1], *(file.read_text("utf-8") for file in (ROOT / "scenes" / "regression").glob("suite*.json"))]
    for text in texts:
        found += [f"a suite of ours: {e.message}" for e in validator.iter_errors(json.loads(text))]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for way, part in (([], schema), (["scenes", 0], schema["definitions"]["scene"])):
            keys = known_keys(read(host, folder, changed(way, "no such key", 1))[1])
            if keys != set(part["properties"]):
                found.append(f"keys of the schema or of pm_host alone: {sorted(keys ^ set(part['properties']))}")
        for way, key, value, isGood in CHANGES:
            what = f"{[*way, key]} = {json.dumps(value)[:80]}"
            if validator.is_valid(changed(way, key, value)) != isGood:
                found.append(f"the schema {'refuses' if isGood else 'lets pass'} {what}")
            code, said = read(host, folder, changed(way, key, value))
            if code != (READ if isGood else REFUSED):
                found.append(f"pm_host ends with {code} of {what}: {said}")
    host.close()
    for line in found:
        print(line)
    print(f"suites: {len(CHANGES)} cases, {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
