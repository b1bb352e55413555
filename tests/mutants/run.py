# SPDX-License-Identifier: MIT
"""Applies each deliberate mistake of mutants.py to a copy of the source, builds what it touches and runs the tests.

A mutant is caught when a test fails, crashes or hangs, or when the copy no longer compiles (which is reported, since
such a mutant proves nothing). One that passes every test survives: a hole in the tests, or a change that cannot be seen,
which tests/mutants/README.md must explain. The exit status is 1 if a mutant survives that is not explained there.
"""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

from mutants import MUTANTS

ROOT = pathlib.Path(__file__).resolve().parents[2]
RESULT = ROOT / "tests/mutants/result.json"
LIMIT_SECONDS = 900  # of one test program
# Folders that look at whole runs come last: a mistake is usually seen where it was made.
ORDER = ["math", "points", "search", "order", "operators", "sweep", "oracles", "formats", "threads", "pipeline", "reference",
         "verify", "cli", "shapes", "render", "report", "faults", "fuzz", "pipelines"]


def run(command, **more):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **more)


class Copy:
    """The tracked files of the project and a build of them, in build/mutants."""

    def __init__(self, folder):
        self.source, self.build = folder / "source", folder / "build"
        self.jobs = str(os.cpu_count())

    def refresh(self):
        """Copies what changed, so that a second run builds little."""
        names = run(["git", "ls-files", "-z"], cwd=ROOT).stdout.split("\0")
        wanted = {name for name in names if name and (ROOT / name).is_file()}
        for old in [p for p in self.source.rglob("*") if p.is_file()] if self.source.exists() else []:
            if str(old.relative_to(self.source)) not in wanted:
                old.unlink()
        for name in wanted:
            to = self.source / name
            if to.exists() and to.read_bytes() == (ROOT / name).read_bytes():
                continue
            to.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, to)
            os.utime(to)
        # -O1: half the time to compile, the same bytes in every result.
        done = run(["cmake", "-S", self.source, "-B", self.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                    "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG"])
        if done.returncode:
            sys.exit(done.stdout)

    def make(self, folders):
        targets = [word for folder in folders for word in ("--target", f"test_{folder}")]
        return run(["cmake", "--build", self.build, "--parallel", self.jobs, *targets])

    def folders(self):
        found = [f.name for f in (self.source / "tests").iterdir() if any(f.glob("*_test.cpp"))]
        return sorted(found, key=lambda f: ORDER.index(f) if f in ORDER else len(ORDER))

    def first_failure(self, folder):
        """Runs one test program in shards; returns the name of a failed test, or None."""
        program = self.build / "tests" / f"test_{folder}"
        shards = 1 if folder in ("cli", "faults") else os.cpu_count()
        environment = dict(os.environ, GTEST_FAIL_FAST="1", GTEST_TOTAL_SHARDS=str(shards),
                           POINTSWEEP_DATA=os.environ.get("POINTSWEEP_DATA", str(ROOT / "../shared/data")))
        logs = [open(self.build / f"mutant-{s}.log", "w+") for s in range(shards)]
        children = [subprocess.Popen([program], stdout=logs[s], stderr=subprocess.STDOUT, cwd=self.build,
                                     env=dict(environment, GTEST_SHARD_INDEX=str(s))) for s in range(shards)]
        failed, deadline = None, time.time() + LIMIT_SECONDS
        while failed is None and any(c.poll() is None for c in children):
            time.sleep(0.02)
            if time.time() > deadline:
                failed = f"{folder}: no end after {LIMIT_SECONDS} s"
            for child, log in zip(children, logs):
                if child.poll() not in (None, 0):
                    failed = self.name_in(folder, log, child.returncode)
        for child, log in zip(children, logs):
            if child.poll() is None:
                child.kill()
            if child.wait() != 0 and failed is None:
                failed = self.name_in(folder, log, child.returncode)
            log.close()
        return failed

    @staticmethod
    def name_in(folder, log, status):
        log.seek(0)
        lines = log.read().splitlines()
        for line in lines:
            if line.startswith("[  FAILED  ]"):
                return f"{folder}/{line.split()[3].rstrip(',')}"
        running = [line.split()[-1] for line in lines if line.startswith("[ RUN      ]")]
        return f"{folder}/{running[-1] if running else '?'} (status {status})"


