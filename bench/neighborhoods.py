#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""script/neighborhoods: how good each operator is with k neighbours, on surfaces with and without noise, as tables in Markdown.

The defaults of the operators (Contract::default_k) are chosen from these tables; docs/neighborhoods.md shows them. Noise is in
multiples of the spacing, the square root of the area for each point. Every figure comes from a definition that does not use the
library: true normals and curvatures of the shapes, numbers of points, shares of outliers that were put in."""
import argparse
import math

import numpy as np
import pointsweep as ps

KS = (4, 6, 8, 12, 16, 24, 32, 48, 64, 96)
NOISES = (0.0, 0.1, 0.3)
AREAS = {"sphere": 4 * math.pi, "torus": 4 * math.pi**2 * 0.3, "plane": 1.0}


def spacing(shape, n):
    return math.sqrt(AREAS[shape] / n)


def surface(shape, n, noise, **options):
    return ps.generate(shape, n, noise=noise * spacing(shape, n), **options)


def true_normals(shape, xyz):
    """Returns the true normals at the nearest points of the surface without noise."""
    if shape == "plane":
        return np.tile([0.0, 0.0, 1.0], (len(xyz), 1))
    centres = np.zeros_like(xyz)
    if shape == "torus":
        centres[:, :2] = xyz[:, :2] / np.linalg.norm(xyz[:, :2], axis=1, keepdims=True)
    away = xyz - centres
    return away / np.linalg.norm(away, axis=1, keepdims=True)


def percentiles(values, *which):
    return np.percentile(values[np.isfinite(values)], which)


def angles(a, b):
    """Between lines, in degrees."""
    return np.degrees(np.arccos(np.minimum(np.abs(np.sum(a * b, axis=1)), 1)))


def run(cloud, k, stages, keep):
    return ps.run(cloud["xyz"], f"knn(k={k}) | {stages}", keep=keep)


def normals(k, noise, n):
    """Angle to the true normal in degrees, 95th percentile, on a torus; share of the points whose normal is off by more than 15
    degrees on a plane that is folded by 90 degrees, in per cent."""
    cloud = surface("torus", n, noise)
    made = run(cloud, k, "normals", ["normal"])["normal"].astype(float)
    torus = percentiles(angles(made, true_normals("torus", cloud["xyz"].astype(float))), 95)[0]
    plane = surface("plane", n, noise)["xyz"].astype(float)
    x, y, z = (plane - np.median(plane, axis=0)).T
    fold = np.where((x < 0)[:, None], np.column_stack([x, y, z]), np.column_stack([z, y, -x]))
    truth = np.where((x < 0)[:, None], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    off = angles(ps.normals(fold, k).astype(float), truth) > 15
    return f"{torus:.1f}, {100 * off.mean():.2f}"


def curvature(k, noise, n):
    """Returns the mean curvature on the unit sphere (true value 1), 5th to 95th percentile, and k1."""
    made = run(surface("sphere", n, noise), k, "normals | curvature", ["mean_curvature", "k1"])
    mean, k1 = (percentiles(made[name], 5, 95) for name in ("mean_curvature", "k1"))
    return f"{mean[0]:.2f}-{mean[1]:.2f}, {k1[0]:.2f}-{k1[1]:.2f}"


def splats(k, noise, n):
    """Major semi-axis in spacings, 5th to 95th percentile, on a sphere."""
    length = run(surface("sphere", n, noise), k, "normals | splats", ["splat_length"])["splat_length"]
    low, high = percentiles(length / spacing("sphere", n), 5, 95)
    return f"{low:.2f}-{high:.2f}"


def features(k, noise, n):
    """Planarity of a plane (1), and linearity of it (0), 5th and 95th percentile."""
    made = run(surface("plane", n, noise), k, "features(names=[planarity,linearity])", ["planarity", "linearity"])
    return f"{percentiles(made['planarity'], 5)[0]:.2f}, {percentiles(made['linearity'], 95)[0]:.2f}"


def density(k, noise, n):
    """Surface density over the true one, 5th to 95th percentile, inside of a plane."""
    cloud = surface("plane", n, noise)
    inside = np.all(np.abs(cloud["xyz"][:, :2] - np.median(cloud["xyz"][:, :2], axis=0)) < 0.4, axis=1)
    low, high = percentiles(run(cloud, k, "density", ["surface_density"])["surface_density"][inside] / n, 5, 95)
    return f"{low:.2f}-{high:.2f}"


def with_outliers(noise, n):
    """A sphere in which one point of fifty is astray, and which are."""
    cloud = surface("sphere", n, noise, outliers=0.02, outlier_box=3)
    off = np.abs(np.linalg.norm(cloud["xyz"], axis=1) - 1)
    return cloud, off > max(5 * noise, 3) * spacing("sphere", n)


def sor(k, noise, n):
    """Outliers found, and points of the surface called outliers, in per cent."""
    cloud, astray = with_outliers(noise, n)
    found = run(cloud, k, "sor", ["outlier"])["outlier"] == 1
    return f"{100 * found[astray].mean():.1f}, {100 * found[~astray].mean():.2f}"


def lof(k, noise, n):
    """Chance that an outlier has a larger factor than a point of the surface, in per cent."""
    cloud, astray = with_outliers(noise, n)
    factor = np.nan_to_num(run(cloud, k, "lof", ["lof"])["lof"].astype(float), posinf=1e300)
    order = np.argsort(np.argsort(factor))
    ones, others = astray.sum(), (~astray).sum()
    return f"{100 * (order[astray].sum() - ones * (ones - 1) / 2) / (ones * others):.2f}"


def components(k, noise, n):
    """Points outside of the largest component of a sphere, in per mille, which should be 0; components of two halves of a plane with
    a gap of five spacings between them, which should be 2."""
    sizes = np.bincount(run(surface("sphere", n, noise), k, "components", ["component"])["component"])
    plane = surface("plane", n, noise)["xyz"].astype(float)
    plane[plane[:, 0] > np.median(plane[:, 0]), 0] += 5 * spacing("plane", n)
    halves = ps.run(plane, f"knn(k={k}) | components", keep=["component"])["component"]
    return f"{1000 * (1 - sizes.max() / n):.1f}, {halves.max() + 1}"


def segments(k, noise, n):
    """Points outside of the largest segment of a sphere (angle 15), in per mille."""
    sizes = np.bincount(run(surface("sphere", n, noise), k, "normals | segments(angle=15)", ["segment"])["segment"])
    return f"{1000 * (1 - sizes.max() / n):.1f}"


def orient(k, noise, n):
    """Normals that point inwards after `orient`, in per mille: torus."""
    cloud = surface("torus", n, noise)
    made = run(cloud, k, "normals | orient", ["normal"])["normal"].astype(float)
    inwards = np.sum(made * true_normals("torus", cloud["xyz"].astype(float)), axis=1) < 0
    return f"{1000 * inwards.mean():.1f}"


def fair(k, noise, n):
    """Returns the root mean square distance to the sphere, after over before; without noise, in spacings."""
    cloud = surface("sphere", n, noise)
    xyz = ps.run(cloud["xyz"], f"knn(k={k}) | normals | splats | fair", keep=["xyz"])["xyz"]
    off = [np.sqrt(np.mean((np.linalg.norm(p.astype(float), axis=1) - 1) ** 2)) for p in (cloud["xyz"], xyz)]
    return f"{off[1] / off[0]:.2f}" if noise else f"{off[1] / spacing('sphere', n):.3f}"


MEASURES = (normals, curvature, splats, features, density, sor, lof, components, segments, orient, fair)


def table(measure, n, ks):
    rows = [f"**{measure.__name__}**: {' '.join(measure.__doc__.split())}", "", "| k | " + " | ".join(f"noise {s}" for s in NOISES) + " |"]
    rows.append("|---" * (len(NOISES) + 1) + "|")
    for k in ks:
        rows.append(f"| {k} | " + " | ".join(measure(k, noise, n) for noise in NOISES) + " |")
    return "\n".join(rows) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("operators", nargs="*", help="names of operators (default: all that are measured)")
    parser.add_argument("-n", type=int, default=20_000, help="points of each surface")
    parser.add_argument("-k", type=int, nargs="+", default=KS)
    given = parser.parse_args()
    for measure in MEASURES:
        if not given.operators or measure.__name__ in given.operators:
            print(table(measure, given.n, given.k), flush=True)


if __name__ == "__main__":
    main()
