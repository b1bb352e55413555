# SPDX-License-Identifier: MIT
"""The law of --resume: every operator of the registry, killed in every phase, goes on in the same memory to the same bytes."""
import collections
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent / "bench"))
from examples import examples, scaled  # noqa: E402


class Broken(Exception):
    pass


def killed_at(command, killed):
    """Runs until a phase begins that is not among `killed`, adds it and kills the process; None if there is no such phase."""
    reading, writing = os.pipe()
    process = subprocess.Popen([*command, "--progress-fd", str(writing)], stderr=subprocess.PIPE, text=True, pass_fds=(writing,))
    os.close(writing)
    phase = None
    with os.fdopen(reading) as lines:
        for line in lines:
            if phase is None and json.loads(line)["phase"] not in killed:
                phase = json.loads(line)["phase"]
                process.send_signal(signal.SIGKILL)
    _, error = process.communicate()
    if phase is None and process.returncode != 0:
        raise Broken(f"the next run fails: {error.strip()}")
    return phase if process.returncode == -signal.SIGKILL else None


def try_operator(tool, folder, pipeline, memory):
    """The phases in which it was killed."""
    def command(output):
        return [str(word) for word in (tool, "run", folder / "in.ply", output, "--pipeline", pipeline, "--memory", memory, "--quiet",
                                       "--resume", output.with_suffix(".done"), "--checkpoint-seconds", "1", "--no-provenance")]

    whole, output, killed = folder / "whole.ply", folder / "killed.ply", []
    done = subprocess.run(command(whole), capture_output=True, text=True)
    if done.returncode != 0:
        raise Broken(f"does not even run: {done.stderr.strip()}")
    while phase := killed_at(command(output), killed):
        killed.append(phase)
        output.unlink(missing_ok=True)  # complete, and only the folder was left to be removed
    if output.read_bytes() != whole.read_bytes():
        raise Broken(f"killed while {', '.join(killed)}, it gives other bytes")
    left = {path.name for path in folder.iterdir()} - {"in.ply", "other.ply", "whole.ply", "killed.ply"}
    if left:
        raise Broken(f"left behind: {sorted(left)}")
    whole.unlink(), output.unlink()
    return killed


def try_all(options):
    """How often operators were killed in each phase."""
    kills = collections.Counter()
    with tempfile.TemporaryDirectory(prefix="pointsweep-faults-", dir=options.work) as folder:
        folder = pathlib.Path(folder)
        for name, points in (("in", options.resumed_points), ("other", options.resumed_points // 10)):
            made = folder / "made.ply"
            subprocess.run([options.tool, "generate", "terrain", made, "-n", str(points), "--quiet"], check=True)
            scaled(options.tool, [made], folder / f"{name}.ply", ["classification"] if name == "other" else [])
            made.unlink()
        for name, pipeline in examples(options.tool, folder / "other.ply").items():
            try:
                kills.update(try_operator(options.tool, folder, pipeline, options.resumed_memory))
            except Broken as broken:
                raise Broken(f"{name} ({pipeline}), resumed: {broken}") from broken
    return dict(kills)
