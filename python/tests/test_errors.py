# SPDX-License-Identifier: MIT
"""Wrong requests, interruptions, warnings."""

import io
import os
import re
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import pointsweep as ps
from pointsweep import _core, _errors, _options

XYZ = np.random.default_rng(3).random((1000, 3))


@pytest.mark.parametrize(
    ("points", "sentence"),
    [
        (XYZ.T, "transpose it"),
        (XYZ[:, :2], r"needs \(n, 3\)"),
        (XYZ.ravel(), r"has the shape \(3000,\)"),
        (XYZ.astype(object), "array of objects"),
        (XYZ.astype(complex), "complex128"),
        ([["a", "b", "c"]], "give integers, float32 or float64"),
        ([[1, 2], [1, 2, 3]], "cannot be read as an array"),
        (np.ma.masked_greater(XYZ, 0.5), "masked values"),
        ({"xyz": XYZ, "intensity": np.ones(5)}, "'intensity' has 5 rows, but 'x' has 1000"),
        ({"x": XYZ[:, 0], "y": XYZ[:, 1]}, "have no 'z'"),
        ({"xyz": XYZ, "row": np.ones(1000)}, "another name"),
        ({"xyz": XYZ, "nx": np.ones(1000), "normal": XYZ}, "components called 'nx'"),
        ({"xyz": XYZ, "": np.ones(1000)}, "has no name"),
    ],
)
def test_wrong_arrays_are_refused_with_a_sentence(points, sentence):
    with pytest.raises(ps.UsageError, match=sentence):
        ps.run(points, "knn(k=8) | normals")


def test_a_pipeline_in_a_file_is_read_or_refused_with_its_name(tmp_path):
    file = tmp_path / "chain.json"
    file.write_text('[{"type": "knn", "k": 8}, {"type": "normals"}]')
    expected = ps.run(XYZ, "knn(k=8) | normals")["normal"]
    for named in (file, str(file), [file]):
        assert np.array_equal(ps.run(XYZ, named)["normal"], expected)
    (tmp_path / "latin.json").write_bytes(b'[{"type": "\xe4"}]')
    for name, sentence in [
        ("nofile.json", r"nofile.json: the pipeline cannot be read \(No such file or directory\); check the name"),
        ("", r"the pipeline cannot be read \(Is a directory\)"),
        ("latin.json", "latin.json: byte 11 of the pipeline is not UTF-8; save"),
    ]:
        for call in (ps.run, ps.plan, lambda points, pipeline: ps.chunks(points, 10, pipeline), lambda _, p: ps.knn(3) | p):
            with pytest.raises(ps.Error, match=sentence):
                call(XYZ, tmp_path / name)
    with pytest.raises(ps.Error, match="nofile.json: the pipeline cannot be read"):
        ps.run(XYZ, "nofile.json")


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: ps.run(XYZ, "knn(k=8) | normal"), "normals"),
        (lambda: ps.run(XYZ, "knn(k=0) | normals"), "k"),
        (lambda: ps.run(XYZ, []), "empty"),
        (lambda: ps.run(XYZ, 8), "neither a text"),
        (lambda: ps.run(XYZ, "knn(k=8) | normals", keep="curvature"), "curvature"),
        (lambda: ps.run(XYZ, "curvature"), "normal"),
        (lambda: ps.run(XYZ, "normals", memory="2 apples"), "memory"),
        (lambda: ps.run(XYZ, "normals", memory=0), "no memory"),
        (lambda: ps.run(XYZ, "normals", threads=0), "threads"),
        (lambda: ps.run(XYZ, "normals", order="random"), "order"),
        (lambda: ps.run(XYZ, "normals", axis=3), "axis"),
        (lambda: ps.run(XYZ, "normals", resume="folder"), "outputs in files"),
        (lambda: ps.run(XYZ, "normals", resume="folder", to="out.ply"), "is for files"),
        (lambda: ps.normals(XYZ, k="many"), "whole number"),
        (lambda: ps.normals(XYZ, orient="viewpoint"), "position of the scanner"),
        (lambda: ps.normals(XYZ, radius=-1), "radius"),
        (lambda: ps.neighbors(XYZ, k=0), "1 or more"),
        (lambda: ps.neighbors(XYZ, radius=float("nan")), "finite"),
        (lambda: ps.generate("teapot", 10), "teapot"),
        (lambda: ps.generate("plane", -1), "negative"),
        (lambda: ps.open([]), "at least one"),
        (lambda: ps.open(XYZ), "not a path"),
        (lambda: ps.open(""), "open: the path is empty"),
        (lambda: ps.open(["a.las", ""]), "open: the path is empty"),
        (lambda: ps.run("", "normals"), "open: the path is empty"),
        (lambda: ps.run(XYZ, "normals", to=""), "to: the path is empty"),
        (lambda: ps.run(XYZ, "normals", to=[""]), "to: the path is empty"),
        (lambda: ps.run(XYZ, "normals", to=[]), "to: the list is empty"),
        (lambda: ps.run(XYZ, "normals", resume=""), "resume: the path is empty"),
        (lambda: ps.run(XYZ, "normals", temp_folder=""), "temp_folder: the path is empty"),
        (lambda: ps.run(XYZ, "normals", keep=""), "'' is not the name of an attribute"),
        (lambda: ps.run(XYZ, ""), "is empty"),
        (lambda: ps.operator(makes={"": "f4"})(len), "has no name"),
        (lambda: ps.select(reads=[""]), "a name is empty"),
        (lambda: ps.plan(XYZ, "normals", to=""), "to: the path is empty"),
        (lambda: ps.generate("plane", 10, ""), "path: the path is empty"),
        (lambda: ps.distance_to(""), "distance_to: cloud: the path is empty"),
        (lambda: ps.crop(polygon=""), "crop: polygon: the path is empty"),
    ],
)
def test_wrong_requests_are_usage_errors(call, sentence):
    with pytest.raises(ps.UsageError, match=sentence):
        call()


