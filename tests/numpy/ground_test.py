# SPDX-License-Identifier: MIT
"""`ground` against SMRF (Pingel, Clarke and McBride 2013) with whole rasters in NumPy, written from the paper and from the documented
rule for holes."""
import math

import numpy as np
import clouds

ABSENT = np.nan
DEFAULTS = {"cell": 1.0, "slope": 0.15, "window": 18.0, "threshold": 0.5, "scalar": 1.25}


def fill(raster, reach):
    """An absent cell gets the mean of the nearest values west, east, south and north, weighted by 1 / distance."""
    def nearest(axis, sign):
        value, distance = np.full(raster.shape, ABSENT), np.zeros(raster.shape)
        for d in range(reach, 0, -1):
            shifted = np.full(raster.shape, ABSENT)
            length = raster.shape[axis]
            if d >= length:
                continue
            to, source = [slice(None)] * 2, [slice(None)] * 2
            to[axis], source[axis] = (slice(d, None), slice(None, length - d)) if sign < 0 else (slice(None, length - d), slice(d, None))
            shifted[tuple(to)] = raster[tuple(source)]
            here = ~np.isnan(shifted)
            value[here], distance[here] = shifted[here], d
        known = distance > 0
        one = np.where(known, distance, 1)
        return np.where(known, value / one, 0), np.where(known, 1 / one, 0)

    (west, w), (east, e), (south, s), (north, n) = (nearest(axis, sign) for axis in (0, 1) for sign in (-1, 1))
    weight = (w + e) + (s + n)
    sums = (west + east) + (south + north)
    filled = np.where(weight > 0, sums / np.where(weight > 0, weight, 1), ABSENT)
    return np.where(np.isnan(raster), filled, raster)


def over_disk(raster, radius, least):
    """The least or greatest value of each disk; absent cells count for nothing."""
    nothing = np.inf if least else -np.inf
    padded = np.pad(np.where(np.isnan(raster), nothing, raster), radius, constant_values=nothing)
    result = np.full(raster.shape, nothing)
    for dx in range(-radius, radius + 1):
        for dy in range(-radius, radius + 1):
            if dx * dx + dy * dy <= radius * radius:
                piece = padded[radius + dx:radius + dx + raster.shape[0], radius + dy:radius + dy + raster.shape[1]]
                result = np.minimum(result, piece) if least else np.maximum(result, piece)
    return np.where(np.isnan(raster), ABSENT, result)


def opened(raster, radius):
    return over_disk(over_disk(raster, radius, True), radius, False)


def slopes(surface, cell):
    def along(axis):
        before, behind = np.full(surface.shape, ABSENT), np.full(surface.shape, ABSENT)
        a, b = [slice(None)] * 2, [slice(None)] * 2
        a[axis], b[axis] = slice(1, None), slice(None, -1)
        before[tuple(a)], behind[tuple(b)] = surface[tuple(b)], surface[tuple(a)]
        central, forward, backward = (behind - before) / (2 * cell), (behind - surface) / cell, (surface - before) / cell
        one = np.where(np.isnan(behind), np.where(np.isnan(before), 0, backward), forward)
        return np.where(np.isnan(before) | np.isnan(behind), one, central)
    gx, gy = along(0), along(1)
    return np.sqrt(gx * gx + gy * gy)


def ground_surface(x, y, z, cell, slope, window):
    """The surface, its slopes, and the numbers of its first cell."""
    radius = math.ceil(window / cell)
    reach = 3 * radius + 3
    column, row = np.floor(x / cell), np.floor(y / cell)
    first = column.min() - reach - 1, row.min() - reach - 1
    shape = int(column.max() - first[0]) + reach + 2, int(row.max() - first[1]) + reach + 2
    lowest = np.full(shape, np.inf)
    np.minimum.at(lowest, ((column - first[0]).astype(int), (row - first[1]).astype(int)), z)
    lowest[np.isinf(lowest)] = ABSENT
    surface = fill(lowest, reach)
    wrong = -surface - opened(-surface, 1) > 5 * cell
    for r in range(1, radius + 1):
        below = opened(surface, r)
        wrong |= surface - below > slope * (cell * r)
        surface = below
    result = fill(np.where(wrong, ABSENT, lowest), reach)
    return result, slopes(result, cell), first


