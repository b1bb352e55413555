# SPDX-License-Identifier: MIT
# Made by script/docs from the declarations of the operators; a test compares it with them.
"""The built-in operators as stages of pipelines: ``ps.knn(16) | ps.normals(orient="up") | ps.sor()``."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from ._files import Cloud
from ._stage import Stage, made_stage, makes_stage

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = [
    "assign", "color", "components", "crop", "curvature", "dbscan", "decimate", "denoise", "density", "distance_to",
    "drop", "fair", "features", "ground", "head", "height", "knn", "level", "lof", "m3c2", "neighborhood_size",
    "orient", "parts", "poisson", "reneighbor", "resort", "ror", "sample", "segments", "simplify", "sor", "splats",
    "statistics", "take", "transform", "unique", "voxel", "where",
]  # fmt: skip


@makes_stage
def knn(
    k: int | None = None,
    *,
    radius: float | None = None,
    k_from: str | None = None,
    radius_from: str | None = None,
    adaptive: Literal["none", "eigenentropy"] | None = None,
    k_min: int | None = None,
) -> Stage:
    """Neighbourhood for all stages: the k nearest points, all points within a radius, or the k nearest of these; the
    first stage of a pipeline, or left out.

    Parameters
    ----------
    k : number of neighbours, excluding the point; a radius without k means all points within it; without both, the
        largest default of the operators in the pipeline; 1 or more.
    radius : maximum distance of a neighbour, in the unit of the coordinates; 0 or more; unit: length.
    k_from : attribute of the input that holds the number of neighbours of each point, at most k, which has to be
        given.
    radius_from : attribute of the input that holds the maximum distance of a neighbour for each point; k or radius
        has to be given as a limit.
    adaptive : choose the number of neighbours of each point, from k_min to k, by the least eigenentropy (Weinmann
        2014); k has to be given; default: "none".
    k_min : smallest number of neighbours that adaptive=eigenentropy may choose; 3 or more; default: 10.

    Formula
    -------
    N_i: the k points of the cloud nearest to p_i without p_i itself, or all within the radius, or the k nearest of
      these. Distances are d² = ((dx² + dy²) + dz²) in double of the coordinates of the input; equal ones are
      ordered by x, y, z, then by input row. Within a radius R: d² <= R·R in double.
    k_from, radius_from: point i keeps the first neighbours that its own k or radius allows.
    adaptive=eigenentropy: the k from k_min on for which E = -Σ e_j ln e_j is least; e_1, e_2, e_3 are the
      eigenvalues of the covariance of p_i and its k nearest neighbours, divided by their sum.

    Source
    ------
    Pajarola, Stream-Processing Points (IEEE Visualization 2005), Section 4.2.2; here exact. eigenentropy: Weinmann,
    Jutzi and Mallet, ISPRS Annals II-3 (2014).

    Cost
    ----
    12 ns per neighbour up to k = 64, 15 ns beyond it; adaptive: 0.1 µs more for each k tried.

    In a text
    ---------
    knn(k=100, adaptive=eigenentropy, k_min=10) | normals
    """
    return made_stage("knn", [
        ("k", "whole", k, None),
        ("radius", "number", radius, None),
        ("k_from", "attribute", k_from, None),
        ("radius_from", "attribute", radius_from, None),
        ("adaptive", "choice", adaptive, None),
        ("k_min", "whole", k_min, None),
    ])


@makes_stage
def normals(
    orient: Literal["none", "up", "viewpoint", "input"] = "none",
    *,
    viewpoint: Sequence[float] | None = None,
    k: int | None = None,
    radius: float | None = None,
) -> Stage:
    """Unit normals, from the weighted covariance of the neighbours (Equation 1 of the paper).

    Parameters
    ----------
    orient : how to orient normals: none, up (towards +z), towards the viewpoint, or to the side of the normals in
        the input.
    viewpoint : position of the scanner for orient=viewpoint, in the coordinates of the cloud; unit: length.
    k, radius : k and radius of a knn before the stage, which begins the pipeline; default: 16 neighbours where
        neither is given.

    Makes
    -----
    normal : (n, 3) float32; unit surface normal; 0 where undefined.

    Neighbours
    ----------
    16 where neither k nor a radius is given.

    Formula
    -------
    n_i: eigenvector of the smallest eigenvalue of
    M_i = 1/|N_i| Σ_j (p_j - p_i)(p_j - p_i)^T θ(|p_j - p_i|)
    θ(r) = exp(-r² / 2σ²), σ² = π max_j |p_j - p_i|² / |N_i|; |N_i| does not count p_i.
    orient=none: the first of the largest components is positive.
    orient=up, viewpoint, input: the dot product with +z, the direction to the viewpoint or the normal of the input
      is positive; where it is 0, as for none.

    Undefined
    ---------
    (0, 0, 0) where the neighbours define no plane: fewer than two, all on the point, or all on a line.

    Source
    ------
    Pajarola, Stream-Processing Points (IEEE Visualization 2005), Section 3.2, Equation 1.

    Cost
    ----
    At k = 8 about 190 cycles per point with AVX2, after the search.

    In a text
    ---------
    knn(k=12) | normals(orient=viewpoint, viewpoint=[0,0,1.7])
    """
    return made_stage("normals", [
        ("orient", "choice", orient, "none"),
        ("viewpoint", "point", viewpoint, None),
    ], k, radius)


@makes_stage
def curvature(*, k: int | None = None, radius: float | None = None) -> Stage:
    """Principal curvatures and derived curvatures, from the covariance of the neighbours' normals (Equation 2).

    Parameters
    ----------
    k, radius : k and radius of a knn before the stage, which begins the pipeline; default: 32 neighbours where
        neither is given.

    Makes
    -----
    k1 : (n,) float32, 1/length; larger principal curvature, without sign.
    k2 : (n,) float32, 1/length; smaller principal curvature, without sign.
    k1_direction : (n, 3) float32; unit tangent along which k1 is.
    mean_curvature : (n,) float32, 1/length; (k1 + k2) / 2, without sign.
    gaussian_curvature : (n,) float32, 1/length^2; k1 k2, without sign.
    rms_curvature : (n,) float32, 1/length; square root of (k1^2 + k2^2) / 2.
    absolute_curvature : (n,) float32, 1/length; k1 + k2.
    surface_variation : (n,) float32; smallest eigenvalue of M_i over the sum of all, [0, 1/3].
    normal_eigenvalues : (n, 3) float32; eigenvalues of C_i, ascending.

    Reads
    -----
    normal, normal of neighbours

    Neighbours
    ----------
    32 where neither k nor a radius is given.

    Formula
    -------
    Over the m neighbours that have a normal, u_j = n_j / |n_j|:
    S = 1/m Σ_j u_j u_j^T, eigenvalues μ0 <= μ1 <= μ2, eigenvectors e0, e1, e2
    D = 1/m Σ_j (p_j - p̄)(p_j - p̄)^T, p̄ their mean
    t1: e1 in the tangent plane of n_i, or e0 × n_i where e0 is nearer to that plane, as a unit vector; t2 = n_i ×
      t1
    Curvatures along t1 and t2: √(μ1 / t1^T D t1) and √(μ0 / t2^T D t2); k1 is the larger.
    C_i = 1/|N_i| Σ_j n_j n_j^T θ(|p_j - p_i|), θ and M_i as in normals.

    Undefined
    ---------
    All values are 0 where the point has no normal, fewer than three neighbours have one, or the neighbours that
    have one lie on a line as seen along the normal.

    Source
    ------
    Pajarola, Stream-Processing Points (IEEE Visualization 2005), Section 4.3.2, Equation 2; the step from variances
    to curvatures is ours (docs/paper.md).

    Cost
    ----
    At k = 8 about 510 cycles per point with AVX2, after the search; attributes that are not kept cost nothing.

    In a text
    ---------
    knn(k=64) | normals | curvature
    """
    return made_stage("curvature", [], k, radius)


@makes_stage
def splats(
    axes: Literal["auto", "positions", "curvature"] = "auto",
    *,
    k: int | None = None,
    radius: float | None = None,
) -> Stage:
    """Elliptical splats that together cover the surface.

    Parameters
    ----------
    axes : derive direction and ratio of the ellipses from curvature or from positions; auto takes curvature if an
        earlier stage computes it and no stage drops it.
    k, radius : k and radius of a knn before the stage, which begins the pipeline; default: 16 neighbours where
        neither is given.

    Makes
    -----
    splat_axis : (n, 3) float32; unit major axis of the splat.
    splat_length : (n,) float32, length; major semi-axis of the splat.
    splat_ratio : (n,) float32; minor over major semi-axis of the splat, in [1/8, 1]; 0: none.

    Reads
    -----
    normal

    Neighbours
    ----------
    16 where neither k nor a radius is given.

    Formula
    -------
    An ellipse around p_i in the tangent plane of n_i, grown until it holds eight neighbours; with m < 8 neighbours,
      √(8/m) times as long as one that holds all. Neighbours on the normal through p_i do not count.
    axes=positions: major axis along the largest eigenvector of M_i (Equation 1), ratio √(λ1/λ2).
    axes=curvature: major axis along the direction of k2, ratio √(k2/k1).
    Ratios are at least 1/8.

    Undefined
    ---------
    All values are 0 where the point has no normal or no neighbour off the point.

    Source
    ------
    Pajarola, Stream-Processing Points (IEEE Visualization 2005), Section 4.3.3; the size is ours (docs/paper.md).

    Cost
    ----
    At k = 8 about 150 cycles per point with AVX2, after the search.

    In a text
    ---------
    knn(k=12) | normals | splats(axes=positions)
    """
    return made_stage("splats", [
        ("axes", "choice", axes, "auto"),
    ], k, radius)


@makes_stage
def fair(f: float = 0.5, *, g: float = 0.5, k: int | None = None, radius: float | None = None) -> Stage:
    """Edge-preserving smoothing: moves points towards the tangent planes of their neighbours (Equation 3).

    Parameters
    ----------
    f : reach of the smoothing: standard deviation of the Gaussian weight of the distance to a neighbour, in % of
        the diagonal of the bounding box of the input; 1e-06 to 100; unit: % of the diagonal.
    g : height of the bumps that are removed: standard deviation of the Gaussian weight of the distance to the
        tangent plane of a neighbour, in % of the diagonal of the bounding box of the input; 1e-06 to 100; unit: %
        of the diagonal.
    k, radius : k and radius of a knn before the stage, which begins the pipeline; default: 64 neighbours where
        neither is given.

    Makes
    -----
    position : (n, 3) float64, length; moved position.

    Reads
    -----
    splat_length, splat_ratio, normal of neighbours, splat_length of neighbours, splat_ratio of neighbours

    Neighbours
    ----------
    64 where neither k nor a radius is given.

    Formula
    -------
    p_i' = 1/w_i Σ_j Π_j(p_i) a_j f(|p_j - p_i|) g(|Π_j(p_i) - p_i|), j over N_i and i
    Π_j(p_i): projection of p_i onto the tangent plane of p_j; w_i: sum of the weights;
    a_j = π length² ratio of the splat of p_j; f and g: Gaussians exp(-r² / 2 width²).

    Undefined
    ---------
    A point stays where it is if no neighbour with a normal and a splat has a weight above 0.

    Source
    ------
    Pajarola, Stream-Processing Points (IEEE Visualization 2005), Section 4.3.4, Equation 3; Π_j as in Jones, Durand
    and Desbrun, Non-iterative, feature-preserving mesh smoothing (2003).

    Cost
    ----
    One reading of the input for the diagonal.

    In a text
    ---------
    knn(k=64) | normals | splats | fair(f=0.3, g=0.3) | normals
    """
    return made_stage("fair", [
        ("f", "number", f, 0.5),
        ("g", "number", g, 0.5),
    ], k, radius)


@makes_stage
def features(
    names: Sequence[Literal["linearity", "planarity", "sphericity", "omnivariance", "anisotropy", "eigenentropy", "eigenvalue_sum", "surface_variation", "verticality", "moment1_axis1", "moment1_axis2", "moment2_axis1", "moment2_axis2", "height_range", "number_of_neighbors"]] | None = None,
    *,
    eigenvalues: Literal["raw", "sqrt", "normalized"] = "raw",
    with_point: bool = True,
    k: int | None = None,
    radius: float | None = None,
) -> Stage:
    """Features of the shape of neighbourhoods, from the eigenvalues of their covariance: like a line, a plane or a
    volume.

    Parameters
    ----------
    names : features to compute, as in [linearity,planarity]; without this option, all of them.
    eigenvalues : what the features are made of: the eigenvalues themselves, their square roots, or the eigenvalues
        divided by their sum.
    with_point : count the point itself among the points of its neighbourhood.
    k, radius : k and radius of a knn before the stage, which begins the pipeline; default: 32 neighbours where
        neither is given.

    Makes
    -----
    linearity : (n,) float32; (λ1 - λ2) / λ1, in [0, 1].
    planarity : (n,) float32; (λ2 - λ3) / λ1, in [0, 1].
    sphericity : (n,) float32; λ3 / λ1, in [0, 1].
    omnivariance : (n,) float32, length^2; ∛(λ1 λ2 λ3).
    anisotropy : (n,) float32; (λ1 - λ3) / λ1, in [0, 1].
    eigenentropy : (n,) float32, length^2; -Σ λ ln λ.
    eigenvalue_sum : (n,) float32, length^2; λ1 + λ2 + λ3.
    surface_variation : (n,) float32; λ3 / (λ1 + λ2 + λ3), in [0, 1/3].
    verticality : (n,) float32; 1 - |e3 · z|, in [0, 1]: 0 for a horizontal plane, 1 for a vertical one.
    moment1_axis1 : (n,) float32, length; |Σ (p - p_i) · e1|.
    moment1_axis2 : (n,) float32, length; |Σ (p - p_i) · e2|.
    moment2_axis1 : (n,) float32, length^2; Σ ((p - p_i) · e1)².
    moment2_axis2 : (n,) float32, length^2; Σ ((p - p_i) · e2)².
    height_range : (n,) float32, length; max z - min z.
    number_of_neighbors : (n,) uint32; n, the number of points.

    Neighbours
    ----------
    32 where neither k nor a radius is given.

    Formula
    -------
    P: the neighbours, and p_i with with_point=yes; n = |P|, p̄ their mean
    Σ = 1/n Σ_P (p - p̄)(p - p̄)^T, eigenvalues l1 >= l2 >= l3, eigenvectors e1, e2, e3
    eigenvalues=raw: λ = l, in length²; sqrt: λ = √l, in length;
    eigenvalues=normalized: λ = l / (l1 + l2 + l3)
    Moments are sums over P. In eigenentropy 0 ln 0 is 0; of raw values and roots it depends on the unit of length.
    CloudCompare: raw, with_point=yes; its '1st order moment' is moment1_axis2² / moment2_axis2.
    jakteristics: the same with n - 1 for n, which changes omnivariance, eigenentropy and eigenvalue_sum alone.
    PDAL: sqrt, with_point=yes, n - 1 for n; its Scattering is sphericity, its DemantkeVerticality verticality; its
      Verticality (Guinard and Landrieu 2017) is another.

    Undefined
    ---------
    Points all in one place, or a neighbour without a finite place: all but number_of_neighbors is 0. Points on a
    line, vertical ones too: verticality is 0, since e3 is any direction across it. Points without a finite place:
    all is 0.

    Source
    ------
    Weinmann et al., Semantic point cloud interpretation based on optimal neighborhoods, relevant features and
    efficient classifiers (ISPRS Journal 105, 2015); Hackel, Wegner, Schindler, Fast semantic segmentation of 3D
    point clouds with strongly varying density (2016), whose first moments have an arbitrary sign that is left out
    here.

    Cost
    ----
    At k = 10 as much as normals, after the search; logarithms and axes only where an attribute needs them.

    In a text
    ---------
    knn(radius=0.5) | features(names=[linearity,planarity,verticality])
    """
    return made_stage("features", [
        ("names", "names", names, None),
        ("eigenvalues", "choice", eigenvalues, "raw"),
        ("with_point", "no|yes", with_point, True),
    ], k, radius)


@makes_stage
def neighborhood_size(*, k: int | None = None, radius: float | None = None) -> Stage:
    """Number of neighbours and distance of the farthest.

    Parameters
    ----------
    k, radius : k and radius of a knn before the stage, which begins the pipeline; default: 8 neighbours where
        neither is given.

    Makes
    -----
    neighbor_count : (n,) uint32; number of neighbours.
    neighbor_radius : (n,) float64, length; distance to the farthest neighbour; 0 without any.

    Neighbours
    ----------
    8 where neither k nor a radius is given.

    Formula
    -------
    |N_i| without p_i, and max_j |p_j - p_i|

    Source
    ------
    PDAL keeps the same as OptimalKNN and OptimalRadius.

    In a text
    ---------
    knn(radius=0.1) | neighborhood_size
    """
    return made_stage("neighborhood_size", [], k, radius)


@makes_stage
def where(condition: str) -> Stage:
    """Keeps the points for which a condition on attributes holds; later stages see neighbours among these.

    Parameters
    ----------
    condition : attributes of the input or made before, row (the number of the point in the inputs, from 0),
        numbers, functions such as abs, + - * /, == != < <= > >=, in (2, 9), between 2 and 5, && || ! or the words
        and, or, not, and parentheses; 'condition=' may be left out.

    Undefined
    ---------
    Points without a finite place are asked like all others: their coordinates are NaN or infinite.

    Cost
    ----
    A pass over the rows, without a search; one more sweep if a later stage needs neighbours again.

    In a text
    ---------
    knn(k=12) | where(z > 0 && z < 100) | normals
    """
    return made_stage("where", [
        ("condition", "condition", condition, None),
    ])


@makes_stage
def crop(
    bounds: Sequence[float] | None = None,
    *,
    polygon: str | os.PathLike[str] | Cloud | None = None,
    outside: bool = False,
    checksum: str | None = None,
) -> Stage:
    """Keeps the points inside a box or polygons; later stages see neighbours among these.

    Parameters
    ----------
    bounds : corners of a box: XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX, or XMIN,YMIN,XMAX,YMAX for any z; 'bounds=' may be
        left out; unit: length.
    polygon : file with polygons, or a polygon itself, as WKT or GeoJSON in the coordinates of the cloud; with
        bounds a point has to lie in both.
    outside : keep the points outside of the box and polygons instead.
    checksum : checksum of the file with polygons, as a processing record holds it; a file with other content is
        refused.

    Formula
    -------
    In the box: XMIN <= x <= XMAX and YMIN <= y <= YMAX (and ZMIN <= z <= ZMAX).
    In a polygon: (x, y) lies on one of its edges, or a ray from it crosses its edges an odd number of times (even-
      odd rule over all its rings). Of several polygons: in any of them. Decided without rounding.

    Undefined
    ---------
    A point of which a coordinate that is compared is NaN or infinite lies outside; outside=true keeps it.

    Source
    ------
    Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates (1997).

    Cost
    ----
    A pass over the rows, without a search; about 50 ns for each point near many edges.

    In a text
    ---------
    knn(k=12) | crop([0,0,100,100]) | normals
    """
    return made_stage("crop", [
        ("bounds", "numbers", bounds, None),
        ("polygon", "file", polygon, None),
        ("outside", "false|true", outside, False),
        ("checksum", "word", checksum, None),
    ])


@makes_stage
def assign(
    assign: str,
    *,
    as_: Literal["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"] | None = None,
) -> Stage:
    """Assigns numbers to attributes, of all points or of those for which a condition holds.

    Parameters
    ----------
    assign : NAME = EXPRESSION or NAME = EXPRESSION where CONDITION, several with commas between, done one after
        another; expressions and conditions are those of where; 'assign=' may be left out.
    as_ : type of new attributes, and of those of the input that are assigned without a condition; without this
        option new ones are float64, or of the type that LAS has for the name, such as uint8 for classification.

    Formula
    -------
    Numbers are evaluated in float64, as by where; an attribute of whole numbers of 64 bits, or a whole number, is
      assigned exactly. A whole-number type gets the nearest one, halves to even.
    An attribute that exists keeps its type (one of the input gets the type of 'as' if no condition is given, and
      scaled numbers, as those of LAS, become float64), and its value where the condition does not hold; a new
      attribute is 0 there. Assigning to x, y or z moves the points.

    Undefined
    ---------
    A value that the type cannot hold ends the run with an error that names the row, and so does arithmetic with
    attributes of 64-bit integers, for a type of 64 bits, where they or the result are beyond 2^53 and float64 may
    round; and so does a NaN or infinite coordinate for a point that has a finite place. Points without a finite
    place are assigned to like all others.

    Cost
    ----
    A pass over the rows, without a search; none where other stages search anyway.

    In a text
    ---------
    knn(k=12) | sor | set(classification = 7 where outlier == 1)
    """
    return made_stage("set", [
        ("assign", "assignments", assign, None),
        ("as", "choice", as_, None),
    ])


@makes_stage
def drop(attributes: str | Sequence[str]) -> Stage:
    """Leaves attributes out of the output; later stages cannot read them; x, y and z are always kept.

    Parameters
    ----------
    attributes : attributes to leave out, of the input or computed by earlier stages; 'attributes=' may be left out.

    Cost
    ----
    None: what is dropped is not computed either, unless a stage before reads it.

    In a text
    ---------
    knn(k=12) | normals | set(facing = nz * nz) | drop(normal)
    """
    return made_stage("drop", [
        ("attributes", "attributes", attributes, None),
    ])


@makes_stage
def transform(
    matrix: ArrayLike | str | os.PathLike[str] | None = None,
    *,
    scale: float = 1,
    translate: Sequence[float] | None = None,
    inverse: bool = False,
) -> Stage:
    """Moves the points by a matrix, and turns their normals and other directions.

    Parameters
    ----------
    matrix : file with a matrix of 4 rows of 4 numbers, the last one 0 0 0 1, or these numbers row by row; the last
        row may be left out.
    scale : factor of the coordinates, after the matrix; above 0.
    translate : added to the coordinates, after the scale; unit: length.
    inverse : move the points back: the inverse of all this.

    Makes
    -----
    position : (n, 3) float64, length; moved position.

    Formula
    -------
    p' = A p + t: x' = ((a11 x + a12 y) + a13 z) + t1, likewise y' and z', in float64. A and t are those of the
      matrix, times scale, plus translate; with inverse=yes A⁻¹ and -A⁻¹ t.
    Normals: n' = |n| A⁻ᵀ n / |A⁻ᵀ n|; tangents (k1_direction, splat_axis): v' = |v| A v / |A v|.
    Lengths of an attribute with the unit lengthᵏ: times sᵏ, s² = trace(AᵀA) / 3. A scale within 1e-6 of 1 is 1. A
      matrix that does not keep angles within 1e-5 is refused where there are lengths.
    These are the attributes of earlier stages by their declarations, and fields of the input that bear the names of
      attributes that operators make (nx, splat_length, mean_distance). All others keep their values; so does the
      coordinate reference system.

    Undefined
    ---------
    A point without a finite place keeps its coordinates; its directions turn. Coordinates that would no longer be
    finite end the run with an error that names the row.

    Cost
    ----
    A pass over the rows, without a search; none where other stages search anyway.

    In a text
    ---------
    knn(k=12) | normals | transform([0,-1,0,100,1,0,0,200,0,0,1,0])
    """
    return made_stage("transform", [
        ("matrix", "matrix", matrix, None),
        ("scale", "number", scale, 1),
        ("translate", "point", translate, None),
        ("inverse", "no|yes", inverse, False),
    ])


@makes_stage
def sor(
    multiplier: float = 2,
    *,
    definition: Literal["pointsweep", "pdal", "pcl", "open3d", "cloudcompare"] = "pointsweep",
    k: int | None = None,
    radius: float | None = None,
) -> Stage:
    """Statistical outliers: points whose mean distance to their neighbours exceeds mean + multiplier * deviation of
    the cloud.

    Parameters
    ----------
    multiplier : a mean distance this many standard deviations above that of the cloud makes an outlier; 0 or more.
    definition : use the rule of this program; the formula shows the differences.
    k, radius : k and radius of a knn before the stage, which begins the pipeline; default: 8 neighbours where
        neither is given.

    Makes
    -----
    mean_distance : (n,) float64, length; mean distance to the neighbours; NaN without any.
    outlier : (n,) uint8; 1: farther from its neighbours than mean + multiplier * deviation.

    Neighbours
    ----------
    8 where neither k nor a radius is given.

    Formula
    -------
    d_i = 1/|N_i| Σ_j |p_j - p_i| (mean_distance); m and s: mean and standard deviation of all n finite d; t = m +
      multiplier * s. N_i never holds p_i.
    pointsweep:   s divides by n - 1; outlier: d > t
    pdal:         s divides by n - 1; outlier: d >= t. mean_k is our k
    pcl:          as pointsweep. mean_k is our k (before PCL 1.7: k + 1)
    open3d:       d_i = 1/(|N_i| + 1) Σ_j |p_j - p_i|, for the point itself counts, at distance 0. Terms of s with d
      = 0 are left out, but count in n; s divides by n - 1; outlier: d >= t or d = 0. nb_neighbors is k + 1
    cloudcompare: s divides by n; outlier: d > t. Its number of points is k + 1

    Undefined
    ---------
    Without neighbours, or if one has no finite place: mean_distance is NaN and outlier 1.

    Source
    ------
    Rusu, Semantic 3D object maps (2009); the sources of PDAL 2 (filters.outlier), PCL 1.13
    (StatisticalOutlierRemoval), Open3D 0.18 (RemoveStatisticalOutliers) and CloudCompare 2.11 (sorFilter). PCL and
    CloudCompare round d to float32; here it is float64.

    Cost
    ----
    One more pass over the rows, in which the outliers are marked; it is the writing of the output where no later
    stage needs neighbours.

    In a text
    ---------
    knn(k=8) | sor(multiplier=2) | where(outlier == 0)
    """
    return made_stage("sor", [
        ("multiplier", "number", multiplier, 2),
        ("definition", "choice", definition, "pointsweep"),
    ], k, radius)


@makes_stage
def denoise(
    multiplier: float = 2,
    *,
    definition: Literal["pointsweep", "pdal", "pcl", "open3d", "cloudcompare"] = "pointsweep",
    k: int | None = None,
    radius: float | None = None,
) -> Stage:
    """Leaves out statistical outliers: sor, without the attributes that it makes.

    Parameters
    ----------
    multiplier : a mean distance this many standard deviations above that of the cloud makes an outlier; 0 or more.
    definition : use the rule of this program; the formula shows the differences.
    k, radius : k and radius of a knn before the stage, which begins the pipeline; default: 8 neighbours where
        neither is given.

    Neighbours
    ----------
    8 where neither k nor a radius is given.

    Formula
    -------
    sor | where(outlier == 0) | drop(mean_distance, outlier)

    Undefined
    ---------
    Without neighbours, or if one has no finite place, a point is left out. Attributes mean_distance and outlier of
    the input are refused.

    Source
    ------
    That of sor.

    Cost
    ----
    That of sor.

    In a text
    ---------
    knn(k=8) | denoise(multiplier=2)
    """
    return made_stage("denoise", [
        ("multiplier", "number", multiplier, 2),
        ("definition", "choice", definition, "pointsweep"),
    ], k, radius)


@makes_stage
def ror(radius: float, *, min_neighbors: int = 2, k: int | None = None) -> Stage:
    """Radius outliers: points with fewer than min_neighbors neighbours within a radius.

    Parameters
    ----------
    radius : the distance within which neighbours count, inclusive; above 0; unit: length.
    min_neighbors : number of neighbours that a point needs, without the point itself; knn needs k of at least this;
        1 or more.
    k : k of a knn before the stage, which begins the pipeline; default: 2 neighbours.

    Makes
    -----
    outlier : (n,) uint8; 1: too few neighbours within the radius.

    Neighbours
    ----------
    2 where neither k nor a radius is given.

    Formula
    -------
    outlier = 1 where |{j in N_i : |p_j - p_i| <= radius}| < min_neighbors, N_i without p_i.
    The min_neighbors nearest neighbours are enough to know, so that knn(k=min_neighbors) before it makes the same
      as knn(radius=...) in less time.
    PDAL (min_k), PCL (setMinNeighborsInRadius) and Open3D (nb_points) keep the same points, except that PDAL and
      Open3D do not count a neighbour at exactly the radius.

    Undefined
    ---------
    A neighbour that has no finite place is not within the radius. A point that has none is an outlier.

    Source
    ------
    PDAL filters.outlier, method radius; PCL RadiusOutlierRemoval; Open3D remove_radius_outlier.

    In a text
    ---------
    knn(k=4) | ror(radius=0.5, min_neighbors=4) | where(outlier == 0)
    """
    return made_stage("ror", [
        ("radius", "number", radius, None),
        ("min_neighbors", "whole", min_neighbors, 2),
    ], k)


@makes_stage
def lof(*, k: int | None = None, radius: float | None = None) -> Stage:
    """Local outlier factor: how many times sparser a point lies than its neighbours do; about 1 inside a cloud.

    Parameters
    ----------
    k, radius : k and radius of a knn before the stage, which begins the pipeline; default: 32 neighbours where
        neither is given.

    Makes
    -----
    k_distance : (n,) float64, length; distance to the farthest neighbour.
    reachability_density : (n,) float64, 1/length; inverse of the mean reachability distance.
    lof : (n,) float64; local outlier factor.

    Neighbours
    ----------
    32 where neither k nor a radius is given.

    Formula
    -------
    k_distance_i = max_j |p_j - p_i| over N_i, which does not hold p_i
    reachability_density: r_i = |N_i| / Σ_j max(k_distance_j, |p_j - p_i|)
    lof_i = 1/|N_i| Σ_j r_j / r_i
    Exactly k neighbours count, as in scikit-learn and PDAL (filters.lof, minpts is k); in the publication more,
      where several are as far as the k-th. scikit-learn adds 1e-10 to the mean reachability; here r is infinite
      where that is 0, and the quotient of two of them is 1.

    Undefined
    ---------
    NaN without neighbours, or if the point, a neighbour or a neighbour of one has no finite place or no neighbours.

    Source
    ------
    Breunig, Kriegel, Ng, Sander, LOF: identifying density-based local outliers (SIGMOD 2000), Definitions 3 to 7.

    Cost
    ----
    Three steps: points stay in memory until the neighbours of their neighbours are known.

    In a text
    ---------
    knn(k=20) | lof | where(lof < 1.5)
    """
    return made_stage("lof", [], k, radius)


@makes_stage
def density(radius: float | None = None, *, k: int | None = None) -> Stage:
    """Points for each unit of area and of volume around a point.

    Parameters
    ----------
    radius : radius of the ball in which points are counted; without this option, the distance to the farthest
        neighbour; above 0; unit: length.
    k : k of a knn before the stage, which begins the pipeline; default: 32 neighbours.

    Makes
    -----
    surface_density : (n,) float32, 1/length^2; points for each unit of area.
    volume_density : (n,) float32, 1/length^3; points for each unit of volume.

    Neighbours
    ----------
    32 where neither k nor a radius is given.

    Formula
    -------
    surface_density = m / (π R²), volume_density = m / (4/3 π R³)
    Without radius: R = max_j |p_j - p_i|, m = |N_i| without p_i.
    With radius R: m = 1 + |{j : |p_j - p_i| <= R}|, as CloudCompare counts; a knn before it has to hold all of
      these.
    A plane through p_i cuts a disc of area π R² out of the ball.

    Undefined
    ---------
    0 without neighbours, where all lie on the point, and where one has no finite place; with radius only for a
    point that has no finite place itself.

    Source
    ------
    CloudCompare, Compute geometric features: surface and volume density; PDAL filters.radialdensity makes the
    volume density with radius.

    In a text
    ---------
    knn(k=16) | density
    """
    return made_stage("density", [
        ("radius", "number", radius, None),
    ], k)


@makes_stage
def statistics(
    of: str | Sequence[str],
    *,
    where: str | None = None,
    k: int | None = None,
    radius: float | None = None,
) -> Stage:
    """Statistics of the neighbours' attributes: mean, median, min, max, range, deviation, majority and count.

    Parameters
    ----------
    of : results, each ATTRIBUTE_STATISTIC with one of the statistics mean, median, min, max, range, deviation,
        majority and count, as in intensity_median, z_range, classification_majority; or count, the number of
        neighbours; 'of=' may be left out.
    where : only neighbours for which this condition holds count; conditions are those of the operator where.
    k, radius : k and radius of a knn before the stage, which begins the pipeline; default: 16 neighbours where
        neither is given.

    Neighbours
    ----------
    16 where neither k nor a radius is given.

    Formula
    -------
    v_1, ..., v_n: the finite values of the attribute at the neighbours for which the condition holds, in the order
      of the search: nearest first where no stage has moved points since. N_i never holds p_i.
    mean:      v_1 + m, m = 1/n Σ (v_j - v_1)
    deviation: √(1/n Σ (v_j - v_1 - m)²), that of the whole population
    median:    the middle value; of an even number (a + b) / 2 of the two middle ones
    range:     max - min
    majority:  the most frequent value; of several the one that comes first
    count:     n; without an attribute, the neighbours for which the condition holds
    Sums and differences are float64, and so are mean, deviation, median and range. min, max and majority have the
      type of the attribute, whole numbers of 64 bits are exact. count is uint32.

    Undefined
    ---------
    Without a neighbour that counts: NaN, of whole numbers 0; count is 0.

    Cost
    ----
    About 5 ns for each neighbour and statistic; median and majority, which sort, 10 to 70 ns; a condition 15 ns.

    In a text
    ---------
    knn(k=16) | normals | statistics(z_range, nz_median, count, where=nz > 0)
    """
    return made_stage("statistics", [
        ("of", "attributes", of, None),
        ("where", "condition", where, None),
    ], k, radius)


@makes_stage
def unique() -> Stage:
    """Keeps the first of points with equal coordinates; later stages see neighbours among those kept.

    Undefined
    ---------
    Points without a finite place are all kept.

    Cost
    ----
    A pass that puts the points in order, without a search.

    In a text
    ---------
    unique
    """
    return made_stage("unique", [])


@makes_stage
def head(number: int) -> Stage:
    """Keeps the first points of the inputs, in the order of the files and their rows.

    Parameters
    ----------
    number : keep the points of so many rows, or all points of a cloud that has fewer; 1 or more.

    Reads
    -----
    row of the input

    Formula
    -------
    Point i is kept if its row in the inputs is less than number, as by where(row < number): rows count from 0 over
      all inputs, whatever earlier stages have left out.

    Undefined
    ---------
    Points without a finite place count and stay like all others, unless the run drops them.

    Cost
    ----
    A pass over the rows, without a search.

    In a text
    ---------
    head(1000)
    """
    return made_stage("head", [
        ("number", "whole", number, None),
    ])


@makes_stage
def decimate(share: float, *, seed: int = 0) -> Stage:
    """Keeps a share of the points, chosen by a hash of their coordinates.

    Parameters
    ----------
    share : keep about this fraction of the points; 0 to 1.
    seed : seed of the random choice: another seed keeps other points; with the same seed, a smaller share is a part
        of a larger one; 0 or more.

    Formula
    -------
    Point i is kept if ⌊h_i / 2^11⌋ / 2^53 < share.
    h = m(m(m(seed ^ x) ^ y) ^ z) of the 64 bits of each coordinate as float64, 0 for -0;
    m(i): j = i + 0x9e3779b97f4a7c15; j = (j ^ j >> 30) * 0xbf58476d1ce4e5b9;
    j = (j ^ j >> 27) * 0x94d049bb133111eb; j ^ j >> 31, all modulo 2^64.

    Undefined
    ---------
    Points of equal coordinates stay together or go together. Points without a finite place stay.

    Source
    ------
    The function m: Steele, Lea and Flood, Fast splittable pseudorandom number generators (OOPSLA 2014).

    Cost
    ----
    A pass over the rows, without a search.

    In a text
    ---------
    decimate(0.1)
    """
    return made_stage("decimate", [
        ("share", "number", share, None),
        ("seed", "whole", seed, 0),
    ])


@makes_stage
def sample(number: int, *, rest: bool = False, seed: int = 0) -> Stage:
    """Keeps exactly so many points, chosen by a hash of their coordinates, or all but these.

    Parameters
    ----------
    number : keep so many points, or all points of a cloud that has fewer; 1 or more.
    rest : keep all other points instead.
    seed : seed of the random choice: another seed keeps other points; with the same seed, a smaller number is a
        part of a larger one; 0 or more.

    Formula
    -------
    The points of the least f_i = ⌊h_i / 2^11⌋ / 2^53, h_i the hash of decimate; equal ones in the order of their
      rows. rest=yes keeps all other points.

    Undefined
    ---------
    Points without a finite place all stay, in addition to the number.

    Cost
    ----
    A pass that puts the points in order by their hash, without a search.

    In a text
    ---------
    sample(1000)
    """
    return made_stage("sample", [
        ("number", "whole", number, None),
        ("rest", "no|yes", rest, False),
        ("seed", "whole", seed, 0),
    ])


@makes_stage
def parts(number: int, *, seed: int = 0) -> Stage:
    """Divides the points at random into parts, by a hash of their coordinates.

    Parameters
    ----------
    number : number of parts, of about the same size; 1 to 65536.
    seed : seed of the random choice: another seed makes other parts; 0 or more.

    Makes
    -----
    part : (n,) uint16; number of the part, from 0.

    Formula
    -------
    part_i = ⌊h_i number / 2^64⌋, h_i the hash of decimate, whose seed is increased by 0x7061727473, "parts" in
      ASCII.

    Undefined
    ---------
    Points of equal coordinates are in the same part. Points without a finite place are in part 0.

    Cost
    ----
    A pass over the rows, without a search; none where other stages search anyway.

    In a text
    ---------
    parts(10) | where(part < 8)
    """
    return made_stage("parts", [
        ("number", "whole", number, None),
        ("seed", "whole", seed, 0),
    ])


@makes_stage
def voxel(size: float, *, keep: Literal["center", "hash", "centroid"] = "center") -> Stage:
    """Keeps one point in each cube of a grid; later stages see neighbours among those kept.

    Parameters
    ----------
    size : edge length of the cubes, whose faces lie at multiples of it; above 0; unit: length.
    keep : point that a cube keeps: the one nearest to its centre, one chosen by a hash, or the one nearest to its
        centre with the means of the cube.

    Formula
    -------
    Voxel of p: (⌊x / size⌋, ⌊y / size⌋, ⌊z / size⌋), quotients rounded to float64: a point on a face belongs to the
      voxel above it. The grid does not depend on the cloud.
    keep=center: the least |p - c|², ((dx² + dy²) + dz²) in float64, c = (voxel + 0.5) * size.
    keep=hash: the least hash of decimate, with the seed 0x766f78656c.
    Of equal ones the point of the least x, then y, then z, then input row.
    keep=centroid: the row of keep=center, at the mean of the points of the voxel. Floating-point numbers, intensity
      and colours become means too: m = (Σ v) / n of the n finite values, limited to their range; Σ is exact and
      rounded once to float64; intensity and colours are rounded to whole numbers, halves to even.
    Normals: the mean, divided by its length; 0 where that is 0. All else is that of the row: whole numbers
      (classification, return number, ids), directions without a sign, arrays, scaled fields.

    Undefined
    ---------
    Points without a finite place all stay, with the values they have. The mean of values none of which is finite is
    NaN.

    Cost
    ----
    A pass that puts the points in order by voxel, without a search; memory does not depend on the size.
    keep=centroid: the averaged attributes travel with the points.

    In a text
    ---------
    knn(k=12) | voxel(0.5) | normals
    """
    return made_stage("voxel", [
        ("size", "number", size, None),
        ("keep", "choice", keep, "center"),
    ])


@makes_stage
def poisson(radius: float, *, radius_from: str | None = None) -> Stage:
    """Keeps points that are farther than a radius from each other and leave no gap wider than it.

    Parameters
    ----------
    radius : minimum distance between kept points; with radius_from, its upper limit; above 0; unit: length.
    radius_from : attribute of the input, or made before, that holds the minimum distance from each point to the
        kept ones.

    Formula
    -------
    In ascending order of h_i (ties by x, y, z, then row) a point is kept unless a kept point j has |p_i - p_j|² <=
      r_i², ((dx² + dy²) + dz²) in float64.
    So of two points at exactly the radius the first in that order stays, and the other is left out.
    h: the hash of decimate with the seed 0x706f6973736f6e.
    r_i = radius, or min(radius_from, radius); 0 where radius_from is NaN or negative.

    Undefined
    ---------
    Points without a finite place all stay.

    Source
    ------
    The greedy maximal independent set, the same in any order of evaluation: Blelloch, Fineman and Shun (SPAA 2012).

    Cost
    ----
    A pass that puts the points in order, without a search; memory holds the points of a slice about two radii
    thick.

    In a text
    ---------
    knn(k=12) | poisson(0.2) | normals
    """
    return made_stage("poisson", [
        ("radius", "number", radius, None),
        ("radius_from", "attribute", radius_from, None),
    ])


@makes_stage
def simplify(error: float, *, most: float | None = None, least: float = 0) -> Stage:
    """Keeps few points on flat parts and many on curved ones: poisson with a radius from the curvature.

    Parameters
    ----------
    error : about the largest distance from a dropped point to the tangent plane of a kept one; above 0; unit:
        length.
    most : maximum distance between kept points, on flat parts; without this option, 32 times error; above 0; unit:
        length.
    least : minimum distance between kept points, where noise looks like curvature; at most `most`; 0 or more; unit:
        length.

    Makes
    -----
    simplify_radius : (n,) float64, length; distance within which a kept point represents this one.

    Reads
    -----
    k1

    Formula
    -------
    r_i = √(2 error / k1_i), at least `least`, at most `most`; then poisson(most, radius_from=r).
    A surface of curvature k1 leaves its tangent plane by k1 r² / 2 at the distance r.

    Undefined
    ---------
    A point without curvature (k1 = 0) gets the largest radius.

    Cost
    ----
    That of poisson with the radius `most`.

    In a text
    ---------
    knn(k=24) | normals | curvature | simplify(error=0.01)
    """
    return made_stage("simplify", [
        ("error", "number", error, None),
        ("most", "number", most, None),
        ("least", "number", least, 0),
    ])


@makes_stage
def level() -> Stage:
    """Gives each point the level of detail at which it is first drawn, by the rule of COPC outputs.

    Makes
    -----
    level : (n,) uint8; depth of the level, from 0; undefined: 255.

    Formula
    -------
    Positions are rounded to steps of e / 2^30, e the widest extent; the cube of width w = 1.125 e has its corner
      half a step below the least coordinates. (A COPC output rounds to the steps of its coordinates, and its cube
      is another one, so that its levels have other points.) An octant with more than 100,000 points is divided,
      unless they lie at one place.
    Depth d takes all points of octants of depth d that are not divided. Then each divided octant of depth d, those
      of even numbers along x, y and z first, takes in the order of a hash of the rounded coordinates each point
      that is not nearer than s_d to a point taken before.
    s_d = s_0 / 2^d. s_0 = √2^k w / 128 with the least k for which depth 0 has at most 100,000 points.
    So the points of level ≤ d are the cloud thinned to the spacing s_d.

    Undefined
    ---------
    Points without a finite place have level 255.

    Source
    ------
    Greedy Poisson discs in an octree as COPC has it (https://copc.io).

    Cost
    ----
    Three passes that put the points in order, without a search; 50 bytes a point in the temporary folder.

    In a text
    ---------
    level | where(level <= 2)
    """
    return made_stage("level", [])


@makes_stage
def ground(
    method: Literal["smrf"] = "smrf",
    *,
    cell: float = 1,
    slope: float = 0.15,
    window: float = 18,
    threshold: float = 0.5,
    scalar: float = 1.25,
    returns: Literal["last", "all"] = "last",
    noise: bool = False,
) -> Stage:
    """Finds the points of the ground by a morphological filter and gives them class 2.

    Parameters
    ----------
    method : filter that finds the ground; there is only this one.
    cell : edge length of the cells of the raster, whose lines lie at multiples of it; above 0; unit: length.
    slope : steepest slope of the ground, rise over run; steeper shapes are objects; 0 or more.
    window : about half the width of the widest object, such as a building; 0 or more; unit: length.
    threshold : largest distance from a point of the ground to the surface, where that is level; 0 or more; unit:
        length.
    scalar : length added to the threshold for each unit of the slope of the surface; 0 or more; unit: length.
    returns : use the last returns of pulses or all returns, where the cloud numbers them.
    noise : let points of the classes 7 and 18 (noise) take part, where the cloud has classes.

    Makes
    -----
    classification : (n,) uint8; class of LAS: 2 for ground.

    Formula
    -------
    Cell of p: (⌊x / cell⌋, ⌊y / cell⌋); R = ⌈window / cell⌉. Rasters have absent cells.
    1. Z: the least z of the points of a cell that take part. F(Z): a cell without one becomes ((W/w + E/e) + (S/s +
      N/n)) / ((1/w + 1/e) + (1/s + 1/n)), W, E, S, N: the nearest values in its row and column, at most 3R + 3
      cells away; w, e, s, n: their distances; missing sides count 0. Without any it is absent.
    2. open(A, r): the greatest, over a disk dx² + dy² <= r², of the least of A over a disk; absent cells count for
      nothing and stay absent. Pits: -F(Z) - open(-F(Z), 1) > 5 cell.
    3. S_0 = F(Z); S_r = open(S_(r-1), r), r = 1 ... R. Objects: for some r S_(r-1) - S_r > slope (cell r).
    4. G = F(Z without the cells of pits and objects); g = sqrt(gx² + gy²) in each cell, by central differences of
      G, one-sided next to an absent cell, 0 between two of them.
    5. G(p), g(p): bilinear between the centres of the four cells around p; where one of these is absent, those of
      the cell of p.
    Ground: points that take part with |z - G(p)| <= threshold + scalar g(p).

    Undefined
    ---------
    Points that do not take part, and those where G is absent, are not ground. What is not ground keeps its class,
    but 1 in the place of 2, and 1 where the cloud has no classes. Points without a finite place keep their class.

    Source
    ------
    Pingel, Clarke and McBride, An improved simple morphological filter for the terrain classification of airborne
    LIDAR data (ISPRS Journal 77, 2013). The paper fills holes by a system of springs over the whole raster, in
    which every cell depends on every other; F is local, so that tiles, their order and points far away change
    nothing. Its optional net for large buildings is not there.

    Cost
    ----
    A pass that puts the points in order by rows of cells and reads them twice, without a search; memory holds about
    6R rows of cells for each of the R disks, or, within a smaller --memory, for one disk at a time.

    In a text
    ---------
    knn(k=8) | sor | where(outlier == 0) | ground(cell=1, window=18)
    """
    return made_stage("ground", [
        ("method", "choice", method, "smrf"),
        ("cell", "number", cell, 1),
        ("slope", "number", slope, 0.15),
        ("window", "number", window, 18),
        ("threshold", "number", threshold, 0.5),
        ("scalar", "number", scalar, 1.25),
        ("returns", "choice", returns, "last"),
        ("noise", "no|yes", noise, False),
    ])


@makes_stage
def height(from_: Literal["ground"] = "ground", *, k: int = 1) -> Stage:
    """Measures the height above the nearest points of the ground, in the plane of x and y.

    Parameters
    ----------
    from_ : measure height from the points of class 2.
    k : number of nearest ground points over which the height of the ground is averaged; 1 to 1024.

    Makes
    -----
    height : (n,) float64, length; z above the nearest points of the ground; NaN without any.

    Reads
    -----
    classification

    Formula
    -------
    h = z - Σ_j w_j z_j / Σ_j w_j, w_j = 1 / d_j², over the k points of class 2 that are nearest in x and y: d_j² =
      dx² + dy² in float64, equal ones by x, y, z, row; summed nearest first.
    Where d_1 = 0: h = z - z_1.

    Undefined
    ---------
    NaN where the cloud has no point of class 2, and for points without a finite place.

    Source
    ------
    Inverse distance weighting: Shepard, A two-dimensional interpolation function for irregularly-spaced data (ACM
    National Conference 1968).

    Cost
    ----
    A pass that puts the points in order along x or y and reads them twice; points of the ground are kept in the
    temporary folder in cells, and memory holds those near the front.

    In a text
    ---------
    knn(k=8) | ground | height(k=3) | where(height < 2)
    """
    return made_stage("height", [
        ("from", "choice", from_, "ground"),
        ("k", "whole", k, 1),
    ])


@makes_stage
def color(
    by: str,
    *,
    map: Literal["viridis", "turbo", "gray", "classes"] = "viridis",
    range: Sequence[float] | None = None,
    bits: Literal["auto", "8", "16"] = "auto",
) -> Stage:
    """Colours points by the values of an attribute.

    Parameters
    ----------
    by : attribute of the input, component of one that an earlier stage computes, or x, y or z; 'by=' may be left
        out.
    map : colour map for numbers, or the colours of the classes of LAS.
    range : values at the ends of the colour map; without this option, the least and the greatest of the cloud.
    bits : bits of a colour channel: 8, or 16 as in LAS; auto takes 16 where the input has colours of 16 bits or
        fields of LAS.

    Makes
    -----
    color : (n, 3) uint8; colour of an attribute's value.

    Formula
    -------
    t = (v - lo) / (hi - lo), at least 0, at most 1; 0 if lo = hi. Channels of 8 bits, halves upwards:
    viridis: linear between ten colours; turbo: a polynomial of degree 5; gray: 255 t.
    classes: the colour of class v, rounded, as render draws it. Of 16 bits: 257 times that.

    Undefined
    ---------
    NaN is grey (128).

    Source
    ------
    Viridis: van der Walt and Smith 2015. Turbo: Mikhailov 2019.

    Cost
    ----
    Without a range one more pass over the rows, which is the writing of the output where no later stage needs
    neighbours.

    In a text
    ---------
    knn(k=12) | normals | curvature | color(k1, map=turbo, range=[0,5])
    """
    return made_stage("color", [
        ("by", "attribute", by, None),
        ("map", "choice", map, "viridis"),
        ("range", "numbers", range, None),
        ("bits", "choice", bits, "auto"),
    ])


@makes_stage
def distance_to(cloud: str | os.PathLike[str] | Cloud, *, most: float | None = None) -> Stage:
    """Measures the distance to the nearest point of another cloud.

    Parameters
    ----------
    cloud : the other cloud: a point file, a folder of them or a pattern.
    most : maximum distance at which the nearest point is looked for; without this option there is no limit; above
        0; unit: length.

    Makes
    -----
    cloud_distance : (n,) float64, length; distance to the nearest point of another cloud.

    Formula
    -------
    d = min_j sqrt((dx² + dy²) + dz²) over the points j of the other cloud, in float64

    Undefined
    ---------
    NaN where no point of the other cloud is within `most`, and for points without a finite place.

    Source
    ------
    Cloud-to-cloud distance: Girardeau-Montaut, Roux, Marc and Thibault, Change detection on points cloud data
    acquired with a ground laser scanner (ISPRS 2005).

    Cost
    ----
    A pass that puts the points in order along an axis; the other cloud is put in the same order in the temporary
    folder (32 bytes a point, and as much while it is ordered), and memory holds what is near the front.

    In a text
    ---------
    distance_to(before.las, most=5) | where(cloud_distance > 0.1)
    """
    return made_stage("distance_to", [
        ("cloud", "file", cloud, None),
        ("most", "number", most, None),
    ])


@makes_stage
def m3c2(cloud: str | os.PathLike[str] | Cloud, cylinder: float, depth: float, *, registration: float = 0) -> Stage:
    """Measures the change to another cloud along the normals, with its level of detection (M3C2).

    Parameters
    ----------
    cloud : the other cloud, measured later: a point file, a folder of them or a pattern.
    cylinder : diameter of the cylinder along the normal (projection scale); above 0; unit: length.
    depth : how far the cylinder reaches to each side of the point; above 0; unit: length.
    registration : error of the registration of the two clouds; 0 or more; unit: length.

    Makes
    -----
    m3c2_distance : (n,) float64, length; change to another cloud along the normal.
    m3c2_lod : (n,) float64, length; level of detection at 95 %.
    m3c2_spread1 : (n,) float64, length; deviation along the normal, this cloud.
    m3c2_spread2 : (n,) float64, length; deviation along the normal, other cloud.
    m3c2_samples1 : (n,) float64; points in the cylinder, this cloud.
    m3c2_samples2 : (n,) float64; points in the cylinder, other cloud.

    Reads
    -----
    normal

    Formula
    -------
    u_i = n_i / |n_i| in float64. Points of each cloud within R = cylinder / 2 of the line through p_i along u_i,
      |(p_j - p_i) × u_i|² <= R·R, and within depth of p_i along it have places a_j = (p_j - p_i) . u_i. With their
      mean m, their standard deviation s (of n - 1) and their number n: distance m_2 - m_1; level of detection 1.96
      (sqrt(s_1² / n_1 + s_2² / n_2) + registration).

    Undefined
    ---------
    Without a finite place all is NaN; without a normal all is NaN but the counts, which are 0. The distance is NaN
    where the cylinder holds no point of the other cloud, a spread where it holds fewer than two points of its
    cloud, and the level of detection where a spread is.

    Source
    ------
    Lague, Brodu and Leroux, Accurate 3D comparison of complex topography with terrestrial laser scanner (ISPRS
    Journal of Photogrammetry and Remote Sensing 82, 2013), Section 3. Normals are those of the stages before, at
    their scale; every point that is left is a core point.

    Cost
    ----
    A pass that puts the points in order along an axis and reads them twice; both clouds are kept in the temporary
    folder (32 bytes a point), and memory holds what is near the front; time grows with the points in a cylinder,
    and each thread needs 8 bytes for each of them, which --memory does not count.

    In a text
    ---------
    knn(radius=1) | normals(orient=up) | m3c2(after.las, cylinder=0.5, depth=2)
    """
    return made_stage("m3c2", [
        ("cloud", "file", cloud, None),
        ("cylinder", "number", cylinder, None),
        ("depth", "number", depth, None),
        ("registration", "number", registration, 0),
    ])


@makes_stage
def take(
    cloud: str | os.PathLike[str] | Cloud,
    attributes: str | Sequence[str],
    *,
    k: int = 1,
    vote: Literal["majority", "mean", "nearest"] = "majority",
    most: float | None = None,
    missing: float | None = None,
) -> Stage:
    """Takes attributes from the nearest points of another cloud.

    Parameters
    ----------
    cloud : the other cloud: a point file, a folder of them or a pattern.
    attributes : attributes of the other cloud, as in [classification, tree_id].
    k : so many nearest points of the other cloud give the value; 1 to 1000.
    vote : the value that they give: their majority, their mean, or that of the nearest.
    most : maximum distance of a point that counts; without this option there is no limit; above 0; unit: length.
    missing : value of points that have no point within 'most'; without this option they keep the value that they
        have, and new attributes are NaN; finite.

    Formula
    -------
    v_1, ..., v_n: the values of the k points of the other cloud with the least (dx² + dy²) + dz² in float64, equal
      ones by x, y, z, then row, however far away they are; with `most` those of them with d² <= most · most.
    majority: the most frequent value; of several the one that the nearest point has
    mean:     the mean, of whole numbers from their exact sum, of others v_1 + 1/n Σ (v_j - v_1), in float64
    nearest:  v_1, with k=1
    Where n > 1, and for means, only finite values count.
    An attribute that the cloud has keeps its type. Whole numbers are exact; means are rounded to whole-number
      types, halves to even. Colours of 8 bits become those of 16 bits by 257, and back. A new attribute has the
      type that it has in the other cloud; means are float64, but those of colours.

    Undefined
    ---------
    Without a value, a point gets `missing`; without that option it keeps the value that it has, and a new attribute
    is NaN: then a new attribute of whole numbers is refused where there is `most`. A point without a finite place
    keeps its values; its new attributes are NaN, those of whole numbers 0. A value that the type of the attribute
    cannot hold ends the run with an error that names the row.

    Cost
    ----
    A pass that puts the points in order along an axis; the other cloud is put in the same order in the temporary
    folder (32 bytes a point and those of its attributes, and as much while it is ordered), and memory holds what is
    near the front.

    In a text
    ---------
    take(labelled.las, attributes=classification, k=5)
    """
    return made_stage("take", [
        ("cloud", "file", cloud, None),
        ("attributes", "attributes", attributes, None),
        ("k", "whole", k, 1),
        ("vote", "choice", vote, "majority"),
        ("most", "number", most, None),
        ("missing", "number", missing, None),
    ])


@makes_stage
def components(distance: float | None = None, *, k: int | None = None, radius: float | None = None) -> Stage:
    """Connected components of the graph of neighbours, with their sizes.

    Parameters
    ----------
    distance : points farther from each other are not joined; a knn before it has to hold all points within it; 0 or
        more; unit: length.
    k, radius : k and radius of a knn before the stage, which begins the pipeline; default: 8 neighbours where
        neither is given.

    Makes
    -----
    component : (n,) int64; number of the connected component; -1 without a place.
    component_size : (n,) uint64; points of the connected component.

    Neighbours
    ----------
    8 where neither k nor a radius is given.

    Formula
    -------
    Points i and j are joined if j is in N_i or i is in N_j; with distance D: if |p_j - p_i| <= D.
    component: numbered from 0 by the first point, that of the least x, then y, then z, then row.

    Undefined
    ---------
    -1, of size 0, for points without a finite place.

    Source
    ------
    Exact minimum spanning forest of the open points, docs/adr/0014.

    Cost
    ----
    A sweep that ends a pass; about 60 bytes a point in the temporary folder.

    In a text
    ---------
    knn(k=8) | components | where(component_size > 100)
    """
    return made_stage("components", [
        ("distance", "number", distance, None),
    ], k, radius)


@makes_stage
def dbscan(eps: float, *, min_points: int = 5, k: int | None = None, radius: float | None = None) -> Stage:
    """Density-based clusters (DBSCAN): points around core points, which have many neighbours.

    Parameters
    ----------
    eps : the distance within which points are neighbours, inclusive; a knn before it has to hold all of them; above
        0; unit: length.
    min_points : number of points within eps that make a core point, itself included; 1 or more.
    k, radius : k and radius of a knn before the stage, which begins the pipeline; default: 8 neighbours where
        neither is given.

    Makes
    -----
    core : (n,) uint8; 1: at least min_points points within eps.
    cluster : (n,) int64; number of the cluster; -1: noise.
    cluster_size : (n,) uint64; points of the cluster; 0: noise.

    Neighbours
    ----------
    8 where neither k nor a radius is given.

    Formula
    -------
    core_i = 1 where |{j : |p_j - p_i| <= eps}| >= min_points, i itself counted, as in scikit-learn.
    Core points within eps of each other are in one cluster. Another point is in that of the nearest core point
      within eps, equal distances by x, y, z, row; without one it is noise, cluster = -1.
    Clusters are numbered from 0 by their first point, that of the least x, then y, then z, then row.
    In scikit-learn and in the publication a border point belongs to the cluster that comes to it first, so that its
      cluster depends on the order of the points.

    Undefined
    ---------
    Core 0, cluster -1 and cluster_size 0 for points without a finite place.

    Source
    ------
    Ester, Kriegel, Sander, Xu, A density-based algorithm for discovering clusters in large spatial databases with
    noise (KDD 1996).

    Cost
    ----
    A sweep of two steps that ends a pass; about 60 bytes a point in the temporary folder.

    In a text
    ---------
    knn(radius=0.5) | dbscan(eps=0.5, min_points=10) | where(cluster >= 0)
    """
    return made_stage("dbscan", [
        ("eps", "number", eps, None),
        ("min_points", "whole", min_points, 5),
    ], k, radius)


@makes_stage
def segments(
    angle: float = 5,
    *,
    distance: float | None = None,
    k: int | None = None,
    radius: float | None = None,
) -> Stage:
    """Smooth segments: neighbours whose normals differ by less than an angle, with sizes and flatness.

    Parameters
    ----------
    angle : maximum angle between the normals of neighbours in one segment; above 0, at most 90; unit: degrees.
    distance : points farther from each other are not joined; 0 or more; unit: length.
    k, radius : k and radius of a knn before the stage, which begins the pipeline; default: 16 neighbours where
        neither is given.

    Makes
    -----
    segment : (n,) int64; number of the smooth segment; -1 without a place.
    segment_size : (n,) uint64; points of the segment.
    segment_residual : (n,) float32, length; root mean square distance of the segment's points to their plane; NaN
        without a place.

    Reads
    -----
    normal, normal of neighbours

    Neighbours
    ----------
    16 where neither k nor a radius is given.

    Formula
    -------
    Points i and j are joined if j is in N_i or i is in N_j, |n_i . n_j| > cos(angle), and with distance D |p_j -
      p_i| <= D. segment: components of these, numbered from 0 by the first point, that of the least x, then y, then
      z, then row. Normals are unit vectors or 0; a normal of 0 is joined with none.
    segment_residual: the root mean square distance of the points of the segment to the plane for which it is least:
      the square root of the least eigenvalue of their covariance; 0 for fewer than 4 points. Positions count in
      steps of 2^-40, up to 2^40, and their sums are exact; the error of the residual is below 10^-7 of the extent
      of the segment, or 2^-40 where that is more.

    Undefined
    ---------
    -1, of size 0, with a residual of NaN, for points without a finite place.

    Source
    ------
    After Rabbani, van den Heuvel, Vosselman, Segmentation of point clouds using smoothness constraint (ISPRS
    Archives XXXVI-5, 2006): its condition, without seeds and their order.

    Cost
    ----
    A sweep that ends a pass; 70 to 90 bytes a point in the temporary folder, 120 beside attributes that the same
    sweep makes.

    In a text
    ---------
    knn(k=12) | normals | segments(angle=5) | where(segment_size > 1000)
    """
    return made_stage("segments", [
        ("angle", "number", angle, 5),
        ("distance", "number", distance, None),
    ], k, radius)


@makes_stage
def orient(
    method: Literal["mst", "trajectory"] = "mst",
    *,
    viewpoint: Sequence[float] | None = None,
    trajectory: str | os.PathLike[str] | Cloud | None = None,
    checksum: str | None = None,
    k: int | None = None,
    radius: float | None = None,
) -> Stage:
    """Gives the normals of each connected surface consistent signs, by a minimum spanning forest.

    Parameters
    ----------
    method : find signs by the minimum spanning forest of the graph of neighbours (mst), or by the place of the
        sensor at the gps_time of the point (trajectory).
    viewpoint : point that most normals of each component face, in the coordinates of the cloud; unit: length.
    trajectory : file with the path of the sensor as lines of time, x, y, z, in the coordinates of the cloud and the
        times of gps_time.
    checksum : checksum of the trajectory, as a processing record holds it; a file with other content is refused.
    k, radius : k and radius of a knn before the stage, which begins the pipeline; default: 16 neighbours where
        neither is given.

    Makes
    -----
    normal_turned : (n,) uint8; 1: orient has turned the normal.
    normal : (n, 3) float32; unit surface normal; 0 where undefined.

    Reads
    -----
    normal

    Neighbours
    ----------
    16 where neither k nor a radius is given.

    Formula
    -------
    Edges join i and j if j is in N_i or i is in N_j, weight 1 - |n_i . n_j|; equal ones by the two points, each by
      x, y, z, row. Along an edge of the minimum spanning forest signs s agree with the sign of n_i . n_j, where 0
      counts as +.
    The signs of a component are turned together so that the larger in absolute value of Σ s n_z and Σ s n . (p - c)
      / e is positive, of equal ones the first; c is its centroid and e the mean of the three edges of its bounding
      box: up for open surfaces, outwards for closed ones. n counts in steps of 2^-20, p in steps of 2^-32, summed
      exactly. With viewpoint v: Σ sign(s n . (v - p)). If that is 0, the normal of the highest point points up; if
      that is level, the one of the first point by x, y, z, row stays.
    trajectory: n . (s(t) - p) >= 0, s(t) on the straight line between the places before and after t.

    Undefined
    ---------
    Normals of 0 stay 0. Points without a finite place keep their normal, and with a trajectory also those without a
    time. Times more than 1 s outside of the trajectory end the run.

    Source
    ------
    Hoppe, DeRose, Duchamp, McDonald, Stuetzle, Surface reconstruction from unorganized points (SIGGRAPH 1992),
    Section 3.3; there the highest point alone decides.

    Cost
    ----
    A sweep that ends a pass; about 150 bytes a point in the temporary folder.

    In a text
    ---------
    knn(k=12) | normals | orient
    """
    return made_stage("orient", [
        ("method", "choice", method, "mst"),
        ("viewpoint", "point", viewpoint, None),
        ("trajectory", "file", trajectory, None),
        ("checksum", "word", checksum, None),
    ], k, radius)


@makes_stage
def reneighbor(
    k: int | None = None,
    *,
    radius: float | None = None,
    k_from: str | None = None,
    radius_from: str | None = None,
    adaptive: Literal["none", "eigenentropy"] | None = None,
    k_min: int | None = None,
) -> Stage:
    """Finds new neighbours at the moved positions, for all later stages; options as for knn (without k and radius:
    those in effect so far).

    Parameters
    ----------
    k : number of neighbours, excluding the point; a radius without k means all points within it; without both, the
        largest default of the operators in the pipeline; 1 or more.
    radius : maximum distance of a neighbour, in the unit of the coordinates; 0 or more; unit: length.
    k_from : attribute of the input that holds the number of neighbours of each point, at most k, which has to be
        given.
    radius_from : attribute of the input that holds the maximum distance of a neighbour for each point; k or radius
        has to be given as a limit.
    adaptive : choose the number of neighbours of each point, from k_min to k, by the least eigenentropy (Weinmann
        2014); k has to be given.
    k_min : smallest number of neighbours that adaptive=eigenentropy may choose; 3 or more.

    Formula
    -------
    N_i from here on is that of a file that holds the positions of now.

    Undefined
    ---------
    A point that was moved to a position that is not finite has no neighbours from here on.

    Source
    ------
    Pajarola, Stream-Processing Points (IEEE Visualization 2005), Section 8.

    Cost
    ----
    One more sweep, and one temporary record for each point.

    In a text
    ---------
    knn(k=64) | normals | splats | fair | reneighbor(k=12) | normals
    """
    return made_stage("reneighbor", [
        ("k", "whole", k, None),
        ("radius", "number", radius, None),
        ("k_from", "attribute", k_from, None),
        ("radius_from", "attribute", radius_from, None),
        ("adaptive", "choice", adaptive, None),
        ("k_min", "whole", k_min, None),
    ])


@makes_stage
def resort() -> Stage:
    """Makes --order sweep write the points in the order of the moved positions; changes no value.

    Source
    ------
    Pajarola, Stream-Processing Points (IEEE Visualization 2005), Section 8.

    Cost
    ----
    One more ordering of the output, with --order sweep.

    In a text
    ---------
    knn(k=64) | normals | splats | fair | resort | normals
    """
    return made_stage("resort", [])
