// SPDX-License-Identifier: MIT
#include "pointsweep/points/promised_type.h"

#include <fmt/format.h>

#include <cstring>
#include <utility>

namespace pointsweep {

PromisedType::PromisedType(Field stored, Type type)
    : stored_(std::move(stored)),
      promised_{.name = "", .type = type},
      bytes_(size_of(type)),
      is_copy_(stored_.type == type && stored_.is_plain()),
      holds_all_(holds_all_of(promised_, stored_)) {}

void PromisedType::convert(const std::byte* record, std::uint64_t row, std::byte* out, FirstRowError& refused) const {
  if (is_copy_) return void(std::memcpy(out, record + stored_.offset, bytes_));
  const double value = value_of(stored_, record);
  set_value(promised_, out, value);
  if (holds_all_ || holds(promised_, value)) return;
  refused.note(row, [&] {
    return RowSentence{"Row ", fmt::format(": '{}' is {}, which is not in the range of {}, the type that a stage "
                                           "reads; "
                                           "leave out such points by where() first.",
                                           stored_.name, value, name_of(promised_.type))};
  });
}

}  // namespace pointsweep
