# SPDX-License-Identifier: MIT
"""Writes docs/pictures/sweep.svg: an animation of the sweep over a small cloud. Drawn from the rules, not from a run."""
import math
import pathlib
import random

WIDTH, HEIGHT, SECONDS, SLABS, REACH = 640, 260, 14, 16, 26
UNREAD, READ, SEARCHED, DONE = "#c8ccd4", "#e8a33d", "#3d7fe8", "#3a9c5f"


def points():
    """A closed curve with a bump, seen from the side, and a few points inside."""
    random.seed(4)
    for i in range(260):
        t = 2 * math.pi * i / 260
        r = 1 + 0.18 * math.sin(5 * t) + random.gauss(0, 0.015)
        yield 320 + 270 * r * math.cos(t) / 1.18, 130 + 100 * r * math.sin(t) / 1.18


def moments(x):
    """When the front has read a point, when its neighbours are complete, when no other point needs it, as shares of the time."""
    width = WIDTH / SLABS
    slab_end = (math.floor(x / width) + 1) * width
    read, searched, done = (0.04 + 0.86 * place / (WIDTH + 3 * REACH) for place in (slab_end, slab_end + REACH, slab_end + 3 * REACH))
    return read, min(searched, 0.95), min(done, 0.97)


def circle(x, y):
    read, searched, done = moments(x)
    return (f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.2" fill="{UNREAD}"><animate attributeName="fill" calcMode="discrete" dur="{SECONDS}s" '
            f'repeatCount="indefinite" values="{UNREAD};{READ};{SEARCHED};{DONE};{DONE}" keyTimes="0;{read:.4f};{searched:.4f};{done:.4f};1"/></circle>')


def front():
    stops = [k * WIDTH / SLABS for k in range(1, SLABS + 1)]
    times = [0.04 + 0.86 * s / (WIDTH + 3 * REACH) for s in stops]
    values = ";".join(["0"] + [f"{s:.1f}" for s in stops] + [f"{WIDTH}"])
    keys = ";".join(["0"] + [f"{t:.4f}" for t in times] + ["1"])
    return (f'<line y1="6" y2="{HEIGHT - 6}" stroke="#444" stroke-width="1.5"><animate attributeName="x1" calcMode="discrete" dur="{SECONDS}s" '
            f'repeatCount="indefinite" values="{values}" keyTimes="{keys}"/><animate attributeName="x2" calcMode="discrete" dur="{SECONDS}s" '
            f'repeatCount="indefinite" values="{values}" keyTimes="{keys}"/></line>')


def legend():
    at = 12
    for colour, text in ((UNREAD, "on disk, not yet read"), (READ, "in memory, waiting for neighbours"), (SEARCHED, "searched, needed by others"),
                         (DONE, "result written, memory free")):
        yield f'<circle cx="{at}" cy="{HEIGHT + 14}" r="5" fill="{colour}"/><text x="{at + 10}" y="{HEIGHT + 18}">{text}</text>'
        at += 28 + 6.1 * len(text)


def main():
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT + 28}" font-family="sans-serif" font-size="11" fill="#333">',
             "<title>The sweep: slabs are read from left to right; only points near the front are in memory</title>",
             *(circle(x, y) for x, y in points()), front(), *legend(), "</svg>"]
    (pathlib.Path(__file__).parent / "sweep.svg").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
