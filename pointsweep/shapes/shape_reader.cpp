// SPDX-License-Identifier: MIT
/// A generated cloud of any size, read like a file although it is stored nowhere.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <future>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/program/generate.h"
#include "pointsweep/shapes/registry.h"
#include "pointsweep/shapes/rng.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kGrain = 4096;     // points made by one task
constexpr std::size_t kBlock = 1 << 18;  // points of a block that is written
constexpr double kFarthestNoise = 13;    // in standard deviations; gaussian_pair() draws nothing above 12.2

void check(const Sampling& s) {
  if (!(s.noise >= 0) || !std::isfinite(s.noise)) fail_usage("noise must be a length of 0 or more, not {}.", s.noise);
  if (!(s.outliers >= 0 && s.outliers <= 1))
    fail_usage("the share of outliers must lie in [0, 1], not {}.", s.outliers);
  if (!(s.outlier_box > 0) || !std::isfinite(s.outlier_box))
    fail_usage("the outlier box must have a positive size, not {}.", s.outlier_box);
  if (!is_finite(s.origin)) fail_usage("the origin must be finite.");
}

template <class T>
void store_triple(Vec3 v, std::byte* to) {
  const std::array<T, 3> values{static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)};
  std::memcpy(to, values.data(), sizeof values);
}

/// The reader of generated_points(): makes each point from the seed and the row alone.
class ShapeReader final : public Reader {
 public:
  /// Throws UsageError for a value out of range.
  ShapeReader(std::unique_ptr<const Shape> shape, const Sampling& sampling)
      : shape_(std::move(shape)), sampling_(sampling) {
    check(sampling);
    const Box box = shape_->bounds();
    const Vec3 half = (0.5 * sampling.outlier_box) * box.extent();
    outlier_box_ = {box.center() - half, box.center() + half};

    info_.path = shape_->name();
    info_.format = "generated " + shape_->name();
    for (const char* name : {"x", "y", "z"}) info_.schema.append(name, sampling.float64 ? Type::f64 : Type::f32);
    if (shape_->has_normals())
      for (const char* name : {"nx", "ny", "nz"}) info_.schema.append(name, Type::f32);
    info_.count = sampling.count;

    Box holds = sampling.outliers > 0 ? outlier_box_ : box;
    holds.include(box);
    const double reach = kFarthestNoise * sampling.noise;
    const Vec3 margin{reach, reach, reach};
    info_.bounds = {(holds.lo - margin) + sampling.origin, (holds.hi + margin) + sampling.origin};
  }

  /// Makes the records on all threads, 5 to 50 million points per second and core.
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    if (row >= info_.count) return 0;
    const std::size_t stride = info_.schema.stride, count = rows_for(row, records);
    parallel_for_blocks(count, kGrain, [&](std::size_t first, std::size_t n, unsigned) {
      for (std::size_t i = first; i < first + n; ++i) store(row + i, records.data() + i * stride);
    });
    return count;
  }

 private:
  SurfacePoint point(std::uint64_t row) const {
    Rng rng(sampling_.seed, row);
    const bool outlier = rng.uniform() < sampling_.outliers;
    SurfacePoint p;
    if (outlier) {
      for (int axis = 0; axis < 3; ++axis) p.position[axis] = rng.uniform(outlier_box_.lo[axis], outlier_box_.hi[axis]);
    } else {
      p = shape_->sample(rng);
      if (sampling_.noise > 0) {
        const Vec2 xy = gaussian_pair(rng), z = gaussian_pair(rng);
        p.position = p.position + sampling_.noise * Vec3{xy.x, xy.y, z.x};
      }
    }
    p.position = p.position + sampling_.origin;
    return p;
  }

  void store(std::uint64_t row, std::byte* record) const {
    const SurfacePoint p = point(row);
    if (sampling_.float64)
      store_triple<double>(p.position, record);
    else
      store_triple<float>(p.position, record);
    if (shape_->has_normals()) store_triple<float>(p.normal, record + info_.schema.fields[3].offset);
  }

  std::unique_ptr<const Shape> shape_;
  Sampling sampling_;
  Box outlier_box_;
};

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
