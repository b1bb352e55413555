# SPDX-License-Identifier: MIT
"""A run over a folder of tiles on the workers of Dask, with the bytes of a run of one process.

The run proceeds in rounds (`_core.plan_parts`). A round has a task for each tile, for each file of another cloud that a
stage reads, or for each range of rows if the output is divided among files. A task needs only results that earlier rounds
have stored in the scratch, so no task waits for another task of its round. The client hands out tasks and records their
replies in the scratch: after the client was killed or has lost its scheduler, the same command continues the run.
"""

from __future__ import annotations

import itertools
import json
import pickle
import time
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager
from typing import Any

from . import _core
from ._errors import Error, UsageError, warn
from ._part import DIVIDING, OF_FUNCTION, Done, Request, Round, Step, build, perform
from ._scratch import Scratch
from ._urls import absolute, state_of

_MOST_TRIES = 4  # largest number of tries of a task whose workers end or whose objects are damaged
_PHASES = {"look": "checking", "other": "ordering", "order": "ordering", "sweep": "sweeping", "forest": "connecting", "label": "updating", "rows": "updating", "write": "writing", "cut": "dividing", "gather": "writing"}
_WAIT_SECONDS = 30.0
_LOOK_SECONDS = 5.0  # time between two checks for tasks that may hang and for new workers
_RESULT_SECONDS = 20.0  # time limit for a reply of a few hundred bytes from its worker
_SLOW_SECONDS = 60.0  # a task counts as hanging after more than this and ten times the longest finished task

Progress = Callable[[str, int, int], Any] | None


@contextmanager
def _connected(client: Any) -> Iterator[Any]:
    """Yields a Dask client: `client` itself, a client of the scheduler at an address, or of new workers on this machine."""
    try:
        from dask import config
        from distributed import Client, LocalCluster
    except ImportError:
        raise UsageError("client: needs the package distributed, which is not installed: pip install distributed.") from None
    if isinstance(client, Client):
        yield client
    elif client == "local":
        # Dask's statistical profile of Python code takes time and shows nothing of the C++ code in which tasks run.
        with config.set({"distributed.worker.profile.enabled": False}):
            with LocalCluster(threads_per_worker=1, memory_limit=None, dashboard_address=":0") as cluster, Client(cluster) as own:
                yield own
    elif isinstance(client, str):
        try:
            own = Client(client, timeout="10s")
        except (OSError, ValueError) as error:
            raise Error(f"client: no scheduler answers at {client} ({error}); start one with: dask scheduler.") from None
        with own:
            yield own
    else:
        raise UsageError(f"client: {client!r} is no client of Dask, no address such as 'tcp://host:8786', and not 'local'.")


