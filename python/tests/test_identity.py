# SPDX-License-Identifier: MIT
"""Changes that make a function another one, so that a run with it is not resumed."""

import functools
import os
import subprocess
import sys
import textwrap
import threading

import numpy as np
import pytest

import pointsweep as ps
from pointsweep._identity import identity_of

SHARED = np.arange(3.0)


def digest(function):
    identity = identity_of(function)
    assert identity.unknown == []
    return identity.digest


def captured(value):
    return lambda p: value


def defaulted(value):
    def function(p, factor=value):
        return factor

    return function


def helped(value):
    def helper(p):
        return value

    return lambda p: helper(p) + 1


def partial(value):
    return functools.partial(lambda p, factor: factor, factor=value)


class Model:
    def __init__(self, weights):
        self.weights = weights

    def __call__(self, p):
        return p.xyz @ self.weights


VALUES = [
    (1, 2),
    ("a", "b"),
    ([1.0, [2.0]], [1.0, [3.0]]),
    ({"a": {"b": 1}}, {"a": {"b": 2}}),
    ({1, 2}, {1, 3}),
    (np.arange(5.0), np.arange(5.0) + np.eye(5)[4]),
    (np.arange(4, dtype="u1"), np.arange(4, dtype="i1")),
    (np.arange(4).reshape(2, 2), np.arange(4)),
    (Model(np.zeros(3)), Model(np.ones(3))),
    ({"model": [Model([1, 2])]}, {"model": [Model([1, 3])]}),
    (np.random.default_rng(1), np.random.default_rng(2)),
    (len, max),
    (Model(0).__call__, Model(1).__call__),
]


@pytest.mark.parametrize("way", [captured, defaulted, helped, partial])
@pytest.mark.parametrize(("value", "other"), VALUES)
def test_a_function_is_another_one_with_other_values(way, value, other):
    assert digest(way(value)) != digest(way(other))


@pytest.mark.parametrize("way", [captured, defaulted, helped, partial])
@pytest.mark.parametrize("make", [lambda: [1, {"a": np.arange(4)}], lambda: Model({"w": (1.5, None)}), lambda: {"b", "a", 3}])
def test_a_function_is_the_same_with_equal_values(way, make):
    assert digest(way(make())) == digest(way(make()))


def test_the_code_counts_and_not_where_it_stands():
    one = eval("lambda p: p.xyz[:, 0] + 1")
    assert digest(one) == digest(eval("\n\nlambda p: p.xyz[:, 0] + 1"))
    assert digest(one) != digest(eval("lambda p: p.xyz[:, 0] + 2")) != digest(eval("lambda p: p.xyz[:, 0] - 2"))


def test_globals_that_it_uses_count(monkeypatch):
    def uses(p):
        return [SHARED * factor for factor in range(3)]

    def other(p):
        return [factor for factor in range(3)]

    before = digest(uses), digest(other)
    monkeypatch.setitem(globals(), "SHARED", SHARED + 1)
    assert digest(uses) != before[0] and digest(other) == before[1]


def test_what_it_uses_of_modules_counts(tmp_path, monkeypatch):
    (tmp_path / "mine.py").write_text("import sub\nscale = 2.0\nunused = 1\ndef f(p):\n    return p * scale\n")
    (tmp_path / "sub.py").write_text("shift = 1\n")
    (tmp_path / "late.py").write_text("import mine\nfactor = 1\ndef g(p):\n    return mine.scale\n")
    monkeypatch.syspath_prepend(tmp_path)
    import mine

    def uses(p):
        return mine.f(p) + mine.sub.shift

    def imports(p):
        import mine as again

        return again.f(p)

    def imports_later(p):
        from late import factor, g

        return mine.unused * factor + g(p)

    late = digest(imports_later)
    before = digest(uses), digest(imports)
    monkeypatch.setattr(mine, "unused", 2)
    assert (digest(uses), digest(imports)) == before and digest(imports_later) != late
    late = digest(imports_later)
    monkeypatch.setattr(mine.sub, "shift", 2)
    assert digest(uses) != before[0] and digest(imports) == before[1]
    monkeypatch.setattr(mine, "scale", 3.0)
    assert digest(imports) != before[1] and digest(imports_later) != late
    late = digest(imports_later)
    monkeypatch.setattr(sys.modules["late"], "factor", 2)
    assert digest(imports_later) != late


def test_functions_and_lists_that_hold_themselves_have_a_digest():
    loop = [1]
    loop.append(loop)

    def even(n):
        return n == 0 or odd(n - 1, loop)

    def odd(n, numbers):
        return n != 0 and even(n - 1)

    assert digest(even) == digest(even) and digest(even) != digest(odd)


def test_other_processes_find_the_same_digest():
    code = """
        import sys
        sys.path.insert(0, sys.argv[1])
        import test_identity as t
        print(*[t.digest(way(value)) for way in (t.captured, t.helped) for value, _ in t.VALUES])
    """
    command = [sys.executable, "-c", textwrap.dedent(code), os.path.dirname(__file__)]
    environments = [{**os.environ, "PYTHONHASHSEED": seed} for seed in "12"]
    children = [subprocess.Popen(command, env=e, stdout=subprocess.PIPE, text=True) for e in environments]
    first, second = [child.communicate()[0] for child in children]
    assert len(first.split()) == 2 * len(VALUES) and first == second


@pytest.mark.parametrize("unknown", [threading.Lock(), [1, {"a": threading.local()}], (i for i in ())])
def test_what_cannot_be_compared_is_not_resumed(tmp_path, unknown):
    cloud = ps.generate("plane", 100, tmp_path / "in.ply")

    @ps.operator(makes={"one": "f4"})
    def uses(p):
        return np.ones(len(p), "f4") if unknown else None

    with pytest.raises(ps.UsageError, match=r"resume: operator 'uses' uses 'unknown' \(a \w+\)"):
        cloud.run(uses, to=tmp_path / "out.ply", resume=tmp_path / "progress")
    cloud.run(uses, to=tmp_path / "out.ply")


def test_trees_that_hold_addresses_are_not_compared():
    from scipy.spatial import cKDTree

    assert identity_of(captured(cKDTree(np.eye(3)))).unknown == ["'value' (a cKDTree)"]


def test_a_run_is_not_resumed_with_another_captured_array(tmp_path):
    cloud = ps.generate("volume", 20000, tmp_path / "in.ply")
    weights = np.ones(3)

    @ps.operator(makes={"weighted": "f8"}, neighbors=False)
    def weighted(p):
        return p.xyz @ weights

    def stop(phase, done, total):
        if phase != "ordering":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        cloud.run(["knn(k=4) | normals", weighted], to=tmp_path / "out.ply", resume=tmp_path / "progress", progress=stop)
    weights[2] = 2
    with pytest.raises(ps.Error, match="another run"):
        cloud.run(["knn(k=4) | normals", weighted], to=tmp_path / "out.ply", resume=tmp_path / "progress")
    weights[2] = 1
    with pytest.warns(ps.PointsweepWarning, match="Went on"):
        cloud.run(["knn(k=4) | normals", weighted], to=tmp_path / "out.ply", resume=tmp_path / "progress")
