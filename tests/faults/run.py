# SPDX-License-Identifier: MIT
"""Makes every file operation of small runs fail, one after the other, and kills runs at every place; see docs/reliability.md.

A run must end with status 0 and the right output, or with status 1, one sentence, and no output at all (or a whole one:
statistics are written last). Nothing else may lie in the folders afterwards; only what kill -9 left may, until the next
run has removed it."""
import argparse
import collections
import datetime
import json
import os
import pathlib
import random
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import resumed_operators

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
LARGE = 120000  # points: enough to have results spilled as well
SPILLED = "--memory 30M --temp-dir temp"
SPILLED_LAZ = "--memory 40M --temp-dir temp"  # its decoder takes some of it
# Name -> what is generated, the run, its outputs. One thread: then operations come in one order.
RUNS = {
    "normals": ("in.ply", "normals in.ply out.ply", ["out.ply"]),
    "normals, spilled": ("in.ply", f"normals in.ply out.ply {SPILLED}", ["out.ply"]),
    "normals in sweep order to LAS, spilled": ("large.las", "normals large.las out.las --order sweep --memory 36M --temp-dir temp", ["out.las"]),
    "curvature of text, statistics": ("in.xyz", "curvature in.xyz out.csv --stats s.json", ["out.csv", "s.json"]),
    "sort, spilled": ("in.ply", f"sort in.ply out.ply {SPILLED}", ["out.ply"]),
    "curvature, stream and results spilled": (
        "large.ply", "curvature large.ply out.ply --memory 43M --temp-dir temp", ["out.ply"]),
    "neighbors and distances": ("in.ply", "neighbors in.ply out.npy --distances d.npy", ["out.npy", "d.npy"]),
    "LAZ to LAZ, spilled": ("in.laz", f"normals in.laz out.laz {SPILLED_LAZ}", ["out.laz"]),
    "E57 to E57": ("in.e57", "normals in.e57 out.e57", ["out.e57"]),
    "PCD to PCD, rows left out, spilled": (
        "in.pcd", f"run in.pcd out.pcd --pipeline 'sor|where(outlier==0)|voxel(0.05)|features' {SPILLED}", ["out.pcd"]),
    "tiles of LAZ, ordered by their boxes": (
        "tiles/a.laz tiles/b.laz", f"normals tiles/ out/ {SPILLED_LAZ}", ["out/a.laz", "out/b.laz"]),
    "connected points, spilled": (
        "in.ply", "run in.ply out.ply --pipeline 'normals|orient|components|where(component_size>10)|set(intensity=7 where z>0)' "
                  "--memory 64M --temp-dir temp", ["out.ply"]),
    "compared with another cloud, spilled": (
        "in.las other.las", "run in.las out.las --pipeline 'normals|distance_to(other.las)|m3c2(other.las, cylinder=0.2, depth=0.2)' "
                            "--memory 80M --temp-dir temp", ["out.las"]),
}
RESUMED = "--resume done --checkpoint-seconds 0 --memory 64M"
# Of more points, so that there are several slabs; killed, given again, killed again.
RESUMED_POINTS = 100000
RESUMED_RUNS = {
    "normals": ("in.ply", f"normals in.ply out.ply {RESUMED}", ["out.ply"]),
    "normals in sweep order to LAS": ("in.las", f"normals in.las out.las --order sweep {RESUMED}", ["out.las"]),
    "neighbors and distances": ("in.ply", f"neighbors in.ply out.npy --distances d.npy {RESUMED}", ["out.npy", "d.npy"]),
    "curvature of text": ("in.xyz", f"curvature in.xyz out.csv {RESUMED}", ["out.csv"]),
    "fairing, new neighbours": ("in.ply", "run in.ply out.ply --pipeline 'normals|splats|fair|reneighbor|normals' "
                                f"{RESUMED}", ["out.ply"]),
    "sort": ("in.ply", f"sort in.ply out.ply {RESUMED}", ["out.ply"]),
    "tiles of LAZ": ("tiles/a.laz tiles/b.laz", f"normals tiles/ out/ {RESUMED}", ["out/a.laz", "out/b.laz"]),
    "rows left out": ("in.pcd", "run in.pcd out.e57 --pipeline 'sor|where(outlier==0)|poisson(0.01)|normals' "
                      f"{RESUMED}", ["out.e57"]),
    "connected points": ("in.ply", f"run in.ply out.ply --pipeline 'normals|orient|segments|voxel(0.02, keep=centroid)' {RESUMED}", ["out.ply"]),
    "compared with another cloud": ("in.las other.las", "run in.las out.las --pipeline 'distance_to(other.las)|where(cloud_distance>1)|normals' "
                                    "--resume done --checkpoint-seconds 0 --memory 96M", ["out.las"]),
}
# Operations that each kind of fault can meet.
SPACE = {"create", "mkdir", "write", "rename", "link", "truncate", "sync", "close"}
KINDS = {"enospc": SPACE, "eio": None, "short": {"read", "write"}, "eintr": {"read", "write"}, "kill": None, "int": None,
         "term": None}
