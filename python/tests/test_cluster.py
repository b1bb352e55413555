# SPDX-License-Identifier: MIT
"""Runs on the workers of Dask: the bytes of one process, whatever happens on the way."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
import traceback
import warnings
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pointsweep as ps

distributed = pytest.importorskip("distributed", reason="distributed is not installed")

from pointsweep import _cluster, _errors, _part, _places, _scratch  # noqa: E402
from pointsweep.cluster import main  # noqa: E402

pytestmark = pytest.mark.filterwarnings("ignore::pointsweep.PointsweepWarning")

CHAINS = [
    "normals | curvature",
    "sor | where(outlier == 0) | reneighbor | normals",
    "set(x = x + 3, z = 2 * z) | where(row != 7) | features",
]


@pytest.fixture
def tiles(tmp_path: Path) -> Path:
    """Nine square tiles of a wavy surface with outliers, one of them empty."""
    rng = np.random.default_rng(5)
    xy = rng.uniform(0, 30, (20_000, 2))
    z = np.sin(xy[:, 0]) + np.cos(xy[:, 1]) + 0.01 * rng.standard_normal(len(xy))
    z[rng.random(len(xy)) < 0.002] += 20
    points = np.column_stack([xy, z])
    folder = tmp_path / "tiles"
    folder.mkdir()
    for i in range(3):
        for j in range(3):
            here = (points[:, 0] // 10 == i) & (points[:, 1] // 10 == j)
            ps.write(folder / f"{i}{j}.ply", {"xyz": points[here]} if (i, j) != (2, 2) else {"xyz": points[:1] + 29.5})
    return folder


@pytest.fixture(scope="module")
def client() -> Any:
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, memory_limit=None, dashboard_address=":0"
    ) as cluster, distributed.Client(cluster) as connected:
        yield connected


def one_process(tiles: Path, pipeline: str, to: Path) -> None:
    ps.open(tiles).run(pipeline, to=f"{to}/", overwrite=True)


def many(tiles: Path, pipeline: str, to: Path, client: Any, **options: Any) -> ps.Report:
    return ps.open(tiles).run(pipeline, to=f"{to}/", client=client, scratch=to.parent / "scratch", memory="256M", **options)


def assert_same(one: Path, other: Path) -> None:
    names = sorted(path.name for path in one.iterdir())
    assert names == sorted(path.name for path in other.iterdir())
    assert [name for name in names if (one / name).read_bytes() != (other / name).read_bytes()] == []


class Immediate:
    """A client whose workers are this process; `fail(task)` may raise before a task or after it."""

    status = "running"

    class Future:
        status = "finished"

        def __init__(self, value: Any, error: BaseException | None) -> None:
            self._value, self._error = value, error

        def done(self) -> bool:
            return True

        def cancel(self) -> None:
            pass

        def result(self, timeout: float) -> Any:
            if self._error is not None:
                raise self._error
            return self._value

    def __init__(self, before: Any = lambda task: None, after: Any = lambda task, done: None) -> None:
        self._before, self._after = before, after

    def scheduler_info(self, n_workers: int) -> Any:
        return {"workers": {"here": {"host": "here"}}}

    def submit(self, function: Any, request: str, objects: str, task: Any, **_: Any) -> Any:
        try:
            self._before(task)
            done = function(request, objects, task)
            self._after(task, done)
            return self.Future(done, None)
        except Exception as error:  # noqa: BLE001
            return self.Future(None, error)


@pytest.fixture
def immediate(monkeypatch: pytest.MonkeyPatch) -> None:
    @contextmanager
    def connected(client: Any) -> Any:
        yield client

    monkeypatch.setattr(_cluster, "_connected", connected)
    monkeypatch.setattr(distributed, "wait", lambda *_, **__: None)
    monkeypatch.setattr(_part, "_worker", lambda: ("here", 1))


@pytest.mark.parametrize("pipeline", CHAINS)
def test_same_bytes(tiles: Path, tmp_path: Path, client: Any, pipeline: str) -> None:
    one_process(tiles, pipeline, tmp_path / "one")
    report = many(tiles, pipeline, tmp_path / "many", client)
    assert_same(tmp_path / "one", tmp_path / "many")
    assert not (tmp_path / "scratch").exists()
    assert report.points > 10_000


@pytest.fixture
def before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Another cloud of three files, in a folder that pipelines name from where the test works."""
    rng = np.random.default_rng(6)
    folder = tmp_path / "before"
    folder.mkdir()
    for i in range(3):
        xyz = np.column_stack([10 * i + rng.uniform(0, 10, 2_000), rng.uniform(0, 30, 2_000), rng.uniform(-1, 1, 2_000)])
        ps.write(folder / f"{i}.ply", {"xyz": xyz, "classification": rng.integers(1, 9, 2_000).astype("u1")})
    monkeypatch.chdir(tmp_path)
    return folder


