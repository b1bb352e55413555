# SPDX-License-Identifier: MIT
"""The scratch of a run of many processes: a folder that all of them see. It says who works in it and what is done."""

from __future__ import annotations

import json
import os
import shutil
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ._errors import Error, UsageError

STALE_SECONDS = 120.0  #: after which a lease that nobody renews may be taken over
_RENEWAL_SECONDS = 10.0
_OBJECTS, _LEASE, _RUN, _OTHERS, _REQUEST, _DONE = "objects", "lease.json", "run.json", "others.json", "request.pickle", "done.jsonl"


class Scratch:
    """A folder that this process alone gives work to, until it is closed."""

    def __init__(self, folder: str, identity: dict[str, Any], take_over: bool) -> None:
        """Raises `Error` where another process works in the folder, or another run has begun there."""
        self.path = Path(folder)
        self._made = not self.path.exists()
        try:
            self.path.mkdir(exist_ok=True)
        except OSError as error:
            raise Error(f"{folder}: cannot be made: {error.strerror}; name a folder that all workers see.") from None
        self._lease = {"host": socket.gethostname(), "process": os.getpid(), "since": time.strftime("%Y-%m-%d %H:%M:%S")}
        self._take_lease(take_over)
        self.lost = False  #: whether another process has taken over
        self._closing = threading.Event()
        self._renewal = threading.Thread(target=self._renew, daemon=True)
        self._renewal.start()
        try:
            self._begin(identity)
        except BaseException:
            self.close()
            raise

    @property
    def objects(self) -> Path:
        """The folder of what tasks leave."""
        return self.path / _OBJECTS

    @property
    def request(self) -> Path:
        """The file with the arguments that all tasks share."""
        return self.path / _REQUEST

    def _begin(self, identity: dict[str, Any]) -> None:
        run = self.path / _RUN
        found = [name for name in os.listdir(self.path) if not name.startswith(_LEASE)]
        if run.exists():
            before = json.loads(run.read_text())
            if before != identity:
                changed = next(key for key in {**before, **identity} if before.get(key) != identity.get(key))
                raise UsageError(
                    f"{self.path}: holds another run, whose {changed} differ; give the same command to finish it, remove the"
                    " folder, or name another one."
                )
        elif found:
            raise UsageError(f"{self.path}: holds {found[0]}, which is no run; name an empty folder.")
        else:
            self.objects.mkdir()
            _write(run, json.dumps(identity))

    def require_unchanged(self, states: dict[str, tuple[int, int]]) -> None:
        """Notes the states of files that the run reads beside its inputs. Raises `Error` if one has changed since it began."""
        others = self.path / _OTHERS
        found = {path: list(state) for path, state in states.items()}
        if not others.exists():
            return _write(others, json.dumps(found))
        before = json.loads(others.read_text())
        changed = next((path for path in {**before, **found} if before.get(path) != found.get(path)), None)
        if changed is not None:
            raise Error(f"{changed}: has changed since the run began; remove {self.path}, and begin again.")

    def done(self) -> Iterator[dict[str, Any]]:
        """What earlier processes have noted, in their order."""
        try:
            lines = (self.path / _DONE).read_text().splitlines()
        except FileNotFoundError:
            return
        for line in lines:
            try:
                yield json.loads(line)
            except ValueError:  # the last line of a process that was killed
                return

    def has_begun(self) -> bool:
        """Whether a task is done."""
        return (self.path / _DONE).exists()

    def note(self, **fact: Any) -> None:
        """Notes that a task is done."""
        with open(self.path / _DONE, "a", encoding="utf-8") as file:
            file.write(json.dumps(fact) + "\n")

    def require_room(self, needed: int) -> None:
        """Raises `Error` if the folder has no room for `needed` bytes."""
        free = shutil.disk_usage(self.path).free
        if free < needed:
            raise Error(
                f"{self.path}: has {free:,} bytes free, and the run puts up to {needed:,} there; free some, or name another folder"
                " as the scratch."
            )

    def require_lease(self) -> None:
        """Raises `Error` if another process has taken over."""
        if self.lost:
            raise Error(f"{self.path}: another process has taken over this run; this one has stopped.")

    def remove(self) -> None:
        """After the run: nothing of it stays."""
        self.close()
        for name in (_RUN, _OTHERS, _REQUEST, _DONE):
            (self.path / name).unlink(missing_ok=True)
        shutil.rmtree(self.objects, ignore_errors=True)
        if self._made:
            try:
                self.path.rmdir()
            except OSError:
                pass

    def close(self) -> None:
        """Lets other processes work in the folder."""
        self._closing.set()
        if self._renewal.is_alive():
            self._renewal.join()
        if not self.lost:
            (self.path / _LEASE).unlink(missing_ok=True)

    def _take_lease(self, take_over: bool) -> None:
        lease = self.path / _LEASE
        text = json.dumps(self._lease)
        try:
            with open(lease, "x", encoding="utf-8") as file:
                file.write(text)
            return
        except FileExistsError:
            pass
        except OSError as error:
            raise Error(f"{self.path}: cannot be written: {error.strerror}; name a folder that all workers see.") from None
        age = self._now() - lease.stat().st_mtime
        if age < STALE_SECONDS and not take_over:
            other = _read(lease)
            raise Error(
                f"{self.path}: process {other.get('process')} on {other.get('host')} works in it since {other.get('since')}; wait for"
                " it, or, if it is gone, wait two minutes or take over (take_over=True, --take-over)."
            )
        _write(lease, text)

    def _now(self) -> float:
        """The time by the clock of the folder, which may be on another machine."""
        probe = self.path / f"{_LEASE}.{socket.gethostname()}-{os.getpid()}"
        probe.write_text("")
        try:
            return probe.stat().st_mtime
        finally:
            probe.unlink()

    def _renew(self) -> None:
        lease = self.path / _LEASE
        while not self._closing.wait(_RENEWAL_SECONDS):
            if _read(lease) != self._lease:
                self.lost = True
                return
            try:
                os.utime(lease)
            except OSError:  # gone for a while
                pass


def _read(lease: Path) -> dict[str, Any]:
    try:
        found = json.loads(lease.read_text())
        return found if isinstance(found, dict) else {}
    except (OSError, ValueError):
        return {}


def _write(path: Path, text: str) -> None:
    beside = path.with_name(f"{path.name}.{os.getpid()}")
    beside.write_text(text)
    os.replace(beside, path)