HARMLESS = {"short", "eintr"}
STATUS_OF_SIGNAL = {"int": 130, "term": 143, "kill": -9}


class Broken(Exception):
    pass


def require(condition, message):
    if not condition:
        raise Broken(message)


class Place:
    """A folder with an input, and what a run in it must give."""

    def __init__(self, options, name, runs=RUNS, points=None):
        self.options, self.name = options, name
        inputs, self.command, self.outputs = runs[name]
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="pointsweep-faults-", dir=options.work))
        (self.folder / "temp").mkdir()
        self.targets = [word for word in shlex.split(self.command) if word in self.outputs or word == "out/"]
        self.input = inputs.split()[0]
        (self.folder / self.input).parent.mkdir(exist_ok=True)
        points = points or (LARGE if self.input.startswith("large") else options.points)
        for number, file in enumerate(inputs.split()):  # side by side, as tiles are
            self.tool(f"generate statue {file} -n {points} --noise 0.002 --origin {4 * number},0,0" if number
                      else f"generate statue {file} -n {points} --noise 0.002")
        self.before = self.files()
        log = self.folder.with_suffix(".log")
        status, error = self.run(FAULTS_LOG=log)
        require(status == 0, f"{name}: does not even run: {error}")
        lines = [line.split() for line in log.read_text().splitlines()]
        self.operations = [words[1] for words in lines]
        require("mkdir" in self.operations or "--temp-dir" not in self.command, f"{name}: spills nothing")
        self.opened_at = max(at for at, words in enumerate(lines, 1) if words[1:3] == ["open", str(self.folder / self.input)])
        log.unlink()
        self.right = {output: self.content(output) for output in self.outputs}
        self.clear()

    def tool(self, arguments):
        subprocess.run([self.options.tool, *arguments.split(), "--quiet"], cwd=self.folder, check=True)

    def run(self, timeout=600, **settings):
        """Status and standard error of one run under the shim."""
        environment = dict(os.environ, LD_PRELOAD=str(self.options.shim), FAULTS_FOLDERS=str(self.folder))
        environment.update({key: str(value) for key, value in settings.items()})
        done = subprocess.run([self.options.tool, *shlex.split(self.command), "--quiet", "--threads", "1"], cwd=self.folder,
                              env=environment, capture_output=True, text=True, timeout=timeout)
        return done.returncode, done.stderr

    def seconds(self):
        """Of one run without a fault."""
        begin = time.monotonic()
        self.run()
        seconds = time.monotonic() - begin
        self.clear()
        return seconds

    def words_with(self, other):
        """The words of the command, some of them replaced."""
        return [other.get(word, word) for word in shlex.split(self.command)]

    def folders_of_outputs(self, folder):
        """Of complete outputs below a folder: a run makes them, and leaves them when an output in them is complete."""
        return {str(pathlib.Path(output).parent) for output in self.outputs if (folder / output).exists()}

    def files(self):
        names = {str(path.relative_to(self.folder)) for path in self.folder.rglob("*")}
        return names - self.folders_of_outputs(self.folder)

    def content(self, name):
        data = (self.folder / name).read_bytes()
        return b"" if name.endswith(".json") else data  # statistics hold times

    def clear(self):
        for path in sorted(self.folder.rglob("*"), reverse=True):  # what is in a folder before the folder
            if str(path.relative_to(self.folder)) not in self.before:
                path.rmdir() if path.is_dir() else path.unlink(missing_ok=True)
        (self.folder / "temp").mkdir(exist_ok=True)

    def require_outputs_whole(self, all_of_them):
        for output in self.outputs:
            present = (self.folder / output).exists()
            require(present or not all_of_them, f"{output} is missing after success")
            require(not present or self.content(output) == self.right[output], f"{output} is wrong")

    def require_clean(self):
        left = self.files() - self.before - set(self.outputs)
        require(not left, f"left behind: {sorted(left)}")