def at_points(surface, gradient, first, x, y, cell):
    """Height and slope at points, between the centres of four cells."""
    def between(c, begin):
        cells = c / cell
        fraction = cells - np.floor(cells)
        upper = fraction >= 0.5
        own = (np.floor(cells) - begin).astype(int)
        return own, own - ~upper, np.where(upper, fraction - 0.5, fraction + 0.5)
    (i, i0, fx), (j, j0, fy) = between(x, first[0]), between(y, first[1])
    corners = [surface[i0 + a, j0 + b] for b in (0, 1) for a in (0, 1)]
    whole = ~np.isnan(corners).any(axis=0)

    def bilinear(raster):
        low = raster[i0, j0] * (1 - fx) + raster[i0 + 1, j0] * fx
        high = raster[i0, j0 + 1] * (1 - fx) + raster[i0 + 1, j0 + 1] * fx
        return np.where(whole, low * (1 - fy) + high * fy, raster[i, j])
    return bilinear(surface), bilinear(gradient)


def smrf(points, takes_part=None, **options):
    """For each point whether it is ground."""
    o = DEFAULTS | options
    x, y, z = points.T
    takes_part = np.full(len(points), True) if takes_part is None else takes_part
    ground = np.full(len(points), False)
    if not takes_part.any():
        return ground
    x, y, z = x[takes_part], y[takes_part], z[takes_part]
    height, gradient = at_points(*ground_surface(x, y, z, o["cell"], o["slope"], o["window"]), x, y, o["cell"])
    ground[takes_part] = np.abs(z - height) <= o["threshold"] + o["scalar"] * gradient
    return ground


def terrains(n=3000):
    """Name, points and cells: hills with boxes, pits and holes; large and negative coordinates; steps of the grid."""
    rng = np.random.default_rng(23)
    xy = rng.random((n, 2)) * [90, 60]
    hills = 3 * np.sin(xy[:, 0] / 15) + 0.1 * xy[:, 1]
    z = hills + rng.normal(0, 0.05, n)
    house = (abs(xy[:, 0] - 40) < 7) & (abs(xy[:, 1] - 30) < 5)
    trees = rng.random(n) < 0.2
    z = z + np.where(house, 8, np.where(trees, 10 * rng.random(n), 0))
    z[rng.random(n) < 0.01] -= 30
    p = np.column_stack([xy, z])
    far = (abs(xy[:, 0] - 60) > 12) | (abs(xy[:, 1] - 20) > 10)
    yield "hills", p, 1
    yield "hills with a hole", p[far], 1
    yield "hills in wide cells", p, 4
    yield "fine cells, most without points", p[:800], 0.5
    yield "negative coordinates", p - [500.25, 1000.5, 300], 1
    yield "national grid", np.round(p * 100) / 100 + [448000, 5263000, 700], 1
    yield "flat", p * [1, 1, 0], 1
    yield "steps", np.floor(p * [1, 1, 2]) / [1, 1, 2], 1
    yield "two islands", np.concatenate([p, p + [150, 0, 20]]), 1
    yield "a strip along y", p[:, [1, 0, 2]] * [0.2, 3, 1], 1


