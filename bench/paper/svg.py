# SPDX-License-Identifier: MIT
"""Plots as inline SVG."""
import html
import math

COLORS = ["#4269d0", "#efb118", "#ff725c", "#6cc5b0", "#3ca951", "#ff8ab7", "#a463f2"]
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 720, 300, 70, 16, 36, 46


def short(value):
    for unit, letter in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if abs(value) >= unit:
            return f"{value / unit:.4g}{letter}"
    return f"{value:.4g}"


class Scale:
    def __init__(self, low, high, begin, end, log=False):
        self.log = log
        self.low, self.high = (math.log10(low), math.log10(high)) if log else (low, high)
        if self.high <= self.low:
            self.high = self.low + 1
        self.begin, self.end = begin, end

    def __call__(self, value):
        value = math.log10(value) if self.log else value
        return self.begin + (value - self.low) / (self.high - self.low) * (self.end - self.begin)

    def ticks(self, wanted=6):
        if self.log:
            few = self.high - self.low < 3
            powers = range(math.floor(self.low), math.ceil(self.high) + 1)
            values = [f * 10.0 ** p for p in powers for f in ((1, 2, 5) if few else (1,))]
            return [v for v in values if self.low - 1e-9 <= math.log10(v) <= self.high + 1e-9]
        rough = (self.high - self.low) / wanted
        power = 10 ** math.floor(math.log10(rough))
        step = next(f * power for f in (1, 2, 5, 10) if f * power >= rough * (1 - 1e-9))
        first = math.ceil(self.low / step - 1e-9)
        return [i * step for i in range(first, int(self.high / step + 1e-9) + 1)]


def text(x, y, anchor, words, kind=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{kind}>{html.escape(words)}</text>'


def opened(height, title):
    return [f'<svg viewBox="0 0 {WIDTH} {height}" role="img" aria-label="{html.escape(title)}">',
            text(LEFT, 18, "start", title, ' class="title"')]


def lines(title, x_label, y_label, series, log=False, dots=False, y_most=None):
    """series: {name: [(x, y), ...]}."""
    xs = [x for points in series.values() for x, _ in points]
    ys = [y for points in series.values() for _, y in points]
    top = y_most or max(ys) * (1.5 if log else 1.1)
    x = Scale(min(xs) if log else 0, max(xs), LEFT, WIDTH - RIGHT, log)
    y = Scale(min(ys) / 1.5 if log else 0, top, HEIGHT - BOTTOM, TOP, log)
    out = opened(HEIGHT, title)
    for tick in y.ticks():
        out.append(f'<path class="grid" d="M{LEFT} {y(tick):.1f}H{WIDTH - RIGHT}"/>' + text(LEFT - 6, y(tick) + 4, "end", short(tick)))
    for tick in x.ticks():
        out.append(f'<path class="grid" d="M{x(tick):.1f} {HEIGHT - BOTTOM}v5"/>' + text(x(tick), HEIGHT - BOTTOM + 18, "middle", short(tick)))
    out.append(text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, "middle", x_label) + text(WIDTH - RIGHT, 18, "end", y_label))
    for color, points in zip(COLORS, series.values()):
        path = "".join(f"{'L' if i else 'M'}{x(a):.1f} {y(min(b, top)):.1f}" for i, (a, b) in enumerate(points))
        out.append(f'<path class="line" stroke="{color}" d="{path}"/>')
        if dots:
            out += [f'<circle cx="{x(a):.1f}" cy="{y(b):.1f}" r="3.5" fill="{color}"/>' for a, b in points]
    return "\n".join(out + legend(list(series))) + "</svg>"


def legend(names):
    if len(names) < 2:
        return []
    out, at = [], LEFT + 8
    for color, name in zip(COLORS, names):
        out.append(f'<rect x="{at:.1f}" y="{TOP - 6}" width="10" height="10" fill="{color}"/>' + text(at + 14, TOP + 3, "start", name))
        at += 34 + 6.3 * len(name)
    return out


def stacked(title, rows):
    """rows: {name: {part: share}}; shares of each row add up to 100."""
    parts = list(next(iter(rows.values())))
    names, bar = 170, 26
    x = Scale(0, 100, names, WIDTH - RIGHT)
    height = TOP + 22 + bar * len(rows) + 8
    out = opened(height, title)
    at = names
    for color, part in zip(COLORS, parts):
        out.append(f'<rect x="{at:.1f}" y="{TOP - 6}" width="10" height="10" fill="{color}"/>' + text(at + 14, TOP + 3, "start", part))
        at += 34 + 6.3 * len(part)
    for i, (name, shares) in enumerate(rows.items()):
        y, done = TOP + 18 + bar * i, 0.0
        out.append(text(names - 8, y + 16, "end", name))
        for color, part in zip(COLORS, parts):
            share = shares.get(part, 0)
            out.append(f'<rect x="{x(done):.1f}" y="{y}" width="{max(x(share) - x(0), 0):.1f}" height="{bar - 6}" fill="{color}"/>')
            if share >= 6:
                out.append(text((x(done) + x(done + share)) / 2, y + 15, "middle", f"{share:.0f} %", ' class="inside"'))
            done += share
    return "\n".join(out) + "</svg>"


def grouped(title, unit, groups):
    """Returns a bar for each value of groups: {name: {kind: value}}."""
    kinds = list(next(iter(groups.values())))
    names, bar = 170, 16
    x = Scale(0, max(v for g in groups.values() for v in g.values()), names, WIDTH - 90)
    height = TOP + 22 + (bar * len(kinds) + 8) * len(groups)
    out = opened(height, title)
    at = names
    for color, kind in zip(COLORS, kinds):
        out.append(f'<rect x="{at:.1f}" y="{TOP - 6}" width="10" height="10" fill="{color}"/>' + text(at + 14, TOP + 3, "start", kind))
        at += 34 + 6.3 * len(kind)
    y = TOP + 18
    for name, values in groups.items():
        out.append(text(names - 8, y + bar * len(kinds) / 2 + 4, "end", name))
        for color, kind in zip(COLORS, kinds):
            out.append(f'<rect x="{names}" y="{y}" width="{x(values[kind]) - names:.1f}" height="{bar - 3}" fill="{color}"/>'
                       + text(x(values[kind]) + 5, y + 11, "start", f"{values[kind]:.3g} {unit}"))
            y += bar
        y += 8
    return "\n".join(out) + "</svg>"
