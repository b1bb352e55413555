// SPDX-License-Identifier: MIT
#include "python/binding/point_batch.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/points/record_map.h"
#include "python/binding/bindings.h"
#include "python/binding/result_arrays.h"

namespace nb = nanobind;

namespace pointsweep {
namespace {

/// Returns an array of this shape and type. fill(to) writes all its values, beginning at `to`.
template <class T, class Fill>
nb::object filled(std::vector<std::size_t> shape, Type type, Fill fill) {
  std::size_t values = 1;
  for (const std::size_t n : shape) values *= n;
  ArrayMemory memory(values * sizeof(T));
  fill(reinterpret_cast<T*>(memory.bytes.get()));
  return numpy_array(std::move(memory), shape, type);
}

void put(double* to, Vec3 p) { to[0] = p.x, to[1] = p.y, to[2] = p.z; }

/// An index outside of every array, so that its use is an error, whereas -1 would mean the last row.
constexpr std::int64_t kNoRow = std::numeric_limits<std::int64_t>::max();

/// Returns the bytes of a missing neighbour: NaN, or 0 for integers.
std::vector<std::byte> missing_value(const Attribute& attribute) {
  const bool is_float = attribute.type == Type::f32 || attribute.type == Type::f64;
  return std::vector<std::byte>(attribute.bytes(), is_float ? std::byte{0xFF} : std::byte{0});
}

}  // namespace

PointBatch::PointBatch(const Neighborhoods& in, const Contract& contract, std::size_t first, std::size_t size)
    : in_(&in),
      alone_(contract.default_k == 0),
      reads_(contract.reads),
      reads_neighbors_(contract.reads_neighbors),
      first_(first),
      size_(size) {
  if (alone_) return;
  for (std::size_t i = first; i < first + size; ++i) width_ = std::max(width_, in.count(i));
}

const Neighborhoods& PointBatch::in() const {
  if (in_ == nullptr)
    fail_usage("the points of an operator can be used during its call only; copy what is needed later.");
  return *in_;
}

const Neighborhoods& PointBatch::in_with_neighbors() const {
  if (alone_) fail_usage("this operator sees no neighbours; make it with neighbors=True.");
  return in();
}

nb::object PointBatch::positions() const {
  return filled<double>({size_, 3}, Type::f64, [&](double* to) {
    for (std::size_t i = 0; i < size_; ++i) put(to + 3 * i, in().position(first_ + i));
  });
}

nb::object PointBatch::rows() const {
  return filled<std::int64_t>({size_}, Type::i64, [&](std::int64_t* to) {
    for (std::size_t i = 0; i < size_; ++i) to[i] = static_cast<std::int64_t>(in().row(first_ + i));
  });
}

nb::object PointBatch::counts() const {
  return filled<std::int64_t>({size_}, Type::i64, [&](std::int64_t* to) {
    for (std::size_t i = 0; i < size_; ++i) to[i] = static_cast<std::int64_t>(in_with_neighbors().count(first_ + i));
  });
}

nb::object PointBatch::neighbor_positions() const {
  const Neighborhoods& points = in_with_neighbors();
  return filled<double>({size_, width_, 3}, Type::f64, [&](double* to) {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = first_; i < first_ + size_; ++i) {
      const NeighborRef* const refs = points.neighbors(i);
      for (std::size_t j = 0; j < width_; ++j, to += 3)
        put(to, j < points.count(i) ? points.position_of(refs[j]) : Vec3{kNaN, kNaN, kNaN});
    }
  });
}

nb::object PointBatch::neighbor_rows() const {
  const Neighborhoods& points = in_with_neighbors();
  return filled<std::int64_t>({size_, width_}, Type::i64, [&](std::int64_t* to) {
    for (std::size_t i = first_; i < first_ + size_; ++i)
      for (std::size_t j = 0; j < width_; ++j)
        *to++ = j < points.count(i) ? static_cast<std::int64_t>(points.neighbor_row(i, j)) : kNoRow;
  });
}

nb::object PointBatch::own(std::size_t a) const {
  const Neighborhoods& points = in();  // must come first: it throws after end(), when reads_ is no longer valid
  const Attribute& attribute = reads_[a];
  const std::byte* const from = points.values<std::byte>(a) + first_ * attribute.bytes();
  ArrayMemory memory(size_ * attribute.bytes());
  std::memcpy(memory.bytes.get(), from, size_ * attribute.bytes());
  std::vector<std::size_t> shape = {size_};
  if (attribute.is_list()) shape.push_back(attribute.fields.size());
  return numpy_array(std::move(memory), shape, attribute.type);
}

nb::object PointBatch::of_neighbors(std::size_t a) const {
  const Neighborhoods& points = in_with_neighbors();
  const Attribute& attribute = reads_neighbors_[a];
  const std::vector<std::byte> missing = missing_value(attribute);
  ArrayMemory memory(size_ * width_ * attribute.bytes());
  with_fixed_size(attribute.bytes(), [&](auto size) {
    if constexpr (size() == 0) {
      fail_usage("the values of '{}' have {} bytes, which is not a size that can be read of neighbours.",
                 attribute.name, attribute.bytes());
    } else {
      std::byte* to = memory.bytes.get();
      for (std::size_t i = first_; i < first_ + size_; ++i) {
        const NeighborRef* const refs = points.neighbors(i);
        for (std::size_t j = 0; j < width_; ++j, to += size()) {
          if (j >= points.count(i)) {
            std::memcpy(to, missing.data(), size());
            continue;
          }
          const auto value = points.value_of<std::array<std::byte, size()>>(a, refs[j]);
          std::memcpy(to, value.data(), size());
        }
      }
    }
  });
  std::vector<std::size_t> shape = {size_, width_};
  if (attribute.is_list()) shape.push_back(attribute.fields.size());
  return numpy_array(std::move(memory), shape, attribute.type);
}

void bind_point_batch(nb::module_& module) {
  nb::class_<PointBatch>(module, "PointBatch")
      .def_prop_ro("size", &PointBatch::size)
      .def_prop_ro("width", &PointBatch::width)
      .def("positions", &PointBatch::positions)
      .def("rows", &PointBatch::rows)
      .def("counts", &PointBatch::counts)
      .def("neighbor_positions", &PointBatch::neighbor_positions)
      .def("neighbor_rows", &PointBatch::neighbor_rows)
      .def("own", &PointBatch::own)
      .def("of_neighbors", &PointBatch::of_neighbors);
}

}  // namespace pointsweep
