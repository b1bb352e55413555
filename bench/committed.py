# SPDX-License-Identifier: MIT
"""Results that are committed, and the tables that docs/performance.md and bench/log.md have of them."""
import datetime
import json
import statistics

import processes
from processes import ROOT


def begun(**figures):
    """A result of this day, commit and machine."""
    return {"date": datetime.date.today().isoformat(), "commit": processes.commit(), "machine": processes.machine(), **figures}


def file_of(result, kind, asked=None):
    """Returns the file for a result: `asked`, or one in bench/results."""
    return asked or ROOT / f"bench/results/{result['date']}-{result['commit'].rstrip('+')}-{kind}.json"


def write(path, result):
    path.write_text(json.dumps(result, indent=1) + "\n")


def read(paths):
    return [json.loads(path.read_text()) for path in paths]


def median(runs, figure):
    return statistics.median(run[figure] for run in runs)


def where(result):
    """Returns the machine and the commit of a result."""
    return f"{result['machine']['cpu']}, {result['machine']['cpus']} cores, commit {result['commit']}, {result['date']}"


def names(paths):
    return ", ".join(f"`{path.resolve().relative_to(ROOT)}`" for path in paths)


def write_table(kind, text):
    """Replaces the tables of script/bench KIND in docs/performance.md or bench/log.md, between the comments that begin and end them."""
    begin, end = f"<!-- {kind}: made by script/bench {kind} --table from committed results -->\n", f"<!-- end of {kind} -->"
    page = next(page for page in (ROOT / "docs/performance.md", ROOT / "bench/log.md") if begin in page.read_text())
    head, rest = page.read_text().split(begin)
    page.write_text(head + begin + text + end + rest.split(end)[1])
