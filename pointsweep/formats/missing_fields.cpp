// SPDX-License-Identifier: MIT
#include "pointsweep/formats/missing_fields.h"

#include "pointsweep/formats/las_origin.h"

namespace pointsweep {
namespace {

constexpr int kOverlapClass = 12;  ///< LAS 1.4 R15, Table 9

}  // namespace

MissingFields::MissingFields(const FileInfo& input, const Schema& common) {
  const char* const kReturns[] = {"return_number", "number_of_returns"};
  if (!input.schema.find(kReturns[0]) && !input.schema.find(kReturns[1])) {
    for (const char* name : kReturns)
      if (const auto at = common.find(name)) ones_.push_back(common.fields[*at]);
  }
  const auto overlap = common.find("overlap"), classification = common.find("classification");
  if (overlap && classification && input.las && input.las->overlap_is_class_12)
    overlap_.emplace(common.fields[*classification], common.fields[*overlap]);
}

void MissingFields::run(std::span<std::byte> records, std::size_t stride) const {
  for (std::size_t at = 0; at + stride <= records.size(); at += stride) {
    std::byte* const record = records.data() + at;
    for (const Field& field : ones_) set_value(field, record, 1);
    if (overlap_ && value_of(overlap_->first, record) == kOverlapClass) set_value(overlap_->second, record, 1);
  }
}

}  // namespace pointsweep
