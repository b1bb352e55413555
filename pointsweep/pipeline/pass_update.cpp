// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/pass_update.h"

#include <algorithm>
#include <cstring>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

/// The rows of the cloud before any select.
std::uint64_t all_rows(const InputCloud& cloud) {
  return cloud.selection() ? cloud.selection()->rows() : cloud.count();
}

}  // namespace

PassUpdate::PassUpdate(const PlannedPass& pass, InputCloud& cloud, std::size_t carried_bytes, const SpillPlace& rows,
                       const SpillPlace& mask)
    : cloud_(cloud),
      carried_bytes_(carried_bytes),
      made_bytes_(pass.plan.result_bytes),
      rows_(std::make_unique<RowFile>(cloud.count(), carried_bytes, rows)),
      values_(pass, cloud.schema()) {
  if (!pass.selects) return;
  mask_.emplace(all_rows(cloud), cloud.selection(), mask);
  for (const Attribute& a : pass.made) {
    if (a.name == selection_attribute().name) return;
    selection_at_ += a.bytes();
  }
}

std::uint64_t PassUpdate::add(const UpdatedRows& rows) {
  const bool reads = values_.needs_input();
  if (reads) {
    inputs_.resize(rows.count * cloud_.schema().stride);
    if (cloud_.read(rows.first, inputs_) != rows.count)
      fail("The input ended at row {} although it had {} points: it changed while it was read.", rows.first,
           cloud_.count());
  }
  carried_.assign(rows.after, rows.after + rows.count * carried_bytes_);
  const std::size_t left = mask_ ? leave_out(rows) : rows.count;
  rows_->append(carried_);
  values_.add(carried_.data(), reads ? inputs_.data() : nullptr, left);
  return reads ? rows.count * cloud_.schema().stride : 0;
}

/// Leaves the rows that are kept in carried_ and inputs_, and returns how many they are.
std::size_t PassUpdate::leave_out(const UpdatedRows& rows) {
  kept_.assign(rows.count, false);
  for (std::size_t i = 0; i < rows.count; ++i) {
    kept_[i] = rows.made[i * made_bytes_ + selection_at_] != std::byte{0};
    mask_->append(kept_[i]);
  }
  compact(carried_, carried_bytes_, kept_);
  if (values_.needs_input()) compact(inputs_, cloud_.schema().stride, kept_);
  return static_cast<std::size_t>(std::ranges::count(kept_, true));
}

void PassUpdate::compact(std::vector<std::byte>& records, std::size_t bytes, const std::vector<bool>& kept) {
  if (bytes == 0) return;
  std::byte* to = records.data();
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (!kept[i]) continue;
    if (to != records.data() + i * bytes) std::memcpy(to, records.data() + i * bytes, bytes);
    to += bytes;
  }
  records.resize(static_cast<std::size_t>(to - records.data()));
}

std::unique_ptr<RowFile> PassUpdate::finish(CloudValues& values) {
  values_.finish(values);
  spilled_bytes_ = rows_->spilled_bytes();
  if (mask_) {
    RowSelection left = mask_->finish();
    spilled_bytes_ += mask_->spilled_bytes();
    cloud_.select(std::move(left));
  }
  return std::move(rows_);
}

}  // namespace pointsweep
