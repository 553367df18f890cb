#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""pm_host against servers that mean no good or never answer, and against what is no file.

usage: hostile_server_test.py PM_HOST [TEST...]
"""
import fcntl
import hashlib
import http.server
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

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ROOT / "scenes" / "regression"
CLEARED = ("OCIO", "http_proxy", "https_proxy", "all_proxy", "HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY")
OPTIONS = ("--size", "16x12", "--passes", "1", "--photons", "1000", "--aa", "1")
# A deaf process is so for tens of seconds; a busy machine makes a quick one late.
SOON = 2.0
# In a network and a file system of its own: a name server that takes questions and gives no answer.
UNANSWERED = """
import os, socket, subprocess, sys
subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
server = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
server.bind(("127.0.0.1", 53))
open(sys.argv[1], "w").write("nameserver 127.0.0.1\\noptions timeout:20\\n")
subprocess.run(["mount", "--bind", sys.argv[1], os.path.realpath("/etc/resolv.conf")], check=True)
process = subprocess.Popen(sys.argv[2:])
server.recv(512)
print(process.pid, flush=True)
sys.exit(process.wait())
"""


class Answer(http.server.BaseHTTPRequestHandler):
    def log_message(self, *_):
        pass

    def do_GET(self):
        test = self.server.test
        test.asked.append(self.path)
        try:
            test.answers.get(self.path, Answer.none)(self)
        except ConnectionError:
            pass

    def none(self):
        self.send_error(404)

    def give(self, body, length=None):
        self.send_response(200)
        self.send_header("Content-Length", str(len(body) if length is None else length))
        self.end_headers()
        self.wfile.write(body)


class Hostile(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="pm hostile ")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.variables = {name: value for name, value in os.environ.items() if name not in CLEARED}
        self.variables["XDG_CACHE_HOME"] = str(self.folder / "cache")
        self.copies = self.folder / "copies"
        self.answers, self.asked = {}, []
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Answer)
        server.test, server.daemon_threads = self, True
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        self.url = f"http://127.0.0.1:{server.server_port}/manifest.json"

    def words(self, scene, *more):
        return [HOST, scene, *OPTIONS, "-o", "a.exr", "--copies", self.copies, *more]

    def run_host(self, words, code, seconds=60):
        done = subprocess.run([str(word) for word in words], cwd=self.folder, env=self.variables, capture_output=True,
                              timeout=seconds, stdin=subprocess.DEVNULL)  # fmt: skip
        said = done.stderr.decode(errors="replace")
        self.assertEqual(done.returncode, code, said)
        return said

    def start(self, words):
        process = subprocess.Popen([str(word) for word in words], cwd=self.folder, env=self.variables,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)  # fmt: skip
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def assert_hears(self, process, what, pid=None, code=143):
        """That SIGTERM ends it soon."""
        begin = time.monotonic()
        os.kill(pid or process.pid, signal.SIGTERM)
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            self.fail(f"{what}: deaf")
        took = time.monotonic() - begin
        print(f"{what}: SIGTERM is heard within {took:.2f} s", file=sys.stderr)
        self.assertEqual(process.returncode, code, what)
        self.assertLess(took, SOON, what)

    def wait_for(self, condition):
        for _ in range(2000):
            if condition():
                return
            time.sleep(0.01)
        self.fail("it never came to that")

    def serve(self, files, **more):
        """A manifest of contents by place; `more` replaces what it says."""
        hashes = {place: hashlib.sha256(content).hexdigest() for place, content in files.items()}
        for place, content in files.items():
            name = hashes[place]
            self.answers[f"/objects/{name[:2]}/{name}"] = lambda to, content=content: to.give(content)
        manifest = {"schema": "pm-pack/1", "scene": "a.obj", "base": "/somewhere", "folders": [], "searchPaths": [],
                    "ocio": None, "environment": None,
                    "files": [{"place": place, "bytes": len(files[place]), "sha256": hashes[place]} for place in sorted(files)],
                    **more}  # fmt: skip
        self.serve_text(json.dumps(manifest))
        return manifest

    def serve_text(self, text):
        self.answers["/manifest.json"] = lambda to: to.give(text.encode())

    def quad(self):
        return (b"v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n")


class Contents(Hostile):
    def test_it_works_at_all(self):
        self.serve({"a.obj": self.quad()})
        self.run_host(self.words(self.url), 0)
        self.assertTrue((self.folder / "a.exr").is_file())

    def test_manifests_that_are_none(self):
        name = "ab" * 32
        file = {"place": "a.obj", "bytes": 1, "sha256": name}
        whole = self.serve({"a.obj": self.quad()})
        for what, text in {
            "nested": "[" * 300_000,
            "nested and closed": "[" * 300_000 + "]" * 300_000,
            "nested objects": '{"a":' * 300_000,
            "nested within": json.dumps(whole)[:-1] + ', "more": ' + "[" * 300_000 + "]" * 300_000 + "}",
            "no text": "\x00\xff" * 1000,
            "empty": "",
            "other schema": json.dumps({**whole, "schema": "pm-pack/2"}),
            "upwards": json.dumps({**whole, "files": [{**file, "place": "../a.obj"}]}),
            "absolute": json.dumps({**whole, "files": [{**file, "place": "/etc/passwd"}]}),
            "folder upwards": json.dumps({**whole, "folders": [".."]}),
            "hash": json.dumps({**whole, "files": [{**file, "sha256": "../" + name[3:]}]}),
            "sums to 0": json.dumps({**whole, "files": [
                *whole["files"], *({"place": f"{i}", "bytes": 2**50, "sha256": f"{i:064x}"} for i in range(2**14))]}),
            "one hash, two lengths": json.dumps({**whole, "files": [
                *whole["files"], {**whole["files"][0], "place": "b", "bytes": 2**49}]}),
        }.items():  # fmt: skip
            with self.subTest(what):
                self.serve_text(text)
                said = self.run_host(self.words(self.url, "--progress", "none"), 3)
                self.assertEqual(len(said.strip().splitlines()), 1, said[:1000])
                self.assertLess(len(said), 1000)
        self.assertEqual(list((self.copies / "objects").rglob("*")) if self.copies.exists() else [], [])

    def test_bodies_that_are_none(self):
        manifest = self.serve({"a.obj": self.quad()})
        place = next(path for path in self.answers if path != "/manifest.json")
        secret = self.folder / "secret"
        secret.write_text("secret")

        def to(address):
            def answer(handler):
                handler.send_response(302)
                handler.send_header("Location", address)
                handler.end_headers()

            return answer

        for what, answer, code in (
            ("longer", lambda handler: handler.give(self.quad() + b"more"), 3),
            ("endless", lambda handler: handler.give(b"#" * 10_000_000, 2**40), 3),
            ("another", lambda handler: handler.give(self.quad()[::-1]), 3),
            ("this machine's", to(f"file://{secret}"), 4),
            ("round and round", to(place), 4),
        ):
            with self.subTest(what):
                self.answers[place] = answer
                self.run_host(self.words(self.url), code)
                self.assertEqual([path for path in self.copies.rglob("*") if path.name == manifest["files"][0]["sha256"]], [])

    def test_limit_holds_while_it_is_fetched(self):
        self.serve({"a.obj": self.quad(), "b.bin": os.urandom(200_000), "c.bin": os.urandom(200_000)})
        said = self.run_host(self.words(self.url, "--copies-limit", str(300_000 / 2**30)), 4)
        self.assertIn("--copies-limit", said)
        self.assertEqual([path for path in self.asked if path.startswith("/objects")], [], "before anything is fetched")

    def test_configs_that_read_elsewhere(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        for what, name in (("device", "/dev/zero"), ("pipe", str(pipe)), ("absolute", "/etc/passwd"),
                           ("upwards", "../" * 20 + "dev/zero")):  # fmt: skip
            for key in ("src", "search_path"):
                with self.subTest(what, key=key):
                    path, src = (".", name) if key == "src" else (os.path.dirname(name), os.path.basename(name))
                    config = (f"ocio_profile_version: 2\nsearch_path: {path}\nroles: {{default: lin, scene_linear: lin}}\n"
                              "displays:\n  s:\n    - !<View> {name: v, colorspace: out}\n"
                              "colorspaces:\n  - !<ColorSpace> {name: lin, isdata: false}\n"
                              f"  - !<ColorSpace>\n    name: out\n    from_scene_reference: !<FileTransform> {{src: {src}}}\n")
                    self.serve({"a.obj": self.quad(), "config.ocio": config.encode()},
                               ocio={"text": "config.ocio", "place": "config.ocio"})
                    said = self.run_host(self.words(self.url, "-o", "a.png"), 3, seconds=20)
                    self.assertIn(os.path.basename(name), said)

    def test_password_is_never_printed(self):
        self.serve({"a.obj": self.quad()})
        secret = "geheim@wort"
        outputs = ("--stats", "stats.json", "--log", "log.txt", "--report", "report.html", "-v")
        for address, code in ((self.url, 0), (self.url + ".none", 4), (self.url.replace("127.0.0.1", "nowhere.invalid"), 4)):
            for user in ("user:geheim%40wort", "geheim", "user:geheim@wort"):
                its = 4 if user.endswith("@wort") else code  # which is no address
                said = self.run_host(self.words(address.replace("//", f"//{user}@"), *(outputs if its == 0 else ["-v"])), its)
                self.assertNotIn("geheim", said)
                self.assertNotIn("wort", said)
        written = [file for file in self.folder.rglob("*") if file.is_file()]
        self.assertGreater(len(written), 4)
        for file in written:
            self.assertNotIn(b"geheim", file.read_bytes(), file)
        farm = [HOST, "farm", self.url.replace("//", f"//u:{secret}@"), *OPTIONS, "-o", "a.exr", "--engine", "commands",
                "--job", "job"]  # fmt: skip
        said = self.run_host(farm, 2)
        self.assertIn(".netrc", said)
        self.assertNotIn("geheim", said)


class Deaf(Hostile):
    def test_resolving(self):
        if subprocess.run(["unshare", "-rmn", "true"], capture_output=True).returncode != 0 or not shutil.which("ip"):
            self.skipTest("no network of one's own can be made here")
        words = ["unshare", "-rmn", sys.executable, "-c", UNANSWERED, self.folder / "resolv.conf",
                 *self.words("http://nobody.example/manifest.json")]  # fmt: skip
        process = self.start(words)
        pid = int(process.stdout.readline())
        time.sleep(0.3)
        self.assert_hears(process, "resolving", pid=pid)

    def test_connecting(self):
        with socket.socket() as server:
            server.bind(("127.0.0.1", 0))
            server.listen(0)
            others = []
            for _ in range(4):  # its queue is full
                other = socket.socket()
                other.setblocking(False)
                other.connect_ex(server.getsockname())
                others.append(other)
            process = self.start(self.words(f"http://127.0.0.1:{server.getsockname()[1]}/manifest.json"))
            time.sleep(2)
            self.assertIsNone(process.poll())
            self.assert_hears(process, "connecting")
            for other in others:
                other.close()

    def test_body(self):
        for what in ("manifest", "content"):
            self.serve({"a.obj": self.quad()})
            place = "/manifest.json" if what == "manifest" else next(p for p in self.answers if "objects" in p)
            end = threading.Event()
            self.addCleanup(end.set)

            def dribble(handler, end=end):
                handler.give(b"{", 2**20 if what == "manifest" else None)
                end.wait(60)

            self.answers[place] = dribble
            if what == "content":
                self.answers[place] = lambda handler, end=end: (handler.send_response(200), handler.end_headers(), end.wait(60))
            self.asked.clear()
            process = self.start(self.words(self.url))
            self.wait_for(lambda: place in self.asked)
            time.sleep(0.2)
            self.assert_hears(process, f"body of a {what}")
            end.set()

    def test_parsing(self):
        entry = '{"place": "%d/%s", "bytes": 1, "sha256": "%064x"},'
        self.serve_text('{"schema": "pm-pack/1", "scene": "a.obj", "base": "/b", "folders": [], "searchPaths": [], "ocio": null,'
                        '"environment": null, "files": [' + "".join(entry % (i, "x", i) for i in range(550_000)) + "]}")
        process = self.start(self.words(self.url))
        self.wait_for(lambda: self.asked)
        time.sleep(0.8)  # it takes some seconds
        if process.poll() is None:
            self.assert_hears(process, "parsing")

    def test_hashing(self):
        shutil.copy(SCENES / "checker.png", self.folder)
        (self.folder / "a.obj").write_bytes(b"mtllib a.mtl\nusemtl m\n" + self.quad())
        (self.folder / "a.mtl").write_text("newmtl m\nmap_Kd checker.png\n")
        with open(self.folder / "checker.png", "r+b") as file:
            file.truncate(16 * 2**30)  # of which nothing is on the disk
        process = self.start([HOST, "pack", "a.obj", "-o", "pack"])
        self.wait_for(lambda: (self.folder / "pack" / "objects").exists())
        time.sleep(0.5)
        self.assert_hears(process, "hashing")

    def test_locks(self):
        manifest = self.serve({"a.obj": self.quad()})
        text = json.dumps(manifest)
        self.run_host(self.words(self.url), 0)
        shutil.rmtree(self.copies / "objects")
        pack = self.copies / "packs" / (hashlib.sha256(text.encode()).hexdigest() + ".json")
        for name, file in (("fetching", self.copies / "lock"), ("making room", pack)):
            with open(file, "r+b") as held:
                fcntl.flock(held, fcntl.LOCK_EX)
                process = self.start(self.words(self.url))
                time.sleep(2)
                self.assertIsNone(process.poll(), process.returncode)
                self.assert_hears(process, f"the lock for {name}")


class NoFiles(Hostile):
    """What may stand where a file is wanted."""

    def test_pipes_and_devices(self):
        os.mkfifo(self.folder / "pipe")
        (self.folder / "a.obj").write_bytes(self.quad())
        parts = self.folder / "parts"
        parts.mkdir()
        os.mkfifo(parts / "pipe.pmpart")
        references = self.folder / "references"
        references.mkdir()
        (self.folder / "suite.json").write_text(json.dumps(
            {"schema": "pm-suite/1", "references": "references", "scenes": [{"name": "a", "scene": "a.obj"}]}))
        (references / "a.exr").write_bytes(b"")
        os.mkfifo(references / "a.json")
        (self.folder / "job").mkdir()
        (self.folder / "job" / ".pm-folder").write_text("pm-folder/1 farm-job\n")
        os.mkfifo(self.folder / "job" / "plan.json")
        render = (HOST, "a.obj", *OPTIONS, "-o", "a.exr")
        for name in ("pipe", "/dev/zero", "references", "/dev/null"):
            for words in (
                (HOST, name), (HOST, "check", name), (HOST, "merge", name, "-o", "b.exr"), (*render, "--checkpoint", name),
                (*render, "--photon-map", name), (*render, "--photon-map", name, "--photons-only"),
                (*render, "--reference", name), (*render, "--environment", name), (*render, "--ocio", name),
                (HOST, "a.obj", *OPTIONS, "-o", name + ".pmpart/a.pmpart"), (*render, "--log", name), (*render, "--stats", name),
                (HOST, "pack", name, "-o", "pack"), (*render, "--texture-cache", "pipe", "--strict", "--plugin", name),
            ):  # fmt: skip
                with self.subTest(" ".join(map(str, words[1:]))):
                    self.refused(words)
        for words in ((HOST, "farm", "a.obj", *OPTIONS, "-o", "a.exr", "--engine", "commands", "--job", "job"),
                      (HOST, "check", "suite.json"), (HOST, "check", "suite.json", "--update", "--because", "x"),
                      (HOST, "watch", "--job", "job", "-o", "b.exr")):  # fmt: skip
            with self.subTest(" ".join(map(str, words[1:]))):
                self.refused(words)
        (self.folder / "a.pm.json").symlink_to("pipe")
        self.refused(render)

    def refused(self, words):
        try:
            done = subprocess.run([str(word) for word in words], cwd=self.folder, env=self.variables, capture_output=True,
                                  timeout=20, stdin=subprocess.DEVNULL)  # fmt: skip
        except subprocess.TimeoutExpired:
            self.fail("it waits for somebody at the other end")
        self.assertIn(done.returncode, (2, 3, 4, 6) if "check" in words else (1, 2, 3, 4), done.stderr)


if __name__ == "__main__":
    HOST = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
