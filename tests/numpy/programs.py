# SPDX-License-Identifier: MIT
"""programs.py TOOL: `sor`, `lof` and `features` against the programs they name, on a generated scan and on one with copies of
points; the test numpy/programs. It compares with what is there: Open3D, scikit-learn and jakteristics in the environment,
pcl_outlier_removal (package pcl-tools) and CloudCompare on the PATH.

No outlier differs, and factors and features are equal to the rounding of float32 (eigenvalue sums and omnivariance times
(n - 1)/n, see docs/operators.md)."""
import os
import shutil
import subprocess
import sys

import numpy as np
from peers import Comparison, has, positions, write_ply

comparison = Comparison(sys.argv[1])
tool, FOLDER = comparison.tool, comparison.folder


def with_copies(source):
    """The first 2,000 points ten times more, so that many have a mean distance of 0."""
    points = positions(tool(source, "where(1 == 1)"))
    write_ply(FOLDER / "copies.ply", np.concatenate([points] + 10 * [points[:2000]]))
    return FOLDER / "copies.ply"


def compare_open3d(source, k, multiplier):
    import open3d
    got = tool(source, f"knn(k={k}) | sor(multiplier={multiplier}, definition=open3d)")
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(positions(got)))
    kept = np.zeros(len(got), bool)
    kept[np.array(cloud.remove_statistical_outlier(k + 1, multiplier)[1])] = True
    comparison.expect((kept == (got["outlier"] == 0)).all(), f"Open3D, k {k}, {source.name}, {(~kept).sum()} outliers")


def compare_kept(name, definition, source, k, multiplier, run):
    """By how many points are kept: the programs give no row numbers."""
    got = tool(source, f"knn(k={k}) | sor(multiplier={multiplier}, definition={definition})")
    points = positions(got).astype(np.float32)
    ours, theirs = int((got["outlier"] == 0).sum()), run(points, k, multiplier)
    comparison.expect(ours == theirs, f"{name}, k {k}, {source.name}, {theirs} kept")


def pcl_keeps(points, k, multiplier):
    header = ("# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {0}\nHEIGHT 1\n"
              "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA ascii").format(len(points))
    np.savetxt(FOLDER / "in.pcd", points, fmt="%.9g", header=header, comments="")
    subprocess.run(["pcl_outlier_removal", FOLDER / "in.pcd", FOLDER / "pcl.pcd", "-method", "statistical", "-mean_k", str(k),
                    "-std_dev_mul", str(multiplier)], check=True, capture_output=True)
    head = (FOLDER / "pcl.pcd").read_bytes().split(b"DATA")[0].decode()
    return int(head.split("POINTS ")[1].split()[0])


def cloudcompare_keeps(points, k, multiplier):
    np.savetxt(FOLDER / "in.xyz", points, fmt="%.9g")
    subprocess.run(["CloudCompare", "-SILENT", "-AUTO_SAVE", "OFF", "-O", FOLDER / "in.xyz", "-SOR", str(k + 1), str(multiplier),
                    "-C_EXPORT_FMT", "ASC", "-SAVE_CLOUDS", "FILE", FOLDER / "cc.xyz"], check=True, capture_output=True,
                   env=dict(os.environ, QT_QPA_PLATFORM="offscreen"))
    return len((FOLDER / "cc.xyz").read_text().splitlines())


def compare_scikit_learn(source, k):
    from sklearn.neighbors import LocalOutlierFactor
    got = tool(source, f"knn(k={k}) | lof")
    model = LocalOutlierFactor(n_neighbors=k).fit(positions(got))
    theirs = -model.negative_outlier_factor_
    comparison.expect(np.abs(got["lof"] / theirs - 1).max() < 1e-6, f"scikit-learn, k {k}, {source.name}, factors")


def compare_jakteristics(source, radius):
    from jakteristics import compute_features
    got = tool(source, f"knn(radius={radius}) | features")
    names = ["linearity", "planarity", "sphericity", "anisotropy", "surface_variation", "verticality", "omnivariance",
             "eigenvalue_sum"]
    theirs = compute_features(positions(got), radius, feature_names=names)
    n = got["number_of_neighbors"].astype(float)
    for i, name in enumerate(names):
        want = theirs[:, i] * ((n - 1) / n if i > 5 else 1)
        difference = np.abs(got[name] - want)[n >= 5].max()
        comparison.expect(difference < 1e-5, f"jakteristics, {name}, difference at most {difference:.1e}")


def main():
    scan = comparison.generate("tls")
    for source in (scan, with_copies(scan)):
        for k, multiplier in ((8, 2.0), (8, 0.2), (3, 0.05)):
            if has("open3d"):
                compare_open3d(source, k, multiplier)
            if shutil.which("pcl_outlier_removal"):
                compare_kept("PCL", "pcl", source, k, multiplier, pcl_keeps)
            if shutil.which("CloudCompare"):
                compare_kept("CloudCompare", "cloudcompare", source, k, multiplier, cloudcompare_keeps)
    if has("sklearn"):
        compare_scikit_learn(scan, 20)
    if has("jakteristics"):
        compare_jakteristics(scan, 0.5)
    comparison.end()


main()
