# SPDX-License-Identifier: MIT
"""The program that `pointsweep run TILES/ OUT/ --dask ADDRESS --scratch DIR` starts: a run on the workers of Dask, with
the messages of the tool."""

from __future__ import annotations

import json
import logging
import os
import sys
import time
import warnings
from typing import Any

from . import _core
from ._cluster import run_on_cluster
from ._crs import Crs
from ._errors import Error, UsageError, keep_names_of_tool
from ._files import open as open_files
from ._options import run_options
from ._stage_list import stages_of


class _Told:
    """Writes progress and messages to stderr."""

    def __init__(self, quiet: bool) -> None:
        self._quiet, self._terminal = quiet, sys.stderr.isatty() and os.environ.get("TERM") != "dumb"
        self._start, self._phase, self._shown = time.monotonic(), "", False

    def progress(self, phase: str, done: int, total: int) -> None:
        if self._quiet:
            return
        if self._terminal:
            sys.stderr.write(f"\r{phase} {100 * done // max(1, total)} %, {done / max(time.monotonic() - self._start, 1e-9):,.0f} points/s ")
            sys.stderr.flush()
            self._shown = True
        elif phase != self._phase:
            self._phase = phase
            self.say("note", f"{phase} {total:,} points")

    def say(self, severity: str, sentence: str) -> None:
        if self._quiet and severity != "error":
            return
        if self._shown:
            sys.stderr.write("\r\x1b[K")
            self._shown = False
        print(f"{severity}: {sentence}", file=sys.stderr)


def _silence_distributed() -> None:
    """Suppresses the log messages of Dask, since this program reports an error in one sentence."""
    try:
        import distributed  # noqa: F401
    except ImportError:
        return
    for name in list(logging.root.manager.loggerDict):
        if name.startswith("distributed"):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)


def _crs_of_tool(text: str) -> Any:
    """Converts a value of --crs as the tool does, so that outputs have the same bytes: codes become GeoTIFF keys."""
    if not text:
        return None
    known = _core.parse_crs(text)
    return "none" if known is None else Crs(known)


def main(request: dict[str, Any]) -> int:
    """Performs the request of the tool. Returns the exit status."""
    told = _Told(request["quiet"])
    keep_names_of_tool()
    _silence_distributed()
    warnings.showwarning = lambda message, *_, **__: told.say("warning", str(message))
    try:
        cloud = open_files(
            request["inputs"],
            format=request["format"],
            crs=_crs_of_tool(request["crs"]),
            replace_crs=request["replace_crs"],
            ignore_crs=request["ignore_crs"],
        )
        given = {**run_options(), **request["options"], **cloud._options}
        statistics = run_on_cluster(
            request["client"],
            request["scratch"],
            request["take_over"],
            list(cloud.files),
            stages_of(request["stages"]) if request["stages"] else [],
            request["keep"],
            given,
            request["outputs"],
            told.progress,
        )
    except UsageError as error:
        told.say("error", str(error))
        return 2
    except Error as error:
        told.say("error", str(error))
        return 1
    except KeyboardInterrupt:
        told.say("note", f"stopped; the same command goes on from {request['scratch']}.")
        return 130
    if request["stats"]:
        with open(request["stats"], "w" if request["options"].get("overwrite") else "x", encoding="utf-8") as file:
            file.write(statistics + "\n")
    counts = json.loads(statistics)
    seconds = counts["seconds"]["total"]
    told.say(
        "note",
        f"wrote {request['output']}: {counts['files']} files, {counts['points_written']} points in {seconds:.1f} s,"
        f" {counts['tasks']} tasks on {len(counts['workers'])} workers",
    )
    return 0
