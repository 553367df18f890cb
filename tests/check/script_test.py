#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""The script of docs/regression.md, word for word but for passes and seeds, makes and checks a suite of ten scenes.

usage: script_test.py PM_HOST
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def main():
    host = pathlib.Path(sys.argv[1]).resolve()
    text = (ROOT / "docs" / "regression.md").read_text(encoding="utf-8")
    script = re.search(r"```sh\n(.*?)```", text, re.DOTALL).group(1)
    assert '"--passes", "8"' in script
    script = script.replace('"--passes", "8"', '"--passes", "2"')
    assert "--seeds 16" in script
    script = script.replace("--seeds 16", "--seeds 4")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scenes").symlink_to(ROOT / "scenes")
        variables = {key: value for key, value in os.environ.items()
                     if key not in ("OCIO", "PM_PLUGIN_PATH")}
        variables["PATH"] = f"{host.parent}:{variables['PATH']}"
        variables["XDG_CACHE_HOME"] = str(folder / "cache")
        done = subprocess.run(["bash", "-e", "-c", script], cwd=folder, env=variables,
                              capture_output=True, text=True)
        print(done.stdout, done.stderr)
        assert done.returncode == 0, done.returncode
        suite = json.loads((folder / "suite" / "suite.json").read_text())
        names = {scene["name"] for scene in suite["scenes"]}
        assert len(names) == 10, names
        assert f"{len(names)} of {len(names)} scenes stored" in done.stdout
        assert f"{len(names)} of {len(names)} scenes right" in done.stdout
        assert (folder / "suite" / "references" / "box.dark.png").exists()
        kept = {file.stem for file in (folder / "suite" / "references").glob("*.json")}
        assert kept == names, kept
        pages = folder / "suite" / "pages"
        assert (pages / "index.html").exists()
        assert all((pages / "scene" / f"{name}.html").exists() for name in names)
        assert (folder / "suite" / "suite.xml").read_text().count("<testcase ") == len(names)


if __name__ == "__main__":
    main()
