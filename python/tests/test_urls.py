# SPDX-License-Identifier: MIT
"""Inputs and outputs by URL: the bytes of local runs, few requests, and one sentence where a server fails."""

from __future__ import annotations

import base64
import json
import os
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from bucket_servers import BucketServer, Proxy, server_of_azure, server_of_google, server_of_s3
from http_server import Server

import pointsweep as ps
from pointsweep import _core
from pointsweep._scratch import Scratch

needs_urls = pytest.mark.skipif(not _core.reads_urls(), reason="this build reads no URLs (POINTSWEEP_REMOTE=ON)")


class Tool:
    """The tool in a folder; its last sentence is that of an error."""

    def __init__(self, path: str, folder: Path, environment: dict[str, str]) -> None:
        self.path, self.folder, self.environment = path, folder, environment

    def __call__(self, *arguments: object, status: int = 0) -> str:
        command = [self.path, *map(str, arguments)]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, env=self.environment, timeout=120)
        assert done.returncode == status, done.stderr
        return done.stdout + done.stderr


def formats(here: Tool) -> list[str]:
    """The extensions of all formats of point files that the tool writes; .npy is for lists of neighbours alone."""
    written = next(line for line in here("--version").splitlines() if line.split()[:1] == ["writes"])
    return [extension.removeprefix(".") for extension in written.replace(",", " ").split()[1:] if extension != ".npy"]


@pytest.fixture
def here(tool: str, tmp_path: Path) -> Tool:
    """The tool, and a file scan.laz in its folder."""
    run = Tool(tool, tmp_path, dict(os.environ))
    run("generate", "sphere", "scan.laz", "-n", 3000, "--quiet")
    return run


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    with Server(tmp_path) as running:
        yield running


class TestWithoutSupport:
    @pytest.mark.skipif(_core.reads_urls(), reason="this build reads URLs")
    def test_a_url_is_refused_with_the_remedy(self, here: Tool) -> None:
        said = here("info", "https://example.com/a.laz", status=1)
        assert "https://example.com/a.laz: is a URL, which this build of pointsweep cannot read or write" in said

    def test_file_urls_are_paths(self, here: Tool) -> None:
        here("convert", f"file://{here.folder}/scan.laz", f"file://{here.folder}/a%20copy.ply")
        here("convert", "scan.laz", "b.ply")
        assert (here.folder / "a copy.ply").read_bytes() == (here.folder / "b.ply").read_bytes()


