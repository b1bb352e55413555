# SPDX-License-Identifier: MIT
"""A run over a folder of tiles on the workers of Dask, with the bytes of a run of one process.

The run goes on in rounds (`_core.plan_parts`). A round has a task for each tile, for each file of another cloud that a
stage reads, or for each range of the rows where the output is divided among files. A task needs nothing but what the
rounds before have left in the scratch, so no task waits for another one. The client hands out tasks, and notes replies in
the scratch: a client that is killed, or that has lost its scheduler, goes on where it was when it is given the same command.
"""

from __future__ import annotations

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
from ._part import DIVIDING, Done, Request, Round, Step, build, perform
from ._scratch import Scratch
from ._urls import absolute, state_of

_MOST_TRIES = 4  # of a task whose workers end, or whose objects are damaged
_PHASES = {"look": "checking", "other": "ordering", "order": "ordering", "sweep": "sweeping", "forest": "connecting", "label": "updating", "rows": "updating", "write": "writing", "cut": "dividing", "gather": "writing"}
_WAIT_SECONDS = 30.0
_LOOK_SECONDS = 5.0  # between two looks at tasks that may hang
_RESULT_SECONDS = 20.0  # for a reply, a few hundred bytes, to come from its worker
_SLOW_SECONDS = 60.0  # a task may hang if it takes longer than this and ten times as long as the longest one before

Progress = Callable[[str, int, int], Any] | None


@contextmanager
def _connected(client: Any) -> Iterator[Any]:
    """A client of Dask: the one that is given, one of the scheduler at an address, or one of workers on this machine."""
    try:
        from dask import config
        from distributed import Client, LocalCluster
    except ImportError:
        raise UsageError("client: needs the package distributed, which is not installed: pip install distributed.") from None
    if isinstance(client, Client):
        yield client
    elif client == "local":
        # The workers' profile of Python, taken a hundred times a second, tells nothing of a task and costs it.
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
    """Runs `stages` over files that all workers see, each of which gets an output; or divides their points among files, whose
    path has a *. Returns the statistics as JSON."""
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
        planned, rows, nonfinite, notes, bytes_of_point, others, record, facts = _core.plan_parts(inputs, stages, keep, given, outputs)
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
            run.perform()
            finished = True
            return run.statistics(time.perf_counter() - start)
    except OSError as error:
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
    """The most workers on one machine. Waits for the first worker for a while: it may be on its way."""
    until = time.monotonic() + _WAIT_SECONDS
    while not (workers := client.scheduler_info(n_workers=-1)["workers"]):
        if time.monotonic() > until:
            raise Error("client: the scheduler has no workers; start some with: dask worker ADDRESS.")
        time.sleep(0.2)
    return max(Counter(worker["host"] for worker in workers.values()).values())


