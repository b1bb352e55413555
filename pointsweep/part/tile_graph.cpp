// SPDX-License-Identifier: MIT
#include "pointsweep/part/tile_graph.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/connect/components.h"
#include "pointsweep/connect/disjoint_sets.h"
#include "pointsweep/fail.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/part/record_list.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kNoLabel = ~std::uint64_t{0};
constexpr std::size_t kAtOnce = 4096;
constexpr Encoding kSegmentsEncoding{"joined components of a tile", 1};

/// Votes that are not concluded, so that components can be joined. No sign is turned in a graph without weights.
class OpenVotes final : public VoteRule {
 public:
  explicit OpenVotes(const VoteRule* rule) : rule_(rule) {}
  std::size_t ballot_bytes() const override { return rule_ != nullptr ? rule_->ballot_bytes() : 0; }
  std::size_t bytes() const override { return rule_ != nullptr ? rule_->bytes() : 0; }
  void start(std::byte* votes, const PointKey& point, const std::byte* ballot) const override {
    if (rule_ != nullptr) rule_->start(votes, point, ballot);
  }
  void merge(std::byte* into, const std::byte* from, bool flips) const override {
    if (rule_ != nullptr) rule_->merge(into, from, flips);
  }
  std::size_t result_bytes() const override { return bytes(); }
  void conclude(const std::byte* votes, std::byte* result) const override { std::copy_n(votes, bytes(), result); }

  /// Of the rule itself.
  std::size_t concluded_bytes() const { return rule_ != nullptr ? rule_->result_bytes() : 0; }
  /// Sets the result, and returns whether the component gets a number.
  bool conclude_to(const std::byte* votes, std::byte* result) const {
    if (rule_ == nullptr) return true;
    rule_->conclude(votes, result);
    return rule_->counts(result);
  }

 private:
  const VoteRule* rule_;
};

/// A component of a tile, as bytes: a FinishedComponent, then its votes.
constexpr std::size_t kComponentBytes = sizeof(PointKey) + sizeof(std::uint64_t);

FinishedComponent component_at(const std::byte* record) {
  FinishedComponent component;
  std::memcpy(&component.first, record, sizeof component.first);
  std::memcpy(&component.points, record + sizeof component.first, sizeof component.points);
  return component;
}

/// A component of the cloud as each of its tiles knows it, as bytes: its number and points, then the result of its
/// votes.
constexpr std::size_t kNumberBytes = 2 * sizeof(std::uint64_t);

void put_number(std::byte* record, std::uint64_t number, std::uint64_t points) {
  std::memcpy(record, &number, sizeof number);
  std::memcpy(record + sizeof number, &points, sizeof points);
}

/// Writes the labels of all rows, and the crossings with the components in which they begin in the place of their rows.
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

/// Which tile has a row.
std::size_t tile_of(const TileCatalogue& tiles, std::uint64_t row) {
  const auto after = std::ranges::upper_bound(tiles.tiles, row, {}, &TileSummary::first_row);
  std::size_t tile = static_cast<std::size_t>(after - tiles.tiles.begin());
  do {
    if (tile-- == 0) fail("a tile names row {}, which no tile has.", row);
  } while (row - tiles.tiles[tile].first_row >= tiles.tiles[tile].rows);
  return tile;
}

/// A component of a tile.
struct Node {
  std::uint64_t tile, number;

  friend auto operator<=>(const Node&, const Node&) = default;
};

/// The components that crossings join.
class Joined {
 public:
  explicit Joined(const OpenVotes& votes) : votes_(votes) {}

  void join(Node a, Node b) {
    const std::uint32_t i = set_of(parents_, place_of(a)), j = set_of(parents_, place_of(b));
    parents_[i] = j;
  }
  /// Adds up points and votes; `record(node)` is that of its component, asked for tile by tile in ascending order.
  template <class Record>
  void add_up(Record record) {
    whole_.resize(parents_.size());
    for (const auto& [node, place] : places_) {
      const std::byte* const component = record(node);
      Whole& whole = whole_[set_of(parents_, place)];
      whole.points += component_at(component).points;
      const std::byte* const votes = component + kComponentBytes;
      if (whole.votes.empty())
        whole.votes.assign(votes, votes + votes_.bytes());
      else
        votes_.merge(whole.votes.data(), votes, false);
    }
    for (Whole& whole : whole_) {
      if (whole.points == 0) continue;
      whole.result.resize(votes_.concluded_bytes());
      whole.counts = votes_.conclude_to(whole.votes.data(), whole.result.data());
    }
  }

