# SPDX-License-Identifier: MIT
"""launch.py SAID COMMAND...: runs a command and prints its wall and CPU seconds, its peak resident bytes and the bytes that it
has read, in all and from disks, as JSON.

This is a separate process, because a child's peak counts what its parent held when it was started: a benchmark with arrays in
memory would report them as the peak of every small program. What the command says goes to the file SAID, if it is not
empty, else to standard error."""
import json
import os
import sys
import time

said, *command = sys.argv[1:]
to = [(os.POSIX_SPAWN_OPEN, 1, said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666)] if said else [(os.POSIX_SPAWN_DUP2, 2, 1)]
begin = time.monotonic()
pid = os.posix_spawnp(command[0], command, os.environ, file_actions=to)
os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT)
wall = time.monotonic() - begin
with open(f"/proc/{pid}/io") as file:
    moved = dict(line.split(": ") for line in file)
_, status, usage = os.wait4(pid, 0)
print(json.dumps({"status": os.waitstatus_to_exitcode(status), "wall_seconds": wall,
                  "user_seconds": usage.ru_utime, "cpu_seconds": usage.ru_utime + usage.ru_stime, "peak_rss_bytes": usage.ru_maxrss * 1024,
                  "read_bytes": int(moved["rchar"]), "disk_read_bytes": int(moved["read_bytes"])}))
