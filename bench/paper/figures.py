# SPDX-License-Identifier: MIT
"""The pictures of the paper: its Figures 1, 7, 8 and 9, of real models where there are, else of a generated statue."""
import pathlib
import sys

import ply

# file below the data folder, axis that points up, view
MODELS = {
    "dragon": ("models/stanford_dragon/dragon_vrip.ply", "y", "0,0"),
    "bunny": ("models/stanford_bunny/reconstruction/bun_zipper.ply", "y", "0,0"),
    "igea": ("models/common3d/igea.ply", "y", "0,0"),
}
NOISY_SCAN = ("models/stanford_dragon_stand/dragonStandRight_0.ply", "y", "0,0")
SIZE = "900x640"
BLACK, RED, YELLOW, GREY = (25, 25, 25), (214, 48, 40), (240, 190, 30), (150, 150, 150)


class Model:
    """A cloud as the pictures need it: bare positions in a PLY of their own."""

    def __init__(self, tool, name, source, up, view):
        self.name, self.view = name, ["--up", up, "--view", view, "--size", SIZE]
        self.path = tool.work / f"{name}.ply"
        columns = ply.read(source)
        self.columns = ply.positions(columns)
        ply.write(self.path, self.columns)


def models(tool, data):
    found = [Model(tool, name, data / path, up, view) for name, (path, up, view) in MODELS.items() if data and (data / path).exists()]
    if found:
        return found
    print("script/paper: no real models (set POINTSWEEP_DATA); the pictures show a generated statue", file=sys.stderr)
    source = tool.work / "statue-pictures.ply"
    tool("generate", "statue", source, "-n", 400000)
    return [Model(tool, "statue", source, "z", "30,10")]


def draw(tool, data):
    """Draws all pictures into the working folder; captions by figure and file."""
    data = pathlib.Path(data) if data else None
    shown = models(tool, data)
    return {
        "figure 1": figure_1(tool, shown[0]),
        "figure 7": [picture for model in shown for picture in figure_7(tool, model)],
        "figure 8": figure_8(tool, shown[0]),
        "figure 9": figure_9(tool, data, shown[0]),
    }


def render(tool, cloud, name, caption, *options):
    tool("render", cloud, tool.work / name, *options)
    return {"file": name, "caption": caption}


def figure_1(tool, model):
    """The sweep when half of the points have been read. Colours of what has left the window: its RMS curvature."""
    splats, states = tool.work / "sweep.ply", tool.work / "states.npy"
    axis = max("xyz", key=lambda a: max(model.columns[a]) - min(model.columns[a]))
    pipeline = "knn(k=8) | normals | curvature | splats"
    tool("run", model.path, splats, "--pipeline", pipeline, "--axis", axis, "--half-way-states", states)
    columns = ply.read(splats)
    state_of = ply.npy_bytes(states)
    colors = {0: BLACK, 1: RED, 2: YELLOW, 3: GREY}
    values = columns["rms_curvature"]
    most = sorted(values)[int(0.95 * (len(values) - 1))] or 1
    rgb = [colors.get(s) or heat(v / most) for s, v in zip(state_of, values)]
    kept = {name: columns[name] for name in ("x", "y", "z", "nx", "ny", "nz", "splat_x", "splat_y", "splat_z", "splat_ratio")}
    # What is not finished has no splat yet and is shown as a small round point.
    kept["splat_length"] = [v if s >= 3 else 0.5 * v for s, v in zip(state_of, columns["splat_length"])]
    for i, channel in enumerate(("red", "green", "blue")):
        kept[channel] = [color[i] for color in rgb]
    frame = tool.work / "frame.ply"
    ply.write(frame, kept)
    counts = {s: state_of.count(s) for s in range(5)}
    caption = (f"{model.name}, swept along {axis}, when half of the points have been read: {counts[0]} unread (black), {counts[1]} waiting for their "
               f"neighbourhood (red), {counts[2]} with normals, waiting for curvature (yellow), {counts[3]} finished but still looked at "
               f"(grey), {counts[4]} gone, as shaded splats coloured by RMS curvature")
    return [render(tool, frame, "figure1.png", caption, *model.view)]


def heat(t):
    """Returns a colour between pale blue, white and orange."""
    t = min(max(t, 0.0), 1.0)
    low, middle, high = (120, 160, 220), (235, 235, 230), (240, 120, 40)
    a, b, s = (low, middle, 2 * t) if t < 0.5 else (middle, high, 2 * t - 1)
    return tuple(int(x + (y - x) * s) for x, y in zip(a, b))


def figure_7(tool, model):
    output = tool.work / f"{model.name}-splats.ply"
    tool("run", model.path, output, "--pipeline", "knn(k=16) | normals | curvature | splats")
    return [render(tool, output, f"figure7-{model.name}-normals.png", f"{model.name}: splats shaded by their normals", "--color", "plain", *model.view),
            render(tool, output, f"figure7-{model.name}-curvature.png", f"{model.name}: RMS curvature", "--color", "curvature", *model.view)]


def shaded(tool, cloud, name, caption, view):
    """A picture of bare points by their splats."""
    output = tool.work / "shaded.ply"
    tool("splats", cloud, output, "-k", 12)
    return render(tool, output, name, caption, "--color", "plain", *view)


def faired(tool, cloud, name, caption, view, k=64):
    output = tool.work / "faired.ply"
    tool("fair", cloud, output, "-k", k)
    return render(tool, output, name, caption, "--color", "plain", *view)


def figure_8(tool, model):
    noisy = tool.work / "noisy.ply"
    ply.write(noisy, ply.with_noise(model.columns, 0.0005 * ply.diagonal(model.columns)))
    return [shaded(tool, model.path, "figure8-original.png", f"{model.name}: original", model.view),
            shaded(tool, noisy, "figure8-noisy.png", "with noise of 0.05 % of the diagonal on each coordinate", model.view),
            faired(tool, noisy, "figure8-smoothed.png", "smoothed (f and g of 0.5 % of the diagonal, k = 64)", model.view)]


def figure_9(tool, data, stand_in):
    if data and (data / NOISY_SCAN[0]).exists():
        model = Model(tool, "raw-scan", data / NOISY_SCAN[0], *NOISY_SCAN[1:])
        what = "one raw range scan of the Stanford dragon"
    else:
        model, what = stand_in, stand_in.name
    return [shaded(tool, model.path, "figure9-scan.png", f"{what}, unchanged", model.view),
            faired(tool, model.path, "figure9-smoothed.png", "smoothed (k = 64)", model.view)]
