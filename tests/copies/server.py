# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""A static server on loopback, python3 -m http.server's own, that notes what is asked for."""
import functools
import http.server
import threading


class Handler(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass

    def do_GET(self):
        note = self.server.note
        with note.lock:
            note.asked.append(self.path)
            left = note.failures.get(self.path, 0)
            note.failures[self.path] = max(left - 1, 0)
            pause = note.pause
        if pause and "/objects/" in self.path:
            pause.wait(30)
        if left:
            self.send_error(503)
        else:
            try:
                super().do_GET()
            except ConnectionError:
                pass  # who asked was killed, or had enough


class Server:
    def __init__(self, folder):
        self.lock, self.asked, self.failures, self.pause = threading.Lock(), [], {}, None
        self.server = http.server.ThreadingHTTPServer(
            ("127.0.0.1", 0), functools.partial(Handler, directory=str(folder)))
        self.server.note = self
        self.thread = threading.Thread(target=self.server.serve_forever, daemon=True)
        self.thread.start()

    def url(self, place="manifest.json"):
        return f"http://127.0.0.1:{self.server.server_port}/{place}"

    def objects(self):
        """The contents that were asked for since the last call."""
        with self.lock:
            asked, self.asked = self.asked, []
        return [path for path in asked if path.startswith("/objects/")]

    def close(self):
        self.server.shutdown()
        self.server.server_close()
        self.thread.join()
