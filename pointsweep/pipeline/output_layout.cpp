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
      add({from, to, to.is_plain() && to.type == from.type, static_cast<std::uint32_t>(size_of(attribute.type))});
      result_stride_ += static_cast<std::uint32_t>(size_of(attribute.type));
    }
  }
}

/// Values that lie side by side in both records are copied at once.
void OutputLayout::add(const Value& value) {
  if (!values_.empty()) {
    Value& last = values_.back();
    if (last.bitwise && value.bitwise && last.from.offset + last.bytes == value.from.offset &&
        last.to.offset + last.bytes == value.to.offset) {
      last.bytes += value.bytes;
      return;
    }
  }
  values_.push_back(value);
}

void OutputLayout::assemble(const std::byte* inputs, const std::byte* results, std::size_t n,
                            std::byte* outputs) const {
  for (std::size_t i = 0; i < n; ++i, inputs += input_stride_, results += result_stride_, outputs += schema_.stride) {
    std::memcpy(outputs, inputs, input_stride_);
    for (const Value& v : values_) {
      if (v.bitwise) {
        std::memcpy(outputs + v.to.offset, results + v.from.offset, v.bytes);
      } else {
        set_value(v.to, outputs, value_of(v.from, results));
      }
    }
  }
}

}  // namespace pointsweep
