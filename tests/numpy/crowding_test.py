# SPDX-License-Identifier: MIT
"""`ror`, `density` and `lof` against their formulas, by brute force."""
import numpy as np
import clouds


def lengths(points, i, rows):
    return np.linalg.norm(points[rows] - points[i], axis=1)


class RadiusOutliersAreThosePdalFinds(clouds.Clouds):
    """filters.outlier, method radius, keeps a point if more than min_k points lie within the radius, itself included."""

    def test(self):
        for c, (name, points) in enumerate(clouds.clouds(500)):
            for r, (radius, least) in enumerate(((0.07, 4), (1.0, 2), (2.5, 12))):
                knn = (f"k={least}", f"k={least + 3}, radius={2 * radius}", f"radius={radius}")[(c + r) % 3]  # each with each radius of some clouds
                with self.subTest(cloud=name, radius=radius, least=least, knn=knn):
                    inlier = np.array([len(rows) + 1 > least for rows in clouds.neighbors(points, None, radius)])
                    got = self.run_pipeline(points, f"knn({knn}) | ror(radius={radius}, min_neighbors={least})")
                    np.testing.assert_array_equal(got["outlier"] == 0, inlier)


class DensitiesAreCountsOverSizes(clouds.Clouds):
    def test(self):
        for name, points in clouds.clouds(500):
            with self.subTest(cloud=name):
                self.check(points, "knn(k=9) | density", clouds.neighbors(points, 9), None)
                self.check(points, "knn(radius=0.2) | density(radius=0.1)", clouds.neighbors(points, None, 0.1), 0.1)

    def check(self, points, pipeline, lists, radius):
        got = self.run_pipeline(points, pipeline)
        for i, rows in enumerate(lists):
            far = lengths(points, i, rows).max(initial=0)
            r, m = (radius, len(rows) + 1) if radius else (far, len(rows))
            surface, volume = (m / (np.pi * r**2), m / (4 / 3 * np.pi * r**3)) if r > 0 else (0, 0)
            np.testing.assert_allclose(got["surface_density"][i], surface, rtol=2e-7)
            np.testing.assert_allclose(got["volume_density"][i], volume, rtol=2e-7)


class LocalOutlierFactorsAreThoseOfTheDefinition(clouds.Clouds):
    def test(self):
        for name, points in clouds.clouds(500):
            for k in (4, 11):
                with self.subTest(cloud=name, k=k):
                    self.check(points, k)

    def check(self, points, k):
        got = self.run_pipeline(points, f"knn(k={k}) | lof")
        lists = clouds.neighbors(points, k)
        if not len(lists[0]):
            for name in ("k_distance", "reachability_density", "lof"):
                self.assertTrue(np.isnan(got[name]).all())
            return
        k_distance = np.array([lengths(points, i, rows).max() for i, rows in enumerate(lists)])
        with np.errstate(divide="ignore", invalid="ignore"):
            density = np.array([1 / np.maximum(k_distance[rows], lengths(points, i, rows)).mean()
                                for i, rows in enumerate(lists)])
            ratios = [np.where(np.isinf(density[rows]) & np.isinf(density[i]), 1, density[rows] / density[i])
                      for i, rows in enumerate(lists)]
        np.testing.assert_allclose(got["k_distance"], k_distance, rtol=1e-14)
        np.testing.assert_allclose(got["reachability_density"], density, rtol=1e-13)
        np.testing.assert_allclose(got["lof"], [r.mean() for r in ratios], rtol=1e-12)


if __name__ == "__main__":
    clouds.main()