class GroundIsThatOfWholeRasters(clouds.Clouds):
    def test(self):
        for name, points, cell in terrains():
            for options in ({"window": 8}, {"window": 3, "slope": 0.4, "threshold": 0.2, "scalar": 0.5}):
                self.check(name, points, cell=cell, **options)

    def test_of_hostile_clouds(self):
        for name, points in clouds.clouds(500):
            extent = float(np.ptp(points[:, :2], axis=0).max())
            for cell in {max(extent / 40, 1e-3), 1.0 if extent < 200 else extent / 100}:
                for window, axes in ((0, "x"), (1, "y"), (4, "xy")):
                    self.check(name, points, axes, cell=cell, window=window * cell)
        self.check("one place of a grid", points + [4e6, 5e6, 100], cell=0.25, window=2)

    def check(self, name, points, axes="xy", **options):
        with self.subTest(cloud=name, **options):
            text = ", ".join(f"{key}={value!r}" for key, value in options.items())
            want = np.where(smrf(points, **options), 2, 1)
            for axis in axes:
                got = self.run_pipeline(points, f"ground({text})", "--axis", axis)["classification"]
                np.testing.assert_array_equal(got, want)


class GroundIsOfLastReturnsWithoutNoise(clouds.Clouds):
    def test(self):
        rng = np.random.default_rng(4)
        for name, points, cell in terrains(1500):
            n = len(points)
            returns = rng.integers(1, 4, n).astype("u1")
            number = rng.integers(1, 4, n).astype("u1")
            classes = rng.choice([0, 1, 2, 5, 6, 7, 18], n).astype("u1")
            columns = {"return_number": returns, "number_of_returns": number, "classification": classes}
            last, quiet = returns >= number, (classes != 7) & (classes != 18)
            rest = np.where(classes == 2, 1, classes)
            for text, takes_part in (("", last & quiet), (", returns=all", quiet), (", noise=yes", last),
                                     (", returns=all, noise=yes", np.full(n, True))):
                with self.subTest(cloud=name, options=text):
                    got = self.run_pipeline(points, f"ground(cell={cell}, window=6{text})", **columns)
                    ground = smrf(points, takes_part, cell=cell, window=6)
                    np.testing.assert_array_equal(got["classification"], np.where(ground, 2, rest))

    def test_without_any_that_takes_part(self):
        points = next(terrains(200))[1]
        classes = np.full(len(points), 7, "u1")
        got = self.run_pipeline(points, "ground", classification=classes)
        np.testing.assert_array_equal(got["classification"], classes)


def heights(points, ground, all_k):
    """For each k the heights above the k nearest ground points in the plane, weighted by 1 / distance²; equal distances by x, y, z, row."""
    if not ground.any():
        return [np.full(len(points), np.nan) for _ in all_k]
    places = points[ground]
    dx, dy = (points[:, None, a] - places[None, :, a] for a in range(2))
    d2 = dx * dx + dy * dy
    nearest = clouds.nearest_first(d2, places)
    result = []
    for k in all_k:
        near = nearest[:, :k]
        z = places[near, 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            weights = 1 / np.take_along_axis(d2, near, axis=1)
            mean = (weights * z).sum(axis=1) / weights.sum(axis=1)
        result.append(points[:, 2] - np.where(np.isinf(weights[:, 0]), z[:, 0], mean))
    return result


class HeightIsAboveTheNearestGround(clouds.Clouds):
    def test(self):
        rng = np.random.default_rng(8)
        hills = [(name, points) for name, points, _ in terrains(800) if name != "hills in wide cells"]  # which has the points of "hills"
        for name, points in hills + list(clouds.clouds(400)):
            for share, all_k in ((0, [4]), (0.02, [1, 30]), (0.6, [1, 4, 30])):
                ground = rng.random(len(points)) < share
                for k, want in zip(all_k, heights(points, ground, all_k)):
                    with self.subTest(cloud=name, share=share, k=k):
                        got = self.run_pipeline(points, f"height(k={k})", classification=np.where(ground, 2, 5).astype("u1"))
                        np.testing.assert_allclose(got["height"], want, rtol=1e-9, atol=1e-9)


if __name__ == "__main__":
    clouds.main()
