// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output_set.h"

#include <algorithm>
#include <cstring>

#include "pointsweep/error.h"
#include "pointsweep/formats/npy_writer.h"

namespace pointsweep {

namespace {
constexpr std::size_t kChunkBytes = 4 << 20;
}

OutputSet::OutputSet(const Cloud& cloud, const std::vector<Attribute>& made, const Outputs& outputs, bool overwrite,
                     std::optional<Box> bounds)
    : layout_(cloud.schema(), made), input_stride_(cloud.schema().stride) {
  const OutputPlan plan{.path = outputs.points,
                        .schema = layout_.schema(),
                        .count = cloud.count(),
                        .extras = cloud.extras(),
                        .overwrite = overwrite,
                        .bounds = bounds};
  if (!outputs.points.empty()) writers_.push_back(create_writer(plan));
  if (outputs.writer) writers_.push_back(outputs.writer(plan));
  for (const Attribute& attribute : made) {
    for (const auto& [name, path] : outputs.arrays) {
      if (name != attribute.name) continue;
      Schema schema;
      schema.append(name, attribute.type, static_cast<std::uint32_t>(attribute.fields.size()));
      const OutputPlan array{
          .path = path, .schema = schema, .count = cloud.count(), .extras = nullptr, .overwrite = overwrite};
      arrays_.push_back({std::make_unique<NpyWriter>(array), result_bytes_, attribute.bytes()});
    }
    result_bytes_ += attribute.bytes();
  }
  if (arrays_.size() != outputs.arrays.size()) fail_usage("An array is asked for that no operator of the chain makes.");
}

void OutputSet::write_results(Cloud& cloud, std::uint64_t first_row, std::span<const std::byte> results) {
  const std::size_t rows = result_bytes_ == 0 ? 0 : results.size() / result_bytes_;
  const std::size_t chunk = std::max<std::size_t>(1, kChunkBytes / layout_.schema().stride);
  for (std::size_t done = 0; done < rows; done += chunk) {
    const std::size_t n = std::min(chunk, rows - done);
    const std::byte* from = results.data() + done * result_bytes_;
    if (!writers_.empty()) {
      inputs_.resize(n * input_stride_);
      assembled_.resize(n * layout_.schema().stride);
      if (cloud.read(first_row + done, inputs_) != n) {
        fail("The input ended at row {} although it had {} points: it changed while it was read.", first_row + done,
             cloud.count());
      }
      layout_.assemble(inputs_.data(), from, n, assembled_.data());
      for (const auto& writer : writers_) writer->write(assembled_);
    }
    for (const Array& array : arrays_) {
      column_.resize(n * array.bytes);
      for (std::size_t i = 0; i < n; ++i) {
        std::memcpy(column_.data() + i * array.bytes, from + i * result_bytes_ + array.offset, array.bytes);
      }
      array.writer->write(column_);
    }
  }
}

void OutputSet::write_records(std::span<const std::byte> records) {
  for (const auto& writer : writers_) writer->write(records);
}

void OutputSet::finish(const Cloud& cloud) {
  cloud.require_unchanged();
  for (const auto& writer : writers_) writer->finish();
  for (const Array& array : arrays_) array.writer->finish();
}

std::uint64_t OutputSet::bytes_written() const {
  std::uint64_t bytes = 0;
  for (const auto& writer : writers_) bytes += writer->bytes_written();
  for (const Array& array : arrays_) bytes += array.writer->bytes_written();
  return bytes;
}

}  // namespace pointsweep
