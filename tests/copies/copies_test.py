#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""pm_host pack, and renders of a scene that is fetched from a static server.

usage: copies_test.py PM_HOST PM_HOST_FORKS PLUGIN [TEST...]
"""
import hashlib
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

from server import Server

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "run"))
from forks import Forks  # noqa: E402

SCENES = ROOT / "scenes" / "regression"
CLEARED = ("OCIO", "http_proxy", "https_proxy", "all_proxy", "HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY")
OPTIONS = ("--size", "24x16", "--passes", "1", "--photons", "2000")


class Copies(unittest.TestCase):
    """A project with a scene, which is packed to `pack` and served."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="pm copies ", ignore_cleanup_errors=True)
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "away").mkdir()
        self.project = self.folder / "project"
        shutil.copytree(SCENES, self.project, ignore=shutil.ignore_patterns("references*"))
        self.scene = self.project / "textured.obj"
        self.pack_folder = self.folder / "pack"
        self.copies = self.folder / "copies"
        self.variables = {**os.environ, "XDG_CACHE_HOME": str(self.folder / "cache")}

    def host(self, *words, code=0, cwd=None):
        """What pm_host printed, as out and err; a farm's commands are of the program itself."""
        cwd = cwd or self.folder
        if words[0] == "farm":
            done = subprocess.run([HOST, *map(str, words)], cwd=cwd, capture_output=True, text=True, env=self.variables,
                                  timeout=120)
            self.assertEqual(done.returncode, code, done.stderr)
            return done.stdout, done.stderr
        ended = FORKS.run(cwd, words, 60, output=str(self.folder),
                          variables={"XDG_CACHE_HOME": self.variables["XDG_CACHE_HOME"]})
        out, err = ((self.folder / name).read_text(errors="replace") for name in (".out", ".err"))
        self.assertEqual(ended["code"], code, err)
        return out, err

    def pack(self, *more, **how):
        return self.host("pack", self.scene, "-o", self.pack_folder, *more, **how)

    def serve(self):
        server = Server(self.pack_folder)
        self.addCleanup(server.close)
        return server

    def manifest(self):
        return json.loads((self.pack_folder / "manifest.json").read_text())

    def hash_of(self, place):
        return next(file["sha256"] for file in self.manifest()["files"] if file["place"] == place)

    def render(self, scene, *more, name="picture.exr", options=OPTIONS, **how):
        """Its bytes, and what was said."""
        # From elsewhere: nothing of the project is beside it.
        done = self.host(scene, *options, "-o", self.folder / name, "--copies", self.copies, *more,
                         cwd=how.pop("cwd", self.folder / "away"), **how)
        file = self.folder / name
        return (file.read_bytes() if file.exists() else None), done[1]

    def hide_project(self):
        self.project.rename(self.folder / "hidden project")

    def cached(self):
        return sorted(file.name for file in (self.copies / "objects").rglob("*") if file.is_file())


