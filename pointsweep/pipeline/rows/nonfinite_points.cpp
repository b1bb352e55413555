// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/nonfinite_points.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/order/working_record.h"

namespace pointsweep {
namespace {

bool holds_nonfinite(const std::filesystem::path& output) {
  const Format* const format = format_of_output(output);
  return format == nullptr || format->real_coordinates;
}

/// Returns an output whose format cannot hold nonfinite coordinates; absent if there is none. A tile is returned only
/// if its input may have nonfinite coordinates.
std::optional<std::filesystem::path> unfit_output(const InputCloud& cloud, const Outputs& outputs) {
  if (outputs.tiles.empty()) return holds_nonfinite(outputs.points) ? std::nullopt : std::optional(outputs.points);
  for (std::size_t t = 0; t < std::min(outputs.tiles.size(), cloud.readers().size()); ++t) {
    const FileInfo& input = cloud.readers()[t]->info();
    if (!holds_nonfinite(outputs.tiles[t]) && can_be_nonfinite(input.schema, input.path)) return outputs.tiles[t];
  }
  return std::nullopt;
}

void require_allowed(const NonfiniteRows& found, const std::optional<std::filesystem::path>& unfit, Nonfinite rule) {
  if (rule == Nonfinite::refuse)
    fail("{} has coordinates that are not finite, as have {} points in all; --nonfinite drop leaves such points out.",
         found.first, found.count);
  if (rule == Nonfinite::keep && unfit)
    fail(
        "{} has coordinates that are not finite, and the output {} cannot hold them; leave such points out with "
        "--nonfinite drop, or write PLY.",
        found.first, unfit->string());
}

}  // namespace

void for_each_nonfinite(const Stream& stream,
                        const std::function<void(std::uint64_t first, std::span<const std::byte> records)>& use) {
  const std::uint64_t n = stream.nonfinite_count(), chunk = 65536;
  std::vector<std::byte> records;
  for (std::uint64_t first = 0; first < n; first += chunk) {
    records.resize(std::min(chunk, n - first) * stream.record_schema().stride);
    stream.read_nonfinite(first, records);
    use(first, records);
  }
}

std::vector<std::uint64_t> rows_of_records(const Stream& stream, std::span<const std::byte> records) {
  const Schema& schema = stream.record_schema();
  std::vector<std::uint64_t> rows;
  for (std::size_t at = 0; at < records.size(); at += schema.stride)
    rows.push_back(row_of(schema, records.data() + at));
  return rows;
}

std::vector<std::uint64_t> first_nonfinite_rows(const Stream& stream, std::size_t most) {
  const std::uint64_t n = std::min<std::uint64_t>(most, stream.nonfinite_count());
  std::vector<std::byte> records(n * stream.record_schema().stride);
  stream.read_nonfinite(0, records);
  return rows_of_records(stream, records);
}

Nonfinite nonfinite_rule(const InputCloud& cloud, const Outputs& outputs, Nonfinite asked) {
  if (asked != Nonfinite::by_format) return asked;
  return !unfit_output(cloud, outputs) ? Nonfinite::keep : Nonfinite::drop;
}

FiniteInput finite_input(const InputCloud& cloud, const Outputs& outputs, const EngineOptions& options) {
  const Nonfinite rule = nonfinite_rule(cloud, outputs, options.nonfinite);
  const std::optional<std::filesystem::path> unfit = unfit_output(cloud, outputs);
  if (rule == Nonfinite::keep && !unfit) return {cloud, {}};
  auto [finite, dropped] = cloud.finite([&](std::uint64_t rows) {
    if (options.observer != nullptr) options.observer->on_progress({"checking", rows, cloud.count(), 0});
  });
  if (dropped.count > 0) require_allowed(dropped, unfit, rule);
  if (dropped.count > 0 && finite.count() == 0)
    fail("{}: none of the {} points has finite coordinates, so nothing is left to write.",
         cloud.readers().front()->info().path.string(), dropped.count);
  return {std::move(finite), std::move(dropped)};
}

std::string FiniteInput::warning() const {
  if (dropped.count == 0) return "";
  return fmt::format("Dropped {} {} whose coordinates are not finite, the first {}; --stats FILE lists their rows.",
                     dropped.count, dropped.count == 1 ? "point" : "points", dropped.first);
}

}  // namespace pointsweep
