# SPDX-License-Identifier: MIT
"""`features` against its formulas, by NumPy's eigh in float64."""
import numpy as np
import clouds


def expected(points, i, rows, scale, with_point):
    """Values by name, and by name how much rounding may change them (inf: it may be anything)."""
    p = points[np.append(rows, i) if with_point else rows] - points[i]
    n = len(p)
    out = {"number_of_neighbors": n, "height_range": np.ptp(p[:, 2]) if n else 0}
    names = ("linearity planarity sphericity omnivariance anisotropy eigenentropy eigenvalue_sum surface_variation "
             "verticality moment1_axis1 moment1_axis2 moment2_axis1 moment2_axis2").split()
    if n == 0 or not np.any(p != p[0]):
        return out | dict.fromkeys(names, 0), {}
    centered = p - p.mean(axis=0)
    values, axes = np.linalg.eigh(centered.T @ centered / n)
    noise = 1e-13 * np.max(np.sum(p * p, axis=1)) + (2.0**-50 * np.abs(points[i]).max()) ** 2
    v3, v2, v1 = np.maximum(values, 0)
    noise3 = noise
    if scale == "sqrt":
        v1, v2, v3, noise3 = v1**0.5, v2**0.5, v3**0.5, noise**0.5
    if scale == "normalized":
        noise3 = noise / values.sum()
        v1, v2, v3 = np.array([v1, v2, v3]) / values.sum()
    total = v1 + v2 + v3
    terms = [v * np.log(v) if v > 0 else 0 for v in (v1, v2, v3)]
    out |= {"linearity": (v1 - v2) / v1, "planarity": (v2 - v3) / v1, "sphericity": v3 / v1,
            "omnivariance": np.cbrt(v1) * np.cbrt(v2) * np.cbrt(v3), "anisotropy": (v1 - v3) / v1,
            "eigenentropy": -sum(terms), "eigenvalue_sum": total, "surface_variation": v3 / total,
            "verticality": 1 - abs(axes[2, 0])}
    doubt = dict.fromkeys(["linearity", "planarity", "sphericity", "anisotropy", "surface_variation"], noise3 / v1)
    doubt["omnivariance"] = np.cbrt(v1 * (v2 + noise3) * (v3 + noise3)) - np.cbrt(v1 * v2 * v3) if v3 < 1e6 * noise3 else 0
    doubt["eigenentropy"] = 30 * noise3 + 1e-13 * sum(map(abs, terms))
    doubt["eigenvalue_sum"] = noise3
    for axis, column in (("axis1", 2), ("axis2", 1)):
        along = p @ axes[:, column]
        out["moment1_" + axis], out["moment2_" + axis] = abs(along.sum()), (along * along).sum()
        gap = np.min(np.abs(np.delete(values, column) - values[column]))
        turn = noise / gap if gap > 10 * noise else np.inf
        doubt["moment1_" + axis] = (turn + 1e-13) * np.abs(p).sum()
        doubt["moment2_" + axis] = (turn + 1e-13) * (p * p).sum()
    line = values[1] <= 3 * noise
    if line:
        out["verticality"] = 0
    doubt["verticality"] = 0 if line else noise / max(values[1] - values[0] - noise, 0.1 * noise)
    return out, doubt


class FeaturesAreThoseOfTheirFormulas(clouds.Clouds):
    """Of every third row."""

    def test(self):
        for name, points in clouds.clouds(600):
            for k, radius, scale, with_point in ((10, np.inf, "raw", "yes"), (7, np.inf, "sqrt", "no"),
                                                 (None, 0.12, "normalized", "yes"), (80, np.inf, "raw", "no")):
                if k is None and name in ("one place", "duplicates"):
                    continue
                with self.subTest(cloud=name, k=k, eigenvalues=scale, with_point=with_point):
                    self.check(points, k, radius, scale, with_point)

    def check(self, points, k, radius, scale, with_point):
        knn = f"k={k}" if k else f"radius={radius}"
        got = self.run_pipeline(points, f"knn({knn}) | features(eigenvalues={scale}, with_point={with_point})")
        lists = clouds.neighbors(points, k, radius)
        decided = 0
        for i in range(0, len(points), 3):
            rows = lists[i]
            want, doubt = expected(points, i, rows, scale, with_point == "yes")
            for name, value in want.items():
                allowed = doubt.get(name, 0) + 3e-7 * abs(value)
                decided += allowed < 1e-3 * max(abs(value), 1e-12)
                self.assertLessEqual(abs(float(got[name][i]) - value), allowed + 1e-40, f"{name} of row {i}")
        self.assertGreater(decided, 0)


class FeaturesOnRequestAreTheSame(clouds.Clouds):
    def test(self):
        points = dict(clouds.clouds())["surface"]
        everything = self.run_pipeline(points, "knn(k=12) | features")
        names = [name for name in everything if name not in "xyz"]
        self.assertEqual(len(names), 15)
        for name in names:
            some = self.run_pipeline(points, f"knn(k=12) | features(names={name})")
            self.assertEqual(list(some), ["x", "y", "z", name])
            np.testing.assert_array_equal(some[name], everything[name])
            kept = self.run_pipeline(points, "knn(k=12) | features", "--keep", f"x,y,z,{name}")
            np.testing.assert_array_equal(kept[name], everything[name])


if __name__ == "__main__":
    clouds.main()
