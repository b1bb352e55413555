// SPDX-License-Identifier: MIT
#include "cli/file_summary.h"

#include <algorithm>
#include <vector>

#include "cli/quantities.h"
#include "pointsweep/error.h"

namespace pointsweep {
namespace {

constexpr std::size_t kPiece = 1 << 16;  // points

void add(FileSummary& summary, Vec3 previous, Vec3 p) {
  for (int axis = 0; axis < 3; ++axis) {
    summary.ascending[static_cast<std::size_t>(axis)] &= p[axis] >= previous[axis];
    summary.descending[static_cast<std::size_t>(axis)] &= p[axis] <= previous[axis];
  }
  summary.bounds.include(p);
}

/// "ascending along x", "descending along y and z", "none". An axis along which nothing changes is in no order.
std::string order_text(const FileSummary& summary) {
  std::string text;
  const Vec3 extent = summary.bounds.extent();
  for (const bool up : {true, false}) {
    std::string axes;
    for (int axis = 0; axis < 3; ++axis) {
      const bool ordered = (up ? summary.ascending : summary.descending)[static_cast<std::size_t>(axis)];
      if (ordered && extent[axis] > 0)
        axes += (axes.empty() ? "" : " and ") + std::string(1, static_cast<char>('x' + axis));
    }
    if (!axes.empty())
      text += (text.empty() ? "" : ", ") + std::string(up ? "ascending along " : "descending along ") + axes;
  }
  return text.empty() ? "none" : text;
}

/// "x y z float32, intensity uint16": runs of one type are named together.
std::string attribute_text(const Schema& schema) {
  std::string text;
  for (std::size_t f = 0; f < schema.fields.size(); ++f) {
    const Field& field = schema.fields[f];
    text += field.name + (field.count > 1 ? fmt::format("[{}]", field.count) : "") + " ";
    const bool run_ends = f + 1 == schema.fields.size() || schema.fields[f + 1].type != field.type;
    if (run_ends) text += std::string(name_of(field.type)) + (f + 1 == schema.fields.size() ? "" : ", ");
  }
  return text;
}

}  // namespace

FileSummary summarize(Reader& reader, const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  const FileInfo& info = reader.info();
  const PositionFields position = position_fields(info.schema, info.path.string());
  std::vector<std::byte> records(kPiece * info.schema.stride);
  std::vector<double> x(kPiece), y(kPiece), z(kPiece);
  FileSummary summary;
  std::optional<Vec3> previous;
  for (std::uint64_t row = 0; row < info.count;) {
    const std::size_t count = reader.read(row, records);
    if (count == 0)
      fail("{}: ends at point {} of {}; it has changed while it was read.", info.path.string(), row, info.count);
    decode_positions(position, records.data(), info.schema.stride, count, x.data(), y.data(), z.data());
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 p{x[i], y[i], z[i]};
      if (!is_finite(p)) {
        ++summary.nonfinite;
        continue;
      }
      add(summary, previous.value_or(p), p);
      previous = p;
    }
    row += count;
    progress(row, info.count);
  }
  return summary;
}

std::string to_text(std::uint64_t points, const Box& bounds) {
  std::string text = fmt::format("  points      {}\n", points);
  if (bounds.empty()) return text;
  for (int axis = 0; axis < 3; ++axis)
    text += fmt::format("  {}           {:.15g} .. {:.15g}\n", "xyz"[axis], bounds.lo[axis], bounds.hi[axis]);
  return text;
}

std::string to_text(const FileInfo& info, const FileSummary& summary) {
  std::string text = fmt::format("{}\n  format      {}, {} bytes\n", info.path.string(), info.format, info.bytes);
  text += to_text(info.count, summary.bounds);
  if (summary.nonfinite > 0) text += fmt::format("  not finite  {} points, not in the bounds\n", summary.nonfinite);
  text += fmt::format("  attributes  {}\n", attribute_text(info.schema));
  return text + fmt::format("  order       {}\n", order_text(summary));
}

}  // namespace pointsweep
