// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/checkpoint/checkpoint.h"

#include <array>
#include <cstdint>

namespace pointsweep {
namespace {

constexpr Encoding kCheckpointEncoding{"checkpoint", 1};
constexpr std::array kCounts = {&Statistics::sweeps,     &Statistics::certified, &Statistics::recalled,
                                &Statistics::degenerate, &Statistics::nonfinite, &Statistics::peak_points};

}  // namespace

void take_counts(Statistics& to, const Statistics& from) {
  for (const auto count : kCounts) to.*count = from.*count;
  to.degenerate_results = from.degenerate_results;
}

void Checkpoint::encode(Encoder& out) const {
  out.begin(kCheckpointEncoding);
  out.put<std::uint64_t>(memory_bytes);
  survey.encode(out);
  out.put<std::uint64_t>(sweep);
  out.put<std::uint64_t>(slab_points);
  for (const auto& part : {&stream, &results, &progress}) out.put_bytes(*part);
  out.put_list(bucket_places, [&](Vec3 p) { out.put_point(p); });
  out.put<std::uint64_t>(mask);
  out.put_list(values, [&](const std::vector<double>& value) { out.put_numbers<double>(value); });
  for (const auto count : kCounts) out.put<std::uint64_t>(counts.*count);
  out.put_list(counts.degenerate_results, [&](const DegenerateResults& results_of_stage) {
    out.put_text(results_of_stage.stage);
    out.put<std::uint64_t>(results_of_stage.count);
    out.put_numbers<std::uint64_t>(results_of_stage.rows);
  });
}

Checkpoint Checkpoint::decode(Decoder& in) {
  in.begin(kCheckpointEncoding);
  Checkpoint c;
  c.memory_bytes = in.get<std::uint64_t>();
  c.survey = Survey::decode(in);
  c.sweep = in.get<std::uint64_t>();
  c.slab_points = in.get<std::uint64_t>();
  for (auto* part : {&c.stream, &c.results, &c.progress}) *part = in.get_bytes();
  c.bucket_places = in.get_list<Vec3>([&] { return in.get_point(); });
  c.mask = in.get<std::uint64_t>();
  c.values = in.get_list<std::vector<double>>([&] { return in.get_numbers<double>(); });
  for (const auto count : kCounts) c.counts.*count = in.get<std::uint64_t>();
  c.counts.degenerate_results = in.get_list<DegenerateResults>([&] {
    return DegenerateResults{in.get_text(), in.get<std::uint64_t>(), in.get_numbers<std::uint64_t>()};
  });
  return c;
}

}  // namespace pointsweep