SUFFIXES = [".points", ".index", ".state", ".rows", ".results", ".labels", ".components", ".crossings", ".nodes", ".edges", ".marks", ".buckets", ".forest"]
IN_ORDER = [
    "unique | ground(cell=0.5, window=2) | height",
    "voxel(0.4, keep=centroid) | normals | where(row > 100) | poisson(0.7)",
    "knn(k=6) | components | where(component_size > 5) | reneighbor | normals | segments(angle=20)",
    "knn(radius=0.3) | dbscan(eps=0.3, min_points=5) | where(cluster >= 0)",
    "normals | orient | reneighbor(k=5) | normals | orient(viewpoint=[5,5,9])",
    "normals | m3c2(before, cylinder=1, depth=2) | take('before/?.ply', attributes=classification, k=3)",
]


@pytest.mark.parametrize("pipeline", IN_ORDER)
def test_same_bytes_of_operators_in_order(tiles: Path, tmp_path: Path, client: Any, before: Path, pipeline: str) -> None:
    one_process(tiles, pipeline, tmp_path / "one")
    report = many(tiles, pipeline, tmp_path / "many", client)
    assert_same(tmp_path / "one", tmp_path / "many")
    assert not (tmp_path / "scratch").exists()
    assert report.statistics["points_swept_over_own"] > 1


def test_another_cloud_may_not_change(tiles: Path, tmp_path: Path, before: Path, immediate: None) -> None:
    pipeline = "distance_to(before)"
    one_process(tiles, pipeline, tmp_path / "one")

    def stop(task: Any) -> None:
        if task["round"].kind == "sweep":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        many(tiles, pipeline, tmp_path / "many", Immediate(stop))
    (before / "1.ply").touch()
    with pytest.raises(ps.Error, match="1.ply: has changed since the run began"):
        many(tiles, pipeline, tmp_path / "many", Immediate())
    _remove(tmp_path / "scratch")

    def change(task: Any) -> None:
        if task["round"].kind == "other" and task["tile"] == 1:
            (before / "2.ply").touch()

    with pytest.raises(ps.Error, match="2.ply: has changed since the run began"):
        many(tiles, pipeline, tmp_path / "many", Immediate(change))
    _remove(tmp_path / "scratch")
    many(tiles, pipeline, tmp_path / "many", Immediate())
    assert_same(tmp_path / "one", tmp_path / "many")


def test_a_worker_is_killed(tiles: Path, tmp_path: Path, client: Any) -> None:
    pipeline = CHAINS[0]
    one_process(tiles, pipeline, tmp_path / "one")
    killed = threading.Event()

    def progress(phase: str, done: int, total: int) -> None:
        if phase == "sweeping" and not killed.is_set():
            killed.set()
            os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)

    many(tiles, pipeline, tmp_path / "many", client, progress=progress)
    assert killed.is_set()
    assert_same(tmp_path / "one", tmp_path / "many")


def test_removes_what_killed_workers_left_of_the_outputs(tiles: Path, tmp_path: Path, client: Any) -> None:
    with subprocess.Popen(["true"]) as ended:
        pass
    one_process(tiles, CHAINS[0], tmp_path / "one")
    (tmp_path / "many").mkdir()
    names = sorted(path.name for path in (tmp_path / "one").iterdir())
    left = [tmp_path / "many" / f".{name}.{ended.pid}.part" for name in names[:2]]
    other = tmp_path / "many" / f".of_another_run.ply.{ended.pid}.part"
    other.touch()
    left[0].touch()
    many(tiles, CHAINS[0], tmp_path / "many", client, progress=lambda *_: left[1].touch())
    assert not any(path.exists() for path in left)
    assert other.exists()
    other.unlink()
    assert_same(tmp_path / "one", tmp_path / "many")


