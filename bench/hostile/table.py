# SPDX-License-Identifier: MIT
"""Prints the table of docs/reliability.md from results of script/hostile: python3 bench/hostile/table.py RESULT.json..."""
import json
import sys


def main():
    print("| cloud | points | time | peak memory | window | recalled | chain of three steps | peak memory | recalled | missed |\n|---|---|---|---|---|---|---|---|---|---|")
    for path in sys.argv[1:]:
        result = json.load(open(path))
        for row in result["rows"]:
            name = f"| {row['cloud']} | {row['points'] / 1e6:g}M |"
            if "ratio" not in row:
                print(f"{name} | | | | | | | {row['verdict']} |")
                continue
            print(f"{name} {row['ratio']:.2f} | {row['peak_rss_mib']} of {result['memory_mib']} MiB "
                  f"| {row['window_percent']:.2f} % ({row['clean_window_percent']:.2f} %) | {row['recalled']} "
                  f"| {row.get('deep_ratio', '-')} | {row.get('deep_peak_rss_mib', '-')} MiB | {row.get('deep_recalled', '-')} "
                  f"| {', '.join(row['missed']) or '-'} |")


if __name__ == "__main__":
    main()
