# SPDX-License-Identifier: MIT
"""The law of --memory: every operator of the registry, on every kind of cloud, in every budget that it accepts, with few and with many threads: the peak of its resident memory stays within the budget.

Each operator runs its example (bench/examples.py) in the least memory that it accepts, which its refusal names, in the least that has room for all threads, and in each of --budgets that is not less
than the first. The runs are numbered; --every N does each N-th of them."""
import datetime
import json
import re
import subprocess
import sys

import processes
from clouds import LAW
from examples import examples, scaled

LEAST = re.compile(r"give --memory (\d+)M")
FOR_ALL_THREADS = re.compile(r"no room for more; --memory (\d+)M")


class Law:
    def __init__(self, bench):
        self.bench, self.options, self.numbered = bench, bench.options, 0
        self.other = scaled(self.bench.tool, self.bench.inputs(LAW[0]), self.options.work / "law-other.ply", ["classification"])

    def cloud(self, cloud):
        return scaled(self.bench.tool, self.bench.inputs(cloud), self.options.work / f"law-{cloud.name}-{self.bench.points}.ply")

    def command(self, cloud, pipeline, memory, threads):
        return [self.bench.tool, "run", cloud, self.options.work / "law.ply", "--quiet", "--force", "--memory", f"{memory}M", "--threads", threads,
                "--temp-dir", self.options.work, "--pipeline", pipeline]

    def run(self, cloud, pipeline, memory, threads):
        """Returns the peak in MiB, or the sentence of the error."""
        statistics = self.options.work / "statistics.json"
        command = [*self.command(cloud, pipeline, memory, threads), "--stats", statistics]
        try:
            done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=self.options.patience)
        except subprocess.TimeoutExpired:
            return f"not finished within {self.options.patience} s"
        if done.returncode != 0:
            return done.stderr.strip() or f"status {done.returncode}"
        return json.loads(statistics.read_text())["peak_rss_bytes"] / 2**20

    def budgets(self, cloud, pipeline, threads):
        """Returns the accepted budgets. A pipeline that no budget refuses needs at most 48 MiB."""
        refusal = self.run(cloud, pipeline, 1, threads)
        least = int(found[1]) if isinstance(refusal, str) and (found := LEAST.search(refusal)) else 48
        plan = [str(word) for word in [*self.command(cloud, pipeline, least, threads), "--dry-run"]]
        told = subprocess.run(plan, capture_output=True, text=True).stdout
        for_all = [int(found[1])] if (found := FOR_ALL_THREADS.search(told)) else []
        return sorted({least, *for_all, *(budget for budget in self.options.budgets if budget > least)})

    def rows(self, cloud):
        file = self.cloud(cloud)
        for name, pipeline in examples(self.bench.tool, self.other).items():
            if self.options.law_operators and name not in self.options.law_operators:
                continue
            for threads in (2, 64):
                for memory in self.budgets(file, pipeline, threads):
                    self.numbered += 1
                    if self.numbered % self.options.every != 0:
                        continue
                    peak = self.run(file, pipeline, memory, threads)
                    kept = not isinstance(peak, str) and peak <= memory
                    yield {"cloud": cloud.name, "operator": name, "threads": threads, "memory_mib": memory,
                           "peak_mib": peak if isinstance(peak, str) else round(peak, 1), "kept": kept}


def main(bench, only):
    law, rows = Law(bench), []
    for cloud in LAW:
        if only and cloud.name not in only:
            continue
        for row in law.rows(cloud):
            rows.append(row)
            if not row["kept"] or bench.options.verbose:
                print(f"{row['cloud']:<12}{row['operator']:<20}{row['threads']:>4} threads: {row['peak_mib']} of {row['memory_mib']} MiB", flush=True)
    broken = sum(not row["kept"] for row in rows)
    print(f"{len(rows)} runs of {bench.points} points, {broken} not within their memory")
    if bench.options.output:
        bench.options.output.parent.mkdir(parents=True, exist_ok=True)
        bench.options.output.write_text(json.dumps({"date": datetime.date.today().isoformat(), "commit": processes.commit(), "machine": processes.machine(),
                                                    "points": bench.points, "law": rows}, indent=1) + "\n")
    if broken:
        sys.exit("script/hostile: a run took more than its --memory")