def check_ended(place, kind, status, error):
    """What every run under a fault that is no kill -9 must have done."""
    sentences = error.strip().splitlines()
    if kind in STATUS_OF_SIGNAL:
        require(status in (0, STATUS_OF_SIGNAL[kind]), f"status {status}: {error}")
    else:
        require(status == 0 or (status == 1 and kind not in HARMLESS), f"status {status}: {error}")
    require(status == 0 or (len(sentences) == 1 and sentences[0].startswith("error: ")), f"not one sentence: {error}")
    place.require_outputs_whole(status == 0)
    place.require_clean()


def check_killed(place, status):
    place.require_outputs_whole(status == 0)
    for output in place.outputs:  # as a user would before trying again; leftovers are the tool's to remove
        (place.folder / output).unlink(missing_ok=True)
    status, error = place.run()
    require(status == 0, f"the next run fails: {error}")
    place.require_outputs_whole(True)
    place.require_clean()


def fault(place, kind, at):
    status, error = place.run(FAULTS_KIND=kind, FAULTS_AT=at)
    if kind == "kill":
        check_killed(place, status)
    else:
        check_ended(place, kind, status, error)
    place.clear()
    return "succeeded" if status == 0 else "ended by the signal" if kind in STATUS_OF_SIGNAL else "refused in a sentence"


