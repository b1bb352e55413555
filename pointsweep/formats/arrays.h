// SPDX-License-Identifier: MIT
/// Arrays in memory as input and output, for programs that use the library without files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/formats/reader.h"
#include "pointsweep/formats/writer.h"

namespace pointsweep {

/// Points from arrays, which are borrowed and must outlive the reader.
class ArrayReader final : public Reader {
 public:
  /// `xyz`: N×3, x y z of one point side by side. Throws UsageError if its size is no multiple of 3.
  explicit ArrayReader(std::span<const float> xyz);
  explicit ArrayReader(std::span<const double> xyz);

  /// One more attribute: N×names.size() values, those of one point side by side, e.g. {"nx", "ny", "nz"}.
  void add(const std::vector<std::string>& names, std::span<const float> values);
  void add(const std::vector<std::string>& names, std::span<const double> values);

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override;

 private:
  struct Column {
    const std::byte* values;
    std::size_t bytes;  ///< of one point
  };
  void add_column(const std::vector<std::string>& names, Type type, std::span<const std::byte> values);

  std::vector<Column> columns_;
};

/// Collects the fields `names` of the plan into `values`, N×names.size(), those of one point side by side.
/// T is float, double, std::uint32_t or std::uint64_t. The path of the plan is not used.
template <class T>
class ArrayWriter final : public Writer {
 public:
  /// Throws UsageError if a field is missing or `values` has another size; both are borrowed until finish().
  ArrayWriter(const OutputPlan& plan, const std::vector<std::string>& names, std::span<T> values);

  void write(std::span<const std::byte> records) override;
  bool can_write_at() const override { return true; }
  void write_at(std::uint64_t row, std::span<const std::byte> records) override;
  void finish() override;

 private:
  std::vector<Field> fields_;  ///< one for each column of values, of one component each
  std::size_t stride_;
  std::span<T> values_;
  std::uint64_t count_;
  std::uint64_t rows_written_ = 0;
};

}  // namespace pointsweep
