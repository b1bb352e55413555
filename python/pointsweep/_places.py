# SPDX-License-Identifier: MIT
"""Small files that several processes share, in a folder or in a bucket."""

from __future__ import annotations

import os
import shutil
import socket
import time
from pathlib import Path
from typing import Protocol

from . import _core
from ._errors import Error
from ._urls import is_url

_JOURNAL_SECONDS = 2.0  # least time between two writes of a journal (a file to which lines are appended) in a bucket


class Place(Protocol):
    """Named files. A written file becomes visible only as a whole."""

    name: str

    def make(self) -> bool:
        """Makes the place if it does not exist. Returns whether it was made. Raises `Error` if that is not possible."""

    def path_of(self, name: str) -> str: ...
    def names(self) -> list[str]: ...
    def exists(self, name: str) -> bool: ...
    def read(self, name: str) -> bytes | None: ...
    def write(self, name: str, content: bytes) -> None: ...

    def write_new(self, name: str, content: bytes) -> bool:
        """Writes a new file and returns True. Returns False, and writes nothing, if a file with this name exists."""

    def age(self, name: str) -> float:
        """Returns the seconds since a file was written or touched, by the clock of the place."""

    def touch(self, name: str) -> None: ...
    def append(self, name: str, line: str) -> None: ...

    def flush(self) -> None:
        """Writes the lines that append() has not written yet."""

    def remove(self, name: str) -> None:
        """Removes the file with this name, or the folder with its contents if the name ends with "/". A missing one is no error."""

    def remove_itself(self) -> None:
        """Removes the place if it is empty."""

    def free_bytes(self) -> int | None:
        """Returns the free bytes of the place; None if it has no limit."""


def place_of(name: str) -> Place:
    return Bucket(name) if is_url(name) else Folder(name)


class Folder:
    def __init__(self, name: str) -> None:
        self.name = name
        self._path = Path(name)

    def make(self) -> bool:
        made = not self._path.exists()
        try:
            self._path.mkdir(exist_ok=True)
        except OSError as error:
            raise Error(f"{self.name}: cannot be made: {error.strerror}; name a folder that all workers see.") from None
        return made

    def path_of(self, name: str) -> str:
        if name.endswith("/"):
            (self._path / name).mkdir(exist_ok=True)
        return str(self._path / name)

    def names(self) -> list[str]:
        return os.listdir(self._path)

    def exists(self, name: str) -> bool:
        return (self._path / name).exists()

    def read(self, name: str) -> bytes | None:
        try:
            return (self._path / name).read_bytes()
        except FileNotFoundError:
            return None

    def write(self, name: str, content: bytes) -> None:
        beside = self._path / f"{name}.{os.getpid()}"
        beside.write_bytes(content)
        os.replace(beside, self._path / name)

    def write_new(self, name: str, content: bytes) -> bool:
        try:
            with open(self._path / name, "xb") as file:
                file.write(content)
            return True
        except FileExistsError:
            return False
        except OSError as error:
            raise Error(f"{self.name}: cannot be written: {error.strerror}; name a folder that all workers see.") from None

    def age(self, name: str) -> float:
        probe = self._path / f"{name}.{socket.gethostname()}-{os.getpid()}"
        probe.write_text("")
        try:
            return probe.stat().st_mtime - (self._path / name).stat().st_mtime
        finally:
            probe.unlink()

    def touch(self, name: str) -> None:
        os.utime(self._path / name)

    def append(self, name: str, line: str) -> None:
        with open(self._path / name, "a", encoding="utf-8") as file:
            file.write(line + "\n")

    def flush(self) -> None:
        pass

    def remove(self, name: str) -> None:
        if name.endswith("/"):
            shutil.rmtree(self._path / name, ignore_errors=True)
        else:
            (self._path / name).unlink(missing_ok=True)

    def remove_itself(self) -> None:
        try:
            self._path.rmdir()
        except OSError:
            pass

    def free_bytes(self) -> int | None:
        return shutil.disk_usage(self._path).free


class Bucket:
    """A place of objects below a URL. Objects cannot be appended to: append() collects lines, and the whole journal is
    written again at intervals of _JOURNAL_SECONDS."""

    def __init__(self, name: str) -> None:
        self.name = name
        self._url = name if name.endswith("/") else name + "/"
        self._journal: dict[str, str] = {}
        self._kept_back = False
        self._written = 0.0

    def make(self) -> bool:
        return False

    def path_of(self, name: str) -> str:
        return self._url + name

    def names(self) -> list[str]:
        return sorted({url[len(self._url) :].split("/")[0] for url in _core.list_objects(self._url)})

    def exists(self, name: str) -> bool:
        return _core.object_state(self._url + name) is not None

    def read(self, name: str) -> bytes | None:
        return _core.get_object(self._url + name)

    def write(self, name: str, content: bytes) -> None:
        _core.put_object(self._url + name, content, True)

    def write_new(self, name: str, content: bytes) -> bool:
        return _core.put_object(self._url + name, content, False)

    def age(self, name: str) -> float:
        probe = f"{self._url}{name}.{socket.gethostname()}-{os.getpid()}"
        _core.put_object(probe, b"", True)
        try:
            now, then = _core.object_state(probe), _core.object_state(self._url + name)
            return now[1] - then[1] if now and then else 0.0
        finally:
            _core.remove_object(probe)

    def touch(self, name: str) -> None:
        content = self.read(name)
        if content is not None:
            self.write(name, content)

    def append(self, name: str, line: str) -> None:
        if name not in self._journal:
            self._journal[name] = (self.read(name) or b"").decode()
        self._journal[name] += line + "\n"
        self._kept_back = True
        if time.monotonic() - self._written > _JOURNAL_SECONDS:
            self.flush()

    def flush(self) -> None:
        if self._kept_back:
            for name, text in self._journal.items():
                self.write(name, text.encode())
            self._kept_back = False
        self._written = time.monotonic()

    def remove(self, name: str) -> None:
        self._journal.pop(name, None)
        for url in _core.list_objects(self._url + name) if name.endswith("/") else [self._url + name]:
            _core.remove_object(url)

    def remove_itself(self) -> None:
        pass

    def free_bytes(self) -> int | None:
        return None