@needs_urls
class TestHttp:
    def test_every_format_gives_the_bytes_of_a_local_run(self, here: Tool, server: Server) -> None:
        for name in formats(here):
            here("convert", "scan.laz", f"in.{name}")
            here("normals", f"in.{name}", "local.ply", "-k", 8, "--force")
            here("normals", f"{server.url}/in.{name}", "remote.ply", "-k", 8, "--force")
            assert (here.folder / "local.ply").read_bytes() == (here.folder / "remote.ply").read_bytes(), name

    @pytest.mark.parametrize("option", [["--memory", "128M"], ["--order", "sweep"], ["--threads", "2"]])
    def test_so_do_options(self, here: Tool, server: Server, option: list[str]) -> None:
        here("normals", "scan.laz", "local.laz", *option)
        here("normals", f"{server.url}/scan.laz", "remote.laz", *option)
        assert (here.folder / "local.laz").read_bytes() == (here.folder / "remote.laz").read_bytes()

    def test_empty_and_one_point(self, here: Tool, server: Server) -> None:
        (here.folder / "one.xyz").write_text("1 2 3\n")
        (here.folder / "none.laz").write_bytes(b"")
        assert "points      1" in here("info", f"{server.url}/one.xyz")
        assert "is empty (0 bytes)" in here("info", f"{server.url}/none.laz", status=1)

    def test_info_reads_the_header_alone(self, here: Tool, server: Server) -> None:
        here("generate", "sphere", "large.laz", "-n", 200_000)
        server.told.requests.clear()
        assert "points      200000" in here("info", f"{server.url}/large.laz")
        assert len(server.told.requests) <= 3 and server.told.bytes_sent < 200_000
        server.told.requests.clear()
        assert "mean" in here("info", "--stats", f"{server.url}/large.laz")
        assert server.told.bytes_sent > (here.folder / "large.laz").stat().st_size * 0.9

    def test_a_run_reads_each_byte_about_once_in_large_requests(self, here: Tool, server: Server) -> None:
        here("generate", "sphere", "large.laz", "-n", 500_000)
        size = (here.folder / "large.laz").stat().st_size
        server.told.requests.clear()
        here("convert", f"{server.url}/large.laz", "copy.ply")
        assert server.told.bytes_sent < 1.05 * size
        assert len(server.told.requests) < 6 + size / 500_000

    def test_copc_levels_read_their_own_bytes(self, here: Tool, server: Server) -> None:
        here("generate", "sphere", "plain.laz", "-n", 400_000)
        here("convert", "plain.laz", "large.copc.laz")
        size = (here.folder / "large.copc.laz").stat().st_size
        server.told.requests.clear()
        here("convert", f"{server.url}/large.copc.laz", "coarse.ply", "--depth", 0)
        assert server.told.bytes_sent < 0.5 * size
        here("convert", "large.copc.laz", "local.ply", "--depth", 0)
        assert (here.folder / "coarse.ply").read_bytes() == (here.folder / "local.ply").read_bytes()

    def test_a_virtual_point_cloud_names_its_files_from_its_url(self, here: Tool, server: Server) -> None:
        features = [{"type": "Feature", "assets": {"data": {"href": href}}} for href in ("./scan.laz", f"{server.url}/two.laz")]
        shutil.copy(here.folder / "scan.laz", here.folder / "two.laz")
        (here.folder / "both.vpc").write_text(json.dumps({"type": "FeatureCollection", "features": features}))
        here("convert", f"{server.url}/both.vpc", "remote.ply")
        here("convert", "scan.laz", "two.laz", "-o", "local.ply")
        assert (here.folder / "remote.ply").read_bytes() == (here.folder / "local.ply").read_bytes()

    def test_another_cloud_by_url(self, here: Tool, server: Server) -> None:
        chain = "distance_to(cloud={})"
        here("run", "scan.laz", "local.ply", "--pipeline", chain.format("scan.laz"), "--no-provenance")
        here("run", "scan.laz", "remote.ply", "--pipeline", chain.format(f"{server.url}/scan.laz"), "--no-provenance")
        assert (here.folder / "remote.ply").read_bytes() == (here.folder / "local.ply").read_bytes()

    def test_python(self, here: Tool, server: Server) -> None:
        local, remote = ps.open(here.folder / "scan.laz"), ps.open(f"{server.url}/scan.laz")
        assert remote.files == [f"{server.url}/scan.laz"] and len(remote) == len(local)
        np.testing.assert_array_equal(remote.run(ps.normals())["normal"], local.run(ps.normals())["normal"])
        assert ps.info(f"{server.url}/scan.laz").points == 3000
        assert len(ps.open(Path(f"{server.url}/scan.laz"))) == 3000  # a Path that has lost a slash

    def test_a_file_that_is_replaced_is_opened_anew(self, here: Tool, server: Server) -> None:
        before = ps.open(f"{server.url}/scan.laz")
        here("generate", "sphere", "scan.laz", "-n", 100, "--force")
        time.sleep(2.1)  # a version that was seen lately is not looked for again
        assert len(before) == 3000 and len(ps.open(f"{server.url}/scan.laz")) == 100

    def test_many_files_are_opened_at_once(self, here: Tool, server: Server) -> None:
        names = [f"{i:03}.laz" for i in range(100)]
        for name in names:
            shutil.copy(here.folder / "scan.laz", here.folder / name)
        server.told.seconds = 0.02
        begin = time.monotonic()
        assert len(ps.open([f"{server.url}/{name}" for name in names])) == 300_000
        assert time.monotonic() - begin < 2  # 200 requests of 20 ms