def test_sizes_are_read_as_the_tool_reads_them():
    sizes = {"256M": 2**28, "1.5G": 3 * 2**29, "4GiB": 2**32, "800b": 800, " 2kB ": 2048, 12345: 12345, None: 0}
    assert {text: _options.bytes_of(text) for text in sizes} == sizes
    for text in ("800", "1.5", "G", "-1G", "1e3M", True, 2.5):
        with pytest.raises(ps.UsageError, match="memory"):
            _options.bytes_of(text)


def test_unknown_options_are_type_errors():
    with pytest.raises(TypeError, match="colour"):
        ps.run(XYZ, "normals", colour="red")


def test_usage_errors_are_errors_and_value_errors():
    assert issubclass(ps.UsageError, ps.Error) and issubclass(ps.UsageError, ValueError)


def test_a_file_that_is_not_there_is_an_error(tmp_path):
    with pytest.raises(ps.Error, match="nothing.laz"):
        ps.open(tmp_path / "nothing.laz")


def test_a_budget_that_is_too_small_says_what_would_do():
    with pytest.raises(ps.Error, match="M") as caught:
        ps.run(XYZ, "knn(k=8) | normals", memory="1M")
    assert not isinstance(caught.value, ps.UsageError)


def test_sentences_of_the_tool_name_the_options_of_the_package():
    named = _errors.with_names_of_python
    assert named("give --memory 29M or more.") == "give memory='29M' or more."
    assert named("--nonfinite drop leaves out; --prefix NAME keeps") == "nonfinite='drop' leaves out; prefix=NAME keeps"
    assert named("a folder with --temp-dir.") == "a folder with temp_folder." and named("a--b") == "a--b"
    assert named("or allow it (--force), --bogus: 3") == "or allow it (overwrite=True), --bogus: 3"
    assert named("allow it with --replace a, or --prefix NAME") == "allow it with replace='a', or prefix=NAME"
    assert named("allow it with --replace a,b, or so") == "allow it with replace=['a', 'b'], or so"
    assert named("--scale 0.01 or --positions float64.") == "scale=0.01 or positions='float64'."
    for name, (_, _, flag) in _core.run_options.items():
        if name not in ("engine", "overwrite", "no_provenance"):
            assert named(f"{flag}: wrong") == f"{name}: wrong"
    assert named("--no-provenance: wrong") == "provenance=False: wrong"


def test_nan_can_be_refused():
    xyz = XYZ.copy()
    xyz[3, 1] = np.nan
    with pytest.raises(ps.Error, match="3|4"):
        ps.run(xyz, "knn(k=8) | normals", nonfinite="refuse")


