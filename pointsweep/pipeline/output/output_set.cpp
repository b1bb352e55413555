// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/output_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/known_values.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/pipeline/rows/input_source.h"
#include "pointsweep/storage/local/unfinished_output.h"

namespace pointsweep {
namespace {
constexpr std::size_t kChunkBytes = 4 << 20;

/// Returns `values` with the ranges of the kept fields alone, in the order of the kept fields.
std::shared_ptr<const KnownValues> of_kept_fields(std::shared_ptr<const KnownValues> values, const KeptFields& kept) {
  if (!values || !kept.input) return values;
  auto some = std::make_shared<KnownValues>(*values);
  some->ranges.clear();
  for (const std::size_t field : *kept.input) some->ranges.push_back(values->ranges[field]);
  return some;
}

/// Returns the schema with its columns in the order of Chain::keep. The schema is unchanged for LAS, which has its own
/// order, and for writers that write no file.
Schema listed_schema(const Schema& schema, const std::filesystem::path& output, const KeptFields& kept,
                     const std::vector<Attribute>& made) {
  const Format* const format = format_of_output(output);
  return format != nullptr && format->real_coordinates ? in_named_order(schema, kept, made) : schema;
}

/// Returns the type of x, y and z in the records for `output`, for a chain that makes `made`; absent: the type of the
/// input.
std::optional<Type> type_of_positions(const std::vector<Attribute>& made, const std::filesystem::path& output,
                                      const EngineOptions& options) {
  const Format* const format = format_of_output(output);
  if (options.positions && format != nullptr && !format->real_coordinates)
    fail_usage("--positions: {} stores coordinates as integers, in {}; leave the option out, or write PLY.",
               format->name, output.string());
  if (options.positions) return options.positions;
  return moves_points(made) ? std::optional(Type::f64) : std::nullopt;
}

}  // namespace

OutputLayout layout_of_output(const InputCloud& cloud, const OutputNames& names, const Outputs& outputs,
                              const EngineOptions& options) {
  return {cloud.schema(), names.made, names.kept, type_of_positions(names.made, outputs.points, options)};
}

OutputPlan plan_of_output(const InputCloud& cloud, const Schema& records, const OutputNames& names,
                          const Outputs& outputs, const EngineOptions& options, OutputPlace place,
                          std::vector<std::string> provenance) {
  return {.path = outputs.points,
          .schema = listed_schema(records, outputs.points, names.kept, names.made),
          .count = cloud.count(),
          .extras = cloud.extras(),
          .overwrite = options.overwrite,
          .bounds = place.bounds,
          .crs = cloud.crs(),
          .replaces_crs = cloud.replaces_crs(),
          .las = cloud.las(),
          .values = of_kept_fields(std::move(place.values), names.kept),
          .other_extras = cloud.other_extras(),
          .made = names.made,
          .provenance = std::move(provenance),
          .layout = options.layout,
          .encoder_bytes = place.encoder_bytes,
          .scratch = place.scratch,
          .temp_folder = options.resources.temp_folder,
          .progress = std::move(place.completing)};
}

OutputSet::OutputSet(const InputCloud& cloud, const OutputNames& names, const Outputs& outputs,
                     const EngineOptions& options, OutputPlace place, std::vector<std::string> provenance)
    : layout_(layout_of_output(cloud, names, outputs, options)),
      input_stride_(cloud.schema().stride),
      rounding_(cloud.schema(), names.made, layout_.schema()),
      name_(options.division.divides() ? folder_of(outputs.points) : outputs.points) {
  const OutputPlan plan =
      plan_of_output(cloud, layout_.schema(), names, outputs, options, place, std::move(provenance));
  if (options.division.divides()) {
    auto divided =
        std::make_unique<DividedWriter>(plan, options.division, DivisionRoom{place.division_bytes, place.scratch});
    divided_ = divided.get();
    points_.add(std::move(divided));
  } else if (!outputs.points.empty()) {
    points_.add(create_writer(plan));
  }
  if (outputs.writer) points_.add(outputs.writer(plan));
  for (const Attribute& attribute : names.made) {
    for (const auto& [name, path] : outputs.arrays) {
      if (name != attribute.name) continue;
      Schema schema;
      schema.append(name, attribute.type, static_cast<std::uint32_t>(attribute.fields.size()));
      const OutputPlan array{.path = path,
                             .schema = schema,
                             .count = cloud.count(),
                             .extras = nullptr,
                             .overwrite = options.overwrite,
                             .made = {attribute},
                             .temp_folder = options.resources.temp_folder};
      arrays_.emplace_back().file.add(array_format().create(array));
      arrays_.back().offset = result_bytes_;
      arrays_.back().bytes = attribute.bytes();
    }
    result_bytes_ += attribute.bytes();
  }
  if (arrays_.size() != outputs.arrays.size()) fail_usage("An array is asked for that no operator of the chain makes.");
}

std::size_t OutputSet::chunk_rows() const { return std::max<std::size_t>(1, kChunkBytes / layout_.schema().stride); }

void OutputSet::write_results(InputCloud& cloud, std::uint64_t first_row, std::span<const std::byte> results) {
  const std::size_t rows = result_bytes_ == 0 ? 0 : results.size() / result_bytes_;
  // All chunks have about the same size, because resize() to a larger chunk after a small one would write zeros.
  const std::size_t chunks = (rows + chunk_rows() - 1) / chunk_rows();
  for (std::size_t done = 0, c = 0; c < chunks; ++c) {
    const std::size_t n = (rows - done) / (chunks - c);
    const std::byte* from = results.data() + done * result_bytes_;
    if (!points_.empty()) {
      inputs_.resize(n * input_stride_);
      assembled_.resize(n * layout_.schema().stride);
      if (!input_rows_) input_rows_.emplace(source_of(cloud));
      input_rows_->read(first_row + done, inputs_);
      layout_.assemble_all(inputs_.data(), from, n, assembled_.data(), first_row + done);
      write_assembled();
    }
    for (Array& array : arrays_) {
      array.column.resize(n * array.bytes);
      for_each_task(n, [&](std::size_t row, std::size_t m) {
        for (std::size_t i = row; i < row + m; ++i)
          std::memcpy(array.column.data() + i * array.bytes, from + i * result_bytes_ + array.offset, array.bytes);
      });
      array.file.write(array.column);
    }
    done += n;
  }
}

void OutputSet::write_records(std::span<const std::byte> records) {
  const std::size_t chunk = chunk_rows() * layout_.schema().stride;
  while (!records.empty()) {
    assembled_.resize(chunk);
    const std::size_t fitting = std::min(records.size(), chunk - filled_);
    std::memcpy(assembled_.data() + filled_, records.data(), fitting);
    records = records.subspan(fitting);
    filled_ += fitting;
    if (filled_ == chunk) write_filled();
  }
}

void OutputSet::write_inputs(std::uint64_t first_row, std::span<const std::byte> records) {
  assemble_inputs(first_row, records, inputs_);
  write_records(inputs_);
}

void OutputSet::write_piece(std::uint64_t first_row, std::vector<std::byte>& records) {
  if (filled_ != 0) return write_inputs(first_row, records);
  if (layout_.passes_inputs())
    assembled_.swap(records);
  else
    assemble_inputs(first_row, records, assembled_);
  write_assembled();
}

void OutputSet::assemble_inputs(std::uint64_t first_row, std::span<const std::byte> records,
                                std::vector<std::byte>& to) const {
  const std::size_t rows = records.size() / input_stride_;
  to.resize(rows * layout_.schema().stride);
  layout_.assemble_all(records.data(), nullptr, rows, to.data(), first_row);
}

void OutputSet::write_filled() {
  assembled_.resize(filled_);
  write_assembled();
  filled_ = 0;
}

void OutputSet::write_assembled() {
  rounding_.see(assembled_);
  points_.write(assembled_);
}

std::vector<std::string> OutputSet::warnings() const {
  std::vector<std::string> all;
  for (const auto& writer : points_.writers())
    all.insert(all.end(), writer->warnings().begin(), writer->warnings().end());
  if (const std::string rounded = rounding_.sentence(); !rounded.empty() && !name_.empty())
    all.push_back(fmt::format("{}: {}", name_.string(), rounded));
  return all;
}

void OutputSet::flush() {
  if (filled_ != 0) write_filled();
  points_.wait();
  for (Array& array : arrays_) array.file.wait();
}

void OutputSet::finish(const InputCloud& cloud) {
  cloud.require_unchanged();
  flush();  // no file gets its name while another one may fail for lack of space
  points_.finish();
  for (Array& array : arrays_) array.file.finish();
}

std::uint64_t OutputSet::bytes_written() const {
  std::uint64_t bytes = points_.bytes_written();
  for (const Array& array : arrays_) bytes += array.file.bytes_written();
  return bytes;
}

std::size_t OutputSet::files_written() const {
  return divided_ != nullptr ? divided_->files() : points_.writers().size();
}

}  // namespace pointsweep