@needs_urls
class TestFaults:
    def test_two_503_are_overcome(self, here: Tool, server: Server) -> None:
        server.told.fail = [503, 503]
        assert "points      3000" in here("info", f"{server.url}/scan.laz")

    @pytest.mark.parametrize(
        "status, words",
        [
            (503, "its server does not answer (503 Service Unavailable, after several attempts)"),
            (403, "access is denied (403 Forbidden)"),
            (404, "no such object (404 Not Found)"),
        ],
    )
    def test_others_end_in_one_sentence(self, here: Tool, server: Server, status: int, words: str) -> None:
        server.told.always = status
        begin = time.monotonic()
        said = here("convert", f"{server.url}/scan.laz", "out.ply", status=1)
        assert f"{server.url}/scan.laz: {words}" in said and said.count("\n") == 1
        assert time.monotonic() - begin < 30 and not (here.folder / "out.ply").exists()

    def test_a_truncated_answer_is_asked_for_again(self, here: Tool, server: Server) -> None:
        server.told.truncate = 1
        assert "points      3000" in here("info", f"{server.url}/scan.laz")
        server.told.tags, server.told.truncate = False, 1
        assert "points      3000" in here("info", f"{server.url}/scan.laz")
        server.told.truncate = 1000
        assert "the answer ended too early, several times" in here("info", f"{server.url}/scan.laz", status=1)

    @pytest.mark.parametrize("after", [1, 2, 3])
    def test_a_file_that_changes_is_refused(self, here: Tool, server: Server, after: int) -> None:
        here("generate", "sphere", "large.ply", "-n", 20_000)
        server.told.change_after = after
        said = here("normals", f"{server.url}/large.ply", "out.ply", status=1)
        assert "has changed since it was opened" in said or "was written to while it was read" in said
        assert not (here.folder / "out.ply").exists()

    def test_a_server_without_ranges_is_refused(self, here: Tool, server: Server) -> None:
        server.told.ranges = False
        assert "gives whole files only" in here("info", f"{server.url}/scan.laz", status=1)

    def test_a_host_that_is_not_there(self, here: Tool) -> None:
        with socket.socket() as unused:
            unused.bind(("127.0.0.1", 0))
            port = unused.getsockname()[1]
        assert "its server does not answer (Connection refused" in here("info", f"http://127.0.0.1:{port}/a.laz", status=1)

    @pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is not installed")
    def test_a_certificate_that_is_not_trusted(self, here: Tool) -> None:
        def openssl(*arguments: str) -> None:
            subprocess.run(["openssl", *arguments], cwd=here.folder, check=True, capture_output=True)

        new_key = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes")
        openssl("req", "-x509", *new_key, "-keyout", "ca.key", "-out", "ca.pem", "-days", "2", "-subj", "/CN=tests")
        openssl("req", *new_key, "-keyout", "own.key", "-out", "own.csr", "-subj", "/CN=tests")
        (here.folder / "extensions").write_text("subjectAltName=IP:127.0.0.1\nbasicConstraints=CA:FALSE\n")
        signing = ("-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial", "-days", "2", "-extfile", "extensions")
        openssl("x509", "-req", "-in", "own.csr", *signing, "-out", "own.pem")
        with Server(here.folder, (here.folder / "own.pem", here.folder / "own.key")) as server:
            said = here("info", f"{server.url}/scan.laz", status=1)
            assert "there is no secure connection to its server (invalid peer certificate: UnknownIssuer)" in said
            here.environment["SSL_CERT_FILE"] = str(here.folder / "ca.pem")
            assert "points      3000" in here("info", f"{server.url}/scan.laz")

    def test_what_http_cannot(self, here: Tool, server: Server) -> None:
        assert "has no listing" in here("info", f"{server.url}/", status=1)
        assert "is read alone" in here("convert", "scan.laz", f"{server.url}/out.laz", status=1)
        assert "its scheme is not http" in here("info", "ftp://example.com/a.laz", status=1)


@needs_urls
class TestSecrets:
    """A password or a signature is used, and stands nowhere."""

    SECRETS = ("hunter2", "0123abcd")

    def require_none(self, *texts: str | bytes) -> None:
        for text in texts:
            for secret in self.SECRETS:
                assert (secret if isinstance(text, str) else secret.encode()) not in text

    def test_a_password(self, here: Tool, server: Server) -> None:
        server.told.password = "Basic " + base64.b64encode(b"me:hunter2").decode()
        url = server.url.replace("//", "//me:hunter2@") + "/scan.laz"
        said = here("normals", url, "out.ply", "--stats", "stats.json", "--report", "report.html")
        self.require_none(said, *(path.read_bytes() for path in here.folder.iterdir()))
        assert server.url + "/scan.laz" in here("info", url)
        self.require_none(here("info", url.replace("hunter2", "hunter2x"), status=1))

    def test_a_signature_that_allows_get_alone(self, here: Tool, server: Server) -> None:
        server.told.signature, server.told.gets_alone = "X-Amz-Date=1&X-Amz-Signature=0123abcd", True
        url = f"{server.url}/scan.laz?{server.told.signature}"
        said = here("normals", url, "out.ply", "--resume", "state")
        self.require_none(said, *(path.read_bytes() for path in here.folder.rglob("*") if path.is_file()))
        self.require_none(here("normals", url + "wrong", "other.ply", status=1))
        stage = f"distance_to(cloud={url})"
        self.require_none(here("run", "scan.laz", "d.ply", "--pipeline", stage), (here.folder / "d.ply").read_bytes())

    def test_python(self, here: Tool, server: Server) -> None:
        server.told.signature = "X-Amz-Signature=0123abcd"
        cloud = ps.open(f"{server.url}/scan.laz?{server.told.signature}")
        self.require_none(repr(cloud), str(cloud.files))
        server.told.signature = "other"
        with pytest.raises(ps.Error) as error:
            cloud.run(ps.normals())
        self.require_none(str(error.value))