def some_of(operations, most):
    """All operations, numbered, or `most` of them: the first, the last, and evenly some between."""
    numbered = list(enumerate(operations, 1))
    if len(numbered) <= most:
        return numbered
    ends = most // 3
    middle = numbered[ends:-ends]
    return numbered[:ends] + middle[:: len(middle) // ends + 1] + numbered[-ends:]


def every_operation(place):
    tally = {}
    for kind, meets in KINDS.items():
        outcomes = collections.Counter()
        met = [(at, operation) for at, operation in enumerate(place.operations, 1) if meets is None or operation in meets]
        for at, operation in [met[i - 1] for i, _ in some_of(met, place.options.most)]:
            try:
                outcomes[fault(place, kind, at)] += 1
            except (Broken, subprocess.TimeoutExpired) as broken:
                raise Broken(f"{place.name}: {kind} at operation {at} ({operation}): {broken}") from broken
        tally[kind] = dict(outcomes)
    return tally


def changed_input(place):
    """The input becomes shorter, longer or another, or the temporary folder goes away, before any operation."""
    tally = {}
    target = {"shrink": place.input, "grow": place.input, "rewrite": place.input, "remove": "temp"}
    for kind, name in target.items():
        if kind == "remove" and "temp" not in place.command:
            continue
        outcomes = collections.Counter()
        original = (place.folder / place.input).read_bytes()
        for at, _ in some_of(place.operations, place.options.most):
            status, error = place.run(FAULTS_KIND=kind, FAULTS_AT=at, FAULTS_TARGET=place.folder / name)
            require(status in (0, 1), f"{place.name}: {kind} at {at}: status {status}: {error}")
            require(status == 0 or len(error.strip().splitlines()) == 1, f"{place.name}: {kind} at {at}: {error}")
            try:
                if kind == "remove" or at > place.opened_at:  # what changes before it is opened is another input
                    place.require_outputs_whole(status == 0)
                place.require_clean()
            except Broken as broken:
                raise Broken(f"{place.name}: {kind} at operation {at}: status {status}: {error}{broken}") from broken
            (place.folder / place.input).write_bytes(original)
            time.sleep(0.02)  # some ticks of the file system's clock
            place.clear()
            outcomes["succeeded" if status == 0 else "refused in a sentence"] += 1
        tally[kind] = dict(outcomes)
    return tally


def kills_of(name, kills):
    """Its share of all kills: most go to the run that is long enough to be met everywhere."""
    shares = {run: 6 if what[0].startswith("large") else 1 for run, what in RUNS.items()}
    return -(-kills * shares[name] // sum(shares.values()))


def random_kills(place, count, seed):
    """kill -9 after a random time, with the next run cleaning up; threads as a user has them."""
    generator = random.Random(seed)
    whole = place.seconds()
    outcomes = collections.Counter()
    for _ in range(count):
        process = subprocess.Popen([place.options.tool, *shlex.split(place.command), "--quiet"], cwd=place.folder,
                                   stderr=subprocess.DEVNULL)
        time.sleep(generator.uniform(0, 1.1 * whole))
        process.send_signal(signal.SIGKILL)
        status = process.wait()
        outcomes["left something for the next run" if place.files() - place.before - set(place.outputs)
                 else "left nothing"] += 1
        try:
            check_killed(place, status)
        except Broken as broken:
            raise Broken(f"{place.name}: after a kill -9: {broken}") from broken
        place.clear()
    return dict(outcomes)


def kills_of_resumed(place, count, seed):
    """kill -9 after a random time, the same command again and again until it ends: the right output, and nothing else."""
    generator = random.Random(seed)
    whole = place.seconds()
    outcomes = collections.Counter()
    while outcomes["kills"] < count:
        for output in place.outputs:  # complete, and only the folder was left to be removed
            (place.folder / output).unlink(missing_ok=True)
        process = subprocess.Popen([place.options.tool, *shlex.split(place.command), "--quiet"], cwd=place.folder,
                                   stderr=subprocess.PIPE, text=True)
        try:
            _, error = process.communicate(timeout=generator.uniform(0, 1.5 * whole))
        except subprocess.TimeoutExpired:
            outcomes["kills"] += 1
            process.send_signal(signal.SIGKILL)
            process.communicate()
            place.require_outputs_whole(False)
            outcomes["left a checkpoint"] += (place.folder / "done/checkpoint").exists()
            continue
        require(process.returncode == 0, f"{place.name}: the next run fails: {error}")
        place.require_outputs_whole(True)
        place.require_clean()
        place.clear()
        outcomes["complete"] += 1
    return dict(outcomes)


def interrupted(options, count, seed):
    """SIGINT and SIGTERM in the middle of longer runs: seconds from the signal to the end, and what is left."""
    generator = random.Random(seed)
    with tempfile.TemporaryDirectory(prefix="pointsweep-faults-", dir=options.work) as folder:
        folder = pathlib.Path(folder)
        subprocess.run([options.tool, *f"generate statue in.ply -n {options.long_points} -q".split()], cwd=folder, check=True)
        run = "run in.ply out.ply -q -f --pipeline".split() + ["knn(k=16)|normals|curvature"]
        begin = time.monotonic()
        subprocess.run([options.tool, *run], cwd=folder, check=True)
        whole = time.monotonic() - begin
        (folder / "out.ply").unlink()
        slowest = 0
        for i in range(count):
            process = subprocess.Popen([options.tool, *run], cwd=folder, stderr=subprocess.DEVNULL)
            time.sleep(generator.uniform(0.02, 0.9) * whole)
            process.send_signal(signal.SIGINT if i % 2 else signal.SIGTERM)
            begin = time.monotonic()
            status = process.wait()
            slowest = max(slowest, time.monotonic() - begin)
            require(status in (0, 130, 143), f"interrupted: status {status}")
            left = {path.name for path in folder.iterdir()} - {"in.ply"}
            require(left == ({"out.ply"} if status == 0 else set()), f"an interrupt leaves {left}")
            (folder / "out.ply").unlink(missing_ok=True)
    require(slowest < 1, f"an interrupted run took {slowest:.2f} s to end")
    return {"signals": count, "slowest end after the signal, s": round(slowest, 3)}


def full_disk(place):
    """A real file system of every size from nothing up, where it may be mounted."""
    outcomes = collections.Counter()
    disk = place.folder / "disk"
    disk.mkdir()
    most = 4 * sum(len(data) for data in place.right.values()) // 1024 + 2048  # kB; the second for what is spilled
    sizes = range(16, most, max(64, most // 40))
    try:
        for size in sizes:
            mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "tmpfs", disk], capture_output=True)
            if mounted.returncode != 0:
                return "not mounted here"
            try:
                words = place.words_with({word: f"disk/{word}" for word in place.targets} | {"temp": "disk"})
                done = subprocess.run([place.options.tool, *words, "--quiet"], cwd=place.folder, capture_output=True, text=True)
                left = {str(path.relative_to(disk)) for path in disk.rglob("*")} - place.folders_of_outputs(disk)
                if done.returncode == 0:
                    require(left == set(place.outputs), f"on a disk of {size}k: {left}")
                    require(all((disk / o).read_bytes() == d for o, d in place.right.items() if d), f"wrong on {size}k")
                else:
                    require(done.returncode == 1 and len(done.stderr.strip().splitlines()) == 1, done.stderr)
                    complete = {output for output in left if (disk / output).read_bytes() == place.right.get(output)}
                    require(left == complete, f"on a disk of {size}k: {left}")  # of several outputs, some may be complete
                outcomes["succeeded" if done.returncode == 0 else "refused in a sentence"] += 1
            finally:
                subprocess.run(["umount", disk], check=True)
    finally:
        disk.rmdir()
    return dict(outcomes)


def read_only_folders(place):
    """Output, statistics or temporary files on a file system that is mounted for reading only."""
    outcomes = collections.Counter()
    closed = place.folder / "closed"
    closed.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "ro,size=16k", "tmpfs", closed], capture_output=True)
    if mounted.returncode != 0:
        closed.rmdir()
        return "not mounted here"
    try:
        for closed_word in [*place.targets, *(["temp"] if "temp" in place.command else [])]:
            words = place.words_with({closed_word: f"closed/{closed_word}"})
            done = subprocess.run([place.options.tool, *words, "--quiet"], cwd=place.folder, capture_output=True, text=True)
            require(done.returncode == 1 and len(done.stderr.strip().splitlines()) == 1, f"{closed_word}: {done.stderr}")
            left = place.files() - place.before - {"closed"}
            require(left <= set(place.outputs) - {closed_word}, f"left behind: {left}")
            place.require_outputs_whole(False)
            outcomes["refused in a sentence"] += 1
            for name in left:
                (place.folder / name).unlink()
    finally:
        subprocess.run(["umount", closed], check=True)
        closed.rmdir()
    return dict(outcomes)