def test_outputs_are_not_overwritten_unasked(tmp_path):
    to = tmp_path / "out.ply"
    to.write_text("precious")
    with pytest.raises(ps.Error, match="out.ply"):
        ps.run(XYZ, "normals", to=to)
    assert to.read_text() == "precious" and os.listdir(tmp_path) == ["out.ply"]
    ps.run(XYZ, "normals", to=to, overwrite=True)
    assert len(ps.open(to)) == 1000


def test_progress_is_called_on_the_calling_thread_and_its_exception_ends_the_run(tmp_path):
    xyz = ps.generate("volume", 400_000)["xyz"]
    calls = []
    ps.run(xyz, "knn(k=32) | normals", progress=lambda *event: calls.append((threading.get_ident(), *event)))
    assert calls and all(thread == threading.get_ident() for thread, *_ in calls)
    assert all(isinstance(phase, str) and 0 <= done <= total for _, phase, done, total in calls)

    def fail(phase, done, total):
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        ps.run(xyz, "knn(k=32) | normals", to=tmp_path / "out.ply", progress=fail)
    assert os.listdir(tmp_path) == []


def test_warnings_are_issued_at_the_line_of_the_caller():
    normal = np.zeros((1000, 3), np.float32)
    with pytest.warns(ps.PointsweepWarning, match="nx, ny, nz") as caught:
        ps.run({"xyz": XYZ, "normal": normal}, "knn(k=8) | normals", order="sweep")
    assert caught[0].filename == __file__


INTERRUPTED = """
    import os, signal, sys
    import numpy as np
    import pointsweep as ps

    signal.signal(signal.SIGINT, signal.default_int_handler)  # jobs of a shell in the background ignore it

    @ps.operator(reads=["normal"], makes={"roughness": "f4"})
    def roughness(p):
        d = p.neighbors_xyz - p.xyz[:, None]
        return np.abs(np.einsum("nkj,nj->nk", d, p.normal)).mean(1)

    chain = ["knn(k=64) | normals"] + [roughness] * (sys.argv[3] == "python")
    xyz = ps.generate("volume", 3_000_000)["xyz"]
    print("started", flush=True)
    try:
        ps.run(xyz, chain, to=sys.argv[1], threads=1, memory="80M", temp_folder=sys.argv[2])
    except KeyboardInterrupt:
        print("interrupted", flush=True)
        print(os.listdir(os.path.dirname(sys.argv[1])), os.listdir(sys.argv[2]), flush=True)
"""


@pytest.mark.parametrize("stages", ["built in", "python"])
def test_control_c_ends_a_run_within_a_second_and_leaves_nothing(tmp_path, stages):
    out, temporary = tmp_path / "out", tmp_path / "temporary"
    out.mkdir(), temporary.mkdir()
    command = [sys.executable, "-c", textwrap.dedent(INTERRUPTED), str(out / "out.ply"), str(temporary), stages]
    child = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "started\n"
    time.sleep(1.0)
    start = time.monotonic()
    child.send_signal(signal.SIGINT)
    assert child.stdout.readline() == "interrupted\n"
    # Left alone, the run takes several seconds more; a second is enough on an idle machine, and other tests run beside.
    assert time.monotonic() - start < 3.0
    assert child.stdout.readline() == "[] []\n"
    assert child.wait() == 0
    child.stdout.close()


def test_two_runs_in_two_threads_do_not_disturb_each_other():
    clouds = [ps.generate("volume", 200_000, seed=s)["xyz"] for s in (1, 2)]
    expected = [ps.normals(xyz, 16) for xyz in clouds]
    got = [None, None]

    def work(i):
        got[i] = ps.normals(clouds[i], 16)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(2)]
    [t.start() for t in threads], [t.join() for t in threads]
    assert all(a.tobytes() == b.tobytes() for a, b in zip(expected, got))


def test_other_threads_run_meanwhile():
    xyz = ps.generate("volume", 400_000)["xyz"]
    ticks = []
    stop = threading.Event()

    def tick():
        while not stop.wait(0.01):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    ps.run(xyz, "knn(k=64) | normals", threads=1)
    stop.set(), thread.join()
    assert len(ticks) > 5


