# SPDX-License-Identifier: MIT
"""A server of HTTP for tests: it serves a folder with ranges, counts what is asked for, and fails as a test tells it."""

from __future__ import annotations

import hashlib
import ssl
import threading
import time
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import unquote, urlsplit


@dataclass
class Behavior:
    """What the server does, and what it was asked for."""

    fail: list[int] = field(default_factory=list)  # statuses of the next answers
    always: int = 0  # status of all answers
    truncate: int = 0  # answers that end in the middle
    ranges: bool = True
    gets_alone: bool = False  # HEAD is forbidden, as for signed addresses
    password: str = ""  # 'Basic ...' that requests must have
    signature: str = ""  # query that requests must have
    tags: bool = True
    seconds: float = 0  # before each answer
    requests: list[tuple[str, str, int]] = field(default_factory=list)  # method, path, bytes sent
    change_after: int = -1  # requests after which all files have another ETag

    @property
    def bytes_sent(self) -> int:
        return sum(sent for _, _, sent in self.requests)


class Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    folder: Path
    behavior: Behavior

    def log_message(self, *_: object) -> None:
        pass

    def do_HEAD(self) -> None:
        self.answer(False)

    def do_GET(self) -> None:
        self.answer(True)

    def refuse(self, status: int, headers: dict[str, str] | None = None) -> None:
        self.behavior.requests.append((self.command, self.path, 0))
        self.send_response(status)
        for name, value in (headers or {}).items():
            self.send_header(name, value)
        self.send_header("Content-Length", "0")
        self.end_headers()

    def answer(self, with_body: bool) -> None:
        told = self.behavior
        address = urlsplit(self.path)
        file = self.folder / unquote(address.path).lstrip("/")
        time.sleep(told.seconds)
        if told.always:
            return self.refuse(told.always)
        if told.fail:
            return self.refuse(told.fail.pop(0))
        if not with_body and told.gets_alone:
            return self.refuse(403)
        if told.password and self.headers.get("Authorization") != told.password:
            return self.refuse(401)
        if told.signature and address.query != told.signature:
            return self.refuse(403)
        if not file.is_file():
            return self.refuse(404)
        status = file.stat()
        changed = 0 <= told.change_after <= len(told.requests)
        tag = '"' + hashlib.md5(f"{status.st_size} {status.st_mtime_ns} {changed}".encode()).hexdigest() + '"'
        if told.tags and self.headers.get("If-Match", tag) != tag:
            return self.refuse(412)
        first, last = 0, status.st_size
        asked = self.headers.get("Range") if told.ranges else None
        if asked:
            begin, end = asked.removeprefix("bytes=").split("-")
            first, last = int(begin), min(int(end) + 1, status.st_size)
            if first >= status.st_size:
                return self.refuse(416, {"Content-Range": f"bytes */{status.st_size}"})
        with open(file, "rb") as opened:
            opened.seek(first)
            body = opened.read(last - first)
        self.send_response(206 if asked else 200)
        if asked:
            self.send_header("Content-Range", f"bytes {first}-{last - 1}/{status.st_size}")
        if told.tags:
            self.send_header("ETag", tag)
        self.send_header("Last-Modified", self.date_time_string(int(status.st_mtime)))
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        if not with_body:
            body = b""
        if told.truncate and body:
            told.truncate -= 1
            body = body[: len(body) // 2]
            self.close_connection = True
        told.requests.append((self.command, self.path, len(body)))
        try:
            self.wfile.write(body)
        except (BrokenPipeError, ConnectionResetError):
            pass


class Server:
    """Serves `folder` at `url` while it is used as a context, with a `certificate` and its key by TLS."""

    def __init__(self, folder: Path, certificate: tuple[Path, Path] | None = None) -> None:
        self.told = Behavior()
        handler = type("Bound", (Handler,), {"folder": folder, "behavior": self.told})
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
        self._server.daemon_threads = True
        self.host = f"127.0.0.1:{self._server.server_address[1]}"
        self.url = f"http://{self.host}"
        if certificate is not None:
            secure = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            secure.load_cert_chain(*certificate)
            self._server.socket = secure.wrap_socket(self._server.socket, server_side=True)
            self.url = f"https://{self.host}"

    def __enter__(self) -> Server:
        threading.Thread(target=self._server.serve_forever, args=[0.01], daemon=True).start()  # seconds until it notices its end
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()
