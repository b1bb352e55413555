// SPDX-License-Identifier: MIT
/// How a record of the output is put together from a record of the input and what the operators made.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pointsweep/points/attribute.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// The input's record unchanged, then the made values; one that the input already has is replaced where it stands.
class OutputLayout {
 public:
  OutputLayout(const Schema& input, const std::vector<Attribute>& made);

  const Schema& schema() const { return schema_; }
  /// `inputs` holds n records of the input, `results` n result records, `outputs` receives n records of schema().
  void assemble(const std::byte* inputs, const std::byte* results, std::size_t n, std::byte* outputs) const;

 private:
  struct Value {
    Field from, to;
    bool bitwise;
    std::uint32_t bytes;
  };
  void add(const Value& value);

  Schema schema_;
  std::uint32_t input_stride_;
  std::uint32_t result_stride_ = 0;
  std::vector<Value> values_;
};

}  // namespace pointsweep
