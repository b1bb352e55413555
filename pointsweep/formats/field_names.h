// SPDX-License-Identifier: MIT
/// Names of fields in the headers of files, names for columns without names, and the fields that an option names.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Returns one name for each component of each field. The components of a field with several become NAME_0, NAME_1,
/// ...; spaces, commas, semicolons, vertical bars, quotes and control characters become '_'; an empty name becomes
/// "unnamed"; a repeated name gets _2, _3, ... added.
std::vector<std::string> column_names(const Schema& schema);
/// Returns a warning about the output `path` with the names of fields that differ in the file; empty if there are none.
/// `format`: name of the format. `stored`: the name in the file of each component of each field, as column_names()
/// lists them. Fields with several components do not count.
std::string changed_names(const std::filesystem::path& path, std::string_view format, const Schema& schema,
                          const std::vector<std::string>& stored);

/// Returns whether a field has this name, in any case.
bool has_name(const Schema& schema, std::string_view name);
/// Returns the first of `name`, NAME_2, NAME_3, ... that no field has, in any case.
std::string unused_name(const Schema& schema, const std::string& name);

/// Returns names for at least three unnamed columns, from their number and the values of the first rows:
/// 3: x y z;  4: x y z intensity;  6: x y z and a normal or colour;  7: x y z intensity and a colour;
/// 9: x y z, a colour and a normal;  else x y z column_4 column_5 ...
/// In all of these rows, a normal has length 0 or 1 (within 0.01), and a colour consists of integers in 0..255.
std::vector<std::string> default_column_names(const std::vector<std::vector<double>>& rows);

/// Returns the field that a user means by `word`, as field_meant() of schema.h finds it. If there is none, throws
/// UsageError with a message that begins with `option` and lists the fields.
const Field& named_field(const Schema& schema, const std::string& word, std::string_view option);

/// Returns the indices of the fields that a user means by `words`. Throws as named_field().
std::vector<std::size_t> named_fields(const Schema& schema, const std::vector<std::string>& words,
                                      std::string_view option);

}  // namespace pointsweep
