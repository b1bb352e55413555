# SPDX-License-Identifier: MIT
"""What other processes get: stages, pipelines, operators and results, pickled and compared."""

import copy
import pickle
import subprocess
import sys

import numpy as np
import pytest
from conftest import made_by, samples

import pointsweep as ps

FACTOR = 2.0


@ps.operator(makes={"double": "f8"}, neighbors=False)
def double(p):
    return FACTOR * p.xyz[:, 0]


@ps.select()
def right(p):
    return p.xyz[:, 0] > 0.5


class Namespace:
    @staticmethod
    @ps.operator(makes={"half": "f8"}, neighbors=False)
    def half(p):
        return p.xyz[:, 0] / 2


@ps.reduce(start=0)
def count(n, block):
    return n + len(block["row"])


def back(value):
    """Returns the value after pickling with the highest protocol; the older protocols in use have to work, too."""
    pickles = [pickle.loads(pickle.dumps(value, protocol)) for protocol in (2, 4, pickle.HIGHEST_PROTOCOL)]
    return pickles[-1]


@pytest.fixture(scope="module")
def stages(declarations):
    """Stages of every operator in the registry: with what is required, and with each value of each option."""
    found = []
    for operator in declarations:
        make, required, options = made_by(operator)
        found.append(make(**required))
        found += [make(**{**required, name: value}) for name, option in options.items() for value in samples(option)]
    return found


def test_every_stage_pickles_and_compares(stages):
    texts = [str(stage) for stage in stages]
    for stage, text in zip(stages, texts):
        copied = back(stage)
        assert type(copied) is ps.Stage and copied == stage and hash(copied) == hash(stage) and str(copied) == text
        assert copy.deepcopy(stage) == stage
    distinct = dict(zip(texts, stages)).values()
    assert len(distinct) > 60 and len(set(distinct)) > 0.9 * len(distinct)  # some options have no effect alone


def test_every_pipeline_pickles_and_compares(stages):
    for stage in stages:
        if stage.name != "knn":
            pipeline = ps.knn(12) | stage | double
            assert back(pipeline) == pipeline != ps.knn(13) | stage | double
            assert hash(back(pipeline)) == hash(pipeline)


def test_what_is_written_otherwise_is_equal():
    assert ps.sor() == ps.sor(2) != ps.sor(3)
    assert ps.knn(8) == ps.Pipeline("knn( k = 8 )") != ps.knn(9)
    assert ps.knn() == ps.Pipeline("knn") != ps.knn(8)  # a knn without k takes the default of the operators after it
    assert ps.knn(radius=0.5) != ps.knn(8, radius=0.5)
    assert ps.sor() == ps.Pipeline("sor") == ps.Pipeline("knn(k=8)|sor") == ps.knn(8) | ps.sor()
    assert ps.where("outlier == 0") == ps.Pipeline("where(outlier==0)") == ps.Pipeline('where(condition="outlier == 0")')
    assert ps.Pipeline("knn(k=4)", double) == ps.Pipeline(["knn(k=4)", back(double)]) != ps.Pipeline("knn(k=4)", right)
    assert ps.knn() != "knn" and ps.Pipeline("no such thing(") == ps.Pipeline("no such thing(")


def test_operators_of_modules_pickle_by_reference():
    assert all(back(made) is made for made in (double, right, count, Namespace.half))
    assert len(pickle.dumps(double)) < 100
    copied = copy.copy(double)
    copied._most_places = 1
    assert double._most_places > 1


def test_other_operators_pickle_by_value():
    pytest.importorskip("cloudpickle")
    factor = np.array([3.0])
    op = ps.operator(makes={"times": "f8"}, neighbors=False, name="times")(lambda p: factor[0] * p.xyz[:, 0])
    chosen = ps.select()(lambda p: p.xyz[:, 0] * factor[0] > 1)
    xyz = np.random.default_rng(2).random((50, 3))
    for stage in (op, chosen):
        copied = back(stage)
        assert copied is not stage and copied == stage and repr(copied) == repr(stage)
        ours, theirs = ps.run(xyz, stage), ps.run(xyz, copied)
        assert all(ours[name].tobytes() == theirs[name].tobytes() for name in ours)
    before = back(op)
    factor[0] = 4
    assert before != op


def test_processes_get_operators_of_the_main_script(tmp_path):
    pytest.importorskip("cloudpickle")
    (tmp_path / "script.py").write_text(
        """
import concurrent.futures, multiprocessing, numpy, pointsweep as ps

@ps.operator(makes={"double": "f8"}, neighbors=False)
def double(p):
    return 2 * p.xyz[:, 0]

if __name__ == "__main__":
    xyz = numpy.ones((10, 3))
    with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        print(pool.submit(ps.run, xyz, ps.knn(4) | double).result()["double"].sum())
"""
    )
    run = subprocess.run([sys.executable, tmp_path / "script.py"], capture_output=True, text=True)
    assert run.stdout == "20.0\n", run.stderr


def test_clouds_results_and_what_they_say_pickle(tmp_path):
    cloud = ps.generate("plane", 100, tmp_path / "in.ply")
    assert back(cloud).attributes == cloud.attributes and len(back(cloud)) == 100
    t = cloud.run("knn(k=8) | normals")
    copied = back(t)
    assert repr(copied) == repr(t) and copied.columns().keys() == t.columns().keys() and repr(copied.report) == repr(t.report)
    assert back(ps.neighbors(t["normal"], 3)).indices.tobytes() == ps.neighbors(t["normal"], 3).indices.tobytes()
    assert back(ps.plan(cloud, "normals", memory="1G")) == ps.plan(cloud, "normals", memory="1G")
