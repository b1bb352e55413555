// SPDX-License-Identifier: MIT
/// Levels of detail as an attribute.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/levels/level_choice.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/points/sorted_records.h"

namespace pointsweep {
namespace {

constexpr double kSteps = 1 << 30;
constexpr std::uint64_t kDepthBits = 5;

/// A point with its row. CurveRecords orders records at one place by their bytes; `row` has its most significant byte
/// first, so that records at one place have the order of their rows.
struct Record {
  GridPoint point;
  std::array<std::byte, 8> row;
  std::array<std::byte, 8> number;  ///< number of the point in the order of arrival
};

std::array<std::byte, 8> first_byte_most(std::uint64_t number) {
  std::array<std::byte, 8> bytes;
  for (std::size_t i = 0; i < 8; ++i) bytes[i] = static_cast<std::byte>(number >> (56 - 8 * i));
  return bytes;
}

class LevelWork final : public InOrderWork {
 public:
  explicit LevelWork(const InOrderSetup& setup)
      : make_scratch_(setup.make_scratch),
        records_(sizeof(Record), setup.memory_bytes / 8 * 7, make_scratch_),
        memory_(setup.memory_bytes / 8) {}

  /// Returns 3: round 0 finds the bounds, round 1 the levels, and round 2 passes on the levels in the order of arrival.
  unsigned rounds() const override { return 3; }

  void add(unsigned round, const OrderedPoints& points, Findings& findings) override {
    if (round == 0) {
      for (const Vec3 p : points.positions) bounds_.include(p);
      count_ += points.rows.size();
    } else if (round == 1) {
      add_records(points);
    } else {
      for (const std::uint64_t row : points.rows) {
        findings.rows.push_back(row);
        findings.values.push_back(static_cast<std::byte>(*levels_->next() & ((1 << kDepthBits) - 1)));
      }
    }
  }

  void end(unsigned round, Findings&) override {
    if (round != 1) return;
    records_.choose({1, 1, 1});
    levels_.emplace(make_scratch_, memory_, count_);
    records_.for_each([&](const CurveKey&, int depth, const std::byte* bytes) {
      Record record;
      std::memcpy(&record, bytes, sizeof record);
      std::uint64_t number;
      std::memcpy(&number, record.number.data(), sizeof number);
      levels_->add(number << kDepthBits | static_cast<std::uint64_t>(depth));
    });
    levels_->finish();
  }

 private:
  /// Returns the length of a step. A run refuses clouds for which this length would be 0 or not finite.
  double step_of() const {
    const Vec3 extent = bounds_.extent();
    const double widest = std::max({extent.x, extent.y, extent.z});
    return widest > 0 ? widest / kSteps : 1;
  }

  void add_records(const OrderedPoints& points) {
    const double step = step_of();
    block_.clear();
    for (std::size_t i = 0; i < points.rows.size(); ++i) {
      const Vec3 p = points.positions[i];
      Record& record = block_.emplace_back();
      for (int axis = 0; axis < 3; ++axis)
        record.point[axis] = static_cast<std::int32_t>(std::nearbyint((p[axis] - bounds_.lo[axis]) / step));
      record.row = first_byte_most(points.rows[i]);
      std::memcpy(record.number.data(), &number_, sizeof number_);
      ++number_;
    }
    records_.add(std::as_bytes(std::span(block_)));
  }

  MakeScratch make_scratch_;
  Box bounds_;
  std::uint64_t count_ = 0, number_ = 0;
  LevelledRecords records_;
  std::uint64_t memory_;
  std::vector<Record> block_;
  std::optional<SortedRecords<std::uint64_t, std::less<>>> levels_;  ///< number of the point * 32 + level
};

/// Makes "level", the depth at which a point is first drawn (levels/level_choice.h). Positions are rounded to steps of
/// 2^-30 of the widest extent, so that the levels equal the levels of a cloud that is stored in these steps.
class Level final : public InOrderOperator {
 public:
  std::string name() const override { return "level"; }
  InOrderContract in_order_contract() const override {
    Attribute level = scalar("level", Type::u8, "1", "depth of the level, from 0; undefined: 255");
    level.fill = std::byte{0xff};
    return {.makes = {level}, .arrival = "three times: for their bounds, their levels, and to take them"};
  }
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override {
    return std::make_unique<LevelWork>(setup);
  }
  std::uint64_t least_bytes(const CloudEstimate& cloud) const override {
    constexpr std::uint64_t kPointBytes = 200;  // for each point of a cloud that is in memory as a whole
    return std::min(least_level_bytes(cloud.threads), (std::uint64_t{1} << 20) + cloud.points * kPointBytes);
  }
};

}  // namespace

OperatorDeclaration level_declaration() {
  return {
      .name = "level",
      .meaning = "gives each point the level of detail at which it is first drawn, by the rule of COPC outputs",
      .make = [](const OptionValues&, const Facts&) { return std::make_shared<Level>(); },
      .formula =
          "Positions are rounded to steps of e / 2^30, e the widest extent; the cube of width w = 1.125 e has its "
          "corner half a "
          "step below the least coordinates. (A COPC output rounds to the steps of its coordinates, and its cube is "
          "another one, so that its levels have other points.) An octant with more than 100,000 points is divided, "
          "unless they lie at "
          "one place.\n"
          "Depth d takes all points of octants of depth d that are not divided. Then each divided octant of depth d, "
          "those of even numbers along x, y and z first, takes in the order of a hash of the rounded coordinates each "
          "point that is not nearer than s_d to a point taken before.\n"
          "s_d = s_0 / 2^d. s_0 = √2^k w / 128 with the least k for which depth 0 has at most 100,000 points.\n"
          "So the points of level ≤ d are the cloud thinned to the spacing s_d.",
      .source = "Greedy Poisson discs in an octree as COPC has it (https://copc.io).",
      .undefined = "Points without a finite place have level 255.",
      .cost = "three passes that put the points in order, without a search; 50 bytes a point in the temporary folder",
      .attributes = {{.name = "level", .meaning = "depth of the level, from 0; undefined: 255"}},
      .example = "level | where(level <= 2)"};
}

ChainStage operators::level() { return std::make_shared<Level>(); }

}  // namespace pointsweep
