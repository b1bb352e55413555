# SPDX-License-Identifier: MIT
"""The clouds of script/hostile: how each is made, with which one it is compared, and which of its points are special."""
import dataclasses


@dataclasses.dataclass(frozen=True)
class Cloud:
    name: str
    made: tuple  # commands that write the input files; see inputs() in run.py
    clean: str = "surface"  # the cloud of the same size with which its time and window are compared
    special: int | str = 0  # rows that verify checks in addition to its sample: the first ones, or those of "normal 0"
    share: float = 0  # share of the points that are outliers, which may stay in the window
    times: int = 1  # factor for the number of points
    options: tuple = ()
    refused: str = ""  # words of the error with which the chain refuses the cloud; empty: not refused
    sample: str = ""  # rows to compare with brute force, if not as many as for other clouds
    verbs: tuple = ("normals", "neighbors")
    chain: str = "knn(k=8) | normals | splats | fair"  # three steps: each reads attributes of neighbours made by the previous one
    small_window: bool = False  # True: its window must stay below 3 % of the cloud at 20M points

    @property
    def timed(self):
        """Returns whether its time per point is worth comparing with that of the clean cloud."""
        return "neighbors" in self.verbs


TWO_STEPS = "knn(k=8) | normals | splats"


def own(name, **settings):
    return Cloud(settings.pop("called", name), (("hostile_cloud", name),), **settings)


def radius(name, length, **settings):
    """Makes a cloud that is searched within a radius, without a limit k: the graph has no fixed width, and time is per neighbour."""
    return Cloud(f"{name}, all within {length}", (("generate", name),), clean=name, sample="300",
                 options=("--radius", str(length)), verbs=("normals",), **settings)


def outliers(percent, box, **settings):
    generate = ("generate", "statue", "--outliers", str(percent / 100), "--outlier-box", str(box))
    return Cloud(f"statue, {percent} % outliers in a box {box}x", (generate,), clean="statue", special="normal 0",
                 share=percent / 100, **settings)


CLEAN = [own("surface"), Cloud("statue", (("generate", "statue"),)), Cloud("volume", (("generate", "volume"),))]

# The clouds of memory_law.py.
LAW = [Cloud("statue", (("generate", "statue"),)), Cloud("terrain", (("generate", "terrain"),)), Cloud("tls", (("generate", "tls"),)),
       Cloud("volume", (("generate", "volume"),)), own("dense-ball"), own("walls")]

HOSTILE = [
    *[outliers(percent, box) for percent in (0.001, 0.1, 1) for box in (10, 1000)],
    outliers(0.1, 20, small_window=True),
    own("two-far-clusters", special=9),
    own("one-point-far-away", special=1),
    Cloud("tls", (("generate", "tls"),), clean="statue", small_window=True),
    Cloud("tls, two stations", (("generate", "tls"), ("generate", "tls", "--seed", "2", "--origin", "60,20,0")), clean="statue"),
    own("three-stations"),
    own("wall-across"),
    own("twice"), own("ten-times"), own("thousand-times"), own("most-at-one-place"),
    # fair refuses clouds that lie in one place.
    own("all-identical", chain=TWO_STEPS), own("all-identical", called="copies beyond the budget", times=5, chain=TWO_STEPS),
    own("plane-across", special=1), own("plane-along", options=("--axis", "z"), called="all equal along the axis"), own("plane-along"),
    own("line"), own("skew-line"), own("grid", clean="volume"),
    own("millimetres"), own("millimetres-at-5e6"), own("near-1e12"), own("extent-1e-12"), own("denormals", refused="scale its coordinates"), own("not-finite"),
    radius("statue", 0.02), radius("statue", 0.06), radius("volume", 0.03),
    own("backwards"), own("organ-pipe"), own("one-slab"),
]
