// SPDX-License-Identifier: MIT
#include "pointsweep/connect/components.h"

#include <cstring>
#include <functional>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/connect/bucketed_graph.h"
#include "pointsweep/connect/spanning_forest.h"
#include "pointsweep/points/sorted_records.h"

namespace pointsweep {
namespace {

/// The index of a component in the log, and its first point, by which components are numbered.
struct FirstOfComponent {
  PointKey first;
  std::uint64_t component;
  friend bool operator<(const FirstOfComponent& a, const FirstOfComponent& b) { return a.first < b.first; }
};
using ByFirstPoint = SortedRecords<FirstOfComponent, std::less<>>;

/// The index of a component in the log, and the number that the component gets. Sorts from the last index to the first,
/// the order in which ForestLog::for_each_point() visits components.
struct ComponentNumber {
  std::uint64_t component, number;
  friend bool operator<(const ComponentNumber& a, const ComponentNumber& b) { return a.component > b.component; }
};
using Numbers = SortedRecords<ComponentNumber, std::less<>>;

FinishedComponent component_in(const std::byte* record) {
  FinishedComponent component;
  std::memcpy(&component, record, sizeof component);
  return component;
}

/// Returns the components that get a number (VoteRule::counts()), in the order of their first points.
ByFirstPoint by_first_point(const ScratchRecords& components, const ComponentsSetup& setup) {
  ByFirstPoint sorted(setup.make_scratch, setup.memory_bytes / 2, components.count());
  std::uint64_t component = components.count();
  ScratchRecords::Backwards backwards(components);
  while (const std::byte* record = backwards.next()) {
    --component;
    if (setup.votes == nullptr || setup.votes->counts(record + sizeof(FinishedComponent)))
      sorted.add({component_in(record).first, component});
  }
  sorted.finish();
  return sorted;
}

/// Returns the numbers of the components, from the last component of the log to the first.
Numbers numbers_of(const ScratchRecords& components, const ComponentsSetup& setup) {
  ByFirstPoint sorted = by_first_point(components, setup);
  Numbers numbers(setup.make_scratch, setup.memory_bytes / 2, sorted.count());
  std::uint64_t next = 0;
  while (const auto first = sorted.next()) numbers.add({first->component, next++});
  numbers.finish();
  return numbers;
}

}  // namespace

Components::Components(const EdgeBuckets& buckets, const ComponentsSetup& setup)
    : setup_(setup), log_(setup.make_scratch, setup.votes != nullptr ? setup.votes->result_bytes() : 0) {
  SpanningForest forest(buckets.weighted(), setup_.votes, log_);
  grow(forest, buckets, {.progress = setup_.progress});
  log_.finish();
  count_ = log_.components().count();
}

bool Components::turns(const std::byte* component) const {
  return setup_.votes != nullptr && setup_.votes->turns(component + sizeof(FinishedComponent));
}

void Components::for_each_point(const std::function<void(std::uint64_t, const ComponentLabel&)>& use) const {
  Numbers numbers = numbers_of(log_.components(), setup_);
  auto next = numbers.next();
  const auto label_of = [&](std::uint64_t component, const std::byte* record) {
    ComponentLabel label{
        .number = ComponentLabel::kNone, .points = component_in(record).points, .flips = turns(record)};
    if (next && next->component == component) {
      label.number = next->number;
      next = numbers.next();
    }
    return label;
  };
  std::uint64_t done = 0;
  log_.for_each_point(label_of, [&](std::uint64_t row, const ComponentLabel& label) {
    use(row, label);
    if (setup_.progress && ++done % (1 << 16) == 0) setup_.progress(done);
  });
}

void Components::for_each_component(
    const std::function<void(const FinishedComponent& component, const std::byte* result)>& use) const {
  ByFirstPoint sorted = by_first_point(log_.components(), setup_);
  std::vector<std::byte> record(log_.components().record_bytes());
  while (const auto next = sorted.next()) {
    stop_if_cancelled();
    log_.components().read(next->component, record);
    use(component_in(record.data()), record.data() + sizeof(FinishedComponent));
  }
}

}  // namespace pointsweep