def test_flags_numbers_and_names_of_wrong_types_are_sentences(tmp_path):
    xyz = np.random.default_rng(1).random((20, 3))
    file = tmp_path / "there.ply"
    file.write_text("kept")
    for words, call in {
        "overwrite: 'no' is neither True nor False": lambda: ps.run(xyz, "normals", to=file, overwrite="no"),
        "radius: True is not a number": lambda: ps.normals(xyz, radius=True),
        "radius: 1000": lambda: ps.normals(xyz, radius=10**400),
        "an array called 1; give it a name": lambda: ps.run({"xyz": xyz, 1: xyz[:, 0]}, "normals"),
        "1 is not the name of an attribute": lambda: ps.operator(makes={1: "f4"})(len),
        "makes: None is no dict": lambda: ps.operator(makes=None)(len),
        "makes: ['a'] is no dict": lambda: ps.operator(makes=["a"])(len),
        "makes: 'a' has no type": lambda: ps.operator(makes={"a": None})(len),
        "makes: ('f4', -1) of 'a' is not a type": lambda: ps.operator(makes={"a": ("f4", -1)})(len),
        "reads: None is no list of names": lambda: ps.operator(makes={"a": "f4"}, reads=None),
        "reads_neighbors: 5 is no list of names": lambda: ps.operator(makes={"a": "f4"}, reads_neighbors=5),
        "to: 5 is not a path": lambda: ps.run(xyz, "normals", to=5),
        "open: 5 is not a path": lambda: ps.open(5),
        "inputs: 5 is not a path": lambda: ps.verify(file, 5),
        "attributes: list is no dict": lambda: ps.run(xyz, "normals", attributes=[1]),
        "keep: 5 is not the name of an attribute": lambda: ps.run(xyz, "normals", keep=5),
        "drop: attributes: 5 is not the name": lambda: ps.drop(5),
        "split: name one attribute": lambda: ps.write(tmp_path / "*.ply", xyz, split=[]),
        "viewpoint: give the position": lambda: ps.normals(xyz, viewpoint=5),
        "viewpoint: give three numbers": lambda: ps.orient(viewpoint=5),
        "origin: give three numbers": lambda: ps.generate("sphere", 10, origin=5),
        "shape: 5 is not a text": lambda: ps.generate(5, 10),
        "color: 5 is not a text": lambda: ps.render(xyz, color=5),
        "format: 5 is not a text": lambda: ps.open(file, format=5),
        "ignore_crs: 'no' is neither": lambda: ps.run(xyz, "normals", ignore_crs="no"),
    }.items():
        with pytest.raises(ps.UsageError, match=re.escape(words)):
            call()
    assert file.read_text() == "kept"
    assert ps.plan(xyz, "normals", axis=np.int64(1), memory="64M") == ps.plan(xyz, "normals", axis=1, memory="64M")


def test_numbers_of_more_than_64_bits_are_refused_in_a_sentence():
    xyz = np.random.default_rng(1).random((20, 3))
    assert len(ps.generate("sphere", 10, seed=2**64 - 1)["xyz"]) == 10
    for words, call in {
        "seed: 18446744073709551616 is too large; choose a number below 2**64": lambda: ps.generate("sphere", 10, seed=2**64),
        "n: 18446744073709551616 is too large": lambda: ps.generate("sphere", 2**64),
        "rows: 9223372036854775808 is not a number of rows": lambda: ps.chunks(xyz, 2**63),
        "bins: -5 is negative": lambda: ps.summary(xyz, bins=-5),
        "size: 4294967296 is too large; choose a number below 2**32": lambda: ps.render(xyz, size=(2**32, 100)),
    }.items():
        with pytest.raises(ps.UsageError, match=re.escape(words)):
            call()


