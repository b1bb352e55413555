// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output_layout.h"

#include <cstring>

namespace pointsweep {

OutputLayout::OutputLayout(const Schema& input, const std::vector<Attribute>& made)
    : schema_(input), input_stride_(input.stride) {
  for (const Attribute& attribute : made) {
    for (const std::string& name : attribute.fields) {
      const Field from{.name = name, .type = attribute.type, .offset = result_stride_};
      const auto known = input.find(name);
      const std::size_t index = known ? *known : schema_.append(name, attribute.type);
      const Field& to = schema_.fields[index];
      appended_whole_ = appended_whole_ && !known && to.offset == input_stride_ + result_stride_;
      values_.push_back({from, to, to.is_plain() && to.type == from.type});
      result_stride_ += static_cast<std::uint32_t>(size_of(attribute.type));
    }
  }
}

void OutputLayout::assemble(const std::byte* inputs, const std::byte* results, std::size_t n,
                            std::byte* outputs) const {
  for (std::size_t i = 0; i < n; ++i, inputs += input_stride_, results += result_stride_, outputs += schema_.stride) {
    std::memcpy(outputs, inputs, input_stride_);
    if (appended_whole_) {
      std::memcpy(outputs + input_stride_, results, result_stride_);
      continue;
    }
    for (const Value& v : values_) {
      if (v.bitwise) {
        std::memcpy(outputs + v.to.offset, results + v.from.offset, size_of(v.from.type));
      } else {
        set_value(v.to, outputs, value_of(v.from, results));
      }
    }
  }
}

}  // namespace pointsweep
