# SPDX-License-Identifier: MIT
"""The package as a whole: what importing it costs, processes, notebooks."""

import ast
import html
import multiprocessing
import os
import subprocess
import sys
import sysconfig
import threading
import types
from pathlib import Path

import numpy as np
import pytest

import pointsweep as ps

XYZ = np.random.default_rng(11).random((4000, 3))


def test_importing_it_imports_little_beside_numpy():
    code = """
import sys
import numpy
before = set(sys.modules)
import pointsweep
print(*sorted(m for m in set(sys.modules) - before if not m.startswith("pointsweep")))
"""
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert set(run.stdout.split()) <= {"__future__", "atexit", "copy"}, "import these where they are needed"


MODULES = sorted(path.stem for path in Path(ps.__file__).parent.glob("*.py"))


def test_each_module_is_imported_alone():
    """Imports each module of the package in a new process, with an empty module in place of the package's __init__, so that no
    other module has been imported. The processes are forks of one that has imported only NumPy."""
    code = f"""
import importlib, os, sys, traceback, types
import numpy
for module in sys.argv[1:]:
    child = os.fork()
    if child == 0:
        package = types.ModuleType("pointsweep")
        package.__path__ = [{os.path.dirname(ps.__file__)!r}]
        sys.modules["pointsweep"] = package
        try:
            importlib.import_module("pointsweep." + module)
        except BaseException:
            traceback.print_exc()
            os._exit(1)
        os._exit(0)
    if os.waitpid(child, 0)[1] != 0:
        sys.exit(module + " is not imported alone")
"""
    run = subprocess.run([sys.executable, "-c", code, *MODULES], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr


def internal_imports(module):
    """Modules of the package that a module imports anywhere in its text, also for types alone."""
    tree = ast.parse((Path(ps.__file__).parent / f"{module}.py").read_text())
    nodes = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.level == 1]
    return {name for node in nodes for name in ([node.module] if node.module else [a.name for a in node.names])} - {"_core"}


def test_modules_import_each_other_in_one_direction():
    above = {module: internal_imports(module) for module in MODULES}
    while ready := [module for module, below in above.items() if not below]:
        above = {module: below - set(ready) for module, below in above.items() if module not in ready}
    assert not above, f"these import each other: {above}"


def test_no_module_of_the_package_is_imported_inside_of_a_function():
    for module in MODULES:
        tree = ast.parse((Path(ps.__file__).parent / f"{module}.py").read_text())
        functions = [node for node in ast.walk(tree) if isinstance(node, (ast.FunctionDef, ast.Lambda))]
        inner = [n for f in functions for n in ast.walk(f) if isinstance(n, ast.ImportFrom) and n.level == 1]
        assert not inner, module


def test_it_leaves_the_interpreter_lock_off():
    if not sysconfig.get_config_var("Py_GIL_DISABLED"):
        pytest.skip("this interpreter has a lock")
    code = "import sys, pointsweep; print(sys._is_gil_enabled())"
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, env={**os.environ, "PYTHON_GIL": ""})
    assert run.stdout.split() == ["False"]


def test_threads_that_raise_at_once_raise_one_exception():
    @ps.operator(makes={"nothing": "f4"})
    def raising(p):
        raise LookupError(threading.get_ident())

    raising._most_places = 1  # a batch for each point
    with pytest.raises(LookupError):
        ps.run(XYZ, ["knn(k=4)", raising], threads=2)


def normals_of(xyz):
    return ps.normals(xyz, 8)


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_processes_run_for_themselves(method):
    expected = ps.normals(XYZ, 8)  # the parent has run before it forks
    with multiprocessing.get_context(method).Pool(2) as pool:
        for found in pool.map(normals_of, [XYZ] * 4):
            assert found.tobytes() == expected.tobytes()


def test_many_threads_run_at_once():
    @ps.operator(reads=["normal"], makes={"tilt": "f4"})
    def tilt(p):
        return np.abs(p.normal[:, 2])

    expected = ps.run(XYZ, "knn(k=8) | normals" | tilt)["tilt"].tobytes()
    found = [None] * 8

    def work(i):
        found[i] = ps.run(XYZ, "knn(k=8) | normals" | tilt, threads=1 + i % 3)["tilt"].tobytes()

    threads = [threading.Thread(target=work, args=(i,)) for i in range(8)]
    [t.start() for t in threads], [t.join() for t in threads]
    assert found == [expected] * 8


def test_a_plan_says_what_a_run_would_do(tmp_path):
    plan = ps.plan(XYZ, ps.knn(16) | ps.normals() | ps.where("nz > 0.5"), memory="100M")
    assert repr(plan) == str(plan) and "normals" in plan and "pass 1 of 2" in plan
    assert plan._repr_html_().startswith("<pre>")
    cloud = ps.generate("plane", 1000, tmp_path / "in.ply")
    assert "normals" in ps.plan(cloud, "knn(k=8) | normals", to=tmp_path / "out.las", order="sweep")
    assert os.listdir(tmp_path) == ["in.ply"]
    with pytest.raises(ps.UsageError, match="is a folder"):
        ps.plan(cloud, "normals", to=tmp_path)
    with pytest.raises(ps.Error, match="memory="):
        ps.plan(XYZ, "normals", memory="1M")


def test_progress_is_shown(monkeypatch, capsys):
    bars = []

    class Bar:
        def __init__(self, total, desc, unit, unit_scale):
            self.total, self.desc, self.n, self.closed = total, desc, 0, False
            bars.append(self)

        def update(self, n):
            self.n += n

        def close(self):
            self.closed = True

    module = types.ModuleType("tqdm.auto")
    module.tqdm = Bar
    monkeypatch.setitem(sys.modules, "tqdm", types.ModuleType("tqdm"))
    monkeypatch.setitem(sys.modules, "tqdm.auto", module)
    xyz = ps.generate("volume", 300_000, progress=True)["xyz"]
    ps.run(xyz, "knn(k=32) | normals", progress=True)
    assert bars and all(bar.closed and bar.n <= bar.total for bar in bars)
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    ps.normals(xyz, progress=True)
    assert "of 300,000 points" in capsys.readouterr().err
    with pytest.raises(ps.UsageError, match="neither a function"):
        ps.normals(xyz, progress=3)


def test_bars_of_notebooks_do_not_ask_for_other_packages(tmp_path):
    (tmp_path / "tqdm").mkdir()
    (tmp_path / "tqdm/__init__.py").write_text("")
    (tmp_path / "tqdm/auto.py").write_text("import warnings; warnings.warn('IProgress not found. Please update ipywidgets.')")
    code = "import pointsweep._progress as p; print(p._has_tqdm())"
    paths = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    run = subprocess.run([sys.executable, "-W", "error", "-c", code], env={**os.environ, "PYTHONPATH": paths}, capture_output=True, text=True)
    assert run.stdout == "True\n" and run.stderr == ""


def test_tables_of_notebooks(tmp_path):
    cloud = ps.generate("plane", 100, tmp_path / "a&b.ply")
    table = cloud._repr_html_()
    assert "100" in table and html.escape("a&b.ply") in table and "nx float32" in table
    t = ps.run(XYZ, "knn(k=8) | normals", keep=["xyz", "normal"])
    assert "<th>normal</th><td>float32</td><td>(4000, 3)</td>" in t._repr_html_() and "4,000 points" in t._repr_html_()
    assert "4,000" in t.report._repr_html_()
    with pytest.warns(ps.PointsweepWarning, match="no point passed"):
        empty = ps.run(XYZ, "where(x > 2)")
    assert "0 points" in empty._repr_html_()