@pytest.fixture(scope="module", params=["s3", "gs", "az"])
def bucket_server(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[BucketServer]:
    starts = {"s3": server_of_s3, "gs": lambda: server_of_google(tmp_path_factory.mktemp("key")), "az": server_of_azure}
    with starts[request.param]() as server:
        yield server


@pytest.fixture
def bucket(bucket_server: BucketServer, here: Tool, monkeypatch: pytest.MonkeyPatch) -> str:
    """The URL of a new bucket, for which `here` and this process have credentials."""
    for variable, value in bucket_server.environment.items():
        monkeypatch.setenv(variable, value)
    here.environment.update(bucket_server.environment)
    return bucket_server.new_bucket()


only_s3 = pytest.mark.parametrize("bucket_server", ["s3"], indirect=True)


def content(url: str) -> bytes:
    found = _core.get_object(url)
    assert found is not None, url
    return found


@needs_urls
class TestBuckets:
    def test_every_format_is_written_and_read(self, here: Tool, bucket: str) -> None:
        for name in formats(here):
            here("convert", "scan.laz", f"local.{name}")
            here("convert", "scan.laz", f"{bucket}/dir/a b.{name}")
            assert content(f"{bucket}/dir/a b.{name}") == (here.folder / f"local.{name}").read_bytes(), name
            here("convert", f"local.{name}", "own.ply", "--force", "--no-provenance")
            here("convert", f"{bucket}/dir/a b.{name}", "back.ply", "--force", "--no-provenance")
            assert (here.folder / "back.ply").read_bytes() == (here.folder / "own.ply").read_bytes(), name

    def test_an_output_of_several_parts(self, here: Tool, bucket: str) -> None:
        here("generate", "sphere", "large.ply", "-n", 800_000)
        here("convert", "large.ply", f"{bucket}/large.ply")
        here("convert", "large.ply", "local.ply")
        assert content(f"{bucket}/large.ply") == (here.folder / "local.ply").read_bytes()
        assert "exists already" in here("convert", "large.ply", f"{bucket}/large.ply", status=1)

    def test_an_object_is_replaced_with_force_alone(self, here: Tool, bucket: str) -> None:
        here("convert", "scan.laz", f"{bucket}/a.ply")
        before = content(f"{bucket}/a.ply")
        assert "exists already" in here("normals", "scan.laz", f"{bucket}/a.ply", "-k", 4, status=1)
        assert content(f"{bucket}/a.ply") == before
        here("normals", "scan.laz", f"{bucket}/a.ply", "-k", 4, "--force")
        assert content(f"{bucket}/a.ply") != before

    def test_folders_patterns_and_tiles(self, here: Tool, bucket: str) -> None:
        (here.folder / "tiles").mkdir()
        for seed in range(3):
            here("generate", "sphere", f"tiles/{seed}.laz", "-n", 2000, "--seed", seed)
            _core.put_object(f"{bucket}/tiles/{seed}.laz", (here.folder / f"tiles/{seed}.laz").read_bytes(), True)
        _core.put_object(f"{bucket}/tiles/notes.md", b"no points", True)
        here("normals", "tiles/", "local/")
        assert "is no point file and is left out" in here("normals", f"{bucket}/tiles/", f"{bucket}/out/")
        here("normals", f"{bucket}/tiles/[0-1].laz", f"{bucket}/two/")
        assert _core.list_objects(f"{bucket}/two/") == [f"{bucket}/two/{seed}.laz" for seed in range(2)]
        for seed in range(3):
            assert content(f"{bucket}/out/{seed}.laz") == (here.folder / f"local/{seed}.laz").read_bytes()
        assert "is also the folder of inputs" in here("normals", f"{bucket}/tiles/", f"{bucket}/tiles/", status=2)
        assert "no file has a name of this pattern" in here("info", f"{bucket}/none/*.laz", status=1)
        assert "that of a folder ends in '/'" in here("info", f"{bucket}/tiles", status=1)
        assert "OK" in here("verify", f"{bucket}/tiles/*.laz", f"{bucket}/out/")
        here("tile", f"{bucket}/tiles/*.laz", f"{bucket}/cut/", "--size", 1)
        here("tile", "tiles/", "cut/", "--size", 1)
        for file in (here.folder / "cut").iterdir():
            assert content(f"{bucket}/cut/{file.name}") == file.read_bytes()
        assert "holds point files already" in here("tile", f"{bucket}/tiles/*.laz", f"{bucket}/cut/", "--size", 1, status=1)

    def test_python(self, here: Tool, bucket: str) -> None:
        ps.run(here.folder / "scan.laz", ps.density(), to=f"{bucket}/one.laz")
        ps.run(here.folder / "scan.laz", ps.density(), to=here.folder / "one.laz")
        assert content(f"{bucket}/one.laz") == (here.folder / "one.laz").read_bytes()
        ps.open(f"{bucket}/*.laz").run(ps.curvature(), to=f"{bucket}/out/")
        assert len(ps.open(f"{bucket}/out/")) == 3000

    @only_s3
    def test_credentials(self, here: Tool, bucket: str) -> None:
        here("convert", "scan.laz", f"{bucket}/a.ply")
        wrong = bucket.replace("//", "//key:hunter2@")
        said = here("info", f"{wrong}/a.ply", status=1)
        assert "credentials in the address of a bucket are not used" in said and "hunter2" not in said
        del here.environment["AWS_ACCESS_KEY_ID"], here.environment["AWS_SECRET_ACCESS_KEY"]
        here.environment["AWS_SKIP_SIGNATURE"] = "true"
        assert "access is denied" in here("info", f"{bucket}/a.ply", status=1)

    @only_s3
    def test_an_upload_that_fails_leaves_nothing(self, here: Tool, bucket: str, tmp_path: Path) -> None:
        here("generate", "sphere", "large.ply", "-n", 800_000)
        with Proxy(here.environment["AWS_ENDPOINT_URL"], puts=2) as proxy:
            here.environment["AWS_ENDPOINT_URL"] = proxy.url
            said = here("convert", "large.ply", f"{bucket}/large.ply", status=1)
        assert "its server does not answer (503" in said
        assert _core.object_state(f"{bucket}/large.ply") is None

    def test_a_run_goes_on_where_it_was(self, here: Tool, bucket: str) -> None:
        here("convert", "scan.laz", f"{bucket}/in.laz")
        here("normals", f"{bucket}/in.laz", "out.ply", "--resume", "state")
        here("normals", f"{bucket}/in.laz", f"{bucket}/out.ply", "--resume", "state")
        assert content(f"{bucket}/out.ply") == (here.folder / "out.ply").read_bytes()


@needs_urls
class TestClusters:
    """Runs on many machines whose tiles, outputs and scratch are in a bucket."""

    @pytest.fixture
    def tiles(self, here: Tool, bucket: str) -> str:
        (here.folder / "tiles").mkdir()
        for seed in range(3):
            here("generate", "sphere", f"tiles/{seed}.laz", "-n", 2000, "--seed", seed)
            _core.put_object(f"{bucket}/tiles/{seed}.laz", (here.folder / f"tiles/{seed}.laz").read_bytes(), True)
        return f"{bucket}/tiles/"

    def test_all_by_url_give_the_bytes_of_one_process(self, here: Tool, bucket: str, tiles: str) -> None:
        distributed = pytest.importorskip("distributed", reason="distributed is not installed")
        chain = "sor | where(outlier == 0) | reneighbor | density"
        ps.open(here.folder / "tiles").run(chain, to=f"{here.folder}/local/")
        with distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, memory_limit=None, dashboard_address=":0"
        ) as cluster, distributed.Client(cluster) as client:
            ps.open(tiles).run(chain, to=f"{bucket}/out/", client=client, scratch=f"{bucket}/scratch", memory="256M")
        for seed in range(3):
            assert content(f"{bucket}/out/{seed}.laz") == (here.folder / f"local/{seed}.laz").read_bytes()
        assert _core.list_objects(f"{bucket}/scratch/") == []

    def test_a_lease_is_respected_and_taken_over(self, bucket: str) -> None:
        first = Scratch(f"{bucket}/scratch", {"run": 1}, False)
        with pytest.raises(ps.Error, match="works in it since"):
            Scratch(f"{bucket}/scratch/", {"run": 1}, False)
        second = Scratch(f"{bucket}/scratch/", {"run": 1}, True)
        second.note(round=0, tile=1)
        second.close()
        first.lost = True
        first.close()
        with pytest.raises(ps.UsageError, match="holds another run, whose run differ"):
            Scratch(f"{bucket}/scratch", {"run": 2}, False)
        third = Scratch(f"{bucket}/scratch", {"run": 1}, False)
        third.note(round=0, tile=2)
        third.flush()
        assert [fact["tile"] for fact in third.done()] == [1, 2]
        third.remove()
        assert _core.list_objects(f"{bucket}/scratch/") == []
