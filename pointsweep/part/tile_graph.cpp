// SPDX-License-Identifier: MIT
#include "pointsweep/part/tile_graph.h"

#include <algorithm>
#include <cstring>
#include <optional>

#include "pointsweep/cancellation.h"
#include "pointsweep/connect/components.h"
#include "pointsweep/fail.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/part/record_list.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {
namespace {

/// Writes the labels of all rows to NAME.labels. Adds each crossing to `by_target` with `from`, the row in the other
/// tile, and `to`, the number of the component in this tile.
void write_labels(RowStore& labels, SortedCrossings& by_row, SortedRecords<Crossing, std::less<>>& by_target,
                  Storage& scratch, const std::string& name, std::uint64_t first_row) {
  RecordListWriter list(scratch, name + ".labels", sizeof(std::uint64_t));
  std::optional<Crossing> next = by_row.next();
  labels.drain([&](std::uint64_t first, std::span<const std::byte> records) {
    stop_if_cancelled();
    list.append(records);
    for (; next && next->from - first_row < first + records.size() / sizeof(std::uint64_t); next = by_row.next()) {
      std::uint64_t component;
      std::memcpy(&component, records.data() + (next->from - first_row - first) * sizeof component, sizeof component);
      by_target.add({next->to, component});
    }
  });
  list.seal();
}

void write_crossings(SortedCrossings& by_target, Storage& scratch, const std::string& name) {
  RecordListWriter list(scratch, name + ".crossings", sizeof(Crossing));
  std::optional<Crossing> last;
  for (std::optional<Crossing> next = by_target.next(); next; next = by_target.next()) {
    if (next != last) list.append(std::as_bytes(std::span(&*next, 1)));
    last = next;
  }
  list.seal();
}

std::vector<Segment> segments_of(const Storage& scratch, const std::string& key) {
  return sealed_value(scratch, key, [](Decoder& in) {
    in.begin(kSegmentsEncoding);
    return in.get_list<Segment>([&] {
      const auto first = in.get<std::uint64_t>();
      return Segment{first, in.get<std::uint64_t>()};
    });
  });
}

}  // namespace

void TileEdges::put(const EdgeBatch& batch, std::size_t own, std::span<const std::byte> ballots) {
  const auto is_own = [&](const PointKey& point) { return rows_.has(point.row); };
  if (std::ranges::all_of(batch.points(), is_own)) return own_.put(batch, own, ballots);
  EdgeBatch among;
  std::vector<ForestEdge> crossings;
  for (std::uint32_t i = 0; i < own; ++i) among.number_of(batch.points()[i]);
  for (const EdgeBatch::Edge& edge : batch.edges()) {
    const PointKey &a = batch.points()[edge.a], &b = batch.points()[edge.b];
    if (is_own(a) && is_own(b))
      among.add(among.number_of(a), among.number_of(b), edge.weight, edge.flips);
    else
      crossings.push_back(batch.forest_edge(edge));
  }
  own_.put(among, own, ballots);
  const std::scoped_lock lock(mutex_);
  take_crossings_(crossings);
}

void leave_graph(const EdgeBuckets& own, SortedCrossings& crossings, RowsOfTile rows, const TileGraphSetup& setup,
                 Storage& scratch, const std::string& name) {
  const OpenVotes votes(setup.votes);
  const ComponentsSetup of_tile{&votes, setup.make_scratch, setup.memory_bytes / 4, setup.progress};
  const Components components(own, of_tile);
  RowStore labels = store_of_labels(rows.count, setup);
  BatchedRows put(labels, sizeof kNoLabel);
  components.for_each_point([&](std::uint64_t row, const ComponentLabel& label) {
    std::memcpy(put.add(row - rows.first), &label.number, sizeof label.number);
  });
  put.flush();
  crossings.finish();
  SortedCrossings by_target(setup.make_scratch, setup.memory_bytes / 4, crossings.count());
  write_labels(labels, crossings, by_target, scratch, name, rows.first);
  by_target.finish();
  write_crossings(by_target, scratch, name);
  RecordListWriter list(scratch, name + ".components", kComponentBytes + votes.bytes());
  components.for_each_component([&](const FinishedComponent& component, const std::byte* result) {
    std::vector<std::byte> record(kComponentBytes + votes.bytes());
    std::memcpy(record.data(), &component.first, sizeof component.first);
    std::memcpy(record.data() + sizeof component.first, &component.points, sizeof component.points);
    std::copy_n(result, votes.bytes(), record.data() + kComponentBytes);
    list.append(record);
  });
  list.seal();
}

void leave_no_graph(const VoteRule* votes, Storage& scratch, const std::string& name) {
  RecordListWriter(scratch, name + ".labels", sizeof(std::uint64_t)).seal();
  RecordListWriter(scratch, name + ".components", kComponentBytes + OpenVotes(votes).bytes()).seal();
  RecordListWriter(scratch, name + ".crossings", sizeof(Crossing)).seal();
}

void for_each_label(const Storage& scratch, const std::string& name, const std::string& key, std::size_t tile,
                    const TileGraphSetup& setup,
                    const std::function<void(std::uint64_t row, const ComponentLabel& label)>& use) {
  struct LabelOfRow {
    std::uint64_t component, row;
    auto operator<=>(const LabelOfRow&) const = default;
  };
  const RecordList list(scratch, name + ".labels", sizeof(std::uint64_t));
  SortedRecords<LabelOfRow, std::less<>> sorted(setup.make_scratch, setup.memory_bytes, list.count());
  for_each_piece<std::uint64_t>(list, [&](std::uint64_t first, std::span<const std::uint64_t> labels) {
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (labels[i] != kNoLabel) sorted.add({labels[i], first + i});
  });
  sorted.finish();
  std::vector<std::byte> record(kNumberedBytes + OpenVotes(setup.votes).concluded_bytes());
  RecordList numbers(scratch, key + ".numbers", record.size());
  std::optional<LabelOfRow> next = sorted.next();
  std::uint64_t component = 0;
  for (const Segment& segment : segments_of(scratch, key + "-" + std::to_string(tile))) {
    for (std::uint64_t i = 0; i < segment.count; ++i, ++component) {
      numbers.read(segment.first + i, record);
      ComponentLabel label{.result = record.data() + kNumberedBytes};
      std::memcpy(&label.number, record.data(), sizeof label.number);
      std::memcpy(&label.points, record.data() + sizeof label.number, sizeof label.points);
      for (; next && next->component == component; next = sorted.next()) use(next->row, label);
    }
  }
  if (next) fail("{}.labels: is damaged.", name);
}

}  // namespace pointsweep
