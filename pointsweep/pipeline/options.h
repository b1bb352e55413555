// SPDX-License-Identifier: MIT
/// Options of operators: declared once, from which come checks, messages, help and defaults.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/math/vec3.h"
#include "pointsweep/pipeline/parse.h"

namespace pointsweep {

enum class OptionKind : std::uint8_t {
  whole,      ///< whole number from `least` to `most`
  number,     ///< number from `least` to `most`
  choice,     ///< one of `choices`
  point,      ///< three finite numbers X,Y,Z
  attribute,  ///< name of an attribute
};

struct OptionDeclaration {
  std::string name;
  OptionKind kind;
  std::string preset;  ///< the value where none is given, as one would write it; empty: there is none
  std::string meaning;
  double least = 0;
  double most = std::numeric_limits<double>::infinity();
  std::vector<std::string> choices = {};

  /// "1 or more", "0 to 90", "none, up or input", "[X,Y,Z]": what may be given.
  std::string allowed() const;
  /// Throws UsageError that begins with `where` unless `value` may be given.
  void check(std::string_view value, std::string_view where) const;
};

/// The checked values of one stage's options.
class OptionValues {
 public:
  /// Throws UsageError for an option that is not declared, given twice, or of a value that may not be.
  OptionValues(const std::vector<OptionDeclaration>& declarations, const StageText& stage);

  /// By name of a declared option. What has no preset is asked for only if given.
  bool given(std::string_view name) const { return given_.contains(name); }
  bool any_given() const { return !given_.empty(); }
  /// The same, with the presets of `declarations` where none is given.
  OptionValues with_presets_of(const std::vector<OptionDeclaration>& declarations) const;
  std::uint64_t whole(std::string_view name) const;
  double number(std::string_view name) const;
  Vec3 point(std::string_view name) const;
  const std::string& choice(std::string_view name) const;

  /// "pipeline, column 12: normals": the stage, for messages of its maker.
  const std::string& where() const { return where_; }

 private:
  std::string where_;
  std::map<std::string, std::string, std::less<>> given_, preset_;
};

}  // namespace pointsweep
