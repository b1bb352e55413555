# SPDX-License-Identifier: MIT
"""`components` against labels that spread over the lists of neighbours in NumPy."""
import numpy as np
import clouds


def components(points, pairs):
    """Number of the component of each point, by the first point in x, y, z, row, and its size."""
    rows = np.arange(len(points))
    order = np.lexsort((rows, *points.T[::-1]))
    label = np.empty(len(points), int)
    label[order] = rows  # the rank of the point itself, and of the first one that it is joined with, in the end
    while True:
        before = label.copy()
        np.minimum.at(label, pairs[:, 0], before[pairs[:, 1]])
        np.minimum.at(label, pairs[:, 1], before[pairs[:, 0]])
        label = label[order[label]]  # the rank that the point of that rank has found
        if (label == before).all():
            break
    _, number, sizes = np.unique(label, return_inverse=True, return_counts=True)
    return number, sizes[number]


def pairs_of(lists):
    return np.array([(i, j) for i, near in enumerate(lists) for j in near], int).reshape(-1, 2)


class Components(clouds.Clouds):
    def check(self, points, lists, pipeline):
        got = self.run_pipeline(points, pipeline)
        number, size = components(points, pairs_of(lists))
        np.testing.assert_array_equal(got["component"], number)
        np.testing.assert_array_equal(got["component_size"], size)

    def test_nearest(self):
        for name, points in clouds.clouds(500):
            for k in (1, 2, 6):
                with self.subTest(name, k=k):
                    self.check(points, clouds.neighbors(points, k), f"knn(k={k}) | components")

    def test_distance(self):
        for name, points in clouds.clouds(500):
            for radius in (0.02, 0.1):
                with self.subTest(name, radius=radius):
                    self.check(points, clouds.neighbors(points, radius=radius), f"knn(radius={radius}) | components(distance={radius})")


if __name__ == "__main__":
    clouds.main()
