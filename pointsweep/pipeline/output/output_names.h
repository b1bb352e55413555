// SPDX-License-Identifier: MIT
/// Under which names made attributes are written, and that none takes the name of an attribute of the input by
/// accident.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/pipeline/plan/kept_fields.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// The rules for names of made attributes: EngineOptions::prefix and EngineOptions::replace.
struct NamingRules {
  std::string prefix;
  std::vector<std::string> replace;
};

struct OutputNames {
  std::vector<Attribute> made;        ///< those that were given, their fields with the names in the output
  KeptFields kept;                    ///< likewise
  std::vector<std::string> replaced;  ///< attributes of the input that are overwritten unasked: they bear the very name
  /// "The input's attributes nx ny nz are replaced ..."; empty if there are none.
  std::string warning() const;
};

/// An attribute of the input is overwritten where an operator makes one of the very name (an input with nx ny nz, and
/// normals are made: a user who asks for normals asks for that), and where `replace` names it. Any other that would
/// lose its name to a made one is refused with UsageError: above all `curvature`, which several programs call the
/// surface variation and others a curvature. With a prefix nothing is overwritten unless `replace` names it. Positions
/// move without prefix. Colours of the input are never replaced unasked. `output` tells the format, in which names may
/// be shortened.
OutputNames name_outputs(const Schema& input, const std::string& input_name, const std::vector<Attribute>& made,
                         const KeptFields& kept, const std::filesystem::path& output, const NamingRules& rules);

}  // namespace pointsweep
