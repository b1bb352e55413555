// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/file_column.h"

#include "pointsweep/points/promised_type.h"

namespace pointsweep {

void fill_file_column(const FileColumn& file, const Schema& schema, const std::byte* records,
                      std::span<const std::uint64_t> rows, std::byte* out, FirstRowError& refused) {
  const std::size_t bytes = size_of(file.type), width = bytes * file.fields.size();
  for (const std::size_t f : file.fields) {
    const PromisedType promised(schema.fields[f], file.type);
    for (std::size_t i = 0; i < rows.size(); ++i)
      promised.convert(records + i * schema.stride, rows[i], out + i * width, refused);
    out += bytes;
  }
}

}  // namespace pointsweep
