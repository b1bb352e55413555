# SPDX-License-Identifier: MIT
"""A copy of the project in build/mutants, where tests/mutants/run.py makes its mistakes."""
import hashlib
import os
import shutil
import subprocess
import sys
import time

LIMIT_SECONDS = 900  # of one test program


def run(command, **more):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **more)


def mistake(root, mutant):
    """The text of the file with the mistake in it, or an explanation why there is none."""
    path = root / mutant.file
    if not path.exists():
        return None, f"{mutant.file} does not exist"
    text = path.read_text()
    if text.count(mutant.find) != 1:
        return None, f"its text occurs {text.count(mutant.find)} times in {mutant.file}"
    return text.replace(mutant.find, mutant.put), None


def digest(root, mutant):
    """Of the mistake and of the file it is made in."""
    path = root / mutant.file
    text = path.read_text() if path.exists() else ""
    return hashlib.sha256("\0".join([text, mutant.find, mutant.put]).encode()).hexdigest()[:16]


class Copy:
    """The tracked files of the project and a build of them.

    `mutated` are the files that some mutant changes: each is compiled alone, not with its folder as usual, so that a
    mistake costs the compilation of one file.
    """

    def __init__(self, root, mutated, jobs, wait_while):
        # Two levels below its source, as build/release is, so that a cache of compilations knows what it has compiled there.
        self.root, self.source, self.build = root, root / "build/mutants", root / "build/mutants/build/release"
        self.mutated, self.jobs, self.wait_while = mutated, jobs, wait_while

    def wait(self):
        while self.wait_while and self.wait_while.exists():
            time.sleep(2)

    def refresh(self):
        """Copies what changed, so that a second run builds little."""
        names = run(["git", "ls-files", "-z"], cwd=self.root).stdout.split("\0")
        wanted = {name for name in names if name and (self.root / name).is_file()}
        for old in self.files():
            if str(old.relative_to(self.source)) not in wanted:
                old.unlink()
        for name in wanted:
            to = self.source / name
            if to.exists() and to.read_bytes() == (self.root / name).read_bytes():
                continue
            to.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(self.root / name, to)
            os.utime(to)
        alone = ";".join(sorted(name for name in self.mutated if name.endswith(".cpp")))
        done = run(["cmake", "-S", self.source, "-B", self.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                    "-DCMAKE_COMPILE_WARNING_AS_ERROR=OFF", "-DCMAKE_CXX_FLAGS=-D_GLIBCXX_ASSERTIONS",
                    "-DPOINTSWEEP_COMMIT=mutant", f"-DPOINTSWEEP_COMPILED_ALONE={alone}"])
        if done.returncode:
            sys.exit(done.stdout)

    def files(self):
        """Of the copy, not of its build."""
        found = self.source.rglob("*") if self.source.exists() else []
        return [p for p in found if p.is_file() and self.source / "build" not in p.parents]

    def make(self, folders):
        """Builds test programs; returns what the compiler says if that fails, else nothing."""
        self.wait()
        targets = [word for folder in folders for word in ("--target", f"test_{folder}")]
        done = run(["cmake", "--build", self.build, "--parallel", str(self.jobs), *targets])
        return done.stdout if done.returncode else ""

    def folders(self):
        return sorted(f.name for f in (self.source / "tests").iterdir() if any(f.glob("*_test.cpp")))

    def first_failure(self, folder, tests):
        """Runs the tests of one program that match the filter, in shards; returns the name of one that failed, or None."""
        self.wait()
        program = self.build / "tests" / f"test_{folder}"
        if "  " not in run([program, f"--gtest_filter={tests}", "--gtest_list_tests"]).stdout:
            return None  # the filter is older than the tests, or newer
        shards = 1 if folder in ("cli", "faults") or (tests != "*" and "*" not in tests) else self.jobs
        environment = dict(os.environ, GTEST_FAIL_FAST="1", GTEST_TOTAL_SHARDS=str(shards),
                           POINTSWEEP_DATA=os.environ.get("POINTSWEEP_DATA", str(self.root / "../shared/data")))
        logs = [open(self.build / f"mutant-{s}.log", "w+") for s in range(shards)]
        children = [subprocess.Popen([program, f"--gtest_filter={tests}"], stdout=logs[s], stderr=subprocess.STDOUT,
                                     cwd=self.build, env=dict(environment, GTEST_SHARD_INDEX=str(s)))
                    for s in range(shards)]
        try:
            return self.outcome(folder, children, logs)
        finally:
            for child, log in zip(children, logs):
                if child.poll() is None:
                    child.kill()
                child.wait()
                log.close()

    def outcome(self, folder, children, logs):
        deadline = time.time() + LIMIT_SECONDS
        while time.time() < deadline:
            states = [child.poll() for child in children]
            for state, log in zip(states, logs):
                if state not in (None, 0):
                    return self.name_in(folder, log, state)
            if None not in states:
                return None
            time.sleep(0.02)
        return self.name_in(folder, logs[0], f"no end after {LIMIT_SECONDS} s")

    @staticmethod
    def name_in(folder, log, status):
        log.seek(0)
        lines = log.read().splitlines()
        for line in lines:
            if line.startswith("[  FAILED  ]"):
                return f"{folder}/{line.split()[3].rstrip(',')}"
        running = [line.split()[-1] for line in lines if line.startswith("[ RUN      ]")]
        return f"{folder}/{running[-1] if running else '*'} (status {status})"
