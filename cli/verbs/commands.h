// SPDX-License-Identifier: MIT
/// The verbs of the tool. To add a verb, define it in a new source file, declare it here, and name it in add_verbs().
#pragma once

#include <CLI/App.hpp>
#include <string_view>
#include <vector>

#include "pointsweep/error.h"

namespace pointsweep {

/// A verb of the tool. `declare` gives it its options and what it does: it runs while the command line is parsed, and
/// throws its errors.
struct Verb {
  const char* name;
  const char* meaning;
  void (*declare)(CLI::App& verb);
};

extern const Verb kConvertVerb, kThinVerb, kTransformVerb, kTileVerb, kSplitVerb, kGroundVerb, kNeighborsVerb,
    kSortVerb, kRunVerb, kOperatorsVerb, kVerifyVerb, kInfoVerb, kGenerateVerb, kRenderVerb, kCompletionVerb, kManVerb,
    kHelpVerb;
std::vector<Verb> short_form_verbs();  // normals, curvature, splats, features, fair, denoise

/// Adds all verbs, in the order of the help. Where the command line begins with the verb `asked`, the others get their
/// names alone, because declaring all options takes half of the time in which the tool starts; help, completion and man
/// show the options of other verbs, and so declare all.
void add_verbs(CLI::App& app, std::string_view asked = "");

/// Error of `verify` if it found no difference but could not check everything. Its exit status is 3.
class NotChecked : public Error {
 public:
  using Error::Error;
};

}  // namespace pointsweep