  struct Whole {
    std::uint64_t points = 0;
    std::vector<std::byte> votes, result;
    bool counts = true;
    std::optional<std::uint64_t> number;
  };
  /// Returns the component of the cloud that a component of a tile is in; null if no crossing touches it.
  Whole* find(Node node) {
    const auto found = places_.find(node);
    return found == places_.end() ? nullptr : &whole_[set_of(parents_, found->second)];
  }

 private:
  std::uint32_t place_of(Node node) {
    const auto [known, is_new] = places_.try_emplace(node, static_cast<std::uint32_t>(parents_.size()));
    if (!is_new) return known->second;
    if (parents_.size() >= ~std::uint32_t{0}) fail("Crossings touch more than {} components.", parents_.size());
    parents_.push_back(known->second);
    return known->second;
  }

  const OpenVotes& votes_;
  std::map<Node, std::uint32_t> places_;
  std::vector<std::uint32_t> parents_;
  std::vector<Whole> whole_;  ///< by representative
};

/// Reads the components of a tile from the first to the last.
class ComponentReader {
 public:
  ComponentReader(const Storage& scratch, const std::string& name, std::size_t record_bytes)
      : list_(scratch, name + ".components", record_bytes), record_bytes_(record_bytes) {}
  /// Returns the next record; null after the last one.
  const std::byte* next() {
    if (at_ == block_.size() && !fill()) return nullptr;
    at_ += record_bytes_;
    return block_.data() + at_ - record_bytes_;
  }

 private:
  static constexpr std::uint64_t kBlockRecords = 64;
  bool fill() {
    const std::uint64_t n = std::min(kBlockRecords, list_.count() - first_);
    block_.resize(n * record_bytes_);
    list_.read(first_, block_);
    first_ += n;
    at_ = 0;
    return n > 0;
  }

  RecordList list_;
  std::size_t record_bytes_;
  std::uint64_t first_ = 0;
  std::vector<std::byte> block_;
  std::size_t at_ = 0;
};

/// Records of KEY.numbers that follow each other, of components of one tile.
struct Segment {
  std::uint64_t first, count;
};

/// Writes the numbers of the components of all tiles, those of each tile in order.
class NumbersWriter {
 public:
  NumbersWriter(Storage& scratch, std::string key, std::size_t tiles, std::size_t record_bytes)
      : scratch_(scratch),
        key_(std::move(key)),
        list_(scratch, key_ + ".numbers", record_bytes),
        record_bytes_(record_bytes),
        waiting_(tiles),
        segments_(tiles) {}

  std::byte* add(std::size_t tile) {
    std::vector<std::byte>& waiting = waiting_[tile];
    if (waiting.size() == kWaiting * record_bytes_) flush(tile);
    waiting.resize(waiting.size() + record_bytes_);
    return waiting.data() + waiting.size() - record_bytes_;
  }
  void seal() {
    for (std::size_t t = 0; t < waiting_.size(); ++t) {
      flush(t);
      Encoder out;
      out.begin(kSegmentsEncoding);
      out.put_list(segments_[t], [&](const Segment& segment) {
        out.put<std::uint64_t>(segment.first);
        out.put<std::uint64_t>(segment.count);
      });
      seal_bytes(scratch_, key_ + "-" + std::to_string(t), out.bytes());
    }
    list_.seal();
  }

 private:
  static constexpr std::size_t kWaiting = 128;
  void flush(std::size_t tile) {
    std::vector<std::byte>& waiting = waiting_[tile];
    if (waiting.empty()) return;
    segments_[tile].push_back({list_.count(), waiting.size() / record_bytes_});
    list_.append(waiting);
    waiting.clear();
  }

  Storage& scratch_;
  std::string key_;
  RecordListWriter list_;
  std::size_t record_bytes_;
  std::vector<std::vector<std::byte>> waiting_;  ///< by tile
  std::vector<std::vector<Segment>> segments_;   ///< by tile
};

