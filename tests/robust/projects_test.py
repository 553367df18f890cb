#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Every command and option that takes a folder or a file, inside a copy of somebody's project: nothing of it changes.

usage: projects_test.py PM_HOST PM_HOST_FORKS PLUGIN [TEST...]
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "run"))
from forks import Forks  # noqa: E402

SCENES = ROOT / "scenes" / "regression"
OPTIONS = ("--size", "16x12", "--passes", "1", "--photons", "1000", "--aa", "1")
HASH = "0123456789abcdef" * 2
MARKER = ".pm-folder"

# Names that pm gives in its folders, or nearly, and what people keep.
OWN_FILES = (
    "objects/tree.obj", "objects/ab/notes.txt", "objects/ab/" + "cd" * 32, "packs/brushes.json", "lock",
    "textures/wood.tx", "textures/wood.rec", "textures/tmp-notes.tx", f"textures/{HASH}.tx", "index/notes.rec",
    "index/tmp-old.rec", "leases/contract.lease", "run.sh", "tasks.txt", "plan.json", "manifest.json", "index.html",
    "scene/textured.html", "render/textured.html", "farm.html", "slurm.sh", "engine.json", "parts/0001.pmpart",
    "photons/0000.pmphotons", "logs/0001.log", "checkpoints/0001.pmcheck", "notes.txt", "cp.tmp",
    "references/textured.exr", "picture.partial.exr", "check.tmp.1/a",
)  # fmt: skip


def snapshot(folder):
    """Place -> what is there; links as links."""
    found = {}
    for path in sorted(folder.rglob("*")):
        place = str(path.relative_to(folder))
        found[place] = f"-> {os.readlink(path)}" if path.is_symlink() else path.read_bytes() if path.is_file() else "folder"
    return found


class Project(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="pm projects ")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.project = self.folder / "project"
        self.project.mkdir()
        for name in ("textured.obj", "scenes.mtl", "checker.png", "leaf.png"):
            shutil.copy(SCENES / name, self.project)
        for name in OWN_FILES:
            file = self.project / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(f"mine: {name}\n")
        (self.project / "empty").touch()
        (self.project / "link").symlink_to("notes.txt")
        (self.project / "suite.json").write_text(json.dumps(
            {"schema": "pm-suite/1", "references": "references", "options": list(OPTIONS),
             "scenes": [{"name": "textured", "scene": "textured.obj", "display": True}]}))
        self.before = snapshot(self.project)
        self.variables = {"XDG_CACHE_HOME": str(self.folder / "cache")}

    def host(self, *words, code=0):
        """What was said; what starts renders of its own is the program itself."""
        if words[0] in ("check", "farm"):
            done = subprocess.run([HOST, *map(str, words)], cwd=self.project, capture_output=True, text=True,
                                  env={**os.environ, **self.variables}, timeout=60)  # fmt: skip
            self.assertEqual(done.returncode, code, done.stderr)
            return done.stderr
        ended = FORKS.run(self.project, words, 60, output=str(self.folder), variables=self.variables)
        said = (self.folder / ".err").read_text(errors="replace")
        self.assertEqual(ended["code"], code, said)
        return said

    def render(self, *words, scene="textured.obj", code=0):
        return self.host(scene, *OPTIONS, "-o", self.folder / "a.exr", *words, code=code)

    def pack(self):
        """The address of a packed scene."""
        self.host("pack", "textured.obj", "-o", self.folder / "pack")
        return "file://" + str(self.folder / "pack" / "manifest.json").replace(" ", "%20")

    def assert_untouched(self):
        self.assertEqual({place: what for place, what in snapshot(self.project).items()
                          if self.before.get(place) != what}, {}, "new or changed")
        self.assertEqual(set(self.before) - set(snapshot(self.project)), set(), "gone")

    def refuses(self, option, *words, run=None, code=4):
        said = (run or self.host)(*words, code=code)
        self.assertEqual(len(said.strip().splitlines()), 1, said)
        self.assertIn(option, said)
        self.assert_untouched()
        return said


