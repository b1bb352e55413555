// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/file_pairs.h"

#include <algorithm>

namespace pointsweep {

std::size_t file_of_row(std::span<const FileOfRows> files, std::uint64_t row) {
  return static_cast<std::size_t>(std::ranges::upper_bound(files, row, {}, &FileOfRows::first) - files.begin()) - 1;
}

FilePairs::FilePairs(const RowSource& in, const RowSource& out, bool in_any_order, std::vector<FieldPair> pairs)
    : pairs_(std::move(pairs)),
      in_{in.files(), in.count()},
      out_{out.files(), out.count()},
      by_file_(!in_any_order && in.files().size() == out.files().size() && in.files().size() > 1) {}

std::span<const FieldPair> FilePairs::of(Side& side, std::uint64_t row) {
  if (!by_file_) return pairs_;
  if (row >= side.first && row < side.end) return side.pairs;
  const std::size_t file = file_of_row(side.files, row);
  side.first = side.files[file].first;
  side.end = file + 1 < side.files.size() ? side.files[file + 1].first : side.count;
  side.pairs.clear();
  for (const FieldPair& pair : pairs_)
    side.pairs.push_back(pair.in_files(in_.files[file].schema, out_.files[file].schema));
  return side.pairs;
}

}  // namespace pointsweep
