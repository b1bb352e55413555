# SPDX-License-Identifier: MIT
"""The shared storage of a run of many processes, called scratch: a folder, or a prefix in a bucket, that all processes can
access. It holds the results of tasks, the list of finished tasks, and the lease of the process that distributes the work."""

from __future__ import annotations

import json
import os
import socket
import threading
import time
from collections.abc import Iterator
from typing import Any

from ._errors import Error, UsageError
from ._places import place_of

STALE_SECONDS = 120.0  #: age after which another process may take over a lease
_RENEWAL_SECONDS = 10.0
_OBJECTS, _LEASE, _RUN, _OTHERS = "objects/", "lease.json", "run.json", "others.json"
_REQUEST, _DONE = "request.pickle", "done.jsonl"


def _as_json(identity: dict[str, Any]) -> str:
    return json.dumps(identity, default=bytes.hex)  # a coordinate system holds bytes


class Scratch:
    """A scratch in which only this process distributes work, until it is closed."""

    def __init__(self, place: str, identity: dict[str, Any], take_over: bool) -> None:
        """Raises `Error` if another process works in the place, or another run has begun there."""
        self.path = place
        self._place = place_of(place)
        self._made = self._place.make()
        self._lease = {"host": socket.gethostname(), "process": os.getpid(), "since": time.strftime("%Y-%m-%d %H:%M:%S")}
        self._take_lease(take_over)
        self._has_noted = False
        self.lost = False  #: True if another process has taken over the lease
        self._closing = threading.Event()
        self._renewal = threading.Thread(target=self._renew, daemon=True)
        self._renewal.start()
        try:
            self._begin(identity)
        except BaseException:
            self.close()
            raise

    @property
    def objects(self) -> str:
        """The path of the folder in which tasks store their results."""
        return self._place.path_of(_OBJECTS)

    def has_object(self, key: str) -> bool:
        return self._place.exists(_OBJECTS + key)

    def remove_object(self, key: str) -> None:
        self._place.remove(_OBJECTS + key)

    @property
    def request(self) -> str:
        """The path of the arguments that all tasks share."""
        return self._place.path_of(_REQUEST)

    def has_request(self) -> bool:
        return self._place.exists(_REQUEST)

    def seal_request(self, content: bytes) -> None:
        self._place.write(_REQUEST, content)

    def _begin(self, identity: dict[str, Any]) -> None:
        found = [name for name in self._place.names() if not name.startswith(_LEASE)]
        run = self._place.read(_RUN)
        if run is not None:
            before, now = json.loads(run), json.loads(_as_json(identity))
            if before != now:
                changed = next(key for key in {**before, **now} if before.get(key) != now.get(key))
                raise UsageError(
                    f"{self.path}: holds another run, whose {changed} differ; give the same command to finish it, remove the"
                    " folder, or name another one."
                )
        elif found:
            raise UsageError(f"{self.path}: holds {found[0]}, which is no run; name an empty folder.")
        else:
            self._place.path_of(_OBJECTS)
            self._place.write(_RUN, _as_json(identity).encode())

    def require_unchanged(self, states: dict[str, tuple[int, int | str]]) -> None:
        """Records the states of files that the run reads besides its inputs. Raises `Error` if one has changed since the run began."""
        found = {path: list(state) for path, state in states.items()}
        noted = self._place.read(_OTHERS)
        if noted is None:
            return self._place.write(_OTHERS, json.dumps(found).encode())
        before = json.loads(noted)
        changed = next((path for path in {**before, **found} if before.get(path) != found.get(path)), None)
        if changed is not None:
            raise Error(f"{changed}: has changed since the run began; remove {self.path}, and begin again.")

    def done(self) -> Iterator[dict[str, Any]]:
        """Yields the records of finished tasks that note() has written, in order, those of earlier processes included."""
        for line in (self._place.read(_DONE) or b"").splitlines():
            try:
                yield json.loads(line)
            except ValueError:  # an incomplete last line, of a process that was killed
                return

    def has_begun(self) -> bool:
        """Returns whether any task is done."""
        self._place.flush()
        return self._has_noted or self._place.exists(_DONE)

    def note(self, **fact: Any) -> None:
        """Records that a task is done. The record may be written a little later: without it, the task is performed again."""
        self._has_noted = True
        self._place.append(_DONE, json.dumps(fact))

    def flush(self) -> None:
        """Writes all records. Must be called before data that a task has needed are removed."""
        self._place.flush()

    def require_room(self, needed: int) -> None:
        """Raises `Error` if the place has no room for `needed` bytes."""
        free = self._place.free_bytes()
        if free is not None and free < needed:
            raise Error(
                f"{self.path}: has {free:,} bytes free, and the run puts up to {needed:,} there; free some, or name another folder"
                " as the scratch."
            )

    def require_lease(self) -> None:
        """Raises `Error` if another process has taken over the lease."""
        if self.lost:
            raise Error(f"{self.path}: another process has taken over this run; this one has stopped.")

    def remove(self) -> None:
        """Removes all files of the run, and the place itself if this process has made it. Ends the lease. A process that is
        killed in the middle leaves a run with no finished task, which the same command begins again."""
        for name in (_DONE, _REQUEST, _OBJECTS, _OTHERS, _RUN):
            self._place.remove(name)
        self.close()
        if self._made:
            self._place.remove_itself()

    def close(self) -> None:
        """Writes all records and ends the lease, so that another process can continue the run."""
        self._closing.set()
        if self._renewal.is_alive():
            self._renewal.join()
        if not self.lost:
            self._place.flush()
            self._place.remove(_LEASE)

    def _take_lease(self, take_over: bool) -> None:
        text = json.dumps(self._lease).encode()
        if self._place.write_new(_LEASE, text):
            return
        if not take_over and self._place.age(_LEASE) < STALE_SECONDS:
            other = self._holder()
            raise Error(
                f"{self.path}: process {other.get('process')} on {other.get('host')} works in it since {other.get('since')}; wait for"
                " it, or, if it is gone, wait two minutes or take over (take_over=True, --take-over)."
            )
        self._place.write(_LEASE, text)

    def _renew(self) -> None:
        while not self._closing.wait(_RENEWAL_SECONDS):
            try:
                if self._holder() != self._lease:
                    self.lost = True
                    return
                self._place.touch(_LEASE)
            except (Error, OSError):  # the place may be unreachable for a while; the next try follows
                pass

    def _holder(self) -> dict[str, Any]:
        try:
            found = json.loads(self._place.read(_LEASE) or b"{}")
            return found if isinstance(found, dict) else {}
        except ValueError:
            return {}
