# SPDX-License-Identifier: MIT
"""Mistakes in what operators compute and in what they see of a neighbourhood."""
from mutant import Mutant

OPS = "pointsweep/operators/"

MUTANTS = [
    Mutant("sigma^2 of theta twice as large", "formulas", OPS + "neighborhood_lanes-inl.h",
           "hn::Set(Lanes(), 0.5 / std::numbers::pi)", "hn::Set(Lanes(), 0.25 / std::numbers::pi)", ("operators:Normals*",)),
    Mutant("M_i of the splats without its weight", "formulas", OPS + "splats_kernel.cpp",
           ": EllipseOfPositions(SumMoments(tile, extents, offsets, weights, v), normal);",
           """: EllipseOfPositions([&] {
                                                  Moments sums{Scaling(extents, v)};
                                                  for (std::size_t from = 0; from < tile.most; from += tile.chunk) {
                                                    offsets.Hold(from);
                                                    for (std::size_t c = 0; c < tile.Held(from); ++c)
                                                      AddOuterProduct(sums.m, sums.scaling.Scaled(offsets.Load(v, c)));
                                                  }
                                                  return sums;
                                                }(), normal);""", ("oracles", "operators:Splats*")),
    Mutant("both widths of fairing doubled", "formulas", OPS + "fair.cpp", "const double inverse = 1 / width;",
           "const double inverse = 0.5 / width;", ("oracles", "operators:Fair*")),
    Mutant("fairing moves away from the planes", "formulas", OPS + "fair.cpp",
           "sum = sum + (weight * pulls[j].off_plane) * pulls[j].normal;",
           "sum = sum - (weight * pulls[j].off_plane) * pulls[j].normal;", ("operators:Fair*",)),
    Mutant("fairing without the point's own weight", "formulas", OPS + "fair.cpp", "double weights = own;",
           "double weights = 0 * own;", ("operators:Fair*", "oracles")),
    Mutant("fairing takes the splat's length for its area", "formulas", OPS + "fair.cpp",
           "const double a = double(length) * double(length) * double(ratio);",
           "const double a = double(length) * double(ratio);", ("operators:Fair*", "oracles")),
    Mutant("fairing without g", "formulas", OPS + "fair.cpp",
           "(dot(reach, reach) + square(inverse_g_ * off_plane)) / 2",
           "(dot(reach, reach) + 0 * square(inverse_g_ * off_plane)) / 2",
           ("operators:Fair*", "oracles")),
    Mutant("variance of positions about p_i instead of the mean", "formulas", OPS + "curvature_kernel.cpp",
           "along = hn::Sub(Dot(u, mu), hn::Mul(pu, hn::Mul(pu, inverse)));", "along = Dot(u, mu);",
           ("operators:Curvature*", "oracles")),
    Mutant("directions of k1 and k2 exchanged", "formulas", OPS + "curvature_kernel.cpp",
           "Choose(hn::Lt(a, b), across, along)", "Choose(hn::Lt(a, b), along, across)", ("operators:Curvature*", "oracles")),
    Mutant("RMS curvature without its half", "formulas", OPS + "curvature_kernel.cpp",
           "hn::Sqrt(hn::Mul(hn::Add(hn::Mul(k1, k1), hn::Mul(k2, k2)), half))",
           "hn::Sqrt(hn::Add(hn::Mul(k1, k1), hn::Mul(k2, k2)))", ("operators:Curvature*", "oracles")),
    Mutant("eigenvalues of C_i over |N_i| + 1", "formulas", OPS + "curvature_kernel.cpp",
           "hn::Div(divisor, hn::Max(neighbors, hn::Set(d, 1.0)))",
           "hn::Div(divisor, hn::Add(neighbors, hn::Set(d, 1.0)))", ("operators:Curvature*", "oracles")),
    Mutant("surface variation over twice the trace", "formulas", OPS + "curvature_kernel.cpp",
           "const V variation = hn::Div(hn::Max(SmallestEigenvalue(sums.moments, trace, normal), zero), trace);",
           "const V variation = hn::Div(hn::Max(SmallestEigenvalue(sums.moments, trace, normal), zero), "
           "hn::Add(trace, trace));", ("operators:Curvature*", "oracles")),
    Mutant("splats hold seven neighbours", "formulas", OPS + "splats_kernel.cpp", "kHeld = 8;", "kHeld = 7;",
           ("operators:Splats*", "oracles")),
    Mutant("splats are never thinner than 1/4", "formulas", OPS + "splats_kernel.cpp", "kThinnest = 1.0 / 8.0;",
           "kThinnest = 1.0 / 4.0;", ("operators:Splats*", "oracles")),
    Mutant("ratio of a ridge's splat without the root", "formulas", OPS + "splats_kernel.cpp",
           "MakeEllipse(axis, hn::Sqrt(hn::Div(k2, k1)))", "MakeEllipse(axis, hn::Div(k2, k1))",
           ("operators:Splats*", "oracles")),
    Mutant("major axis of the smaller eigenvalue", "formulas", OPS + "splats_kernel.cpp",
           "Tangent(normal, e.vector2, e.vector1)", "Tangent(normal, e.vector1, e.vector2)", ("operators:Splats*", "oracles")),
    Mutant("normals away from the viewpoint", "formulas", OPS + "normals.cpp", "dot(n, options.viewpoint - in.position(i))",
           "dot(n, in.position(i) - options.viewpoint)", ("operators:Normals*",)),
    Mutant("eigenentropy of a covariance without p_i", "formulas", OPS + "least_eigenentropy.cpp",
           "static_cast<double>(j + 2);", "static_cast<double>(j + 1);", ("operators:LeastEigenentropy*", "oracles")),
    Mutant("the last of equal eigenentropies", "ties", OPS + "least_eigenentropy.cpp", "if (!(entropy < best)) continue;",
           "if (!(entropy <= best)) continue;", ("operators:LeastEigenentropy*", "oracles")),
    Mutant("radius of an attribute without its rim", "ties", OPS + "limits_from_attributes.cpp",
           "return distance2 <= radius2 || std::sqrt(distance2) <= radius;", "return distance2 < radius2;",
           ("operators:LimitsFromAttributes*", "pipeline")),
    Mutant("splats in a scale off by two", "formulas", OPS + "splats_kernel.cpp", "hn::Mul(fitted, power)",
           "hn::Mul(fitted, hn::Add(power, power))", ("operators:Splats*",)),
    Mutant("behind a mover the last neighbour counts as the farthest", "movers", "include/pointsweep/neighborhood.h",
           "sorted_by_distance_(position_column < 0 && !moved) {}", "sorted_by_distance_(position_column < 1000 || moved) {}",
           ("operators:MovedPoints*", "oracles")),
    Mutant("coincident neighbours weigh as the nearest one in Equation 2", "formulas",
           OPS + "neighborhood_lanes-inl.h", "return hn::IfThenElse(some, absolute, theta);",
           "return hn::IfThenElse(some, hn::IfThenElse(some, theta, absolute), theta);", ("operators:Normals*", "oracles")),

    # Operators that look at the whole cloud, and expressions
    Mutant("deviation of the whole population instead of a sample", "formulas", OPS + "outliers.cpp",
           "std::sqrt(n_squared_variance() / n / (n - 1))", "std::sqrt(n_squared_variance() / n / n)",
           ("pipeline:Select.*", "verify")),
    Mutant("a point at the threshold itself is an outlier", "ties", OPS + "outliers.cpp",
           "!(in.value<double>(0, i) <= threshold_)", "!(in.value<double>(0, i) < threshold_)", ("pipeline:Select.*", "verify")),
    Mutant("whole numbers are compared as doubles", "formulas", OPS + "expression_evaluation.cpp",
           "if (is_whole(node.parts[0]) && is_whole(node.parts[1]) &&",
           "if (is_whole(node.parts[0]) && is_whole(node.parts[1]) && size_ == 0 &&", ("operators:Expression.*",)),
    Mutant("and means or", "formulas", OPS + "expression_evaluation.cpp",
           "both ? out[i] & right[i] : out[i] | right[i];", "both ? out[i] | right[i] : out[i] & right[i];",
           ("operators:Expression.*",)),
    Mutant("exact sums forget what lies below a tie", "ties", "pointsweep/math/exact_sum.cpp",
           "(below == half && (rest ||", "(below == half && ((rest && bits < 0) ||", ("math:ExactSum.*",)),
]
