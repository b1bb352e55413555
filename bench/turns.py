# SPDX-License-Identifier: MIT
"""Programs run in turn on one cloud, each answer checked before its time counts, and compared with one another."""
import dataclasses
import json
import pathlib
import statistics
import subprocess
import sys
from typing import Callable, Optional

import processes


@dataclasses.dataclass
class Case:
    label: str
    command: Callable            # function from the path of the output to a command
    over: Optional[str] = None   # label of the case it is compared with
    answer: str = ""             # cases of one answer must write the same bytes
    tool: bool = True            # True: the command is pointsweep, which writes statistics
    in_memory: bool = False      # True: the run must not spill
    timed: bool = True           # False: the case runs once, for its answer alone
    says: Optional[str] = None   # text that the command must print
    check: Optional[Callable] = None  # checks an answer, from an output and its figures, instead of "same bytes"; returns a remark


class Turns:
    def __init__(self, options, cases, suffix=".ply"):
        self.options, self.cases, self.suffix = options, cases, suffix
        self.answers, self.runs, self.remarks = {}, {}, {}

    def rows(self, **fields):
        """Returns one row for each timed case: medians, and medians of the ratios of all turns to another case."""
        try:
            for turn in range(self.options.repeat):
                for case in self.cases:
                    if case.timed or turn == 0:
                        self.run(case)
        finally:
            for path in [*self.answers.values(), self.options.work / "stats.json", self.options.work / "said"]:
                path.unlink(missing_ok=True)
        return [dict(fields, **self.row(case)) for case in self.cases if case.timed]

    def run(self, case):
        output, stats, said = (self.options.work / name for name in (f"output{self.suffix}", "stats.json", "said"))
        output.unlink(missing_ok=True)
        words = ["--stats", stats, "--temp-dir", self.options.work, "--force", "--quiet"] if case.tool else []
        figures = processes.run([*case.command(output), *words], said)
        if case.says and said.read_text().strip() != case.says:
            sys.exit(f"script/bench engine: {case.label} took {said.read_text().strip()}")
        if case.tool:
            figures.update(of_statistics(json.loads(stats.read_text())))
            for clock in ("wall_seconds", "cpu_seconds"):  # leaves out the time in which the reference engine counts the neighbours that it misses
                figures[clock] -= figures["audit_seconds"]
        if case.in_memory and figures["spilled_bytes"] != 0:
            sys.exit(f"script/bench engine: {case.label} spilled {figures['spilled_bytes']} bytes; choose a smaller --sizes")
        self.check(case, output, figures)
        self.runs.setdefault(case.label, []).append(figures)

    def check(self, case, output, figures):
        """Checks an output. The first output of each answer is kept for comparison with the others."""
        if case.answer not in self.answers:
            self.answers[case.answer] = output.rename(self.options.work / f"answer-{len(self.answers)}{self.suffix}")
            return
        answer = self.answers[case.answer]
        if case.check:
            self.remarks[case.label] = case.check(answer, output, figures)
        elif not processes.same_bytes(answer, output):
            sys.exit(f"script/bench engine: '{case.label}' writes other bytes than the first run of the same answer: {output}")
        output.unlink()

    def row(self, case):
        runs = self.runs[case.label]
        median = {figure: statistics.median(run[figure] for run in runs) for figure in runs[0]}
        row = {"program": case.label, "median": median, "runs": runs, "remark": self.remarks.get(case.label, "")}
        if case.over:
            turns = list(zip(runs, self.runs[case.over]))
            row["over"] = case.over
            row["ratio"] = {figure: statistics.median(run[figure] / base[figure] for run, base in turns)
                            for figure in ("wall_seconds", "cpu_seconds", "peak_rss_bytes", "busy_seconds")
                            if figure in runs[0] and figure in self.runs[case.over][0]}
        return row


def of_statistics(stats):
    """Returns figures of a run. `busy_seconds` is the time of search and operators, summed over threads, for each thread."""
    seconds = stats["seconds"]
    return {"order_seconds": seconds["order"], "write_seconds": seconds["write"], "total_seconds": seconds["total"],
            "busy_seconds": (seconds["search"] + sum(seconds["operators"].values())) / stats["threads"],
            "spilled_bytes": stats["bytes"]["spilled"], "audit_seconds": stats.get("reference", {}).get("audit_seconds", 0),
            "incomplete_share": 1 - stats["certified"] / stats["points"]}


def compare_normals(options):
    """Returns a check for Case: at most as many normals may differ as the run itself counts as not certain."""
    def check(answer, output, figures):
        share = figures["incomplete_share"]
        done = subprocess.run([options.build / "bench/compare_normals", answer, output, f"{share + 1e-9:.12f}"], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"script/bench engine: {output} differs from {answer}: {done.stdout}{done.stderr}")
        return f"{share:.1%} of the neighbourhoods not exact, {json.loads(done.stdout)['share']:.1%} of the normals differ"
    return check
