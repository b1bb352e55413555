// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/file_column.h"

#include <cstring>

namespace pointsweep {

void fill_file_column(const FileColumn& file, const Schema& schema, const std::byte* records, std::size_t size,
                      std::byte* out) {
  const std::size_t bytes = size_of(file.type);
  const Field to{.name = "", .type = file.type};
  for (std::size_t i = 0; i < size; ++i, records += schema.stride) {
    for (const std::size_t f : file.fields) {
      const Field& from = schema.fields[f];
      if (from.type == file.type && from.is_plain())
        std::memcpy(out, records + from.offset, bytes);
      else
        set_value(to, out, value_of(from, records));
      out += bytes;
    }
  }
}

}  // namespace pointsweep