class Renders(Copies):
    def test_same_bytes_and_nothing_is_fetched_twice(self):
        local, _ = self.render(self.scene, name="local.exr")
        self.pack()
        self.hide_project()
        server = self.serve()
        self.assertEqual(self.render(server.url())[0], local)
        files = {file["sha256"] for file in self.manifest()["files"]}
        self.assertEqual(sorted(server.objects()), sorted(f"/objects/{h[:2]}/{h}" for h in files))
        self.assertEqual(len(files), 4, "scene, library and two textures")
        self.assertEqual(self.render(server.url())[0], local)
        self.assertEqual(server.objects(), [])

    def test_one_changed_texture_is_fetched_alone(self):
        self.pack()
        server = self.serve()
        before, _ = self.render(server.url())
        server.objects()
        shutil.copy(self.project / "checker.png", self.project / "leaf.png")
        self.pack()
        with open(self.project / "leaf.png", "ab") as file:
            file.write(b"changed")
        self.pack()
        after, said = self.render(server.url())
        self.assertEqual(server.objects(), [f"/objects/{self.hash_of('leaf.png')[:2]}/{self.hash_of('leaf.png')}"])
        self.assertIn("1 of 4 files are fetched", said)
        self.assertNotEqual(after, before)

    def test_colour_config_with_what_it_names(self):
        config = ("--context", "SHOT=b", "--look", "night")
        options = ("--ocio", "project/studio/config.ocio", *config)
        local, _ = self.render(self.scene, *options, name="local.png", cwd=self.folder)
        self.pack(*options)
        self.hide_project()
        server = self.serve()
        self.assertEqual(self.render(server.url(), *options, name="far.png")[0], local)
        self.assertEqual(self.render(server.url(), *config, name="far.png")[0], local, "by itself")
        places = [file["place"] for file in self.manifest()["files"]]
        self.assertIn("studio/grades/b.cc", places)
        self.assertNotIn("studio/grades/a.cc", places, "of another shot")

    def test_sky_sidecar_and_search_path(self):
        textures = self.folder / "library" / "textures"
        textures.mkdir(parents=True)
        (self.project / "leaf.png").rename(textures / "leaf.png")
        sky = self.folder / "library" / "sky.hdr"
        sky.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n" + bytes(range(80, 112)))
        (self.project / "textured.pm.json").write_text(json.dumps(
            {"schema": "pm-sidecar/1", "cameras": [{"name": "side", "position": [3, 2, 5], "lookAt": [0, 0, 0]}]}))
        options = ("--search-path", textures, "--environment", sky)
        local, _ = self.render(self.scene, *options, name="local.exr")
        self.assertNotEqual(self.render(self.scene, "--no-sidecar", *options, name="other.exr")[0], local)
        self.assertNotEqual(self.render(self.scene, *options[:2], name="other.exr")[0], local)
        self.pack(*options)
        self.hide_project()
        shutil.rmtree(self.folder / "library")
        server = self.serve()
        self.assertEqual(self.render(server.url(), *options[2:])[0], local)
        self.assertIn("sky.hdr", self.render(server.url(), "--environment", "another/sky.hdr", code=4)[1])

    def test_absolute_names_and_names_that_go_up(self):
        shots = self.project / "shots" / "deep"
        shots.mkdir(parents=True)
        (self.project / "models").mkdir()
        # One by its whole path, one through a folder that holds nothing of the scene.
        text = (self.project / "scenes.mtl").read_text().replace(
            "leaf.png", f"{self.project}/leaf.png").replace("checker.png", "../../models/../checker.png")
        (shots / "scenes.mtl").write_text(text)
        self.scene = shots / "textured.obj"
        shutil.copy(self.project / "textured.obj", self.scene)
        local, _ = self.render(self.scene, name="local.exr")
        self.pack()
        self.hide_project()
        # Others that a name could lead to by mistake are of this machine, not of the scene.
        self.project.mkdir()
        shutil.copy(SCENES / "checker.png", self.project / "leaf.png")
        far, said = self.render(self.serve().url())
        self.assertNotIn("leaf.png", said)
        self.assertEqual(far, local)

    def test_tiles(self):
        (self.project / "tex").mkdir()
        for tile, picture in (("1001", "leaf.png"), ("1002", "checker.png"), ("1011", "checker.png")):
            shutil.copy(SCENES / picture, self.project / "tex" / f"t.{tile}.png")
        library = self.project / "scenes.mtl"
        text = library.read_text()
        self.assertIn("map_Kd checker.png", text)
        library.write_text(text.replace("map_Kd checker.png", "map_Kd Tex/t.<UDIM>.png"))
        local, _ = self.render(self.scene, name="local.exr")
        self.pack()
        self.hide_project()
        self.assertEqual(self.render(self.serve().url())[0], local)
        places = [file["place"] for file in self.manifest()["files"]]
        self.assertEqual([place for place in places if place.startswith("tex/")],
                         ["tex/t.1001.png", "tex/t.1002.png", "tex/t.1011.png"])

    def test_parts_of_copies_and_of_the_original_go_together(self):
        self.pack()
        server = self.serve()
        options = ("--bucket-size", "8")
        local, _ = self.render(self.scene, *options, name="local.exr")
        for scene, run in ((self.scene, 1), (server.url(), 2)):
            self.render(scene, *options, "--buckets", f"{run}/2", name=f"p{run}.pmpart")
        self.host("merge", "p1.pmpart", "p2.pmpart", "-o", "merged.exr")
        self.assertTrue((self.folder / "merged.exr").read_bytes() == local)

    def test_file_address_and_default_name(self):
        self.pack()
        self.host(f"file://{str(self.pack_folder).replace(' ', '%20')}/manifest.json", *OPTIONS, "--copies", self.copies)
        self.assertTrue((self.folder / "pack.exr").exists())

    def test_frames_have_packs_of_their_own(self):
        server = self.serve()
        for frame in ("0001", "0002"):
            self.host("pack", self.scene, "-o", self.pack_folder / f"\u0411 shot.{frame}")
        self.assertIn("shot.0001/", self.render(server.url("%d0%91%20shot.%04d/manifest.json"), "--frame", "1", "-v")[1])
        said = self.render(server.url("%d0%91%20shot.####/manifest.json"), "--frames", "1-2", "-v", name="p.##.exr")[1]
        for frame in ("0001", "0002"):
            self.assertIn(f"shot.{frame}/", said)
        self.assertTrue((self.folder / "p.02.exr").exists())

    def test_packing_again_writes_only_the_manifest(self):
        self.pack()
        before = {file: file.stat().st_mtime_ns for file in self.pack_folder.rglob("objects/*/*")}
        self.assertIn("0.0 MiB are new", self.pack()[1])
        self.assertEqual({file: file.stat().st_mtime_ns for file in self.pack_folder.rglob("objects/*/*")}, before)
        for file in before:
            self.assertEqual(hashlib.sha256(file.read_bytes()).hexdigest(), file.name)


