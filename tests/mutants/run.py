# SPDX-License-Identifier: MIT
"""Applies each deliberate mistake of mutants.py to a copy of the source, builds what it touches and runs the tests.

A mutant is caught when a test fails, crashes or hangs, or when the copy no longer compiles (which is reported, since
such a mutant proves nothing). One that passes every test survives: a hole in the tests, or a change that cannot be seen,
which tests/mutants/README.md must explain. The exit status is 1 if a mutant survives that is not explained there.

The test that caught a mutant last time is tried first, then the tests the mutant names, then all others.
"""
import argparse
import json
import os
import pathlib
import sys
import time

from mutants import MUTANTS
from mutated_copy import Copy, digest, mistake

ROOT = pathlib.Path(__file__).resolve().parents[2]
RESULT = ROOT / "tests/mutants/result.json"
# Folders that look at whole runs come last: a mistake is usually seen where it was made.
ORDER = ["math", "points", "levels", "search", "order", "operators", "sweep", "oracles", "formats", "threads", "pipeline", "laws", "reference",
         "verify", "cli", "shapes", "render", "report", "faults", "fuzz", "pipelines"]


def attempts(mutant, last, folders):
    """Pairs of a folder and a filter of its tests, in the order in which they are tried."""
    first = []
    if last and last["outcome"] == "caught":
        first.append(last["by"].split(" (")[0].split("/", 1))
    first += [word.split(":", 1) if ":" in word else [word, "*"] for word in mutant.tests]
    others = sorted(folders, key=lambda f: ORDER.index(f) if f in ORDER else len(ORDER))
    tried = []
    for folder, tests in [tuple(pair) for pair in first if pair[0] in folders] + [(f, "*") for f in others]:
        if (folder, "*") not in tried and (folder, tests) not in tried:
            tried.append((folder, tests))
    return tried


def verdict_of(copy, mutant, last):
    changed, trouble = mistake(copy.source, mutant)
    if trouble:
        return "stale", trouble
    path = copy.source / mutant.file
    original = path.read_text()
    path.write_text(changed)
    try:
        for folder, tests in attempts(mutant, last, copy.folders()):
            errors = copy.make([folder])
            if errors:
                return "does not compile", errors.strip().splitlines()[-3:]
            failed = copy.first_failure(folder, tests)
            if failed:
                return "caught", failed
        return "survived", None
    finally:
        path.write_text(original)


def confirm(copy, known):
    """Marks what was caught by a test that passes without any mistake, and forgets what was caught by another one."""
    catchers = {}
    for row in known.values():
        if row["outcome"] == "caught" and not row.get("confirmed"):
            folder, test = row["by"].split(" (")[0].split("/", 1)
            catchers.setdefault(folder, {}).setdefault(test, []).append(row)
    for folder, rows in sorted(catchers.items()):
        errors = copy.make([folder])
        if errors:
            sys.exit(errors)
        while rows and (failed := copy.first_failure(folder, ":".join(sorted(rows)))):
            print(f"{failed} fails without any mistake", flush=True)
            for row in rows.pop(failed.split(" (")[0].split("/", 1)[1]):
                del known[row["name"]]
        for row in [row for same in rows.values() for row in same]:
            row["confirmed"] = True


def explained():
    """Names of the survivors that the README explains, each as `name` at the begin of a list item."""
    text = (ROOT / "tests/mutants/README.md").read_text()
    return {line[3:line.index("`", 3)] for line in text.splitlines() if line.startswith("- `")}


def last_results():
    return {r["name"]: r for r in json.loads(RESULT.read_text())} if RESULT.exists() else {}


def is_settled(mutant, row):
    """Whether the last result still holds: the mutant and the file it changes have the same text."""
    good = row and (row["outcome"] == "caught" or (row["outcome"] == "survived" and mutant.name in explained()))
    return bool(good and row["text"] == digest(ROOT, mutant))


def show(chosen, last):
    for m in chosen:
        row = last.get(m.name)
        _, trouble = mistake(ROOT, m)
        state = row["outcome"] if row else "not tried"
        if row and row["text"] != digest(ROOT, m):
            state += ", before the text changed"
        print(f"{m.area:12} {m.name} ({m.file}): " + (f"STALE, {trouble}" if trouble else state))


def save(known):
    rows = [known[m.name] for m in MUTANTS if m.name in known]
    RESULT.write_text("[\n" + ",\n".join(" " + json.dumps(row) for row in rows) + "\n]\n")


def arguments():
    parser = argparse.ArgumentParser(prog="script/mutants", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", metavar="TEXT", help="mutants whose name, area or file contains TEXT")
    parser.add_argument("--list", action="store_true", help="print the mutants, whether each still applies, and its last result")
    parser.add_argument("--continue", action="store_true", dest="go_on",
                        help="only what has no result yet, survived unexplained, or whose file has changed since")
    parser.add_argument("--new", action="store_true", help="only what has no result yet")
    parser.add_argument("--jobs", metavar="N", type=int, default=os.cpu_count(),
                        help="processes of a build, and parts of a test program that run at once (default: the cores)")
    parser.add_argument("--minutes", metavar="N", type=float, default=float("inf"), help="begin no mutant after N minutes")
    parser.add_argument("--wait-while", metavar="FILE", type=pathlib.Path,
                        help="wait before a build or a test program while FILE exists, e.g. as long as something is measured")
    return parser.parse_args()


def summary(chosen, known):
    rows = [known[m.name] for m in chosen if m.name in known]
    survivors = [r["name"] for r in rows if r["outcome"] == "survived"]
    useless = [r["name"] for r in rows if r["outcome"] not in ("survived", "caught")]
    print(f"{len(chosen)} mutants: {sum(r['outcome'] == 'caught' for r in rows)} caught, {len(survivors)} survived, "
          f"{len(useless)} could not be tried, {len(chosen) - len(rows)} left")
    for name in survivors:
        print(f"survived: {name}" + (" (explained)" if name in explained() else ""))
    for name in useless:
        print(f"could not be tried: {name}: {known[name]['outcome']}: {known[name]['by']}")
    return 1 if useless or set(survivors) - explained() else 0


def main():
    options = arguments()
    chosen = [m for m in MUTANTS if not options.only or options.only in f"{m.name}|{m.area}|{m.file}"]
    last = last_results()
    if options.list:
        return show(chosen, last)
    # A run of all mutants begins with an empty result; another one changes the rows of what it tries.
    known = dict(last) if options.go_on or options.new or options.only else {}
    wanted = [m for m in chosen if not options.go_on or not is_settled(m, last.get(m.name))]
    if options.new:
        wanted = [m for m in wanted if m.name not in last]
    # Headers last, since they cost many compilations; neighbours in this order share them.
    wanted.sort(key=lambda m: (not m.file.endswith(".cpp"), m.file))
    copy = Copy(ROOT, {m.file for m in MUTANTS}, options.jobs, options.wait_while)
    begun = time.time()
    if wanted:
        copy.refresh()
    for number, mutant in enumerate(wanted, 1):
        since = time.time()
        if since - begun > 60 * options.minutes:
            break
        outcome, detail = verdict_of(copy, mutant, last.get(mutant.name))
        known[mutant.name] = {"name": mutant.name, "file": mutant.file, "text": digest(copy.source, mutant),
                              "outcome": outcome, "by": detail}
        print(f"{number:3}/{len(wanted)} {outcome:9} {time.time() - since:5.0f} s  {mutant.name}: {detail or ''}", flush=True)
        save(known)
    if wanted:
        confirm(copy, known)
        save(known)
    return summary(chosen, known)


if __name__ == "__main__":
    sys.exit(main())
