# SPDX-License-Identifier: MIT
"""Control groups of Linux with a hard limit of memory, page cache included."""
import contextlib
import os
import pathlib


def _own():
    """The folder of the control group of this process that limits memory, and the name of the file of the limit."""
    groups = dict(line.strip().split(":", 2)[1:] for line in open("/proc/self/cgroup"))
    if "memory" in groups:
        return pathlib.Path("/sys/fs/cgroup/memory") / groups["memory"].strip("/"), "memory.limit_in_bytes"
    return pathlib.Path("/sys/fs/cgroup") / groups.get("", "/").strip("/"), "memory.max"


@contextlib.contextmanager
def limited(limit, name=""):
    """Returns a function that moves a process, by default the calling one, into a new control group with this limit in bytes;
    None without a limit, and if groups cannot be made. The processes have to end before the context does."""
    if limit is None:
        yield None
        return
    parent, limit_file = _own()
    group = parent / f"pointsweep-{os.getpid()}{name}"
    try:
        group.mkdir()
    except OSError as error:
        print(f"without a hard limit of memory: {error}")
        yield None
        return
    try:
        (group / limit_file).write_text(str(limit))
    except OSError as error:
        group.rmdir()
        print(f"without a hard limit of memory: {error}")
        yield None
        return
    try:
        yield lambda pid=None: (group / "cgroup.procs").write_text(str(pid or os.getpid()))
    finally:
        group.rmdir()
