# SPDX-License-Identifier: MIT
"""The threads that call operators: each keeps its `threading.local` values for the length of a run, and no longer."""

import gc
import subprocess
import sys
import threading
import weakref

import numpy as np
import pytest

import pointsweep as ps

XYZ = np.random.default_rng(21).random((3000, 3))


class Kept:
    """What an operator keeps in each thread."""


def counting(fails_after=None):
    """An operator with small batches, and the values that its threads have made."""
    local, made, calls = threading.local(), [], []

    @ps.operator(makes={"z2": "f8"}, neighbors=False)
    def z2(p):
        calls.append(len(p))
        if not hasattr(local, "value"):
            local.value = Kept()
            made.append(weakref.ref(local.value))
        if fails_after is not None and len(calls) > fails_after:
            raise LookupError("enough")
        return p.xyz[:, 2] ** 2

    z2._most_places = 20
    return z2, made, calls, local


def living(made):
    gc.collect()
    return sum(value() is not None for value in made)


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_each_thread_keeps_its_values_for_the_length_of_a_run(threads):
    z2, made, calls, local = counting()
    for runs in (1, 2):
        assert np.array_equal(ps.run(XYZ, z2, threads=threads)["z2"], XYZ[:, 2] ** 2)
        assert len(calls) > 100 * runs and runs <= len(made) <= threads * runs
        assert living(made) == 0


def test_runs_at_the_same_time_have_threads_of_their_own():
    found = {}

    def work(i):
        z2, made, calls, local = counting()
        same = ps.run(XYZ, z2, threads=2)["z2"].tobytes() == (XYZ[:, 2] ** 2).tobytes()
        found[i] = same, len(calls) > 100, len(made) <= 2, living(made)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    [t.start() for t in threads], [t.join() for t in threads]
    assert found == {i: (True, True, True, 0) for i in range(4)}


def test_nothing_is_kept_after_a_run_that_fails():
    z2, made, calls, local = counting(fails_after=10)
    with pytest.raises(LookupError, match="enough"):
        ps.run(XYZ, z2, threads=2)
    assert 1 <= len(made) <= 2 and living(made) == 0


def test_nothing_is_kept_after_a_run_that_is_interrupted():
    z2, made, calls, local = counting()
    begun = threading.Event()
    plain = z2.function

    def slow(p):
        begun.set()
        return plain(p)

    def stop(phase, done, total):
        if begun.is_set():
            raise KeyboardInterrupt

    z2.function = slow
    with pytest.raises(KeyboardInterrupt):
        while True:
            ps.run(XYZ, z2, threads=2, progress=stop)
    assert living(made) == 0


def test_a_run_inside_of_an_operator_has_threads_of_its_own():
    inner, made, calls, local = counting()

    @ps.operator(makes={"inner": "f8"}, neighbors=False)
    def outer(p):
        return ps.run(p.xyz, inner, threads=2)["z2"]

    assert np.array_equal(ps.run(XYZ, outer, threads=2)["inner"], XYZ[:, 2] ** 2)
    assert living(made) == 0


def test_pyproj_transforms_points_in_all_threads():
    pyproj = pytest.importorskip("pyproj")
    to_degrees = pyproj.Transformer.from_crs(25832, 4326, always_xy=True)

    @ps.operator(makes={"degrees": ("f8", 2)}, neighbors=False)
    def degrees(p):
        return np.column_stack(to_degrees.transform(p.xyz[:, 0], p.xyz[:, 1]))

    degrees._most_places = 500
    xyz = XYZ * 1000 + [500000, 5400000, 0]
    expected = np.column_stack(to_degrees.transform(xyz[:, 0], xyz[:, 1]))
    assert np.array_equal(ps.run(xyz, degrees, threads=2)["degrees"], expected)


@pytest.mark.parametrize("points", [1_000, 2_000_000])
def test_a_run_in_a_daemon_thread_does_not_abort_the_process_at_its_end(points):
    program = f"""
import threading, time
import numpy as np
import pointsweep as ps
xyz = np.random.default_rng(1).random(({points}, 3))
def go():
    while True:
        ps.normals(xyz, k=8)
threading.Thread(target=go, daemon=True).start()
end = time.time() + 0.3
while time.time() < end:
    sum(range(1000))
"""
    for _ in range(10):
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
