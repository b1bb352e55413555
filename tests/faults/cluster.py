# SPDX-License-Identifier: MIT
"""script/faults cluster: kills workers, the scheduler and the client of a run over tiles at random moments, with the scratch in a folder and in
a bucket (a server of S3 on this machine), stops a worker, takes the scratch away for a while, and fills it. After each, the same command ends with the bytes of one process, or says in one sentence what to do, and leaves nothing in the scratch."""

from __future__ import annotations

import argparse
import os
import pathlib
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PIPELINE = "knn(k=8) | sor | where(outlier == 0) | reneighbor | normals"


class Broken(Exception):
    pass


def arguments():
    parser = argparse.ArgumentParser(prog="script/faults cluster", description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--points", type=int, default=1_000_000, help="of the cloud (default 1000000)")
    parser.add_argument("--workers", type=int, default=30, help="kill -9 of a worker (default 30)")
    parser.add_argument("--clients", type=int, default=10, help="kill -9 of the client (default 10)")
    parser.add_argument("--schedulers", type=int, default=3, help="kill -9 of the scheduler (default 3)")
    parser.add_argument("--bucket", type=int, default=10, help="kill -9 of a worker, and half as many of the client, with the scratch in a bucket (default 10)")
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


class Bucket:
    """A bucket of a server of S3 (moto), for which this process and those that it starts have credentials."""

    URL = "s3://bucket/scratch/"

    def __init__(self) -> None:
        with socket.socket() as unused:
            unused.bind(("127.0.0.1", 0))
            port = unused.getsockname()[1]
        self._server = subprocess.Popen([sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(port)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        endpoint = f"http://127.0.0.1:{port}"
        os.environ.update(AWS_ACCESS_KEY_ID="key", AWS_SECRET_ACCESS_KEY="secret", AWS_REGION="us-east-1", AWS_ENDPOINT_URL=endpoint)
        import boto3

        self._client = boto3.client("s3", endpoint_url=endpoint, region_name="us-east-1")
        for _ in range(100):
            try:
                self._client.create_bucket(Bucket="bucket")
                return
            except Exception:  # noqa: BLE001 - the server is not there yet
                time.sleep(0.1)
        raise Broken("the server of S3 does not start")

    def names(self) -> list[str]:
        return [found["Key"] for found in self._client.list_objects_v2(Bucket="bucket").get("Contents", [])]

    def stop(self) -> None:
        self._server.kill()


class Cluster:
    """A scheduler, and workers that start again when they end."""

    def __init__(self, folder: pathlib.Path, package: pathlib.Path) -> None:
        self._folder, self._port = folder, 0
        self._environment = {**os.environ, "PYTHONPATH": str(package)}
        self.start_scheduler()
        self.workers = [self._worker() for _ in range(2)]

    def start_scheduler(self) -> None:
        said = open(self._folder / "scheduler.txt", "w+", encoding="utf-8")
        port = ["--port", str(self._port)] if self._port else ["--port", "0"]
        self.scheduler = subprocess.Popen([sys.executable, "-m", "distributed.cli.dask_scheduler", "--no-dashboard", "--host", "127.0.0.1", *port], stderr=said, env=self._environment)
        for _ in range(200):
            found = re.search(r"Scheduler at:\s+(tcp://\S+:(\d+))", (self._folder / "scheduler.txt").read_text())
            if found:
                self.address, self._port = found[1], int(found[2])
                return
            time.sleep(0.1)
        raise Broken("the scheduler does not start")

    def _worker(self) -> subprocess.Popen:
        said = open(self._folder / "workers.txt", "a", encoding="utf-8")
        return subprocess.Popen([sys.executable, "-m", "distributed.cli.dask_worker", self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard",
                                 "--death-timeout", "60", "--local-directory", str(self._folder)], stderr=said,
                                env=self._environment)

    def keep_workers(self) -> None:
        self.workers = [worker if worker.poll() is None else self._worker() for worker in self.workers]

    def wait_for_a_worker(self) -> None:
        """A run that starts while no worker is known to the scheduler is refused, which is right and not what is tried here."""
        import distributed

        with distributed.Client(self.address, set_as_default=False) as client:
            client.wait_for_workers(1, timeout=60)

    def kill_worker(self, number: int) -> None:
        self.workers[number].kill()
        self.workers[number].wait()
        self.keep_workers()

    def kill_scheduler(self) -> None:
        self.scheduler.kill()
        self.scheduler.wait()
        self.start_scheduler()
        for worker in self.workers:
            worker.kill()
            worker.wait()
        self.keep_workers()

    def stop(self) -> None:
        for process in (*self.workers, self.scheduler):
            process.kill()


class Runs:
    def __init__(self, options, folder: pathlib.Path, cluster: Cluster) -> None:
        self._options, self._folder, self._cluster = options, folder, cluster
        self.bucket: Bucket | None = None  #: with the scratch, if it is not in a folder
        self._environment = {**os.environ, "POINTSWEEP_PYTHON": sys.executable, "PYTHONPATH": str(options.build / "python")}
        tool = options.build / "cli/pointsweep"
        subprocess.run([tool, "generate", "terrain", folder / "all.ply", "-n", str(options.points), "--outliers", "0.001", "--outlier-box", "2", "--quiet"], check=True)
        subprocess.run([tool, "tile", folder / "all.ply", f"{folder / 'tiles'}/", "--size", "250", "--quiet"], check=True)
        subprocess.run([tool, "run", folder / "tiles", f"{folder / 'one'}/", "--pipeline", PIPELINE, "--quiet"], check=True)

    def start(self, scratch: pathlib.Path | None = None, *words: str) -> subprocess.Popen:
        self._cluster.wait_for_a_worker()
        return subprocess.Popen([self._options.build / "cli/pointsweep", "run", self._folder / "tiles", f"{self._folder / 'many'}/", "--pipeline", PIPELINE,
                                 "--dask", self._cluster.address, "--scratch", scratch or (Bucket.URL if self.bucket else self._folder / "scratch"), "--memory", "256M", *words],
                                stderr=subprocess.PIPE, text=True, env=self._environment)

    def finish(self, run: subprocess.Popen) -> None:
        """Waits for the run, which has to succeed."""
        _, said = run.communicate(timeout=600)
        if run.returncode != 0:
            raise Broken(f"status {run.returncode}: {said}")
        self.expect_same()

    def is_finished(self) -> bool:
        """Returns whether a client that was killed had written all outputs and begun to empty the scratch."""
        scratch = self._folder / "scratch"
        left = self.bucket.names() if self.bucket else os.listdir(scratch) if scratch.exists() else []
        return (self._folder / "many").exists() and not any(name.endswith("request.pickle") for name in left)

    def expect_same(self) -> None:
        one, many = self._folder / "one", self._folder / "many"
        names = sorted(os.listdir(one))
        if sorted(os.listdir(many)) != names:
            raise Broken("the folder of outputs holds other files than that of one process")
        for name in names:
            if (one / name).read_bytes() != (many / name).read_bytes():
                raise Broken(f"{name} differs from that of one process")
        scratch = self._folder / "scratch"
        if scratch.exists() and os.listdir(scratch):
            raise Broken(f"the scratch holds {os.listdir(scratch)}")
        if self.bucket and self.bucket.names():
            raise Broken(f"the scratch holds {self.bucket.names()}")
        shutil.rmtree(many)


def expect_sentence(said: str, wanted: str) -> None:
    errors = [line for line in said.splitlines() if line.startswith("error:")]
    if len(errors) != 1 or wanted not in errors[0] or "Traceback" in said:
        raise Broken(f"instead of one sentence with '{wanted}': {said}")


def kill_workers(runs: Runs, cluster: Cluster, times: int, chance: random.Random) -> int:
    killed = 0
    while killed < times:
        run = runs.start()
        while run.poll() is None and killed < times:
            time.sleep(chance.uniform(0.5, 3))
            if run.poll() is None:
                cluster.kill_worker(chance.randrange(2))
                killed += 1
        runs.finish(run)
    return killed


def kill_clients(runs: Runs, times: int, chance: random.Random) -> int:
    for _ in range(times):
        run = runs.start(None, "--take-over")
        time.sleep(chance.uniform(1, 8))
        run.send_signal(signal.SIGKILL)
        run.communicate()
        if run.returncode == 0 or runs.is_finished():  # it was faster
            runs.expect_same()
    runs.finish(runs.start(None, "--take-over"))
    return times


def kill_schedulers(runs: Runs, cluster: Cluster, options, chance: random.Random) -> int:
    for _ in range(options.schedulers):
        run = runs.start()
        time.sleep(chance.uniform(3, 7))
        cluster.kill_scheduler()
        _, said = run.communicate(timeout=300)
        if run.returncode == 0:
            runs.expect_same()
            continue
        expect_sentence(said, "the scheduler is gone")
    run = runs.start()
    _, said = run.communicate(timeout=600)
    if run.returncode != 0:
        raise Broken(said)
    runs.expect_same()
    return options.schedulers


def use_bucket(runs: Runs, cluster: Cluster, bucket: Bucket | None, options, chance: random.Random) -> str:
    if bucket is None:
        return "not tried: this build reads no URLs, or moto[server] is not installed"
    runs.bucket = bucket
    runs.finish(runs.start())
    workers = kill_workers(runs, cluster, options.bucket, chance)
    return f"kill -9 of workers: {workers}, of the client: {kill_clients(runs, options.bucket // 2, chance)}"


def bucket_if_possible(options) -> Bucket | None:
    said = subprocess.run([options.build / "cli/pointsweep", "--version"], capture_output=True, text=True, check=True).stdout
    try:
        import moto  # noqa: F401
    except ImportError:
        return None
    return Bucket() if re.search(r"URLs\s+http", said) else None


def fill_scratch(runs: Runs, folder: pathlib.Path) -> str:
    """A scratch on a small disk, which is only possible for root."""
    disk = folder / "disk"
    disk.mkdir()
    if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=8M", "tmpfs", disk], capture_output=True).returncode != 0:
        return "not tried: a small disk cannot be mounted"
    try:
        _, said = runs.start(disk / "scratch").communicate(timeout=300)
        expect_sentence(said, "bytes free, and the run puts up to")
    finally:
        subprocess.run(["umount", disk], check=True)
    return "refused before the work"


def wait_for_a_task(run: subprocess.Popen, folder: pathlib.Path) -> None:
    """Waits until the scratch in a folder notes that a task is done."""
    while not (folder / "scratch/done.jsonl").exists() and run.poll() is None:
        time.sleep(0.01)


def stop_worker(runs: Runs, cluster: Cluster, folder: pathlib.Path) -> str:
    """A worker that does not answer, and is not gone: its tasks go to the other one after a minute."""
    run = runs.start()
    wait_for_a_task(run, folder)
    cluster.workers[0].send_signal(signal.SIGSTOP)
    start = time.monotonic()
    runs.finish(run)
    cluster.kill_worker(0)
    return f"the run has ended after {time.monotonic() - start:.0f} s"


def move_scratch_away(runs: Runs, folder: pathlib.Path, chance: random.Random) -> str:
    """A scratch that is gone for a while, as after a fault of the network."""
    told = 0
    for _ in range(5):
        run = runs.start()
        wait_for_a_task(run, folder)
        time.sleep(chance.uniform(0, 0.5))
        if not (folder / "scratch").exists():
            runs.finish(run)
            continue
        (folder / "scratch").rename(folder / "elsewhere")
        time.sleep(chance.uniform(0.1, 3))
        (folder / "elsewhere").rename(folder / "scratch")
        _, said = run.communicate(timeout=600)
        if run.returncode == 0:
            runs.expect_same()
            continue
        told += 1
        expect_sentence(said, "")
        runs.finish(runs.start(None, "--take-over"))
    return f"5 times, of which {told} ended the run with a sentence"


def fill_disk_meanwhile(runs: Runs, folder: pathlib.Path) -> str:
    """A disk that another program fills while the run works."""
    disk = folder / "full"
    disk.mkdir()
    if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=300M", "tmpfs", disk], capture_output=True).returncode != 0:
        return "not tried: a small disk cannot be mounted"
    try:
        run = runs.start(disk / "scratch")
        while not (disk / "scratch/done.jsonl").exists() and run.poll() is None:
            time.sleep(0.01)
        with open(disk / "other", "wb", buffering=0) as other:
            try:
                while other.write(bytes(1 << 20)):
                    pass
            except OSError:
                pass
        _, said = run.communicate(timeout=600)
        (disk / "other").unlink()
        if run.returncode == 0:
            runs.expect_same()
            return "the run was faster"
        expect_sentence(said, "")
        runs.finish(runs.start(disk / "scratch"))
    finally:
        subprocess.run(["umount", disk], check=True)
    return "one sentence, and the same command went on"


def main() -> None:
    options = arguments()
    chance = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        bucket = bucket_if_possible(options)
        cluster = Cluster(folder, options.build / "python")
        try:
            runs = Runs(options, folder, cluster)
            runs.finish(runs.start())
            print("a run without faults has the bytes of one process", flush=True)
            print(f"kill -9 of workers: {kill_workers(runs, cluster, options.workers, chance)}", flush=True)
            print(f"kill -9 of the client: {kill_clients(runs, options.clients, chance)}", flush=True)
            print(f"kill -9 of the scheduler: {kill_schedulers(runs, cluster, options, chance)}", flush=True)
            print(f"a worker that hangs: {stop_worker(runs, cluster, folder)}", flush=True)
            print(f"a scratch that is gone for a while: {move_scratch_away(runs, folder, chance)}", flush=True)
            print(f"a scratch that is filled meanwhile: {fill_disk_meanwhile(runs, folder)}", flush=True)
            print(f"a scratch in a bucket: {use_bucket(runs, cluster, bucket, options, chance)}", flush=True)
            print(f"a scratch that is too small: {fill_scratch(runs, folder)}", flush=True)
        except Broken as broken:
            sys.exit(f"script/faults cluster: {broken}")
        finally:
            cluster.stop()
            if bucket:
                bucket.stop()


if __name__ == "__main__":
    main()
