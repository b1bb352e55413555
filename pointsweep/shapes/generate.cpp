// SPDX-License-Identifier: MIT
#include "pointsweep/program/generate.h"

#include <future>
#include <span>

#include "pointsweep/cancellation.h"
#include "pointsweep/shapes/registry.h"
#include "pointsweep/shapes/shape_reader.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kBlock = 1 << 18;  // points of a block

/// Writes points in two alternating blocks: one is filled on all threads while the other is written to disk.
void write_all(Reader& points, Writer& writer, const std::function<void(std::uint64_t done)>& progress) {
  const std::size_t stride = points.info().schema.stride;
  std::vector<std::byte> blocks[2] = {std::vector<std::byte>(kBlock * stride), std::vector<std::byte>(kBlock * stride)};
  std::future<void> writing;
  for (std::uint64_t row = 0, turn = 0; row < points.info().count; ++turn) {
    stop_if_cancelled();
    std::vector<std::byte>& block = blocks[turn % 2];
    const std::size_t made = points.read(row, block);
    if (writing.valid()) writing.get();
    writing = std::async(std::launch::async,
                         [&writer, records = std::span(block).first(made * stride)] { writer.write(records); });
    row += made;
    progress(row);
  }
  if (writing.valid()) writing.get();
}

}  // namespace

std::vector<NamedShape> shapes() {
  std::vector<NamedShape> named;
  for (const auto& shape : all_shapes()) named.push_back({shape->name(), shape->meaning()});
  return named;
}

std::unique_ptr<Reader> generated_points(std::string_view shape, const Sampling& sampling) {
  return std::make_unique<ShapeReader>(create_shape(shape), sampling);
}

void write_generated(Reader& points, Writer& writer, unsigned threads,
                     const std::function<void(std::uint64_t done)>& progress) {
  with_threads(threads != 0 ? threads : thread_count(), [&] { write_all(points, writer, progress); });
  writer.finish();
}

}  // namespace pointsweep
