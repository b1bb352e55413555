# SPDX-License-Identifier: MIT
"""Performs a task of a run of many processes, in a worker."""

from __future__ import annotations

import functools
import hashlib
import json
import os
import pickle
import threading
import time
import uuid
from typing import Any, NamedTuple

from . import _core
from ._errors import Error
from ._options import bytes_of
from ._urls import bytes_at, is_url, state_of

_REMOTE_BYTES = 32 << 20  # memory for reading and writing objects of a bucket
DIVIDING = ("cut", "gather")  #: kinds of the rounds that divide the points of all inputs among files
#: attribute of exceptions that a function of the caller has raised in a worker
OF_FUNCTION = "_pointsweep_of_function"
_one_at_a_time = threading.Lock()  # a task may use all memory and all threads of its process


class Step(NamedTuple):
    """A phase of a run that a task performs in one pass, such as 'order' or 'sweep'."""

    kind: str
    number: int  #: number of the pass


class Round(NamedTuple):
    """A round: a task for each tile, for each file of another cloud, or, if the output is divided, for each range of rows;
    and the kind of join that combines the results of its tasks."""

    steps: list[Step]
    join: str

    @property
    def kind(self) -> str:
        return self.steps[0].kind

    @property
    def number(self) -> int:
        """The number of the pass of the first step."""
        return self.steps[0].number


class Request(NamedTuple):
    """The arguments that all tasks of a run share. Tasks read them from the scratch, which spares the scheduler their size."""

    build: str
    inputs: list[str]
    states: list[tuple[int, int | str]]  #: (bytes, time of change or ETag) of each input
    outputs: list[str]  #: one path for each input; one path with a * if the output is divided among files
    others: dict[int, list[str]]  #: for the number of a pass, the files of the other cloud that the pass reads
    other_states: dict[str, tuple[int, int | str]]  #: (bytes, time of change or ETag) of each file in `others`
    stages: list[Any]
    record: list[str]  #: names of the stages, for the processing record of the outputs
    facts: tuple[int, float]  #: facts about the whole cloud: the number of points, and the length of its unit in metres
    keep: list[str]
    options: dict[str, Any]
    processes: int  #: largest number of workers on one machine


class Done(NamedTuple):
    """The reply of a task, a few hundred bytes."""

    left: str  #: name under which the task has stored its results in the scratch
    rows: int  #: number of rows of the tile that no stage has dropped, or of the file of another cloud
    own: int  #: finite points of the tile that were ordered or swept
    swept: int  #: points that were swept: those of the tile and of its halo
    written: int  #: points written to outputs
    dropped: int  #: points dropped for their non-finite coordinates
    bytes_read: int
    bytes_written: int
    bytes_in_scratch: int
    seconds: float
    peak_bytes: int
    worker: str
    files: int  #: number of files that the task has written
    warnings: list[str]


@functools.cache
def build() -> str:
    """Returns the version of the library and a hash of its code."""
    with open(_core.__file__, "rb") as file:
        return f"{_core.version} ({hashlib.sha256(file.read()).hexdigest()[:12]})"


@functools.lru_cache(maxsize=2)
def _request(path: str, _changed: int | str) -> Request:
    if is_url(path):
        content = _core.get_object(path)
        if content is None:
            raise Error(f"{path}: is gone, the request of the run; was it finished by another process?")
        request = pickle.loads(content)
    else:
        with open(path, "rb") as file:
            request = pickle.load(file)
    assert isinstance(request, Request)
    return request


def perform(request_path: str, objects: str, task: dict[str, Any]) -> Done:
    """Performs a task and returns its reply. A task may be performed twice: each copy stores equal results under a name of
    its own, and the client uses the first reply."""
    worker, threads = _worker()
    request = _request(request_path, state_of(request_path)[1])
    if build() != request.build:
        raise Error(f"{worker}: has pointsweep {build()}, the client {request.build}; install one version on all machines.")
    kind, tile = task["round"].kind, task["tile"]
    others = request.others.get(task["round"].number, [])
    paths, other_file, output = request.inputs[tile : tile + 1], others[0] if others else "", tile
    if kind == "other":
        paths, other_file, output = request.inputs[:1], others[tile], 0
        _require_unchanged(other_file, request.other_states[other_file], worker)
    elif kind in DIVIDING:
        paths, output = request.inputs, 0
        for path, state in zip(paths, request.states):
            _require_unchanged(path, state, worker)
    else:
        _require_unchanged(paths[0], request.states[tile], worker)
    left = f"{task['round_number']:02d}-{tile:06d}-{uuid.uuid4().hex[:12]}"
    options = dict(request.options)
    options["threads"] = options["threads"] or str(threads)
    memory = bytes_of(options["memory"] or None) or _share_of_memory(request.processes)
    if is_url(objects) and not is_url(paths[0]):  # the run's memory plan counts requests for inputs, not for objects of the scratch
        memory = max(memory - _REMOTE_BYTES, memory // 2)
    options["memory"] = f"{memory}B"
    with _one_at_a_time:
        start = time.perf_counter()
        try:
            rows, own, swept, text = _core.perform_part(
                objects, (paths, request.stages, request.keep, options, [request.outputs[output]], request.facts),
                {**task, "other_file": other_file, "record": request.record, "after": left}, None,
            )
        except Exception as error:
            if error.__traceback__ is not None and error.__traceback__.tb_next is not None:  # a frame of Python below this one
                setattr(error, OF_FUNCTION, True)
            raise
        seconds = time.perf_counter() - start
    counts = json.loads(text) if text else {}
    return Done(
        left,
        rows,
        own,
        swept,
        int(counts.get("points_written", 0)),
        int(counts.get("dropped", 0)),
        int(counts.get("bytes", {}).get("read", 0)),
        int(counts.get("bytes", {}).get("written", 0)),
        _bytes_left(objects, left),
        seconds,
        int(counts.get("peak_rss_bytes", 0)),
        worker,
        int(counts.get("files_written", 0)),
        list(counts.get("warnings", [])),
    )


def _require_unchanged(path: str, then: tuple[int, int | str], worker: str) -> None:
    try:
        now = state_of(path)
    except OSError as error:
        raise Error(f"{path}: {worker} cannot read it: {error.strerror}; put the files where all workers see them.") from None
    if now != then:
        raise Error(f"{path}: has changed since the run began ({then[0]} bytes then, {now[0]} now).")


def _bytes_left(objects: str, left: str) -> int:
    """Returns the bytes of the objects that a task has stored in the scratch under the name `left`."""
    return sum(bytes_at(os.path.join(objects, left + end)) for end in _core.left_by_tasks)


def _worker() -> tuple[str, int]:
    from distributed import get_worker

    try:
        worker = get_worker()
    except ValueError:
        return "this process", os.cpu_count() or 1
    return str(worker.address), int(worker.state.nthreads)


def _share_of_memory(processes: int) -> int:
    return max(1, _core.available_memory() // 2 // max(1, processes))