def test_goes_on_where_a_client_was_stopped(tiles: Path, tmp_path: Path, immediate: None) -> None:
    one_process(tiles, CHAINS[1], tmp_path / "one")
    performed: list[tuple[int, int]] = []
    stops = (3, 5, 14, 23, 31, 46, 49, 100)
    for stop in stops:

        def before(task: Any, stop: int = stop) -> None:
            if len(performed) == stop:
                raise KeyboardInterrupt
            performed.append((task["round_number"], task["tile"]))

        try:
            many(tiles, CHAINS[1], tmp_path / "many", Immediate(before))
        except KeyboardInterrupt:
            continue
        break
    assert len(performed) - len(set(performed)) <= len(stops), "only the task in flight is performed again"
    assert_same(tmp_path / "one", tmp_path / "many")
    assert not any((tmp_path / "scratch").iterdir()), "what a resumed run has found is empty"


@pytest.mark.parametrize("removed", range(6))
def test_a_client_that_is_killed_while_it_empties_the_scratch(
    tiles: Path, tmp_path: Path, immediate: None, monkeypatch: pytest.MonkeyPatch, removed: int
) -> None:
    names: list[str] = []
    remove = _places.Folder.remove

    def remove_until_killed(place: Any, name: str) -> None:
        if len(names) == removed:
            raise KeyboardInterrupt
        names.append(name)
        remove(place, name)

    one_process(tiles, "normals", tmp_path / "one")
    with monkeypatch.context() as killed, pytest.raises(KeyboardInterrupt):
        killed.setattr(_places.Folder, "remove", remove_until_killed)
        many(tiles, "normals", tmp_path / "many", Immediate())
    assert_same(tmp_path / "one", tmp_path / "many")
    try:
        many(tiles, "normals", tmp_path / "many", Immediate(), take_over=True)
    except ps.Error as error:
        assert "exists already" in str(error) and removed > 1
    assert_same(tmp_path / "one", tmp_path / "many")
    assert not (tmp_path / "scratch").exists() or not any((tmp_path / "scratch").iterdir())


