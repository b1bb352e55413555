// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/sweep_progress.h"

namespace pointsweep {

void SweepProgress::pack(Packer& out) const {
  out.put(slabs_read);
  out.put(window);
  out.put(dropped);
  out.put(saturated_locations);
  out.put(deferred);
  for (const std::uint64_t count : {certified, recalled, recalled_slabs, peak_points}) out.put(count);
  out.put<std::uint64_t>(degenerate.size());
  for (const DegenerateRows& rows : degenerate) {
    out.put(rows.count());
    out.put(rows.lowest());
  }
}

SweepProgress SweepProgress::unpacked(Unpacker& packed) {
  SweepProgress p;
  p.slabs_read = packed.get<std::uint32_t>();
  p.window = packed.get_vector<WindowedCell>();
  p.dropped = packed.get_vector<DroppedCellOfSlab>();
  p.saturated_locations = packed.get_vector<SaturatedLocation>();
  p.deferred = packed.get_vector<DeferredPoint>();
  for (std::uint64_t* count : {&p.certified, &p.recalled, &p.recalled_slabs, &p.peak_points})
    *count = packed.get<std::uint64_t>();
  for (auto stages = packed.get<std::uint64_t>(); stages > 0; --stages) {
    const auto count = packed.get<std::uint64_t>();
    p.degenerate.emplace_back(count, packed.get_vector<std::uint64_t>());
  }
  return p;
}

}  // namespace pointsweep
