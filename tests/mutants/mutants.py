# SPDX-License-Identifier: MIT
"""Deliberate mistakes, each of which at least one test must notice. tests/mutants/run.py applies them one at a time.

A mutant replaces the only occurrence of `find` in `file` by `put`. `tests` names the folders of tests/ that should
notice it, nearest first; the other folders are tried after these.
"""
from dataclasses import dataclass


@dataclass(frozen=True)
class Mutant:
    name: str  # what the mistake is, in a few words
    area: str
    file: str
    find: str
    put: str
    tests: tuple = ()


OPS = "pointsweep/operators/"
SWEEP = "pointsweep/sweep/"
ORDER = "pointsweep/order/"
SEARCH = "pointsweep/search/"
FORMATS = "pointsweep/formats/"
PIPELINE = "pointsweep/pipeline/"

MUTANTS = [
    # Formulas
    Mutant("sigma^2 of theta twice as large", "formulas", OPS + "neighborhood_lanes-inl.h",
           "hn::Set(Lanes(), 0.5 / std::numbers::pi)", "hn::Set(Lanes(), 0.25 / std::numbers::pi)", ("operators",)),
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
                                                }(), normal);""", ("oracles", "operators")),
    Mutant("both widths of fairing doubled", "formulas", OPS + "fair.cpp", "const double inverse = 1 / width;",
           "const double inverse = 0.5 / width;", ("oracles", "operators")),
    Mutant("fairing moves away from the planes", "formulas", OPS + "fair.cpp",
           "sum = sum + (weight * pulls[j].off_plane) * pulls[j].normal;",
           "sum = sum - (weight * pulls[j].off_plane) * pulls[j].normal;", ("operators",)),
    Mutant("fairing without the point's own weight", "formulas", OPS + "fair.cpp", "double weights = own;",
           "double weights = 0 * own;", ("operators", "oracles")),
    Mutant("fairing takes the splat's length for its area", "formulas", OPS + "fair.cpp",
           "const double a = double(length) * double(length) * double(ratio);",
           "const double a = double(length) * double(ratio);", ("operators", "oracles")),
    Mutant("fairing without g", "formulas", OPS + "fair.cpp",
           "(dot(reach, reach) + square(inverse_g_ * off_plane)) / 2", "dot(reach, reach) / 2",
           ("operators", "oracles")),
    Mutant("variance of positions about p_i instead of the mean", "formulas", OPS + "curvature_kernel.cpp",
           "along = hn::Sub(Dot(u, mu), hn::Mul(pu, hn::Mul(pu, inverse)));", "along = Dot(u, mu);",
           ("operators", "oracles")),
    Mutant("directions of k1 and k2 exchanged", "formulas", OPS + "curvature_kernel.cpp",
           "Choose(hn::Lt(a, b), across, along)", "Choose(hn::Lt(a, b), along, across)", ("operators", "oracles")),
    Mutant("RMS curvature without its half", "formulas", OPS + "curvature_kernel.cpp",
           "hn::Sqrt(hn::Mul(hn::Add(hn::Mul(k1, k1), hn::Mul(k2, k2)), half))",
           "hn::Sqrt(hn::Add(hn::Mul(k1, k1), hn::Mul(k2, k2)))", ("operators", "oracles")),
    Mutant("eigenvalues of C_i over |N_i| + 1", "formulas", OPS + "curvature_kernel.cpp",
           "hn::Div(divisor, hn::Max(neighbors, hn::Set(d, 1.0)))",
           "hn::Div(divisor, hn::Add(neighbors, hn::Set(d, 1.0)))", ("operators", "oracles")),
    Mutant("surface variation over twice the trace", "formulas", OPS + "curvature_kernel.cpp",
           "const V variation = hn::Div(hn::Max(SmallestEigenvalue(sums.moments, trace, normal), zero), trace);",
           "const V variation = hn::Div(hn::Max(SmallestEigenvalue(sums.moments, trace, normal), zero), "
           "hn::Add(trace, trace));", ("operators", "oracles")),
    Mutant("splats hold seven neighbours", "formulas", OPS + "splats_kernel.cpp", "kHeld = 8;", "kHeld = 7;",
           ("operators", "oracles")),
    Mutant("splats are never thinner than 1/4", "formulas", OPS + "splats_kernel.cpp", "kThinnest = 1.0 / 8.0;",
           "kThinnest = 1.0 / 4.0;", ("operators", "oracles")),
    Mutant("ratio of a ridge's splat without the root", "formulas", OPS + "splats_kernel.cpp",
           "MakeEllipse(axis, hn::Sqrt(hn::Div(k2, k1)))", "MakeEllipse(axis, hn::Div(k2, k1))",
           ("operators", "oracles")),
    Mutant("major axis of the smaller eigenvalue", "formulas", OPS + "splats_kernel.cpp",
           "Tangent(normal, e.vector2, e.vector1)", "Tangent(normal, e.vector1, e.vector2)", ("operators", "oracles")),
    Mutant("normals away from the viewpoint", "formulas", OPS + "normals.cpp", "dot(n, options.viewpoint - in.position(i))",
           "dot(n, in.position(i) - options.viewpoint)", ("operators",)),
    Mutant("eigenentropy of a covariance without p_i", "formulas", OPS + "least_eigenentropy.cpp",
           "static_cast<double>(j + 2);", "static_cast<double>(j + 1);", ("operators", "oracles")),
    Mutant("the last of equal eigenentropies", "ties", OPS + "least_eigenentropy.cpp", "if (!(entropy < best)) continue;",
           "if (!(entropy <= best)) continue;", ("operators", "oracles")),
    Mutant("radius of an attribute without its rim", "ties", OPS + "limits_from_attributes.cpp",
           "in.distance2(i, middle) <= radius2 ?", "in.distance2(i, middle) < radius2 ?", ("operators", "pipeline")),
    Mutant("splats in a scale off by two", "formulas", OPS + "splats_kernel.cpp", "hn::Mul(fitted, power)",
           "hn::Mul(fitted, hn::Add(power, power))", ("operators",)),

    Mutant("behind a mover the last neighbour counts as the farthest", "movers", "pointsweep/points/neighborhoods.h",
           "sorted_by_distance_(position_column < 0 && !moved) {}", "sorted_by_distance_(position_column < 1000 || moved) {}",
           ("operators", "oracles")),
    Mutant("coincident neighbours weigh as the nearest one in Equation 2", "formulas",
           OPS + "neighborhood_lanes-inl.h", "return hn::IfThenElse(some, absolute, theta);",
           "return hn::IfThenElse(some, theta, theta);", ("operators", "oracles")),
    Mutant("a scan angle of a hundredth of a degree", "formats", FORMATS + "las_point_formats.cpp",
           "kScanAngleScale = 0.006;", "kScanAngleScale = 0.01;", ("formats",)),
    Mutant("the reference engine's stream is in no order", "order", PIPELINE + "run.cpp",
           ".canonical = whole || by_reference(),", ".canonical = whole,", ("reference", "cli")),

    # Order of neighbours
    Mutant("equal distances by y before x", "ties", SEARCH + "best_list.h",
           "if (a.position.x != b.position.x) return a.position.x < b.position.x;\n"
           "  if (a.position.y != b.position.y) return a.position.y < b.position.y;",
           "if (a.position.y != b.position.y) return a.position.y < b.position.y;\n"
           "  if (a.position.x != b.position.x) return a.position.x < b.position.x;", ("search", "pipeline")),
    Mutant("equal positions by the higher row", "ties", SEARCH + "best_list.h", "return a.row < b.row;",
           "return a.row > b.row;", ("search", "pipeline")),
    Mutant("runs of close distances one too short", "ties", SEARCH + "exact_order.cpp",
           "const int length = std::countr_one(close_to_next >> begin) + 1;",
           "const int length = std::max(2, std::countr_one(close_to_next >> begin));", ("search", "pipeline")),
    Mutant("no margin for single precision", "ties", SEARCH + "leaf_query-inl.h", "kRelativeMargin = 0x1p-11f;",
           "kRelativeMargin = 0x1p-20f;", ("search", "pipeline")),
    Mutant("no margin far from the centre", "ties", SEARCH + "leaf_query-inl.h", "kAbsoluteMargin = 0x1p-28f;",
           "kAbsoluteMargin = 0x1p-60f;", ("search", "pipeline")),
    Mutant("leaves left out that are a little too near", "certificates", SEARCH + "exact_search.cpp",
           "constexpr double kSafety = 1 - 1e-12;", "constexpr double kSafety = 1.02;", ("search", "pipeline")),
    Mutant("canonical order by z before y", "order", ORDER + "canonical_order.cpp",
           "for (std::size_t a = 0, level = 1; a < 3; ++a)", "for (std::size_t a = 2, level = 1; a < 3; --a)", ("order",)),
    Mutant("copies of a point without the last one", "ties", SEARCH + "copies.cpp", "++with_self.k;", "", ("search", "pipeline")),

    # Certificates and retention
    Mutant("unread slabs are noticed at half their distance", "certificates", SWEEP + "certificate.cpp",
           "if (distance2(slabs_[s].box, box) > reach2) continue;\n    if (!needed_only",
           "if (4 * distance2(slabs_[s].box, box) > reach2) continue;\n    if (!needed_only", ("sweep", "pipeline")),
    Mutant("dropped cells are noticed at half their distance", "certificates", SWEEP + "certificate.cpp",
           "if (distance2(dropped, box) <= reach2) out.push_back(dropped);",
           "if (4 * distance2(dropped, box) <= reach2) out.push_back(dropped);", ("sweep", "pipeline")),
    Mutant("a dropped cell is not remembered", "certificates", SWEEP + "window.cpp",
           "outside_.cell_was_dropped(cell.slab, cell.cell.box);", "", ("sweep", "pipeline")),
    Mutant("a place is full one point too early", "certificates", SWEEP + "window.cpp", "cell.cell.row[k]);",
           "cell.cell.row[k - 1]);", ("pipeline", "sweep")),
    Mutant("copies of the last wanted row are superfluous", "certificates", SWEEP + "certificate.cpp",
           "least_row > at->second;", "least_row >= at->second;", ("sweep", "pipeline")),
    Mutant("a cell leaves although lists name it", "retention", SWEEP + "window.cpp",
           "cell.steps_done < plan_.step_count() || referred[slot]", "cell.steps_done < plan_.step_count()",
           ("pipeline",)),
    Mutant("a step begins before its neighbours' last one", "retention", SWEEP + "window.cpp",
           "return cells_[slot]->steps_done >= step; });", "return cells_[slot]->steps_done + 1 >= step; });",
           ("pipeline",)),

    # Spills and order
    Mutant("boxes of slabs without their z", "order", ORDER + "distribution.cpp",
           "chunk.boxes[list].include(Vec3{x[i], y[i], z[i]});", "chunk.boxes[list].include(Vec3{x[i], y[i], y[i]});",
           ("order", "pipeline")),
    Mutant("a bucket's second chunk is its first", "spills", ORDER + "row_store.cpp", "store_->read(b, first,",
           "store_->read(b, 0 * first,", ("order", "pipeline")),
    Mutant("a continued read begins anew", "spills", ORDER + "spill_file.cpp",
           "bytes.size() - done, static_cast<off_t>(offset + done));\n    if (n < 0 && errno == EINTR) continue;\n    if (n <= 0)\n      fail(\"cannot",
           "bytes.size() - done, static_cast<off_t>(offset));\n    if (n < 0 && errno == EINTR) continue;\n    if (n <= 0)\n      fail(\"cannot",
           ("faults", "order")),
    Mutant("rows carried between sweeps begin at 0", "spills", PIPELINE + "updated_cloud.cpp",
           "carried->read(first + at, old);", "carried->read(at, old);", ("pipeline",)),
    Mutant("points of infinite position are lost in sweep order", "order", PIPELINE + "ordered_output.cpp",
           "{ write({record, bytes}); });", "{ if (bytes == 0) write({record, bytes}); });",
           ("pipeline", "cli")),
    Mutant("a recalled point's place is its index", "recall", PIPELINE + "result_sinks.cpp",
           "kept_[{slab, index}] = {stream_.slabs()[slab].first + open.rank[index],",
           "kept_[{slab, index}] = {stream_.slabs()[slab].first + index,", ("pipeline",)),
    Mutant("rows of working records end at 2^16", "order", ORDER + "working_record.cpp",
           "const auto row = static_cast<Row>(first_row + i);",
           "const auto row = static_cast<Row>((first_row + i) & 0xffffffff);", ("order",)),

    # Formats
    Mutant("big-endian PLY is not turned round", "formats", FORMATS + "ply_reader.cpp",
           "if (swaps_) swap_bytes(info_.schema, bytes);", "", ("formats",)),
    Mutant("integers are cut off instead of rounded", "formats", "pointsweep/points/schema.cpp",
           "const double rounded = std::nearbyint(value);", "const double rounded = std::trunc(value);",
           ("points", "formats")),
    Mutant("bit fields write into their neighbours", "formats", "pointsweep/points/schema.cpp",
           "const std::uint64_t chosen = std::min(saturate<std::uint64_t>(bits), mask);",
           "const std::uint64_t chosen = saturate<std::uint64_t>(bits);", ("points", "formats")),
    Mutant("bounds of a LAS header without its offset", "formats", FORMATS + "las_statistics.cpp",
           "header.bounds.hi[axis] = hi_[a] * header.scale[axis] + header.offset[axis];",
           "header.bounds.hi[axis] = hi_[a] * header.scale[axis];", ("formats",)),
    Mutant("returns are counted without their mask", "formats", FORMATS + "las_statistics.cpp",
           "& return_mask_];", "& 0x07];", ("formats",)),
    Mutant("negative infinity of Windows is positive", "formats", FORMATS + "number_text.cpp",
           "if (negative) value = -value;", "", ("formats",)),
    Mutant("fields an input lacks keep what was there", "formats", "pointsweep/points/record_conversion.cpp",
           "std::memset(to, 0, to_stride_);", "", ("points", "formats")),
    Mutant("an output replaces a file that appeared meanwhile", "formats", FORMATS + "output_file.cpp",
           "::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0",
           "::rename(from.c_str(), to.c_str()) == 0", ("formats", "cli")),

    # Resume
    Mutant("a resumed run reads no slab twice", "resume", SWEEP + "sweep_restart.cpp",
           "return slab - std::min(slab, static_cast<std::uint32_t>(plan_.step_count()));", "return slab;", ("pipeline",)),
    Mutant("a resumed run forgets the dropped cells", "resume", SWEEP + "sweep_restart.cpp",
           "if (cell.slab < first_slab_) outside.cell_was_dropped(cell.slab, cell.box);",
           "if (cell.slab > first_slab_) outside.cell_was_dropped(cell.slab, cell.box);", ("pipeline",)),
    Mutant("a resumed run forgets the deferred points", "resume", SWEEP + "sweep.cpp",
           "workers_.front().deferred = from.deferred;", "", ("pipeline",)),
    Mutant("a checkpoint in a sweep keeps the results before it", "resume", PIPELINE + "checkpoints.cpp",
           "last_.progress = packed(progress);\n  last_.results = packed(results);", "last_.progress = packed(progress);",
           ("pipeline",)),
    Mutant("another radius counts as the same run", "resume", PIPELINE + "run_identity.cpp",
           "plan.neighborhood.k, plan.neighborhood.radius);", "plan.neighborhood.k, 0 * plan.neighborhood.k);",
           ("pipeline",)),
]