/// Joins what crossings join: rows that are named come in ascending order, tile by tile.
void join_crossings(const Storage& scratch, const TileCatalogue& tiles, const std::vector<std::string>& names,
                    const TileGraphSetup& setup, Joined& joined) {
  struct From {
    std::uint64_t to;
    Node node;
    bool operator<(const From& other) const { return std::tie(to, node) < std::tie(other.to, other.node); }
  };
  SortedRecords<From, std::less<>> all(setup.make_scratch, setup.memory_bytes, ~std::uint64_t{0} >> 32);
  for (std::size_t t = 0; t < names.size(); ++t) {
    RecordList list(scratch, names[t] + ".crossings", sizeof(Crossing));
    std::vector<Crossing> crossings;
    for (std::uint64_t first = 0; first < list.count(); first += crossings.size()) {
      stop_if_cancelled();
      crossings.resize(std::min<std::uint64_t>(kAtOnce, list.count() - first));
      list.read(first, std::as_writable_bytes(std::span(crossings)));
      for (const Crossing& c : crossings) all.add({c.from, {t, c.to}});
    }
  }
  all.finish();
  std::size_t tile = names.size();
  std::optional<RecordList> labels;
  for (std::optional<From> next = all.next(); next; next = all.next()) {
    if (const std::size_t of_row = tile_of(tiles, next->to); of_row != tile) {
      tile = of_row;
      labels.emplace(scratch, names[tile] + ".labels", sizeof(std::uint64_t));
    }
    std::uint64_t number;
    labels->read(next->to - tiles.tiles[tile].first_row, std::as_writable_bytes(std::span(&number, 1)));
    if (number == kNoLabel) fail("{}.labels: is damaged.", names[tile]);
    joined.join(next->node, {tile, number});
  }
}

/// Numbers the components of all tiles in the order of their first points.
void number_components(Storage& scratch, const std::vector<std::string>& names, const OpenVotes& votes, Joined& joined,
                       const std::string& key) {
  struct Front {
    PointKey first;
    std::size_t tile;
    const std::byte* record;
    bool operator<(const Front& other) const { return other.first < first; }  // the least is on top
  };
  std::vector<std::unique_ptr<ComponentReader>> readers;
  std::priority_queue<Front> fronts;
  const auto advance = [&](std::size_t tile) {
    if (const std::byte* const record = readers[tile]->next()) fronts.push({component_at(record).first, tile, record});
  };
  NumbersWriter numbers(scratch, key, names.size(), kNumberBytes + votes.concluded_bytes());
  std::vector<std::uint64_t> done(names.size());
  std::uint64_t next = 0;
  for (std::size_t t = 0; t < names.size(); ++t) {
    readers.push_back(std::make_unique<ComponentReader>(scratch, names[t], kComponentBytes + votes.bytes()));
    advance(t);
  }
  while (!fronts.empty()) {
    stop_if_cancelled();
    const Front front = fronts.top();
    fronts.pop();
    std::byte* const to = numbers.add(front.tile);
    Joined::Whole* const whole = joined.find({front.tile, done[front.tile]++});
    if (whole != nullptr) {
      if (!whole->number) whole->number = whole->counts ? next++ : ComponentLabel::kNone;
      put_number(to, *whole->number, whole->points);
      std::ranges::copy(whole->result, to + kNumberBytes);
    } else {
      const bool counts = votes.conclude_to(front.record + kComponentBytes, to + kNumberBytes);
      put_number(to, counts ? next++ : ComponentLabel::kNone, component_at(front.record).points);
    }
    advance(front.tile);
  }
  numbers.seal();
}

std::vector<Segment> segments_of(const Storage& scratch, const std::string& key) {
  const std::optional<std::vector<std::byte>> bytes = sealed_bytes(scratch, key);
  if (!bytes) fail("{}: is damaged.", key);
  Decoder in(*bytes);
  in.begin(kSegmentsEncoding);
  std::vector<Segment> segments = in.get_list<Segment>([&] {
    const auto first = in.get<std::uint64_t>();
    return Segment{first, in.get<std::uint64_t>()};
  });
  in.finish();
  return segments;
}

}  // namespace

TileEdges::TileEdges(EdgeBuckets& own, RowsOfTile rows, const MakeScratch& make_scratch, std::uint64_t memory_bytes)
    : own_(own), rows_(rows), crossings_(make_scratch, memory_bytes, rows.count) {}

void TileEdges::put(const EdgeBatch& batch, std::size_t own, std::span<const std::byte> ballots) {
  const auto row = [&](std::uint32_t point) { return batch.points()[point].row; };
  EdgeBatch among;
  std::vector<Crossing> crossings;
  for (std::uint32_t i = 0; i < own; ++i) among.number_of(batch.points()[i]);
  for (const EdgeBatch::Edge& edge : batch.edges()) {
    const bool has_a = rows_.has(row(edge.a)), has_b = rows_.has(row(edge.b));
    if (has_a && has_b)
      among.add(among.number_of(batch.points()[edge.a]), among.number_of(batch.points()[edge.b]), 0, false);
    else
      crossings.push_back(has_a ? Crossing{row(edge.a), row(edge.b)} : Crossing{row(edge.b), row(edge.a)});
  }
  own_.put(among, own, ballots);
  const std::scoped_lock lock(mutex_);
  for (const Crossing& crossing : crossings) crossings_.add(crossing);
}