class SomebodysOwn(Project):
    def test_folder_of_copies(self):
        address = self.pack()
        said = self.refuses("--copies .: has ", "--copies", ".", run=lambda *words, code: self.render(
            *words, scene=address, code=code))
        self.assertIn(MARKER, said)

    def test_texture_cache(self):
        self.refuses("--texture-cache .: has ", "--texture-cache", ".", run=self.render)
        self.refuses("--texture-cache .", "--texture-cache", ".", "--texture-cache-size", "0.000001", run=self.render)
        for what in ("--clear", "--verify", "--list"):
            self.refuses("--texture-cache .: has ", "cache", what, "--texture-cache", ".")

    def test_one_file_is_enough(self):
        for option, run in (("--texture-cache", self.render), ("--html", lambda *words, code: self.host(
                "check", "suite.json", *words, code=code))):
            self.refuses(option, option, "check.tmp.1", run=run)

    def test_job(self):
        for engine in ("commands", "parallel"):
            self.refuses("--job", "farm", "textured.obj", *OPTIONS, "-o", self.folder / "a.exr", "--engine", engine,
                         "--job", ".")  # fmt: skip
        self.refuses("--job", "farm", "textured.obj", *OPTIONS, "-o", self.folder / "a.exr", "--engine", "commands",
                     "--job", ".", "--dry-run")  # fmt: skip

    def test_pack(self):
        self.refuses("pack -o", "pack", "textured.obj", "-o", ".")

    def test_pages(self):
        self.refuses("--html", "check", "suite.json", "--html", ".")

    def test_references(self):
        said = self.refuses("--update", "check", "suite.json", "--update", "--because", "new", "--seeds", "4")
        self.assertIn("textured.exr", said)

    def test_pieces(self):
        for name in ("notes.txt", "empty", "link", "cp.tmp"):
            for more in ((), ("--resume",), ("--keep-checkpoint",)):
                self.refuses("is there and no checkpoint", "--checkpoint", name, *more, run=self.render, code=3)
            said = self.host("textured.obj", *OPTIONS, "--photon-map", name, "--photons-only", code=3)
            self.assertIn("is there and no photon map", said)
            self.assert_untouched()

    def test_checkpoint_beside(self):
        self.render("--checkpoint", "cp", "--keep-checkpoint")
        self.assertTrue((self.project / "cp").is_file())
        self.render("--checkpoint", "cp", "--resume")
        self.assert_untouched()

    def test_a_render_and_its_reports(self):
        self.render("--stats", self.folder / "s", "--log", self.folder / "l", "--report", self.folder / "r.html",
                    "--texture-cache", self.folder / "textures")  # fmt: skip
        self.assert_untouched()

    def test_default_places_never_end_a_render(self):
        address = self.pack()
        usual = self.folder / "theirs" / "pm"
        (usual / "copies").mkdir(parents=True)
        for file in (usual / "mine.txt", usual / "copies" / "mine.txt"):
            file.write_text("mine\n")
        before = snapshot(usual)
        self.variables = {"XDG_CACHE_HOME": str(usual.parent)}
        for scene in ("textured.obj", address):
            said = self.render(scene=scene)
            self.assertIn("mine.txt", said)
            self.assertIn("for this run only", said)
            self.assertEqual(snapshot(usual), before)
        self.host("cache", "--clear", code=4)
        self.assertEqual(snapshot(usual), before)
        self.assertEqual(list(pathlib.Path(tempfile.gettempdir()).glob(f"pm_host.{os.getpid()}*")), [])


class FullDisks(Project):
    def test_a_cache_on_a_full_disk_gives_the_right_picture(self):
        if subprocess.run(["unshare", "-rm", "mount", "-t", "tmpfs", "tmpfs", "/mnt"], capture_output=True).returncode != 0:
            self.skipTest("no file system can be mounted here")
        self.render("--texture-cache", self.folder / "roomy")
        (self.folder / "small").mkdir()
        for temporary, code in ((self.folder, 0), (self.folder / "small", 4)):
            done = subprocess.run(
                ["unshare", "-rm", "sh", "-c", 'mount -t tmpfs -o size=20k tmpfs "$1" && shift && exec "$@"', "sh",
                 str(self.folder / "small"), HOST, "textured.obj", *OPTIONS, "-o", str(self.folder / "b.exr"),
                 "--texture-cache", str(self.folder / "small" / "c")],
                cwd=self.project, env={**os.environ, "TMPDIR": str(temporary)}, capture_output=True, text=True)  # fmt: skip
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn("No space left on device", done.stderr)
        self.assertEqual((self.folder / "a.exr").read_bytes(), (self.folder / "b.exr").read_bytes())


