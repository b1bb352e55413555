# SPDX-License-Identifier: MIT
"""open3d_normals.py IN OUT K: normals by Open3D, file to file. Open3D counts the point itself among its neighbours."""
import sys

import open3d

source, target, k = sys.argv[1:]
cloud = open3d.io.read_point_cloud(source)
cloud.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(int(k) + 1), fast_normal_computation=False)
if not open3d.io.write_point_cloud(target, cloud):
    sys.exit(f"{target}: Open3D could not write it")
