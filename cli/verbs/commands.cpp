// SPDX-License-Identifier: MIT
#include "cli/verbs/commands.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "cli/text/help.h"

namespace pointsweep {
namespace {

/// A verb of the tool. `declare` adds its options and the callback that runs it.
struct Verb {
  std::string_view name;
  const char* meaning;
  void (*declare)(CLI::App& verb);
  bool shows_other_verbs = false;  ///< true if the verb prints the options of other verbs
};

/// All verbs, in the order of the help.
constexpr Verb kVerbs[] = {
    {"convert", "Copy, merge or compress: write the points into another format", declare_convert_verb},
    {"normals", "Compute a unit normal for every point from its exact neighbours", declare_short_form},
    {"curvature", "Compute normals and principal curvatures", declare_short_form},
    {"splats", "Compute normals and elliptical splats that cover the surface", declare_short_form},
    {"features", "Compute features of the shape of neighbourhoods: linearity, planarity, verticality and more",
     declare_short_form},
    {"fair", "Smooth the surface, edge-preserving: move the points, then compute normals and splats",
     declare_short_form},
    {"denoise", "Leave out points that are far from their neighbours: statistical outliers", declare_short_form},
    {"thin", "Keep fewer points: one in each voxel, at a distance, a share, or a number", declare_thin_verb},
    {"transform", "Move the points by a matrix, and turn their normals", declare_transform_verb},
    {"tile", "Divide the points among square tiles, a file each", declare_tile_verb},
    {"split", "Divide the points by an attribute or at random, a file for each part", declare_split_verb},
    {"ground", "Find the points of the ground by a morphological filter (SMRF)", declare_ground_verb},
    {"neighbors", "Find the exact k nearest neighbours of every point", declare_neighbors_verb},
    {"sort", "Write the points in ascending order along an axis", declare_sort_verb},
    {"run", "Run a pipeline of operators over the points", declare_run_verb},
    {"operators", "List the operators, their options, inputs and outputs", declare_operators_verb},
    {"verify", "Check a result by brute force, or compare two files", declare_verify_verb},
    {"info", "Show format, coordinate system, bounds and attributes of point files", declare_info_verb},
    {"generate", "Generate a point cloud of a known shape, of any size", declare_generate_verb},
    {"render", "Draw a cloud as a picture", declare_render_verb},
    {"completion", "Print a script that completes commands in a shell", declare_completion_verb, true},
    {"man", "Print a manual page, or write all of them", declare_man_verb, true},
    {"help", "Show this help, or the help of a verb or an operator", declare_help_verb, true},
};

/// Refuses options with empty values: an empty file name would mean the current folder, and other options need a value.
void refuse_empty_values(CLI::App& verb) {
  const CLI::Validator not_empty(
      [](std::string& value) {
        return std::string(value.empty() ? "the value is empty; give one, or leave the option out" : "");
      },
      "");
  for (CLI::Option* option : verb.get_options())
    if (option->get_items_expected_max() > 0) option->check(not_empty);
}

}  // namespace

void add_verbs(CLI::App& app, std::string_view asked) {
  const Verb* const alone = std::ranges::find(kVerbs, asked, &Verb::name);
  const bool declares_all = alone == std::end(kVerbs) || alone->shows_other_verbs;
  for (const Verb& verb : kVerbs) {
    CLI::App& added = *app.add_subcommand(std::string(verb.name), verb.meaning);
    added.group("Verbs");
    added.get_help_ptr()->group(kOtherGroup);
    if (!declares_all && &verb != alone) continue;
    verb.declare(added);
    refuse_empty_values(added);
  }
}

}  // namespace pointsweep