def run_on_cluster(
    client: Any,
    scratch: str,
    take_over: bool,
    source: list[str],
    stages: list[Any],
    keep: list[str],
    options: dict[str, Any],
    outputs: list[str],
    progress: Progress,
) -> str:
    """Runs `stages` over files that all workers can read, with an output for each file; or, if the path of `outputs` has a *,
    divides the points of all files among output files. Returns the statistics as JSON."""
    start = time.perf_counter()
    inputs = [absolute(path) for path in source]
    outputs = [absolute(path) for path in outputs]
    named = [_core.with_absolute_files(stage) if isinstance(stage, str) else stage for stage in stages]
    identity = {
        "inputs": [[path, *state_of(path)] for path in inputs],
        "outputs": outputs,
        "stages": _core.canonical_stages(named) if stages else [],
        "attributes to keep": keep,
        "options": {name: value for name, value in options.items() if name not in ("memory", "threads", "temp_folder")},
        "versions of pointsweep": build(),
    }
    place = Scratch(scratch, identity, take_over)
    finished = False
    try:
        begun = place.has_request()
        given = {**options, "overwrite": "yes" if begun else options["overwrite"]}
        planned, rows, nonfinite, notes, bytes_of_point, others, record, facts = _core.plan_parts((inputs, stages, keep, given, outputs, None))
        rounds = [Round([Step(*step) for step in steps], join) for steps, join in planned]
        others = {number: ([absolute(path) for path in paths], counts) for number, (paths, counts) in others.items()}
        other_states = {path: state_of(path) for paths, _ in others.values() for path in paths}
        place.require_unchanged(other_states)
        for note in notes:
            warn(note)
        place.require_room(bytes_of_point * sum(rows))
        with _connected(client) as connected:
            request = Request(
                build(), inputs, [state_of(path) for path in inputs], outputs, {number: paths for number, (paths, _) in others.items()},
                other_states, named, record, facts, keep, {**options, "nonfinite": nonfinite}, _workers_of_a_machine(connected),
            )
            _seal_request(place, request)
            run = _Run(connected, place, request, rounds, rows, {number: counts for number, (_, counts) in others.items()}, progress)
            own = [] if run.divides() else outputs
            _core.remove_abandoned(own)  # only the client does so: a worker would list the folders again for each of its tasks
            run.perform()
            _core.remove_abandoned(own)
            finished = True
            return run.statistics(time.perf_counter() - start)
    except OSError as error:
        if getattr(error, OF_FUNCTION, False):
            raise
        raise Error(
            f"{scratch}: {error.strerror or error}; the scratch has to stay where it is and to have room: mend that and give the"
            " same command, which goes on where this one was."
        ) from None
    finally:
        place.remove() if finished or not place.has_begun() else place.close()


def _seal_request(place: Scratch, request: Request) -> None:
    try:
        import cloudpickle as pickler
    except ImportError:
        pickler = pickle
    place.seal_request(pickler.dumps(request))


def _workers_of_a_machine(client: Any) -> int:
    """Returns the largest number of workers on one machine. Waits up to _WAIT_SECONDS for the first worker to connect."""
    until = time.monotonic() + _WAIT_SECONDS
    while not (workers := client.scheduler_info(n_workers=-1)["workers"]):
        if time.monotonic() > until:
            raise Error("client: the scheduler has no workers; start some with: dask worker ADDRESS.")
        time.sleep(0.2)
    return max(Counter(worker["host"] for worker in workers.values()).values())


