# SPDX-License-Identifier: MIT
"""`sor` against the rules of five programs, each written after its source, with float64 in place of its float32."""
import numpy as np
import clouds


def first(nearest, k):
    return [rows[:k] for rows in nearest]


def pdal(points, nearest, mean_k, multiplier):
    """filters.outlier, method statistical: running means, n - 1, inliers are below the threshold."""
    distances = np.zeros(len(points))
    for i, rows in enumerate(first(nearest, mean_k)):
        for j, row in enumerate(rows, 1):
            distances[i] += (np.linalg.norm(points[row] - points[i]) - distances[i]) / j
    threshold = distances.mean() + multiplier * np.sqrt(((distances - distances.mean())**2).sum() / (len(points) - 1))
    return ~(distances < threshold), distances, threshold


def pcl(points, nearest, mean_k, multiplier):
    """pcl::StatisticalOutlierRemoval of PCL 1.13: one more point is searched, and the first, the query, is left out."""
    distances = np.array([np.linalg.norm(points[rows] - points[i], axis=1).sum() / len(rows)
                          for i, rows in enumerate(first(nearest, mean_k))])
    n = len(distances)
    mean = distances.sum() / n
    threshold = mean + multiplier * np.sqrt(((distances - mean)**2).sum() / (n - 1))
    return distances > threshold, distances, threshold


def open3d(points, nearest, nb_neighbors, std_ratio):
    """RemoveStatisticalOutliers: the query is one of its neighbours; means of 0 are neither squared nor kept."""
    distances = np.array([np.append(np.linalg.norm(points[rows] - points[i], axis=1), 0).mean()
                          for i, rows in enumerate(first(nearest, nb_neighbors - 1))])
    mean = distances[distances > 0].sum() / len(points)
    squares = ((distances - mean)**2)[distances > 0].sum()
    threshold = mean + std_ratio * np.sqrt(squares / (len(points) - 1))
    return ~((distances > 0) & (distances < threshold)), distances, threshold


def cloudcompare(points, nearest, knn, n_sigma):
    """CCCoreLib::CloudSamplingTools::sorFilter: knn points with the query, which is left out; deviation of the population."""
    distances = np.array([np.linalg.norm(points[rows] - points[i], axis=1).mean()
                          for i, rows in enumerate(first(nearest, knn - 1))])
    threshold = distances.mean() + n_sigma * np.sqrt(np.abs((distances**2).mean() - distances.mean()**2))
    return ~(distances <= threshold), distances, threshold


# Where the program's number counts the point itself, it is one more than k.
RULES = {"pointsweep": (pcl, 0), "pdal": (pdal, 0), "pcl": (pcl, 0), "open3d": (open3d, 1), "cloudcompare": (cloudcompare, 1)}


class OutliersAreThoseOfEachProgram(clouds.Clouds):
    def test(self):
        for name, points in clouds.clouds(500):
            if name == "one point":
                continue
            nearest = clouds.neighbors(points, 20)
            for k, multiplier in ((8, 2), (5, 0.5)):
                for definition, (rule, more) in RULES.items():
                    with self.subTest(cloud=name, definition=definition, k=k):
                        self.check(points, k, multiplier, definition, *rule(points, nearest, k + more, multiplier))

    def check(self, points, k, multiplier, definition, outlier, distances, threshold):
        got = self.run_pipeline(points, f"knn(k={k}) | sor(multiplier={multiplier}, definition={definition})")
        np.testing.assert_allclose(got["mean_distance"], distances, rtol=1e-12)
        decided = (np.abs(distances - threshold) > 1e-9 * threshold) | (distances == 0)
        np.testing.assert_array_equal(got["outlier"][decided], outlier[decided])


if __name__ == "__main__":
    clouds.main()
