# SPDX-License-Identifier: MIT
"""Writes the table of README.md from committed results: bench/readme.py RESULT.json..."""
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BEGIN, END = "<!-- numbers: made by bench/readme.py from a committed result -->\n", "<!-- end of numbers -->"


def table(results):
    first = results[0]
    most = max(len(row['runs']) for result in results for row in result['rows'])
    runs = f'medians of {most} runs' if most > 1 else 'single runs'
    yield (f"Normals, k = {first['k']}, whole processes from file to file, points in random file order, {first['threads']} threads, {runs}; "
           f"{first['machine']['cpu']}, {first['machine']['cpus']} cores, {first['compiler'].split(') ')[-1]}, {first['date']}. "
           "Answers compared before times count.\n\n")
    yield "| cloud | program | wall s | CPU s | peak MB | CPU, pointsweep = 1 |\n|---|---|---|---|---|---|\n"
    for result in results:
        base = {}
        for row in result["rows"]:
            cloud = f"{row['shape']} {row['points'] / 1e6:g}M"
            median = row["median"]
            base.setdefault(cloud, median["cpu_seconds"])
            yield (f"| {cloud} | {row['program']} | {median['wall_seconds']:.2f} | {median['cpu_seconds']:.2f} | "
                   f"{median['peak_rss_bytes'] / 1e6:.0f} | {median['cpu_seconds'] / base[cloud]:.2f} |\n")
    yield f"\nMade by `script/bench`; runs in {', '.join(f'`{name}`' for name in sys.argv[1:])}.\n"


def main():
    results = [json.loads((ROOT / name).read_text()) for name in sys.argv[1:]]
    readme = ROOT / "README.md"
    head, rest = readme.read_text().split(BEGIN)
    readme.write_text(head + BEGIN + "".join(table(results)) + END + rest.split(END)[1])


if __name__ == "__main__":
    main()