void leave_graph(const EdgeBuckets& own, TileEdges& edges, RowsOfTile rows, const TileGraphSetup& setup,
                 Storage& scratch, const std::string& name) {
  const OpenVotes votes(setup.votes);
  const ComponentsSetup of_tile{&votes, setup.make_scratch, setup.memory_bytes / 4, setup.progress};
  const Components components(own, of_tile);
  std::vector<std::byte> none(sizeof kNoLabel);
  std::memcpy(none.data(), &kNoLabel, sizeof kNoLabel);
  RowStore labels(rows.count, none, setup.spill, std::max<std::uint64_t>(setup.memory_bytes / 4, 1 << 20));
  std::vector<std::uint64_t> some, numbers;
  const auto put = [&] {
    labels.put(some, std::as_bytes(std::span(numbers)));
    some.clear();
    numbers.clear();
  };
  components.for_each_point([&](std::uint64_t row, const ComponentLabel& label) {
    some.push_back(row - rows.first);
    numbers.push_back(label.number);
    if (some.size() == kAtOnce) put();
  });
  put();
  edges.crossings().finish();
  SortedCrossings by_target(setup.make_scratch, setup.memory_bytes / 4, edges.crossings().count());
  write_labels(labels, edges.crossings(), by_target, scratch, name, rows.first);
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

void join_graphs(Storage& scratch, const TileCatalogue& tiles, const std::vector<std::string>& names,
                 const TileGraphSetup& setup, const std::string& key) {
  const OpenVotes votes(setup.votes);
  Joined joined(votes);
  join_crossings(scratch, tiles, names, setup, joined);
  std::size_t tile = names.size();
  std::optional<RecordList> components;
  std::vector<std::byte> record(kComponentBytes + votes.bytes());
  joined.add_up([&](const Node& node) {
    if (node.tile != tile) {
      tile = node.tile;
      components.emplace(scratch, names[tile] + ".components", record.size());
    }
    components->read(node.number, record);
    return record.data();
  });
  number_components(scratch, names, votes, joined, key);
  seal_bytes(scratch, key, {});
}

void for_each_label(const Storage& scratch, const std::string& name, const std::string& key, std::size_t tile,
                    const TileGraphSetup& setup,
                    const std::function<void(std::uint64_t row, const ComponentLabel& label)>& use) {
  struct LabelOfRow {
    std::uint64_t component, row;
    auto operator<=>(const LabelOfRow&) const = default;
  };
  RecordList labels(scratch, name + ".labels", sizeof(std::uint64_t));
  SortedRecords<LabelOfRow, std::less<>> sorted(setup.make_scratch, setup.memory_bytes, labels.count());
  std::array<std::uint64_t, kAtOnce> some;
  for (std::uint64_t first = 0; first < labels.count(); first += some.size()) {
    stop_if_cancelled();
    const std::size_t n = std::min<std::uint64_t>(some.size(), labels.count() - first);
    labels.read(first, std::as_writable_bytes(std::span(some).first(n)));
    for (std::size_t i = 0; i < n; ++i)
      if (some[i] != kNoLabel) sorted.add({some[i], first + i});
  }
  sorted.finish();
  std::vector<std::byte> record(kNumberBytes + OpenVotes(setup.votes).concluded_bytes());
  RecordList numbers(scratch, key + ".numbers", record.size());
  std::optional<LabelOfRow> next = sorted.next();
  std::uint64_t component = 0;
  for (const Segment& segment : segments_of(scratch, key + "-" + std::to_string(tile))) {
    for (std::uint64_t i = 0; i < segment.count; ++i, ++component) {
      numbers.read(segment.first + i, record);
      ComponentLabel label{.result = record.data() + kNumberBytes};
      std::memcpy(&label.number, record.data(), sizeof label.number);
      std::memcpy(&label.points, record.data() + sizeof label.number, sizeof label.points);
      for (; next && next->component == component; next = sorted.next()) use(next->row, label);
    }
  }
  if (next) fail("{}.labels: is damaged.", name);
}

}  // namespace pointsweep