class Faults(Copies):
    def setUp(self):
        super().setUp()
        self.pack()
        self.server = self.serve()

    def flip(self, file):
        os.chmod(file, 0o644)
        content = bytearray(file.read_bytes())
        content[len(content) // 2] ^= 1
        stamp = file.stat()
        file.write_bytes(content)
        os.utime(file, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))

    def test_poisoned_copy_is_found(self):
        good, _ = self.render(self.server.url())
        self.server.objects()
        for place in ("leaf.png", "textured.obj"):
            name = self.hash_of(place)
            self.flip(self.copies / "objects" / name[:2] / name)
            again, said = self.render(self.server.url())
            self.assertEqual(again, good)
            self.assertIn(f"the copy of {place} is not what it was", said)
            self.assertEqual(self.server.objects(), [f"/objects/{name[:2]}/{name}"])
        self.assertEqual(self.render(self.server.url())[1].count("is not what it was"), 0)

    def test_added_and_exchanged_files_are_found(self):
        good, _ = self.render(self.server.url())
        tree = next(path for path in (self.copies / "packs").iterdir() if path.is_dir())
        (tree / "textured.pm.json").write_text('{"schema": "pm-sidecar/1", "cameras": [{"name": "x", "position": [9, 9, 9], "lookAt": [0, 0, 0]}]}')
        (tree / "leaf.png").unlink()
        shutil.copy(SCENES / "checker.png", tree / "leaf.png")
        again, said = self.render(self.server.url())
        self.assertEqual(again, good)
        self.assertIn("textured.pm.json: does not belong to the scene", said)

    def test_damaged_at_the_server(self):
        name = self.hash_of("leaf.png")
        self.flip(self.pack_folder / "objects" / name[:2] / name)
        picture, said = self.render(self.server.url(), code=3)
        self.assertIsNone(picture)
        self.assertIn("is not leaf.png as the manifest has it: its SHA-256 is", said)
        self.assertEqual(self.server.objects().count(f"/objects/{name[:2]}/{name}"), 2, "tried once more")
        self.assertNotIn(name, self.cached())
        self.assertEqual([file for file in self.cached() if ".tmp." in file], [])

    def test_longer_and_shorter_at_the_server(self):
        name = self.hash_of("leaf.png")
        file = self.pack_folder / "objects" / name[:2] / name
        os.chmod(file, 0o644)
        content = file.read_bytes()
        file.write_bytes(content + b"x")
        self.assertIn(f"is longer than {len(content)} bytes", self.render(self.server.url(), code=3)[1])
        file.write_bytes(content[:-1])
        self.assertIn(f"{len(content) - 1} bytes in place of {len(content)}", self.render(self.server.url(), code=3)[1])

    def test_absent_at_the_server(self):
        name = self.hash_of("leaf.png")
        (self.pack_folder / "objects" / name[:2] / name).unlink()
        self.assertIn(f"{name}: can't be fetched: the server answers 404", self.render(self.server.url(), code=4)[1])
        self.assertIn("nothing.json: can't be fetched: the server answers 404",
                      self.render(self.server.url("nothing.json"), code=4)[1])

    def test_no_server(self):
        with socket.socket() as unused:
            unused.bind(("127.0.0.1", 0))
            url = f"http://127.0.0.1:{unused.getsockname()[1]}/manifest.json"
        said = self.render(url, code=4)[1]
        self.assertIn("can't be fetched", said)
        self.assertIn("5 times", said)

    def test_overloaded_server_is_asked_again(self):
        name = self.hash_of("leaf.png")
        self.server.failures = {f"/objects/{name[:2]}/{name}": 2, "/manifest.json": 1}
        self.render(self.server.url())
        self.assertEqual(self.server.objects().count(f"/objects/{name[:2]}/{name}"), 3)

    def test_no_manifest(self):
        (self.pack_folder / "manifest.json").write_text("{}")
        self.assertIn("is no packed scene", self.render(self.server.url(), code=3)[1])

    def test_manifest_that_leads_out_of_its_folder(self):
        manifest = self.manifest()
        for place in ("../outside.png", "/etc/outside.png", "a//b.png", "a/./b.png", ""):
            manifest["files"][0]["place"] = place
            (self.pack_folder / "manifest.json").write_text(json.dumps(manifest))
            self.assertIn("is no place", self.render(self.server.url(), code=3)[1])

    def test_manifest_whose_places_do_not_fit(self):
        good = self.manifest()
        first, second = good["files"][0]["place"], good["files"][1]["place"]
        for change, scene, said in (({"place": second}, second, "is there twice"),
                                    ({"place": "elsewhere"}, first, "is not among its files"),
                                    ({"place": second + "/x"}, second, "is a file and a folder"),
                                    ({"sha256": "../../x"}, first, "is no SHA-256"),
                                    ({"bytes": 1 << 60}, first, "are too many"), 
                                    ({"bytes": -1}, first, "no whole number"), ({"bytes": 1e300}, first, "no whole number"),
                                    ({"bytes": "1"}, first, "no whole number"), ({"bytes": None}, first, "no whole number")):
            manifest = json.loads(json.dumps(good))
            manifest["files"][0].update(change)
            manifest["scene"] = scene
            (self.pack_folder / "manifest.json").write_text(json.dumps(manifest))
            self.assertIn(said, self.render(self.server.url(), code=3)[1])

    def test_sidecar_can_not_be_written(self):
        self.assertIn("--write-sidecar", self.render(self.server.url(), "--write-sidecar", code=2)[1])


