# SPDX-License-Identifier: MIT
"""The clouds that script/same-bytes runs over: all are made by one of the two tools, so that both read the same files."""
import subprocess

MADE = [
    ("generate", "terrain", "terrain.ply", "-n", "8M"),
    ("generate", "terrain", "again.ply", "-n", "8M", "--seed", "2", "--noise", "0.02"),
    ("run", "terrain.ply", "patch.ply", "--pipeline", "crop([300,300,360,360]) | drop(nx, ny, nz)"),
    ("run", "terrain.ply", "patch.laz", "--pipeline", "crop([300,300,360,360]) | drop(nx, ny, nz)"),
    ("run", "again.ply", "other.laz", "--pipeline", "crop([300,300,360,360]) | drop(nx, ny, nz)"),
    ("generate", "statue", "statue.ply", "-n", "30k"),
    ("generate", "statue", "outliers.ply", "-n", "300k", "--outliers", "0.001"),
    ("generate", "tls", "tls.ply", "-n", "50k"),
    ("run", "tls.ply", "tls.las", "--pipeline", "decimate(1)"),
    *(("run", "patch.ply", f"patch.{extension}", "--pipeline", "decimate(1)") for extension in ("csv", "pcd", "e57", "pts")),
    *(("run", "patch.laz", f"tiles/{x}-{y}.laz", "--pipeline", f"crop([{300 + 30 * x},{300 + 30 * y},{329.999999 + 30 * x},{329.999999 + 30 * y}])")
      for x in (0, 1) for y in (0, 1)),
]
HEADER = "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
NOT_FINITE = [f"{i * 37 % 101} {i * 53 % 97} {'nan' if i % 50 == 3 else i % 7}" for i in range(2000)]


def make(tool, folder):
    (folder / "tiles").mkdir(parents=True, exist_ok=True)
    (folder / "not-finite.ply").write_text(HEADER.format(len(NOT_FINITE)) + "\n".join(NOT_FINITE) + "\n")
    (folder / "empty.ply").write_text(HEADER.format(0))
    (folder / "flight.csv").write_text("0, 330, 280, 200\n1, 330, 380, 200\n")
    (folder / "one.ply").write_text(HEADER.format(1) + "1 2 3\n")
    for words in MADE:
        subprocess.run([tool, *words, "--force", "--quiet"], cwd=folder, check=True)
    for name in ("terrain.ply", "again.ply"):
        (folder / name).unlink()
