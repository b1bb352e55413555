// SPDX-License-Identifier: MIT
/// Moving all points by a matrix, and converting their directions and lengths.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/rows/affine_map.h"

namespace pointsweep {

/// Returns the unit of the attribute `name` that an operator makes as a single value; "1" if no operator makes it.
std::string unit_of_made(const std::string& name);

/// Moves the points, and converts each attribute that is a direction or a length: attributes of earlier stages, and
/// attributes of the input with the names of attributes that operators of this library make.
class Transform final : public LocalOperator {
 public:
  /// Reads the file with the matrix, if there is one. Throws Error, beginning with the file's name, if the file cannot
  /// be read or holds no matrix. Throws UsageError, beginning with `place`, if no option gives a motion, a matrix given
  /// as text is invalid, or the matrix is singular.
  explicit Transform(TransformOptions options, std::string place = "transform");
  std::string name() const override { return "transform"; }
  Contract contract() const override;
  /// Throws RowError naming the lowest row whose coordinates would no longer be finite.
  void apply(const Neighborhoods& in, Columns& out) const override;
  std::array<bool, 3> changes_system() const override;
  std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const override;

 private:
  /// Returns the factor for the values of an attribute: the scale to the power of the length in the attribute's unit.
  double factor_of(const Attribute& attribute) const;
  bool changes(const Attribute& attribute) const;
  template <class T>
  void change(std::size_t number, const Neighborhoods& in, Columns& out) const;

  std::string place_;
  AffineMap map_, back_;
  std::optional<double> scale_;     ///< scale of lengths; nullopt if it depends on the direction
  std::vector<Attribute> changed_;  ///< attributes that are read and made again; set by bound()
};

}  // namespace pointsweep
