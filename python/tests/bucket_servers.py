# SPDX-License-Identifier: MIT
"""Servers of buckets for tests: of S3 (moto), of Azure (azurite-blob, if it is installed), and of Google Cloud Storage.

No server for tests answers the XML requests of Google Cloud Storage. They differ from those of S3 in two headers and in
how a path is quoted, so moto answers them behind a proxy that translates these.
"""

from __future__ import annotations

import base64
import hashlib
import hmac
import http.client
import json
import shutil
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from email.utils import formatdate
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote, unquote

import pytest


class BucketServer(NamedTuple):
    """A server that runs, and what a process has to know for it."""

    scheme: str
    address: str
    environment: dict[str, str]

    def new_bucket(self) -> str:
        """Makes a bucket and returns its URL."""
        name = f"test-{time.monotonic_ns()}"
        headers = _signed_for_azure(name) if self.scheme == "az" else {}
        path = f"{_AZURE_ACCOUNT}/{name}?restype=container" if self.scheme == "az" else name
        urllib.request.urlopen(urllib.request.Request(f"{self.address}/{path}", method="PUT", headers=headers)).close()
        return f"{self.scheme}://{name}"


class Proxy:
    """Passes requests on to a server. After the first `puts` requests that put something, if `puts` is given, it answers
    503 to those that follow."""

    def __init__(self, target: str, puts: int | None = None) -> None:
        left = [puts]
        host = target.removeprefix("http://")

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def log_message(self, *_: object) -> None:
                pass

            def do_GET(self) -> None:
                body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
                if self.command == "PUT" and left[0] is not None:
                    if left[0] <= 0:
                        self.send_response(503)
                        self.send_header("Content-Length", "0")
                        return self.end_headers()
                    left[0] -= 1
                to = http.client.HTTPConnection(host)
                to.request(self.command, *_for_s3(self.path, body, dict(self.headers.items())))
                answer = to.getresponse()
                content = answer.read()
                self.send_response(answer.status)
                for name, value in answer.getheaders():
                    if name.lower() not in ("connection", "transfer-encoding", "content-length"):
                        self.send_header(name, value)
                self.send_header("Content-Length", answer.getheader("Content-Length", str(len(content))))
                self.end_headers()
                self.wfile.write(content)

            do_PUT = do_POST = do_HEAD = do_DELETE = do_GET

        self._server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self._server.daemon_threads = True
        self.url = f"http://127.0.0.1:{self._server.server_address[1]}"
        threading.Thread(target=self._server.serve_forever, args=[0.01], daemon=True).start()

    def __enter__(self) -> Proxy:
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()


def _for_s3(path: str, body: bytes, headers: dict[str, str]) -> tuple[str, bytes, dict[str, str]]:
    """Translates a request to Google Cloud Storage into one to S3. A request to S3 stays as it is."""
    if not headers.get("authorization", "").startswith("AWS4"):
        headers["authorization"] = "AWS4-HMAC-SHA256 Credential=key/20200101/us-east-1/s3/aws4_request, SignedHeaders=host, Signature=0"
        place, _, query = path.partition("?")
        path = f"{quote(unquote(place))}?{query}"
    if headers.pop("x-goog-if-generation-match", None) == "0":  # the object must not exist yet
        headers["If-None-Match"] = "*"
    return path, body, headers


# The account that every Azurite has, and its published key.
_AZURE_ACCOUNT = "devstoreaccount1"
_AZURE_KEY = "Eby8vdM02xNOcqFlqUwJPLlmEtlCDXJ1OUzFT50uSRZ6IFsuFq2UVErCz4I6tq/K1SZFPTOtr/KBHBeksoGMGw=="


def _signed_for_azure(name: str) -> dict[str, str]:
    """Returns the headers of a request that makes a container."""
    headers = {"x-ms-date": formatdate(usegmt=True), "x-ms-version": "2021-08-06"}
    lines = ["PUT", *[""] * 11, *(f"{key}:{value}" for key, value in headers.items())]
    text = "\n".join([*lines, f"/{_AZURE_ACCOUNT}/{_AZURE_ACCOUNT}/{name}", "restype:container"])
    signature = hmac.new(base64.b64decode(_AZURE_KEY), text.encode(), hashlib.sha256).digest()
    return {**headers, "Authorization": f"SharedKey {_AZURE_ACCOUNT}:{base64.b64encode(signature).decode()}"}


def _free_port() -> int:
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        return int(unused.getsockname()[1])


@contextmanager
def _running(command: list[str], port: int) -> Iterator[str]:
    """Runs a server, and yields its address once it accepts connections."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        for _ in range(300):
            try:
                socket.create_connection(("127.0.0.1", port)).close()
                break
            except OSError:
                time.sleep(0.1)
        yield f"http://127.0.0.1:{port}"
    finally:
        process.kill()
        process.wait()


@contextmanager
def _moto() -> Iterator[str]:
    pytest.importorskip("moto.server", reason="moto[server] is not installed")
    port = _free_port()
    with _running([sys.executable, "-W", "ignore", "-m", "moto.server", "-H", "127.0.0.1", "-p", str(port)], port) as address:
        yield address


@contextmanager
def server_of_s3() -> Iterator[BucketServer]:
    with _moto() as address:
        yield BucketServer("s3", address, {
            "AWS_ACCESS_KEY_ID": "key",
            "AWS_SECRET_ACCESS_KEY": "hunter2",
            "AWS_REGION": "us-east-1",
            "AWS_ENDPOINT_URL": address,
        })


@contextmanager
def server_of_google(folder: Path) -> Iterator[BucketServer]:
    """`folder`: gets the file of the account's key."""
    with _moto() as address, Proxy(address) as proxy:
        key = folder / "google-key.json"
        key.write_text(json.dumps({
            "gcs_base_url": proxy.url, "disable_oauth": True, "client_email": "", "private_key": "", "private_key_id": ""
        }))
        yield BucketServer("gs", address, {"GOOGLE_SERVICE_ACCOUNT": str(key)})


@contextmanager
def server_of_azure() -> Iterator[BucketServer]:
    program = shutil.which("azurite-blob")
    if program is None:
        pytest.skip("azurite-blob is not installed (npm install --global azurite)")
    port = _free_port()
    command = [program, "--inMemoryPersistence", "--blobPort", str(port), "--silent", "--skipApiVersionCheck", "--disableTelemetry"]
    with _running(command, port) as address:
        yield BucketServer("az", address, {"AZURE_STORAGE_USE_EMULATOR": "true", "AZURITE_BLOB_STORAGE_URL": address})