class _Run:
    """Performs the rounds of a run and keeps the replies of their tasks."""

    def __init__(
        self, client: Any, place: Scratch, request: Request, rounds: list[Round], rows: list[int], other_rows: dict[int, list[int]],
        progress: Progress,
    ) -> None:
        self._client, self._place, self._request, self._rounds, self._rows = client, place, request, rounds, rows
        self._progress, self._other_rows = progress, other_rows
        self._tiles = len(rows)
        self._first_row = list(itertools.accumulate(rows, initial=0))  # first row of each tile or range, then the number of all rows
        self._done: list[dict[int, Done]] = [{} for _ in rounds]
        self._longest, self._damages = 0.0, 0
        self._hanging: set[str] = set()  #: addresses of workers that have taken much too long for a task
        self._forgotten = 0  #: number of the first round whose results may still be in the scratch
        for fact in place.done():
            self._done[fact["round"]][fact["tile"]] = Done(*fact["done"])

    def perform(self) -> None:
        number = 0
        while number < len(self._rounds):
            again = self._perform_round(number)
            number = number + 1 if again is None else again

    def _perform_round(self, number: int) -> int | None:
        """Performs the tasks of a round that are not done, and joins the results of all its tasks. Returns None, or the
        number of the round to perform again because results of one of its tasks, or its join, are damaged."""
        kinds = {step.kind for step in self._rounds[number].steps}
        todo = [task for task in range(len(self._rows_of(number))) if task not in self._done[number]]
        damaged = self._hand_out(number, todo) or self._join(number, is_new=bool(todo))
        if damaged is not None:
            return self._go_back(*damaged)
        if kinds & {"sweep", "label", "rows"} and self._rounds[number].join not in ("borders", "components"):
            self._forget_before(number)
        return None

    def _rows_of(self, number: int) -> list[int]:
        """Returns for each task of a round the number of rows that it takes: of a tile, a file of another cloud or a range."""
        this = self._rounds[number]
        return self._other_rows[this.number] if this.kind == "other" else self._rows

    def _join(self, number: int, is_new: bool) -> tuple[int, int | None] | None:
        """Joins the results of a round's tasks, unless an earlier process has done so. Returns None, or the round and task
        whose results are damaged, as _damaged_by() does."""
        this = self._rounds[number]
        objects, r = self._place.objects, self._request
        names = [self._done[number][task].left for task in range(len(self._rows_of(number)))]
        try:
            key = _joined_by(number)
            if not is_new and self._place.has_object(key):
                return None
            shared = (r.inputs[:1], r.stages, r.keep, r.options, r.outputs[:1], r.facts)
            if this.join == "tiles":
                _core.join_tiles(objects, names, r.others[this.number] if this.kind == "other" else r.inputs, key)
            if this.join in ("borders", "components"):
                catalogue, borders = self._joined_before(number, "tiles"), self._joined_before(number, "borders")
                _core.join_graph(objects, shared, this, catalogue, borders, names, key)
            if this.join == "pieces":
                options = {**r.options, "overwrite": "yes"} if self._done[number + 1] else r.options  # this run may have written some files
                _core.join_pieces(objects, (r.inputs, r.stages, r.keep, options, r.outputs, r.facts), names, key)
            if this.join == "values":
                _core.join_values(objects, shared, this, self._joined_before(number, "values"), names, key)
        except Error as error:
            damaged = _damaged_by(error)
            if damaged is None:
                raise
            return damaged
        return None

    def _go_back(self, number: int, tile: int | None) -> int:
        """Marks the task, or the join if `tile` is None, whose objects are damaged as not done. Returns the round with which
        the run continues: if the inputs of the task have been removed from the scratch, the first one."""
        self._damages += 1
        if self._damages > _MOST_TRIES * len(self._rounds):
            raise Error(f"{self._place.path}: objects there are damaged again and again; name another folder as the scratch.")
        if 0 < number <= self._forgotten:
            self._done = [{} for _ in self._rounds]
            self._forgotten = 0
            return 0
        if tile is None:
            self._place.remove_object(_joined_by(number))
        else:
            self._done[number].pop(tile, None)
        return number

    def _hand_out(self, number: int, todo: list[int]) -> tuple[int, int | None] | None:
        """Performs the tasks `todo` of a round. Submits two tasks for each worker, so that none waits for the client.
        Returns None, or the round and task whose damaged results a task needs."""
        from distributed import TimeoutError as late

        kind = self._rounds[number].kind
        left, tries = list(reversed(todo)), Counter[int]()
        running: dict[Any, tuple[int, float]] = {}
        rows = self._rows_of(number)
        points = sum(rows[tile] for tile in self._done[number])
        self._tell(kind, points, sum(rows))
        looked, window = float("-inf"), 0
        while left or any(tile not in self._done[number] for tile, _ in running.values()):
            self._place.require_lease()
            if time.monotonic() - looked > _LOOK_SECONDS:
                self._double_slow(number, running)
                window = 2 * max(1, len(self._client.scheduler_info(n_workers=-1)["workers"]))
                looked = time.monotonic()
            while left and len(running) < window:
                tile = left.pop()
                running[self._submit(number, tile)] = tile, time.monotonic()
            future = self._next(running)
            if future is None:
                continue
            tile, since = running.pop(future)
            if tile in self._done[number]:
                continue  # another copy of the task was faster
            try:
                done = future.result(timeout=_RESULT_SECONDS)
            except late:  # the worker that holds the reply does not answer
                self._hanging.update(*self._client.who_has([future]).values())
                left.append(tile)
                continue
            except CancelledError:
                raise _scheduler_gone() from None
            except Exception as error:  # noqa: BLE001 - an error of the task, of its worker or of the scheduler
                if self._client.status not in ("running", "connecting"):
                    raise _scheduler_gone() from None
                damaged = _damaged_by(error)
                tries[tile] += 1
                if damaged is None and not _may_pass(error):
                    raise
                if tries[tile] >= _MOST_TRIES:
                    is_lost = isinstance(error, MemoryError) or type(error).__name__ == "KilledWorker"
                    remedy = "give workers more memory than memory= says, or look at their logs" if is_lost else "look at the logs of the workers"
                    raise Error(
                        f"{self._path_of(number, tile)}: its task has failed {tries[tile]} times ({type(error).__name__}: {error}); {remedy}."
                    ) from None
                if damaged is not None:
                    for other in running:
                        other.cancel()
                    return damaged
                left.append(tile)
                continue
            self._longest = max(self._longest, time.monotonic() - since)
            self._done[number][tile] = done
            self._place.note(round=number, tile=tile, done=list(done))
            points += rows[tile]
            self._tell(kind, points, sum(rows))
        for copy in running:  # copies of tasks that another worker has done
            copy.cancel()
        return None

    def _next(self, running: dict[Any, Any]) -> Any:
        """Returns a future that is done; None if none is done within _LOOK_SECONDS."""
        from distributed import TimeoutError as late
        from distributed import wait

        try:
            wait(list(running), timeout=_LOOK_SECONDS, return_when="FIRST_COMPLETED")
        except late:
            if self._client.status not in ("running", "connecting"):
                raise _scheduler_gone() from None
            return None
        except CancelledError:  # the scheduler was restarted and has lost its tasks
            raise _scheduler_gone() from None
        return next(future for future in running if future.done())

    def _submit(self, number: int, tile: int) -> Any:
        this = self._rounds[number]
        rounds = [n for n in reversed(range(number)) if self._rounds[n].kind not in ("look", "other")]
        before = "" if this.kind == "other" else next((self._done[n][tile].left for n in rounds if tile in self._done[n]), "")
        look = sum(done.dropped for done in self._done[0].values()) if self._rounds[0].kind == "look" else 0
        task = {
            "round": this,
            "round_number": number,
            "tile": tile,
            "tiles": self._tiles,
            "first_row": 0 if this.kind == "other" else self._first_row[tile],
            "rows": self._rows_of(number)[tile],
            "dropped": look,
            "before": before,
            "catalogue": self._joined_before(number, "tiles"),
            **{join: self._joined_before(number, join) for join in ("values", "borders", "components", "pieces")},
            "other_catalogue": self._joined_before(number, "tiles", of_other=this.number),
        }
        key = f"{_PHASES[this.kind]}-{number}-{tile}-{time.monotonic_ns()}"
        return self._client.submit(perform, self._place.request, self._place.objects, task, key=key, pure=False, workers=self._workers())

    def _workers(self) -> list[str] | None:
        """Returns the addresses of workers that may get a task: None for all workers, else those that do not seem to hang."""
        if not self._hanging:
            return None
        return [worker for worker in self._client.scheduler_info(n_workers=-1)["workers"] if worker not in self._hanging] or None

    def _path_of(self, number: int, task: int) -> str:
        this = self._rounds[number]
        if this.kind in DIVIDING:
            return f"{this.kind} {task + 1} of {self._tiles}"
        return self._request.others[this.number][task] if this.kind == "other" else self._request.inputs[task]

    def _joined_before(self, number: int, join: str, of_other: int | None = None) -> str:
        """Returns the key of the last join of the kind `join` before round `number`; empty without one. `of_other`: number of
        the pass that reads the other cloud whose tiles were joined; None for joins over the points of the run."""
        for earlier in reversed(range(number)):
            this = self._rounds[earlier]
            if (this.join, this.number if this.kind == "other" else None) == (join, of_other):
                return _joined_by(earlier)
        return ""

    def _double_slow(self, number: int, running: dict[Any, Any]) -> None:
        """Submits a copy of each task that may hang to another worker."""
        if self._longest == 0:
            return  # no task is done, so that the usual time of a task is unknown
        now = time.monotonic()
        tiles = Counter(tile for tile, _ in running.values())
        slow = [
            (future, tile)
            for future, (tile, since) in running.items()
            if future.status == "pending" and now - since > max(_SLOW_SECONDS, 10 * self._longest) and tiles[tile] == 1
        ]
        if not slow:
            return
        keys = {future.key for future, _ in slow}
        self._hanging.update(worker for worker, at_hand in self._client.processing().items() if keys & set(at_hand))
        for _, tile in slow:
            running[self._submit(number, tile)] = tile, now

    def _forget_before(self, number: int) -> None:
        self._place.flush()
        for earlier in range(self._forgotten, number):
            for done in self._done[earlier].values():
                _core.forget_part(self._place.objects, done.left)
        self._forgotten = number

    def divides(self) -> bool:
        return self._rounds[-1].kind in DIVIDING

    def _tell(self, kind: str, points: int, of: int) -> None:
        if self._progress is not None:
            self._progress(_PHASES[kind], points, of)

    def statistics(self, seconds: float) -> str:
        """Returns the statistics of the run as JSON, like the library for a run of one process, with counts for each worker."""
        last = self._done[-1].values()
        tasks = [done for of_round in self._done for done in of_round.values()]
        sweeps = [d for of_round, r in zip(self._done, self._rounds) if any(step.kind == "sweep" for step in r.steps) for d in of_round.values()]
        workers: dict[str, dict[str, float]] = {}
        for done in tasks:
            worker = workers.setdefault(done.worker, {"tasks": 0, "seconds": 0.0, "peak_rss_bytes": 0})
            worker["tasks"] += 1
            worker["seconds"] += done.seconds
            worker["peak_rss_bytes"] = max(worker["peak_rss_bytes"], done.peak_bytes)
        warnings = list(dict.fromkeys(sentence for done in (tasks if self.divides() else last) for sentence in done.warnings))
        for sentence in warnings:
            warn(sentence)
        return json.dumps(
            {
                "points": sum(self._rows),
                "points_written": sum(done.written for done in last),
                "warnings": warnings,
                "seconds": {"total": seconds, "tasks": sum(done.seconds for done in tasks)},
                "bytes": {"read": sum(d.bytes_read for d in tasks), "written": sum(d.bytes_written for d in tasks), "scratch": sum(d.bytes_in_scratch for d in tasks)},
                "files": sum(done.files for done in last) if self.divides() else self._tiles,
                "points_swept_over_own": sum(d.swept for d in sweeps) / max(1, sum(d.own for d in sweeps)),
                "tasks": len(tasks),
                "workers": workers,
            }
        )


def _joined_by(number: int) -> str:
    return f"joined-{number:02d}"


def _damaged_by(error: BaseException) -> tuple[int, int | None] | None:
    """Returns (round, tile) of the task whose object an error message calls damaged, or (round, None) if the object is the
    join of that round; None for other errors."""
    text = str(error)
    parts = text.removesuffix(": is damaged.").split(".", 1)[0].split("-")
    if not text.endswith(": is damaged."):
        return None
    if parts[0] == "joined" and len(parts) > 1 and parts[1].isdigit():
        return int(parts[1]), None
    if len(parts) != 3 or not (parts[0].isdigit() and parts[1].isdigit()):
        return None
    return int(parts[0]), int(parts[1])


def _may_pass(error: BaseException) -> bool:
    """Returns whether a task may succeed when it is performed again: its worker has ended, or the error is one of the network, of
    files or of Dask. Errors of the library, and exceptions of functions of the caller, come again."""
    if getattr(error, OF_FUNCTION, False):
        return False
    return isinstance(error, (OSError, MemoryError)) or type(error).__module__.partition(".")[0] in ("distributed", "dask", "tornado")


def _scheduler_gone() -> Error:
    return Error("client: the scheduler is gone; start it again and give the same command, which goes on where this one was.")
