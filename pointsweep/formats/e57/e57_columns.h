// SPDX-License-Identifier: MIT
/// The representation of the attributes of a record in E57.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/formats/e57/e57_file.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// One value of a point: an attribute of the file, and where a record has it.
struct E57Column {
  E57Attribute attribute;  ///< name "cartesianX", "nor:normalX", "ps:NAME"
  Field field;             ///< of one component

  /// The number that the file stores: an integer without its scale, or the bits of a double.
  std::uint64_t stored(const std::byte* record) const;
};

/// Returns the columns for records of `schema`, the coordinates first, without `invalid_state`.
std::vector<E57Column> e57_columns(const Schema& schema);

/// `name` with '_' for every character but letters, digits, '-' and '_'. A name that the standard uses, or that XML
/// does not allow, has an '_' in front.
std::string e57_name(const std::string& name);

}  // namespace pointsweep
