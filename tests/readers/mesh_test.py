# SPDX-License-Identifier: MIT
"""The vertices of OFF and OBJ files, against trimesh. No tolerance."""
import trimesh

import tool
from columns import assert_same
from ply_file import read_ply


class VerticesOfMeshesAreReadAsTrimeshReadsThem(tool.Files):
    def test(self):
        self.each(tool.real_files(".off", ".obj"), 2, self.check)

    def check(self, path):
        vertices = trimesh.load_mesh(str(path), process=False, maintain_order=True).vertices
        assert_same(self, read_ply(tool.convert(path, self.folder / "out.ply")), dict(zip("xyz", vertices.T)))


if __name__ == "__main__":
    tool.main()