def mistake(copy, mutant):
    """The file with the mistake in it, or an explanation why there is none."""
    path = copy.source / mutant.file
    if not path.exists():
        return None, f"{mutant.file} does not exist"
    text = path.read_text()
    if text.count(mutant.find) != 1:
        return None, f"its text occurs {text.count(mutant.find)} times in {mutant.file}"
    return text.replace(mutant.find, mutant.put), None


def verdict_of(copy, mutant):
    path = copy.source / mutant.file
    changed, trouble = mistake(copy, mutant)
    if trouble:
        return "stale", trouble
    original = path.read_text()
    path.write_text(changed)
    try:
        folders = copy.folders()
        first = [f for f in mutant.tests if f in folders]
        for group in [[f] for f in first] + [[f] for f in folders if f not in first]:
            built = copy.make(group)
            if built.returncode:
                return "does not compile", built.stdout.strip().splitlines()[-3:]
            for folder in group:
                failed = copy.first_failure(folder)
                if failed:
                    return "caught", failed
        return "survived", None
    finally:
        path.write_text(original)


def explained():
    """Names of the survivors that the README explains, each as `name` at the begin of a list item."""
    text = (ROOT / "tests/mutants/README.md").read_text()
    return {line[3:line.index("`", 3)] for line in text.splitlines() if line.startswith("- `")}


def arguments():
    parser = argparse.ArgumentParser(prog="script/mutants", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", metavar="TEXT", help="mutants whose name, area or file contains TEXT")
    parser.add_argument("--list", action="store_true", help="print the mutants and whether each still applies")
    parser.add_argument("--keep", action="store_true", help="merge what is tried into the last result")
    return parser.parse_args()


def main():
    options = arguments()
    chosen = [m for m in MUTANTS if not options.only or options.only in f"{m.name}|{m.area}|{m.file}"]
    copy = Copy(ROOT / "build/mutants")
    if options.list:
        copy.source = ROOT
        for m in chosen:
            _, trouble = mistake(copy, m)
            print(f"{m.area:12} {m.name} ({m.file})" + (f": STALE, {trouble}" if trouble else ""))
        return 0
    copy.refresh()
    built = copy.make(copy.folders())
    if built.returncode:
        sys.exit(built.stdout)
    for folder in copy.folders():
        failed = copy.first_failure(folder)
        if failed:
            sys.exit(f"{failed} fails without any mistake: nothing can be learned from mutants.")
    known = {r["name"]: r for r in json.loads(RESULT.read_text())["mutants"]} if options.keep and RESULT.exists() else {}
    for number, mutant in enumerate(chosen, 1):
        begun = time.time()
        outcome, detail = verdict_of(copy, mutant)
        known[mutant.name] = {"name": mutant.name, "area": mutant.area, "file": mutant.file, "outcome": outcome,
                              "by": detail}
        print(f"{number:3}/{len(chosen)} {outcome:9} {time.time() - begun:5.0f} s  {mutant.name}: {detail or ''}", flush=True)
        if not options.only or options.keep:
            revision = run(["git", "describe", "--always", "--dirty"], cwd=ROOT).stdout.strip()
            rows = [known[m.name] for m in MUTANTS if m.name in known]
            RESULT.write_text(json.dumps({"commit": revision, "mutants": rows}, indent=1) + "\n")
    rows = [known[m.name] for m in chosen]
    survivors = [r["name"] for r in rows if r["outcome"] == "survived"]
    useless = [r["name"] for r in rows if r["outcome"] not in ("survived", "caught")]
    print(f"{len(rows)} mutants: {sum(r['outcome'] == 'caught' for r in rows)} caught, {len(survivors)} survived, "
          f"{len(useless)} could not be tried")
    for name in survivors:
        print(f"survived: {name}" + (" (explained)" if name in explained() else ""))
    for name in useless:
        print(f"not tried: {name}: {known[name]['outcome']}: {known[name]['by']}")
    return 1 if useless or set(survivors) - explained() else 0


if __name__ == "__main__":
    sys.exit(main())