def arguments():
    parser = argparse.ArgumentParser(prog="script/faults", description=__doc__.split("\n")[0])
    parser.add_argument("--tool", type=pathlib.Path, default=ROOT / "build/release/cli/pointsweep")
    parser.add_argument("--shim", type=pathlib.Path, default=ROOT / "build/release/tests/libpointsweep_faults.so")
    parser.add_argument("--most", type=int, default=150, help="operations tried of a run with more (default 150)")
    parser.add_argument("--points", type=int, default=4000, help="in each small cloud (default 4000)")
    parser.add_argument("--kills", type=int, default=200, help="random kill -9 in all, at least (default 200)")
    parser.add_argument("--long-points", type=int, default=1000000, help="in the run that is interrupted (default 1000000)")
    parser.add_argument("--seed", type=int, default=1, help="of the random times")
    parser.add_argument("--work", type=pathlib.Path, help="folder to work in (default: the system's temporary folder)")
    parser.add_argument("--resumed-points", type=int, default=2000000, help="of the cloud that every operator goes on with (default 2000000)")
    parser.add_argument("--resumed-memory", default="256M", help="in which every operator goes on (default 256M)")
    parser.add_argument("--only", nargs="+", choices=[*RUNS, "resumed", "operators"], metavar="RUN",
                        help="names of the runs to try; resumed: those that go on after a kill; operators: every operator, killed in every phase")
    parser.add_argument("--output", type=pathlib.Path, help="JSON file for what was tried; what it has of other runs is kept")
    return parser.parse_args()


