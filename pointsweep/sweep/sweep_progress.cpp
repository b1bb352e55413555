// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/sweep_progress.h"

namespace pointsweep {

void SweepProgress::pack(Packer& out) const {
  out.put(slabs_read);
  out.put(window);
  out.put(dropped);
  out.put(full_places);
  out.put(deferred);
  for (const std::uint64_t count : {certified, recalled, recalled_slabs, degenerate, peak_points}) out.put(count);
}

SweepProgress SweepProgress::unpacked(Unpacker& packed) {
  SweepProgress p;
  p.slabs_read = packed.get<std::uint32_t>();
  p.window = packed.get_vector<WindowedCell>();
  p.dropped = packed.get_vector<DroppedCell>();
  p.full_places = packed.get_vector<FullPlace>();
  p.deferred = packed.get_vector<DeferredPoint>();
  for (std::uint64_t* count : {&p.certified, &p.recalled, &p.recalled_slabs, &p.degenerate, &p.peak_points})
    *count = packed.get<std::uint64_t>();
  return p;
}

}  // namespace pointsweep
