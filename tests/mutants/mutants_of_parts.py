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
    Mutant("rows of a tile count from 0 in its part", "parts", PART + "part_stream.cpp",
           "row += tiles_.tiles[tile].first_row;", "", TESTS),
    Mutant("blocks of a tile that the halo cuts off are forgotten", "parts", PART + "part_stream.cpp",
           "add(far_, t, far);", "", TESTS),
    Mutant("distant tiles are forgotten", "parts", PART + "part_stream.cpp",
           "for (const TileRegion& region : regions) add_region(t, region);", ";", TESTS),
    Mutant("a damaged block is taken for whole", "parts", PART + "part_stream.cpp",
           "if (checksum_of(records) != checksum)", "if (false)", ("part:*",)),
    Mutant("the values of the cloud are those of the last tile", "parts", "pointsweep/pipeline/rows/pass_values.cpp",
           "      all->load(of_part[v]);", "      if (&of_part == &saved.back()) all->load(of_part[v]);", TESTS),
    Mutant("a part forgets which rows are left", "parts", RUN,
           "if (!state.mask.empty()) {", "if (state.mask.size() > 1000000) {", TESTS),
    Mutant("numbers of rows begin anew in each tile", "parts", RUN,
           "const NumberedInput numbered(tile, plan, task.first_row);", "const NumberedInput numbered(tile, plan);", TESTS),
]
