# SPDX-License-Identifier: MIT
"""Deliberate mistakes in levels of detail and in COPC files."""
from mutant import Mutant

LEVELS = "pointsweep/levels/"
LAS = "pointsweep/formats/las/"
CHOICE = ("levels:LevelChoice.*",)
FILES = ("cli:Copc.*",)

MUTANTS = [
    Mutant("leaves keep out no points beside them", "levels", LEVELS + "level_choice.cpp",
           "if (const Leaf* leaf = leaf_around(leaves_, beside)) return add_once(leaves, leaf);",
           "if (leaf_around(leaves_, beside) != nullptr) return;", CHOICE),
    Mutant("octants of one depth do not know each other", "levels", LEVELS + "level_choice.cpp",
           "if (node->is_done)", "if (false && node->is_done)", CHOICE),
    Mutant("points of lesser depths keep out no others", "levels", LEVELS + "level_choice.cpp",
           "else if (before != nullptr)", "else if (false && before != nullptr)", CHOICE),
    Mutant("a root of any number of points is good enough", "levels", LEVELS + "level_choice.cpp",
           "choose_node(root, nullptr, root.nodes[0], kMostRootPoints)", "choose_node(root, nullptr, root.nodes[0], kAnyNumber)", CHOICE),
    Mutant("points of leaves beyond half the spacing keep out none", "levels", LEVELS + "level_choice.cpp",
           "octant_of(leaf.key, leaf.depth)), -spacing);", "octant_of(leaf.key, leaf.depth)), -0.5 * spacing);", CHOICE),
    Mutant("a disc that touches a half of a block covers it", "levels", LEVELS + "disc_choice.cpp",
           "if (farthest2(box, p) < spacing2_) return", "if (distance2(box, p) < spacing2_) return", CHOICE),
    Mutant("kept points in the cells above are overlooked", "levels", LEVELS + "disc_choice.cpp",
           "kNear[] = {0, -1, 1};", "kNear[] = {0, -1};", CHOICE),
    Mutant("many points at one place are divided", "levels", LEVELS + "level_choice.cpp",
           " || first_at_last_ <= first ||", " ||", CHOICE),
    Mutant("leaves are the smallest octants", "levels", LEVELS + "level_choice.cpp",
           "while (!leaves_.empty() && leaves_.back().first >= first) leaves_.pop_back();", "if (false) leaves_.pop_back();", CHOICE),
    Mutant("records at one place stay in their order", "levels", LEVELS + "curve_records.cpp",
           "    return std::memcmp(&records[a.row * record_bytes_], &records[b.row * record_bytes_], record_bytes_) < 0;\n",
           "    return a.row < b.row;\n", FILES),
    Mutant("a stretch ends before the records of its end in the first piece", "levels", LEVELS + "curve_records.cpp",
           "return end.is_behind ? order <= 0 : order < 0;", "return end.is_behind && order <= 0;", CHOICE + FILES),
    Mutant("the GPS range of a COPC file ends where it begins", "levels", LAS + "copc_layout.cpp",
           "std::max(times_.greatest, time)}", "std::min(times_.greatest, time)}", FILES),
    Mutant("points of class 12 get no overlap flag", "levels", LAS + "las_frame.cpp",
           "if (record[kClassAt] == kOverlapClass) record[kFlagsAt]", "if (record[kClassAt] != record[kClassAt]) record[kFlagsAt]", FILES),
    Mutant("the hierarchy of a COPC input stays in its copy", "levels", LAS + "las_pieces.cpp",
           "if (!evlrs.copc_hierarchy) return;", "if (!evlrs.copc_hierarchy || evlrs.count > 0) return;", FILES),
    Mutant("nodes of the depth asked for are not read", "levels", "pointsweep/formats/chosen_chunks.cpp",
           "return chunk.depth <= depth;", "return chunk.depth < depth;", FILES),
    Mutant("rows of chosen chunks are those of the first one", "levels", "pointsweep/formats/chosen_chunks.cpp",
           "all_->read(chosen.chunk.first_row + before, to)", "all_->read(chunks_.chosen_.front().chunk.first_row + before, to)", FILES),
    Mutant("a crop chooses nodes by where points were before they moved", "levels", "pointsweep/pipeline/rows/input_source.cpp",
           "if (select == nullptr) break;", "if (select == nullptr) continue;", FILES),
]