class _Run:
    """The rounds of a run, and what is known between them."""

    def __init__(
        self, client: Any, place: Scratch, request: Request, rounds: list[Round], rows: list[int], other_rows: dict[int, list[int]],
        progress: Progress,
    ) -> None:
        self._client, self._place, self._request, self._rounds, self._rows = client, place, request, rounds, rows
        self._progress, self._other_rows = progress, other_rows
        self._tiles = len(rows)
        self._first_row = _sums_before(rows)
        self._done: list[dict[int, Done]] = [{} for _ in rounds]
        self._longest, self._damages = 0.0, 0
        self._hanging: set[str] = set()  #: workers that have taken much too long for a task
        self._forgotten = 0  #: the round before which nothing is left in the scratch
        for fact in place.done():
            self._done[fact["round"]][fact["tile"]] = Done(*fact["done"])

    def perform(self) -> None:
        number = 0
        while number < len(self._rounds):
            again = self._perform_round(number)
            number = number + 1 if again is None else again

    def _perform_round(self, number: int) -> int | None:
        """Performs the tasks that are not done, and joins what they have left. Returns the number of an earlier round of
        which a task is to be performed again, since what it has left is damaged."""
        kinds = {step.kind for step in self._rounds[number].steps}
        todo = [task for task in range(len(self._rows_of(number))) if task not in self._done[number]]
        damaged = self._hand_out(number, todo) or self._join(number, is_new=bool(todo))
        if damaged is not None:
            return self._go_back(*damaged)
        if kinds & {"sweep", "label", "rows"} and self._rounds[number].join not in ("borders", "components"):
            self._forget_before(number)
        return None

    def _rows_of(self, number: int) -> list[int]:
        """The rows of what each task of a round takes: a tile, or a file of another cloud."""
        this = self._rounds[number]
        return self._other_rows[this.number] if this.kind == "other" else self._rows

    def _join(self, number: int, is_new: bool) -> tuple[int, int | None] | None:
        """Joins what the tasks of a round have left, unless an earlier process has. Returns what is damaged."""
        this = self._rounds[number]
        objects, r = self._place.objects, self._request
        names = [self._done[number][task].left for task in range(len(self._rows_of(number)))]
        try:
            key = _joined_by(number)
            if not is_new and self._place.has_object(key):
                return None
            shared = (objects, r.inputs[:1], r.stages, r.keep, r.options, r.outputs[:1], r.facts, this)
            if this.join == "tiles":
                _core.join_tiles(objects, names, r.others[this.number] if this.kind == "other" else r.inputs, key)
            if this.join in ("borders", "components"):
                _core.join_graph(*shared, self._joined_before(number, _stores_tiles), self._joined_before(number, _has_borders), names, key)
            if this.join == "pieces":
                options = {**r.options, "overwrite": "yes"} if self._done[number + 1] else r.options  # files of ours may be there
                _core.join_pieces(objects, r.inputs, r.stages, r.keep, options, r.outputs, r.facts, names, key)
            if this.join == "values":
                _core.join_values(*shared, self._joined_before(number, _has_values), names, key)
        except Error as error:
            damaged = _damaged_by(error)
            if damaged is None:
                raise
            return damaged
        return None

    def _go_back(self, number: int, tile: int | None) -> int:
        """Forgets that a task is done, or a round is joined, whose objects are damaged. If what the task needs is gone, all tasks begin again."""
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
        """Keeps every worker busy, with one more task each at hand."""
        from distributed import TimeoutError as late

        kind = self._rounds[number].kind
        left, tries = list(reversed(todo)), Counter[int]()
        running: dict[Any, tuple[int, float]] = {}
        rows = self._rows_of(number)
        points = sum(rows[tile] for tile in self._done[number])
        self._tell(kind, points, sum(rows))
        looked = time.monotonic()
        while left or any(tile not in self._done[number] for tile, _ in running.values()):
            self._place.require_lease()
            if time.monotonic() - looked > _LOOK_SECONDS:
                self._double_slow(number, running)
                looked = time.monotonic()
            window = 2 * max(1, len(self._client.scheduler_info(n_workers=-1)["workers"]))
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
            except late:  # its worker has it, and does not answer
                self._hanging.update(*self._client.who_has([future]).values())
                left.append(tile)
                continue
            except CancelledError:
                raise _scheduler_gone() from None
            except Exception as error:  # noqa: BLE001 - of the task, of its worker or of the scheduler
                if self._client.status not in ("running", "connecting"):
                    raise _scheduler_gone() from None
                damaged = _damaged_by(error)
                tries[tile] += 1
                if isinstance(error, (Error, UsageError)) and damaged is None:
                    raise
                if tries[tile] >= _MOST_TRIES:
                    raise Error(
                        f"{self._path_of(number, tile)}: its task has failed {tries[tile]} times ({type(error).__name__}: {error}); give"
                        " workers more memory than memory= says, or look at their logs."
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
        for copy in running:  # of tasks that another worker has done
            copy.cancel()
        return None

    def _next(self, running: dict[Any, Any]) -> Any:
        """The next future that is done; None if none is for a while."""
        from distributed import TimeoutError as late
        from distributed import wait

        try:
            wait(list(running), timeout=_LOOK_SECONDS, return_when="FIRST_COMPLETED")
        except late:
            if self._client.status not in ("running", "connecting"):
                raise _scheduler_gone() from None
            return None
        except CancelledError:  # what the scheduler knew is lost
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
            "catalogue": self._joined_before(number, _stores_tiles),
            "values": self._joined_before(number, _has_values),
            "borders": self._joined_before(number, _has_borders),
            "components": self._joined_before(number, lambda round: round.join == "components"),
            "pieces": self._joined_before(number, lambda round: round.join == "pieces"),
            "other_catalogue": self._joined_before(number, lambda round: (round.kind, round.number) == ("other", this.number)),
        }
        key = f"{_PHASES[this.kind]}-{number}-{tile}-{time.monotonic_ns()}"
        return self._client.submit(perform, self._place.request, self._place.objects, task, key=key, pure=False, workers=self._workers())

    def _workers(self) -> list[str] | None:
        """Those that seem to work, where some seem to hang."""
        if not self._hanging:
            return None
        return [worker for worker in self._client.scheduler_info(n_workers=-1)["workers"] if worker not in self._hanging] or None

    def _path_of(self, number: int, task: int) -> str:
        this = self._rounds[number]
        if this.kind in DIVIDING:
            return f"{this.kind} {task + 1} of {self._tiles}"
        return self._request.others[this.number][task] if this.kind == "other" else self._request.inputs[task]

    def _joined_before(self, number: int, is_wanted: Callable[[Round], bool]) -> str:
        """The name of what the last of these rounds before round `number` has left of all tiles; empty: there is none."""
        return next((_joined_by(n) for n in reversed(range(number)) if is_wanted(self._rounds[n])), "")

    def _double_slow(self, number: int, running: dict[Any, Any]) -> None:
        """Gives tasks that may hang to another worker, too."""
        if self._longest == 0:
            return  # how long a task takes is not known
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

    def _divides(self) -> bool:
        return self._rounds[-1].kind in DIVIDING

    def _tell(self, kind: str, points: int, of: int) -> None:
        if self._progress is not None:
            self._progress(_PHASES[kind], points, of)

    def statistics(self, seconds: float) -> str:
        """What a report of the run says, as the library writes it for a run of one process, and what each worker did."""
        last = self._done[-1].values()
        tasks = [done for of_round in self._done for done in of_round.values()]
        sweeps = [d for of_round, r in zip(self._done, self._rounds) if any(step.kind == "sweep" for step in r.steps) for d in of_round.values()]
        workers: dict[str, dict[str, float]] = {}
        for done in tasks:
            worker = workers.setdefault(done.worker, {"tasks": 0, "seconds": 0.0, "peak_rss_bytes": 0})
            worker["tasks"] += 1
            worker["seconds"] += done.seconds
            worker["peak_rss_bytes"] = max(worker["peak_rss_bytes"], done.peak_bytes)
        warnings = list(dict.fromkeys(sentence for done in (tasks if self._divides() else last) for sentence in done.warnings))
        for sentence in warnings:
            warn(sentence)
        return json.dumps(
            {
                "points": sum(self._rows),
                "points_written": sum(done.written for done in last),
                "warnings": warnings,
                "seconds": {"total": seconds, "tasks": sum(done.seconds for done in tasks)},
                "bytes": {"read": sum(d.bytes_read for d in tasks), "written": sum(d.bytes_written for d in tasks), "scratch": sum(d.bytes_in_scratch for d in tasks)},
                "files": sum(done.files for done in last) if self._divides() else self._tiles,
                "points_swept_over_own": sum(d.swept for d in sweeps) / max(1, sum(d.own for d in sweeps)),
                "tasks": len(tasks),
                "workers": workers,
            }
        )


def _stores_tiles(round: Round) -> bool:
    return round.join == "tiles" and round.kind != "other"


def _has_borders(round: Round) -> bool:
    return round.join == "borders"


def _has_values(round: Round) -> bool:
    return round.join == "values"


def _joined_by(number: int) -> str:
    return f"joined-{number:02d}"


def _sums_before(rows: list[int]) -> list[int]:
    sums, before = [], 0
    for count in rows:
        sums.append(before)
        before += count
    return sums


def _damaged_by(error: BaseException) -> tuple[int, int | None] | None:
    """(round, tile) of the task that has left what the sentence calls damaged; no tile: it was made of what all have left."""
    text = str(error)
    parts = text.removesuffix(": is damaged.").split(".", 1)[0].split("-")
    if not text.endswith(": is damaged."):
        return None
    if parts[0] == "joined" and len(parts) > 1 and parts[1].isdigit():
        return int(parts[1]), None
    if len(parts) != 3 or not (parts[0].isdigit() and parts[1].isdigit()):
        return None
    return int(parts[0]), int(parts[1])


def _scheduler_gone() -> Error:
    return Error("client: the scheduler is gone; start it again and give the same command, which goes on where this one was.")