class Sharing(Copies):
    def start(self, url, name, *more):
        process = subprocess.Popen([HOST, url, *OPTIONS, *more, "-o", self.folder / name, "--copies", self.copies],
                                   env=self.variables, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def test_two_at_once_fetch_once(self):
        self.pack()
        server = self.serve()
        server.pause = threading.Event()
        workers = [self.start(server.url(), f"{i}.exr") for i in range(3)]
        while server.asked.count("/manifest.json") < 3:
            time.sleep(0.01)
        time.sleep(1)  # all want the same now
        server.pause.set()
        for worker in workers:
            self.assertEqual(worker.wait(120), 0, worker.stderr.read())
        objects = server.objects()
        self.assertEqual(len(objects), len(set(objects)), objects)
        self.assertEqual(len({(self.folder / f"{i}.exr").read_bytes() for i in range(3)}), 1)

    def test_killed_while_it_fetches(self):
        self.pack()
        server = self.serve()
        server.pause = threading.Event()
        worker = self.start(server.url(), "killed.exr")
        while not any("/objects/" in path for path in server.asked):
            time.sleep(0.01)
        worker.kill()
        worker.wait()
        server.pause.set()
        self.render(server.url())
        self.assertEqual([file for file in self.cached() if ".tmp." in file], [], "what it left is removed")

    def test_interrupted_while_it_fetches(self):
        self.pack()
        server = self.serve()
        server.pause = threading.Event()
        self.addCleanup(server.pause.set)
        worker = self.start(server.url(), "interrupted.exr")
        while not any("/objects/" in path for path in server.asked):
            time.sleep(0.01)
        worker.send_signal(signal.SIGINT)
        self.assertEqual(worker.wait(10), 130)
        self.assertEqual(self.cached(), [])

    def test_farm_of_a_fetched_scene(self):
        self.pack()
        server = self.serve()
        farm = ("--bucket-size", "8", "--copies", self.copies)
        local, _ = self.render(self.scene, *farm[:2], name="local.exr")
        printed = self.host("farm", server.url(), *OPTIONS, *farm, "--engine", "commands", "--job", "job", "--runs", "2",
                            "-o", "farm.exr")[0]
        self.hide_project()
        for command in (line for line in printed.splitlines() if not line.startswith("#")):
            subprocess.run(command, shell=True, check=True, env=self.variables, cwd=self.folder, capture_output=True)
        self.assertTrue((self.folder / "farm.exr").read_bytes() == local)
        self.assertEqual(len(server.objects()), 4)

    def test_room_is_made_by_what_is_not_used(self):
        for name in ("a", "b", "c"):
            with open(self.project / "leaf.png", "ab") as file:
                file.write(os.urandom(1 << 20))
            self.host("pack", self.scene, "-o", self.folder / "packs" / name)
        self.pack_folder = self.folder / "packs"
        server = self.serve()
        limit = ("--copies-limit", str(5.5 / 1024))  # a is 1 MiB, b 2, c 3
        self.render(server.url("a/manifest.json"), *limit)
        self.render(server.url("b/manifest.json"), *limit)
        self.render(server.url("a/manifest.json"), *limit)
        server.objects()
        with server.lock:
            server.asked = []
        self.render(server.url("c/manifest.json"), *limit)  # b goes, it was not used for longest
        with server.lock:
            server.asked = []
        self.render(server.url("a/manifest.json"), *limit)
        self.assertEqual(server.asked, ["/a/manifest.json"], "a stayed")
        self.render(server.url("b/manifest.json"), *limit)
        self.assertIn("objects", " ".join(server.asked), "b went")
        size = sum(file.stat().st_size for file in (self.copies / "objects").rglob("*") if file.is_file())
        self.assertLessEqual(size, 5.5 * (1 << 20))

    def test_what_is_in_use_stays(self):
        for name in ("a", "b"):
            with open(self.project / "leaf.png", "ab") as file:
                file.write(os.urandom(1 << 20))
            self.host("pack", self.scene, "-o", self.folder / "packs" / name)
        self.pack_folder = self.folder / "packs"
        server = self.serve()
        limit = ("--copies-limit", str(2.5 / 1024))  # a is 1 MiB, b 2
        worker = self.start(server.url("a/manifest.json"), "a.exr", "--passes", "100000", "-v")
        self.assertTrue(any(" meshes, " in line for line in worker.stderr), "it renders")
        worker.send_signal(signal.SIGSTOP)
        before = self.cached()
        said = self.render(server.url("b/manifest.json"), *limit, code=4)[1]
        self.assertIn("--copies-limit allows", said)
        self.assertEqual(self.cached(), before)
        worker.send_signal(signal.SIGCONT)
        worker.kill()
        worker.wait()
        self.render(server.url("b/manifest.json"), *limit)
        self.assertFalse(set(before) <= set(self.cached()), "a went once nobody rendered it")

    def test_too_large_for_the_limit(self):
        self.pack()
        said = self.render(self.serve().url(), "--copies-limit", "0.0000001", code=4)[1]
        self.assertIn("--copies-limit allows", said)
        self.assertEqual(self.cached(), [])


class Packing(Copies):
    def test_scene_that_is_not_there(self):
        self.scene = self.project / "none.obj"
        self.assertIn("none.obj", self.pack(code=4)[1])
        self.assertFalse(self.pack_folder.exists())

    def test_one_folder_is_wanted(self):
        self.host("pack", self.scene, code=2)
        self.host("pack", "http://127.0.0.1/manifest.json", "-o", "x", code=2)

    def test_name_that_would_lead_elsewhere(self):
        # A whole path whose letters are of another case leads to its file here, and nowhere in a pack.
        shots = self.project / "shots"
        shots.mkdir()
        whole = self.folder / "Project" / "leaf.png"
        (shots / "scenes.mtl").write_text((SCENES / "scenes.mtl").read_text().replace("leaf.png", str(whole)))
        self.scene = shots / "textured.obj"
        shutil.copy(SCENES / "textured.obj", self.scene)
        shutil.copy(SCENES / "checker.png", shots / "checker.png")
        said = self.pack(code=3)[1]
        self.assertIn(f"where the scene reads {self.project}/leaf.png, its copies would lead to", said)
        self.assertFalse((self.pack_folder / "manifest.json").exists())
        self.assertEqual(sorted(file.name for file in self.pack_folder.iterdir()), [".pm-folder", "objects"])

    def test_config_with_an_absolute_search_path(self):
        config = self.project / "studio" / "config.ocio"
        text = config.read_text()
        self.assertIn("search_path:", text)
        lines = [f"search_path: {self.project}/studio/grades" if line.startswith("search_path:")
                 else line for line in text.splitlines()]
        config.write_text("\n".join(lines) + "\n")
        said = self.pack("--ocio", config, "--context", "SHOT=a", code=3)[1]
        self.assertIn("is found by an absolute path", said)


if __name__ == "__main__":
    HOST = os.path.abspath(sys.argv.pop(1))
    for name in CLEARED:
        os.environ.pop(name, None)
    FORKS = Forks(os.path.abspath(sys.argv.pop(1)), os.path.abspath(sys.argv.pop(1)))
    try:
        unittest.main()
    finally:
        FORKS.close()
