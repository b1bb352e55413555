# SPDX-License-Identifier: MIT
"""programs.py TOOL: `sor`, `lof` and `features` against the programs they name, on a generated scan and on one with copies of
points. To be run by hand, in a Python environment with numpy and plyfile; it compares with what is there: Open3D, scikit-learn and
jakteristics in that environment, pcl_outlier_removal (package pcl-tools) and CloudCompare on the PATH.

With Open3D 0.20, PCL 1.13, CloudCompare 2.11, scikit-learn 1.9 and jakteristics 0.6 no outlier differed, and factors and features
were equal to the rounding of float32 (eigenvalue sums and omnivariance times (n - 1)/n, see docs/operators.md)."""
import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np
import plyfile

TOOL, FOLDER = sys.argv[1], pathlib.Path(tempfile.mkdtemp())


def tool(source, pipeline):
    subprocess.run([TOOL, "run", source, FOLDER / "out.ply", "-f", "-q", "--pipeline", pipeline], check=True)
    return plyfile.PlyData.read(str(FOLDER / "out.ply"))["vertex"].data


def positions(table):
    return np.stack([table[axis] for axis in "xyz"], axis=1).astype(np.float64)


def with_copies(source):
    """The first 2,000 points ten times more, so that many have a mean distance of 0."""
    points = positions(tool(source, "where(1 == 1)"))
    points = np.concatenate([points] + 10 * [points[:2000]])
    table = np.array([tuple(p) for p in points], [(axis, "f8") for axis in "xyz"])
    plyfile.PlyData([plyfile.PlyElement.describe(table, "vertex")]).write(str(FOLDER / "copies.ply"))
    return FOLDER / "copies.ply"


def report(what, differences):
    print(f"{what}: {differences}")


def compare_open3d(source, k, multiplier):
    import open3d
    got = tool(source, f"knn(k={k}) | sor(multiplier={multiplier}, definition=open3d)")
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(positions(got)))
    kept = np.zeros(len(got), bool)
    kept[np.array(cloud.remove_statistical_outlier(k + 1, multiplier)[1])] = True
    report(f"Open3D, k {k}, {source}: {(~kept).sum()} outliers, different", (kept == (got["outlier"] != 0)).sum())


def compare_kept(name, definition, source, k, multiplier, run):
    """By how many points are kept: the programs give no row numbers."""
    got = tool(source, f"knn(k={k}) | sor(multiplier={multiplier}, definition={definition})")
    points = positions(got).astype(np.float32)
    ours, theirs = int((got["outlier"] == 0).sum()), run(points, k, multiplier)
    report(f"{name}, k {k}, {source}: {theirs} kept, ours", ours)


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
    report(f"scikit-learn, k {k}, {source}: largest relative difference", np.abs(got["lof"] / theirs - 1).max())


def compare_jakteristics(source, radius):
    from jakteristics import compute_features
    got = tool(source, f"knn(radius={radius}) | features")
    names = ["linearity", "planarity", "sphericity", "anisotropy", "surface_variation", "verticality", "omnivariance",
             "eigenvalue_sum"]
    theirs = compute_features(positions(got), radius, feature_names=names)
    n = got["number_of_neighbors"].astype(float)
    for i, name in enumerate(names):
        want = theirs[:, i] * ((n - 1) / n if i > 5 else 1)
        report(f"jakteristics, {name}: largest difference", np.abs(got[name] - want)[n >= 5].max())


def main():
    scan = FOLDER / "scan.ply"
    subprocess.run([TOOL, "generate", "tls", scan, "-n", "40k", "-q"], check=True)
    has = importlib.util.find_spec
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
    shutil.rmtree(FOLDER)


main()
