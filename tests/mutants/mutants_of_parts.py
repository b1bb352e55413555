# SPDX-License-Identifier: MIT
"""Mistakes in tiles that are swept alone, in their stream, and in the tasks of a run on many machines."""
from mutant import Mutant

PART = "pointsweep/part/"
RUN = "pointsweep/pipeline/run/part_run.cpp"
TESTS = ("part:*", "pipeline:*PartRun*")

MUTANTS = [
    Mutant("the recall of a part knows no other tiles", "parts", "pointsweep/sweep/frontier.cpp",
           "if (!is_superfluous(slab.box, slab.least_row))", "if (false)", TESTS),
    Mutant("tiles beyond the halo stop no certificate", "parts", "pointsweep/sweep/frontier.cpp",
           "return read_ < slabs_.size() &&", "return false &&", TESTS),
    Mutant("a halo is handed over, too", "parts", "pointsweep/sweep/slab_loader.cpp",
           "made->is_only_looked_at = stream_.slabs()[slab].is_halo;", "", TESTS),
    Mutant("rows of a tile count from 0 in its part", "parts", PART + "tile_reader.cpp",
           "row += tiles_.tiles[tile].first_row;", "", TESTS),
    Mutant("blocks of a tile that the halo cuts off are forgotten", "parts", PART + "part_stream.cpp",
           "add(far_, t, far);", "", TESTS),
    Mutant("distant tiles are forgotten", "parts", PART + "part_stream.cpp",
           "for (const TileRegion& region : regions) add_region(t, region);", ";", TESTS),
    Mutant("a damaged block is taken for whole", "parts", PART + "tile_reader.cpp",
           "if (checksum_of(records) != checksum)", "if (false)", ("part:*",)),
    Mutant("the values of the cloud are those of the last tile", "parts", "pointsweep/pipeline/rows/pass_values.cpp",
           "      all->load(of_part[v]);", "      if (&of_part == &saved.back()) all->load(of_part[v]);", TESTS),
    Mutant("a part forgets which rows are left", "parts", RUN,
           "if (!state.mask.empty()) {", "if (state.mask.size() > 1000000) {", TESTS),
    Mutant("numbers of rows begin anew in each tile", "parts", RUN,
           "const NumberedInput numbered(tile, plan, task.first_row);", "const NumberedInput numbered(tile, plan);", TESTS),
    Mutant("an operator in order knows the points of its tile alone", "parts", PART + "needed_points.cpp",
           "  add_blocks(*source, blocks);\n  const std::uint64_t points", "  const std::uint64_t points", TESTS),
    Mutant("the nearest of a box are as near as its nearest corner", "parts", PART + "needed_points.cpp",
           "within.emplace_back(most_distance2(", "within.emplace_back(distance2(", TESTS),
    Mutant("one point is as good as k", "parts", PART + "needed_points.cpp",
           "if ((points += count) >= reach_.nearest)", "if ((points += count) >= 1)", TESTS),
    Mutant("the ground of a part ends at its window", "parts", "pointsweep/operators/ground/ground.cpp",
           "radius * (radius + 1) + 2 * (3 * radius + 3) + 4}", "radius}", TESTS),
    Mutant("other parts know the highest points of the cells", "parts", "pointsweep/operators/ground/ground.cpp",
           "points.positions[i].z < points.positions[known->second].z", "points.positions[i].z > points.positions[known->second].z", TESTS),
    Mutant("other parts know the points that are no ground", "parts", "pointsweep/operators/ground/height.cpp",
           "if (points.values[i] == kGroundClass) ground.push_back(i);", "if (points.values[i] != kGroundClass) ground.push_back(i);", TESTS),
    Mutant("cylinders reach no farther than half of their depth", "parts", "pointsweep/operators/change/m3c2.cpp",
           "std::hypot(options_.cylinder / 2, options_.depth) * (1 + 1e-6)", "options_.depth / 2", TESTS),
    Mutant("no point is missing in a part", "parts", "pointsweep/operators/thinning/poisson.cpp",
           "may_lack_ && may_lack_(p, r)", "false", TESTS),
    Mutant("points wait for those of which missing points decide in vain", "parts", "pointsweep/operators/thinning/undecided_points.cpp",
           "slots_[greater].lacks_some = true;", "(void)greater;", TESTS + ("pipeline:UndecidedPoints.*",)),
    Mutant("an order of numbered points numbers them anew", "parts", "pointsweep/order/stream.cpp",
           "options.numbered ? WorkingRecord(source.schema)", "false ? WorkingRecord(source.schema)", TESTS),
]
