// SPDX-License-Identifier: MIT
/// Joins components of different tiles along the edges between tiles, and numbers the components of the whole cloud.
#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <queue>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/fail.h"
#include "pointsweep/part/record_list.h"
#include "pointsweep/part/tile_graph.h"

namespace pointsweep {
namespace {

/// A component of a tile: the number of the tile, and the number of the component in the tile.
struct Node {
  std::uint64_t tile, number;

  friend auto operator<=>(const Node&, const Node&) = default;
};

/// The components of tiles that edges between tiles (crossings) touch, as disjoint sets: each set is one component of
/// the cloud.
class Joined {
 public:
  explicit Joined(const OpenVotes& votes) : votes_(votes) {}

  void join(Node a, Node b) {
    const std::uint32_t i = set_of(parents_, place_of(a)), j = set_of(parents_, place_of(b));
    parents_[i] = j;
  }
  /// Sums the points and votes of each set and concludes the votes. record(node) returns the record of a component of a
  /// tile; the calls go through the tiles in ascending order.
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

  /// A component of the cloud: sums over its components of tiles, and its number, once it has one.
  struct Whole {
    std::uint64_t points = 0;
    std::vector<std::byte> votes, result;
    bool counts = true;
    std::optional<std::uint64_t> number;
  };
  /// Returns the component of the cloud that holds `node`; null if no crossing touches `node`.
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
  std::vector<Whole> whole_;  ///< sums of each set, at the index of the representative of the set
};

/// Reads the components of a tile from the first to the last.
class ComponentReader {
 public:
  ComponentReader(const Storage& scratch, const std::string& name, std::size_t record_bytes)
      : list_(scratch, name + ".components", record_bytes), record_bytes_(record_bytes) {}
  /// Returns the next record, which is valid until the next call; null after the last record.
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

/// Writes the numbers of the components of all tiles into one list, in which the records of each tile keep their order.
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
  std::vector<std::vector<std::byte>> waiting_;  ///< records of each tile that are not written yet
  std::vector<std::vector<Segment>> segments_;   ///< for each tile, the segments of its written records
};

/// Joins the two components that each crossing connects. The crossings are sorted by the row to which they lead, so
/// that the labels of each tile are opened once.
void join_crossings(const Storage& scratch, const TileCatalogue& tiles, const std::vector<std::string>& names,
                    const TileGraphSetup& setup, Joined& joined) {
  struct From {
    std::uint64_t to;
    Node node;
    auto operator<=>(const From&) const = default;
  };
  const auto crossings_of = [&](std::size_t t) {
    return RecordList(scratch, names[t] + ".crossings", sizeof(Crossing));
  };
  std::uint64_t count = 0;
  for (std::size_t t = 0; t < names.size(); ++t) count += crossings_of(t).count();
  SortedRecords<From, std::less<>> all(setup.make_scratch, setup.memory_bytes, count);
  for (std::size_t t = 0; t < names.size(); ++t)
    for_each_piece<Crossing>(crossings_of(t), [&](std::uint64_t, std::span<const Crossing> crossings) {
      for (const Crossing& c : crossings) all.add({c.from, {t, c.to}});
    });
  all.finish();
  std::size_t tile = names.size();
  std::optional<RecordList> labels;
  for (std::optional<From> next = all.next(); next; next = all.next()) {
    if (const std::size_t of_row = tiles.tile_of(next->to); of_row != tile) {
      tile = of_row;
      labels.emplace(scratch, names[tile] + ".labels", sizeof(std::uint64_t));
    }
    std::uint64_t number;
    labels->read(next->to - tiles.tiles[tile].first_row, std::as_writable_bytes(std::span(&number, 1)));
    if (number == kNoLabel) fail("{}.labels: is damaged.", names[tile]);
    joined.join(next->node, {tile, number});
  }
}

/// Numbers the components of the whole cloud in the order of their first points. A component that its votes exclude
/// (VoteRule::counts()) gets ComponentLabel::kNone.
void number_components(Storage& scratch, const std::vector<std::string>& names, const OpenVotes& votes, Joined& joined,
                       const std::string& key) {
  struct Front {
    PointKey first;
    std::size_t tile;
    const std::byte* record;
    bool operator<(const Front& other) const { return other.first < first; }  // the least key is on top of the queue
  };
  std::vector<std::unique_ptr<ComponentReader>> readers;
  std::priority_queue<Front> fronts;
  const auto advance = [&](std::size_t tile) {
    if (const std::byte* const record = readers[tile]->next()) fronts.push({component_at(record).first, tile, record});
  };
  NumbersWriter numbers(scratch, key, names.size(), kNumberedBytes + votes.concluded_bytes());
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
      std::ranges::copy(whole->result, to + kNumberedBytes);
    } else {
      const bool counts = votes.conclude_to(front.record + kComponentBytes, to + kNumberedBytes);
      put_number(to, counts ? next++ : ComponentLabel::kNone, component_at(front.record).points);
    }
    advance(front.tile);
  }
  numbers.seal();
}

}  // namespace

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

}  // namespace pointsweep