def test_an_empty_keep_is_refused(tmp_path):
    xyz = np.random.default_rng(1).random((20, 3))
    ps.write(tmp_path / "a.ply", {"xyz": xyz, "intensity": xyz[:, 0]}, keep="x")
    assert list(ps.read(tmp_path / "a.ply")) == ["xyz"]
    for call in (
        lambda keep: ps.run(xyz, "knn(k=4) | normals", keep=keep),
        lambda keep: ps.run(xyz, "knn(k=4) | normals", keep=keep, to=tmp_path / "b.ply"),
        lambda keep: ps.plan(xyz, "knn(k=4) | normals", keep=keep),
        lambda keep: ps.write(tmp_path / "b.ply", xyz, keep=keep),
        lambda keep: ps.read(tmp_path / "a.ply", keep=keep),
        lambda keep: ps.open(tmp_path / "a.ply").with_columns(label=xyz[:, 0]).read(keep=keep),
        lambda keep: ps.chunks(xyz, 10, keep=keep),
        lambda keep: ps.verify(tmp_path / "a.ply", keep=keep),
    ):
        for keep in ([], ()):
            with pytest.raises(ps.UsageError, match="keep: the list is empty; name what to keep, or"):
                call(keep)
    assert os.listdir(tmp_path) == ["a.ply"]


class Opened(io.BytesIO):
    pass


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: ps.read(Opened(b"ply")), "open: Opened is no path; give the path of the file, or write"),
        (lambda: ps.read(Opened()), "open: Opened is no path"),
        (lambda: ps.run(Opened(b"ply"), "normals"), "points: Opened is no path"),
        (lambda: ps.open(b"a.laz"), "open: bytes is no path"),
        (lambda: ps.open([b"a.laz"]), "open: bytes is no path"),
        (lambda: ps.run(b"a.laz", "normals"), "points: bytes is no path"),
        (lambda: ps.run([{"xyz": XYZ}, {"xyz": XYZ}], "normals"), "points: a list of 2 clouds is no cloud; join"),
        (lambda: ps.run([XYZ, XYZ[:5]], "normals"), "points: a list of 2 clouds is no cloud; join"),
        (lambda: ps.run((XYZ, XYZ), "normals"), "points: a tuple of 2 clouds is no cloud; join"),
        (lambda: ps.crop(polygon={"name": 1}), "polygon: this dict is no polygon; give GeoJSON"),
        (lambda: ps.crop(polygon=[(0, 0), (1, 0), (1, 1)]), "polygon: this list is no polygon; give GeoJSON"),
        (lambda: ps.crop(polygon={"type": "Polygon"}), "crop: polygon: is no valid GeoJSON"),
        (lambda: ps.crop(((0, 0, 0), (1, 1, 1))), r"bounds: give the numbers one after another: \(\*low, \*high\)"),
    ],
)
def test_what_is_no_cloud_and_no_path_is_refused_with_the_remedy(call, sentence):
    with pytest.raises(ps.UsageError, match=sentence) as caught:
        call()
    assert "\\x" not in str(caught.value) and "0x" not in str(caught.value)


def test_files_with_columns_are_run_by_every_function_or_refused_with_the_remedy(tmp_path):
    ps.write(tmp_path / "a.ply", XYZ)
    labelled = ps.open(tmp_path / "a.ply").with_columns(label=np.arange(1000))
    expected = labelled.run("where(label > 3)")
    for t in (ps.run(labelled, "where(label > 3)"), ps.where("label > 3")(labelled)):
        assert t.keys() == expected.keys() and all(np.array_equal(t[name], expected[name]) for name in t)
    assert ps.normals(labelled, 8).tobytes() == ps.normals(XYZ, 8).tobytes() and "pass 1" in ps.plan(labelled, "where(label > 3)")
    ps.write(tmp_path / "b.ply", labelled)
    assert np.array_equal(ps.read(tmp_path / "b.ply")["label"], np.arange(1000))
    for call in (ps.render, ps.summary, lambda points: ps.neighbors(points, 3)):
        with pytest.raises(ps.UsageError, match="these files have columns.*write both to a file first"):
            call(labelled)


def test_an_unknown_option_has_the_nearest_one_in_its_error():
    for call in (lambda: ps.run(XYZ, "normals", memroy="1G"), lambda: ps.write("a.ply", XYZ, memroy="1G"), lambda: ps.knn(3)(XYZ, memroy="1G")):
        with pytest.raises(TypeError, match="'memroy' is not an option. The nearest one is 'memory'."):
            call()


def test_the_error_about_replaced_attributes_names_arguments_of_python(tmp_path):
    points = {"xyz": XYZ, "red": np.zeros(1000)}
    with pytest.raises(ps.UsageError, match="allow it with replace='color', or rename the computed attributes with prefix=NAME") as caught:
        ps.run(points, "color(z)", to=tmp_path / "a.ply")
    assert "--" not in str(caught.value)