def test_damaged_objects_are_made_again(tiles: Path, tmp_path: Path, immediate: None) -> None:
    pipeline = CHAINS[1] + " | segments(angle=20) | orient | where(segment_size > 2)"
    one_process(tiles, pipeline, tmp_path / "one")
    damaged: set[str] = set()

    def after(task: Any, done: Any) -> None:
        if task["tile"] == 4:
            for suffix in SUFFIXES:
                damage(f"{done.left}{suffix}", f"{task['round_number']}{suffix}")

    def before(task: Any) -> None:
        if task["tile"] == 7:
            for path in sorted((tmp_path / "scratch" / "objects").glob("joined-*")):
                if path.name.split("-")[2:] in ([], ["3"]):
                    damage(path.name, f"{task['round_number']} {path.name}")

    def damage(name: str, key: str) -> None:
        path = tmp_path / "scratch" / "objects" / name
        if key not in damaged and path.exists() and path.stat().st_size > 40:
            damaged.add(key)
            content = bytearray(path.read_bytes())
            content[len(content) // 2] ^= 1
            path.write_bytes(content)

    many(tiles, pipeline, tmp_path / "many", Immediate(before, after))
    assert set(SUFFIXES) <= {"." + key.split(".", 1)[1] for key in damaged if "joined" not in key}, damaged
    assert sum("joined" in key for key in damaged) > 3, damaged
    assert_same(tmp_path / "one", tmp_path / "many")


def test_says_what_is_wrong(tiles: Path, tmp_path: Path, immediate: None, monkeypatch: pytest.MonkeyPatch) -> None:
    client, to = Immediate(), tmp_path / "many"
    with pytest.raises(ps.UsageError, match="name it with scratch="):
        ps.open(tiles).run("normals", to=f"{to}/", client=client)
    with pytest.raises(ps.UsageError, match="name a folder"):
        ps.open(tiles).run("normals", to=to / "all.ply", client=client, scratch=tmp_path / "scratch")
    with pytest.raises(ps.UsageError, match="one process"):
        many(tiles, "normals | sample(100)", to, client)
    with pytest.raises(ps.UsageError, match="is for the workers of a client"):
        ps.open(tiles).run("normals", to=f"{to}/", scratch=tmp_path / "scratch")
    assert not (tmp_path / "scratch").exists()

    def change(task: Any) -> None:
        if task["round_number"] == 1:
            os.utime(tiles / "11.ply", (1, 1))

    with pytest.raises(ps.Error, match="11.ply: has changed since the run began"):
        many(tiles, "normals", to, Immediate(change))
    with pytest.raises(ps.UsageError, match="holds another run, whose"):
        many(tiles, "normals", to, client)
    _remove(tmp_path / "scratch")
    _remove(to)
    monkeypatch.setattr(_part, "build", lambda: "0.0 (other)")
    with pytest.raises(ps.Error, match=r"has pointsweep 0\.0 \(other\), the client"):
        many(tiles, "normals", to, client)


def test_another_client_waits_or_takes_over(tiles: Path, tmp_path: Path, immediate: None) -> None:
    one_process(tiles, "normals", tmp_path / "one")

    def second(task: Any) -> None:
        if task["round_number"] == 1 and task["tile"] == 2:
            with pytest.raises(ps.Error, match="works in it since"):
                many(tiles, "normals", tmp_path / "many", Immediate())
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        many(tiles, "normals", tmp_path / "many", Immediate(second))
    lease = tmp_path / "scratch" / "lease.json"
    lease.write_text(json.dumps({"host": "elsewhere", "process": 1, "since": "yesterday"}))
    with pytest.raises(ps.Error, match="process 1 on elsewhere"):
        many(tiles, "normals", tmp_path / "many", Immediate())
    old = time.time() - _scratch.STALE_SECONDS - 1
    os.utime(lease, (old, old))
    many(tiles, "normals", tmp_path / "many", Immediate())
    assert_same(tmp_path / "one", tmp_path / "many")


def test_a_scratch_that_is_too_small_is_refused(
    tiles: Path, tmp_path: Path, immediate: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    import shutil

    usage = shutil.disk_usage(tmp_path)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: usage._replace(free=1000))
    with pytest.raises(ps.Error, match="has 1,000 bytes free, and the run puts up to"):
        many(tiles, "normals", tmp_path / "many", Immediate())


def test_operators_of_python_run_on_workers(tiles: Path, tmp_path: Path, client: Any) -> None:
    scale = 3.0

    @ps.operator(makes={"height": "float32"})
    def heights(points: Any) -> Any:
        return {"height": points.xyz[:, 2] * scale}

    pipeline = ps.normals() | heights
    ps.open(tiles).run(pipeline, to=f"{tmp_path / 'one'}/")
    ps.open(tiles).run(pipeline, to=f"{tmp_path / 'many'}/", client=client, scratch=tmp_path / "scratch", memory="256M")
    assert_same(tmp_path / "one", tmp_path / "many")


@pytest.mark.parametrize("divided", [{"tile": 7, "tile_buffer": 2}, {"split": "part"}])
def test_points_are_divided_among_files(tiles: Path, tmp_path: Path, immediate: None, divided: dict[str, Any]) -> None:
    numbered, one, other, scratch = (tmp_path / name for name in ("numbered", "one", "many", "scratch"))
    ps.open(tiles).run("set(part = floor(z), as=int32)", to=f"{numbered}/")
    ps.open(numbered).write(one / "*.ply", **divided)
    damaged: set[str] = set()

    def before(task: Any) -> None:
        """Damages what the round before has left, and ends a run."""
        objects = [] if task["round"].kind != "gather" else [*scratch.glob("objects/00-000004-*"), *scratch.glob("objects/joined-*")]
        for path in objects:
            if path.suffix not in damaged:
                damaged.add(path.suffix)
                content = bytearray(path.read_bytes())
                content[len(content) // 2] ^= 1
                path.write_bytes(content)
        if len(damaged) == 3 and task["tile"] == 6 and "stopped" not in damaged:
            damaged.add("stopped")
            raise KeyboardInterrupt

    def write(**options: Any) -> ps.Report:
        return ps.open(numbered).write(other / "*.ply", client=Immediate(before), scratch=scratch, **options)

    with pytest.raises(KeyboardInterrupt):
        write(**divided)
    report = write(**divided)
    assert damaged == {"", ".pieces", ".cut", "stopped"}
    assert_same(one, other)
    assert report.points_written == len(ps.open(tiles)) and report.statistics["files"] == len(list(one.iterdir()))
    with pytest.raises(ps.Error, match="holds point files already"):
        write(**divided)
    with pytest.raises(ps.UsageError, match="no stage changes"):
        many(tiles, "normals", tmp_path / "refused", Immediate(), tile=7)


@pytest.mark.skipif("POINTSWEEP_TOOL" not in os.environ, reason="POINTSWEEP_TOOL does not name the tool")
@pytest.mark.parametrize("crs", ["EPSG:2154", "EPSG:2154+5720", "none", "system.prj"])
def test_a_system_stated_to_the_tool(tiles: Path, tmp_path: Path, immediate: None, monkeypatch: pytest.MonkeyPatch, crs: str) -> None:
    """The tool replaces itself by a program of Python, which here is one that keeps the request."""
    (tmp_path / "system.prj").write_text('PROJCS["RGF93 / Lambert-93",GEOGCS["RGF93"],UNIT["metre",1],AUTHORITY["EPSG","2154"]]')
    keeps = tmp_path / "python"
    keeps.write_text(f"#!/bin/sh\ncat /dev/fd/$3 > {tmp_path / 'request'}\n")
    keeps.chmod(0o755)
    command = [os.environ["POINTSWEEP_TOOL"], "normals", tiles, f"{tmp_path / 'many'}/", "--crs", crs]
    subprocess.run([*command, "--dask", "here", "--scratch", tmp_path / "scratch", "--quiet"], check=True, cwd=tmp_path,
                   env={**os.environ, "POINTSWEEP_PYTHON": str(keeps)})
    monkeypatch.setattr(_errors, "_of_tool", False)
    monkeypatch.setattr(warnings, "showwarning", warnings.showwarning)
    assert main({**json.loads((tmp_path / "request").read_text()), "client": Immediate()}) == 0
    command[3] = f"{tmp_path / 'one'}/"
    subprocess.run([*command, "--quiet"], check=True, cwd=tmp_path)
    assert_same(tmp_path / "one", tmp_path / "many")


@pytest.mark.skipif("POINTSWEEP_TOOL" not in os.environ, reason="POINTSWEEP_TOOL does not name the tool")
def test_the_tool_starts_it(tiles: Path, tmp_path: Path) -> None:
    one_process(tiles, "normals", tmp_path / "one")
    command = [os.environ["POINTSWEEP_TOOL"], "normals", tiles, f"{tmp_path / 'many'}/", "--dask", "local", "--memory", "256M"]
    environment = {**os.environ, "POINTSWEEP_PYTHON": sys.executable, "PYTHONPATH": os.pathsep.join(sys.path)}
    refused = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert refused.returncode == 2 and "--scratch DIR" in refused.stderr
    done = subprocess.run([*command, "--scratch", tmp_path / "scratch"], capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    assert "note: wrote" in done.stderr and "9 files" in done.stderr
    assert_same(tmp_path / "one", tmp_path / "many")
    again = subprocess.run([*command, "--scratch", tmp_path / "scratch"], capture_output=True, text=True, env=environment)
    assert again.returncode == 1 and "--force" in again.stderr, "options have the names of the tool"
    missing = subprocess.run(
        [*command, "--scratch", tmp_path / "scratch"], capture_output=True, text=True, env={**environment, "POINTSWEEP_PYTHON": "/nowhere/python"}
    )
    assert missing.returncode == 1 and "pip install pointsweep distributed" in missing.stderr


def _remove(folder: Path) -> None:
    import shutil

    shutil.rmtree(folder)


@pytest.mark.parametrize("error", [ValueError("too steep"), FileNotFoundError(2, "no table", "table.csv")])
def test_an_exception_of_an_operator_is_raised_again_at_once(tiles: Path, tmp_path: Path, client: Any, error: Exception) -> None:
    calls = tmp_path / "calls"

    @ps.operator(makes={"slope": "f4"})
    def slope(p: Any) -> Any:
        with open(calls, "a") as file:
            file.write(".")
        raise error

    with pytest.raises(type(error), match=error.args[-1]) as caught:
        many(tiles, ps.knn(8) | slope, tmp_path / "many", client)
    assert "in slope" in "".join(traceback.format_tb(caught.value.__traceback__))
    assert len(calls.read_text()) <= 9, "a task was performed again"