def main():
    # The shell starts what runs in its background with SIGINT ignored, and the tool would inherit that.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    options = arguments()
    options.tool, options.shim = options.tool.resolve(), options.shim.resolve()
    if options.work:
        options.work.mkdir(parents=True, exist_ok=True)
    names = [name for name in RUNS if not options.only or name in options.only]
    resumed = RESUMED_RUNS if not options.only or "resumed" in options.only else []
    result = json.loads(options.output.read_text()) if options.output and options.output.exists() else {"runs": {}}
    result.update(date=datetime.date.today().isoformat(), points=options.points, large_points=LARGE)
    result["commit"] = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True,
                                      text=True).stdout.strip()
    for name in names:
        place = Place(options, name)
        kills = kills_of(name, options.kills)
        tried = {"operations": dict(collections.Counter(place.operations)), "faults": every_operation(place),
                 "changed": changed_input(place), "random kill -9": random_kills(place, kills, options.seed),
                 "disks of every size": full_disk(place), "read-only folders": read_only_folders(place)}
        result["runs"][name] = tried
        print(f"{name}: {json.dumps(tried)}", flush=True)
        shutil.rmtree(place.folder)
    for index, name in enumerate(resumed):
        place = Place(options, name, RESUMED_RUNS, RESUMED_POINTS)
        kills = options.kills // len(RESUMED_RUNS) + (index < options.kills % len(RESUMED_RUNS))
        tried = kills_of_resumed(place, kills, options.seed + index)
        result["runs"][f"{name}, resumed"] = {"random kill -9": tried}
        print(f"{name}, resumed: {json.dumps(tried)}", flush=True)
        shutil.rmtree(place.folder)
    if not options.only or "operators" in options.only:
        result["operators, resumed"] = resumed_operators.try_all(options)
        print(f"every operator, killed in every phase: {json.dumps(result['operators, resumed'])}", flush=True)
    if not options.only:
        result["interrupts"] = interrupted(options, 20, options.seed)
        print(f"interrupts: {json.dumps(result['interrupts'])}", flush=True)
    order = [*RUNS, *(f"{name}, resumed" for name in RESUMED_RUNS)]
    result["runs"] = {name: result["runs"][name] for name in order if name in result["runs"]}
    if options.output:
        options.output.parent.mkdir(parents=True, exist_ok=True)
        options.output.write_text(json.dumps(result, indent=1) + "\n")
    print("Nothing wrong, partial or left behind.")


if __name__ == "__main__":
    try:
        main()
    except (Broken, resumed_operators.Broken) as broken:
        sys.exit(f"script/faults: {broken}")
