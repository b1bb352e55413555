// SPDX-License-Identifier: MIT
/// Another cloud that an InOrderOperator reads beside the one that goes through the chain.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/in_order_operator.h"
#include "pointsweep/order/source.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/storage/local/spill_file.h"

namespace pointsweep {

class OtherCloud {
 public:
  /// Opens the files that `name` stands for (files.h). Throws Error where there is none, UsageError where they
  /// state another coordinate reference system than `cloud` and the latter does not ignore that.
  /// `reads`: the attributes that are read of it, by the names of its fields.
  OtherCloud(const std::string& name, std::vector<Attribute> reads, const InputCloud& cloud);

  const std::string& name() const { return name_; }
  std::uint64_t count() const { return cloud_->count(); }
  std::vector<std::filesystem::path> files() const;
  /// The files and their states, as a part of the identity of a resumable run.
  std::string identity() const;
  /// Sentences for the user.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// Puts its points in order along the axis, into a temporary file, and gives them. Throws Error if a file has changed
  /// since it was opened. Needs working_bytes() of memory beside the file.
  void give_in_order(int axis, const SpillPlace& spill, const std::function<void(std::uint64_t rows)>& progress,
                     const std::function<void(const OtherPoints&)>& take);
  /// Puts the points of a cloud in order along the axis, into a temporary file, with their values of `reads`.
  static Stream in_order(InputCloud& cloud, const std::string& name, const std::vector<Attribute>& reads, int axis,
                         const SpillPlace& spill, const std::function<void(std::uint64_t rows)>& progress);
  /// Puts working records of such points in the order (StreamOptions::numbered).
  static Stream in_order(const PointSource& numbered, int axis, const SpillPlace& spill);
  /// Gives the finite points of such a stream.
  static void give(const Stream& stream, const std::string& name, const std::vector<Attribute>& reads,
                   const std::function<void(std::uint64_t rows)>& progress,
                   const std::function<void(const OtherPoints&)>& take);
  /// Throws UsageError where its files store what is read in different types, so that they cannot be tiles of one
  /// cloud.
  void require_same_types() const;
  std::vector<std::uint64_t> counts() const;  ///< points, by file
  /// `value_bytes`: of what is read of a point.
  static std::uint64_t working_bytes(unsigned threads, std::uint64_t value_bytes);

 private:
  std::string name_;
  std::vector<Attribute> reads_;
  std::unique_ptr<InputCloud> cloud_;
  std::vector<std::string> warnings_;
};

/// For each pass the other cloud that it reads, if it does.
std::vector<std::optional<OtherCloud>> open_others(const ChainPlan& plan, const InputCloud& cloud);

}  // namespace pointsweep