class PmsOwn(Project):
    """Folders that pm made, in which somebody laid files; and folders of before there were markers."""

    def lay(self, folder):
        """Files of other people's in all of its folders."""
        laid = []
        for place in [folder, *(path for path in folder.rglob("*") if path.is_dir())]:
            for name in ("notes.txt", "wood.tx", "notes.rec", "tmp-x.tx", "0001.txt", "a.html"):
                if not (place / name).exists():
                    (place / name).write_text("mine\n")
                    laid.append(place / name)
        return laid

    def assert_laid(self, laid):
        self.assertEqual([file for file in laid if not file.is_file() or file.read_text() != "mine\n"], [])

    def unmark(self, folder):
        self.assertTrue((folder / MARKER).read_text().startswith("pm-folder/1 "))
        (folder / MARKER).unlink()

    def test_texture_cache(self):
        cache = self.folder / "textures of pm"
        words = ("--texture-cache", cache)
        self.render(*words)
        self.unmark(cache)
        (cache / "lost+found").mkdir()
        (cache / ".gitkeep").touch()
        (cache / "textures" / ".nfs0001").touch()
        self.render(*words)
        self.unmark(cache)
        self.host("cache", "--verify", *words)
        laid = self.lay(cache)
        old = os.stat(laid[0]).st_mtime - 400 * 24 * 3600
        for file in laid:
            os.utime(file, (old, old))
        self.render(*words, "--texture-cache-size", "0.000001")
        for what in ("--list", "--verify", "--clear"):
            self.host("cache", what, *words)
        self.assert_laid(laid)
        self.assertEqual([file for file in cache.rglob("*.tx") if file not in laid], [], "cleared")
        (cache / MARKER).unlink()
        self.render(*words, code=4)
        self.assert_laid(laid)

    def test_folder_of_copies(self):
        address, copies = self.pack(), self.folder / "copies of pm"
        self.render("--copies", copies, scene=address)
        self.unmark(copies)
        self.render("--copies", copies, scene=address)
        tree = next(path for path in (copies / "packs").iterdir() if path.is_dir())
        laid = [file for file in self.lay(copies) if not file.is_relative_to(tree)]
        (tree / "scenes.mtl").unlink()
        (tree / "scenes.mtl").write_text("edited\n")
        said = self.render("--copies", copies, scene=address)
        self.assertIn("does not belong to the scene; it is now", said)
        self.assertEqual((copies / "set_aside" / "scenes.mtl").read_text(), "edited\n")
        self.assertEqual((copies / "set_aside" / "notes.txt").read_text(), "mine\n")
        # Room is made by all of it, for another.
        (tree / "notes.txt").write_text("mine again\n")
        with open(self.project / "textured.obj", "a") as file:
            file.write("# another\n" * 1000)
        address = self.pack()
        files = json.loads((self.folder / "pack" / "manifest.json").read_text())["files"]
        self.render("--copies", copies, "--copies-limit", str((sum(file["bytes"] for file in files) + 1) / 2**30),
                    scene=address)  # fmt: skip
        self.assertFalse((tree / "textured.obj").exists())
        self.assertIn("mine again\n", [file.read_text() for file in (copies / "set_aside").iterdir()])
        self.assert_laid(laid)
        (copies / MARKER).unlink()
        self.render("--copies", copies, scene=address, code=4)

    def test_job_pack_and_pages(self):
        for words, folder in (
            (("farm", "textured.obj", *OPTIONS, "-o", self.folder / "a.exr", "--engine", "commands", "--job"), "job"),
            (("pack", "textured.obj", "-o"), "pack"),
            (("check", "suite.json", "--html"), "pages"),
        ):
            folder = self.folder / folder
            code = 3 if words[0] == "check" else 0  # it has no references
            if words[0] == "check":
                shutil.rmtree(self.project / "references")
            self.host(*words, folder, code=code)
            laid = self.lay(folder)
            self.host(*words, folder, code=code)
            self.unmark(folder)
            self.host(*words, folder, code=code)
            self.assertTrue((folder / MARKER).is_file(), "known by its own file")
            self.assert_laid(laid)

    def test_a_page_of_somebody_in_pms_folder(self):
        shutil.rmtree(self.project / "references")
        pages = self.folder / "pages"
        self.host("check", "suite.json", "--html", pages, code=3)
        for page in (pages / "index.html", pages / "scene" / "textured.html"):
            kept = page.read_bytes()
            page.write_text("<p>mine</p>\n")
            self.assertIn("no page of pm's", self.host("check", "suite.json", "--html", pages, code=4))
            self.assertEqual(page.read_text(), "<p>mine</p>\n")
            page.write_bytes(kept)

    def test_folder_of_another_kind(self):
        cache = self.folder / "cache of pm"
        self.render("--texture-cache", cache)
        before = snapshot(cache)
        said = self.host("pack", "textured.obj", "-o", cache, code=4)
        self.assertIn("another purpose (texture-cache)", said)
        self.assertEqual(snapshot(cache), before)

    def test_picture_that_is_called_like_a_temporary_file(self):
        cache = self.folder / "textures of pm"
        shutil.copy(self.project / "checker.png", self.project / "tmp-0123456789abcdef.png")
        mtl = self.project / "scenes.mtl"
        mtl.write_text(mtl.read_text().replace("checker.png", "tmp-0123456789abcdef.png"))
        self.render("--texture-cache", cache)
        self.host("cache", "--list", "--texture-cache", cache)
        self.assertIn("tmp-0123456789abcdef.png", (self.folder / ".out").read_text())


if __name__ == "__main__":
    HOST = sys.argv.pop(1)
    FORKS = Forks(sys.argv.pop(1), sys.argv.pop(1))
    try:
        unittest.main()
    finally:
        FORKS.close()
