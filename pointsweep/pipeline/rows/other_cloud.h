// SPDX-License-Identifier: MIT
/// Another cloud that an InOrderOperator reads in addition to the cloud of the chain.
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
  /// Opens the files that `name` means (files.h). Throws Error if there are none or they have no points; UsageError if
  /// they state another coordinate reference system than `cloud`, unless `cloud` ignores reference systems. `reads`:
  /// the attributes to read, named like fields of the other cloud.
  OtherCloud(const std::string& name, std::vector<Attribute> reads, const InputCloud& cloud);

  const std::string& name() const { return name_; }
  std::uint64_t count() const { return cloud_->count(); }
  std::vector<std::filesystem::path> files() const;
  /// Returns the files and their states, as a part of the identity of a resumable run.
  std::string identity() const;
  /// Returns warnings about the cloud, as sentences for the user.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// Puts the points in order along the axis, into a temporary file, and passes those with finite coordinates to `take`
  /// in this order. Throws Error if a file has changed since it was opened. Needs working_bytes() of memory, without
  /// the file.
  void give_in_order(int axis, const SpillPlace& spill, const std::function<void(std::uint64_t rows)>& progress,
                     const std::function<void(const OtherPoints&)>& take);
  /// Puts the points of a cloud in order along the axis, into a temporary file, with their values of `reads`.
  static Stream in_order(InputCloud& cloud, const std::string& name, const std::vector<Attribute>& reads, int axis,
                         const SpillPlace& spill, const std::function<void(std::uint64_t rows)>& progress);
  /// Puts points in order along the axis, into a temporary file. `numbered`: working records, whose last field is the
  /// row (StreamOptions::numbered), with the values that give() needs.
  static Stream in_order(const PointSource& numbered, int axis, const SpillPlace& spill);
  /// Passes the finite points of a stream made by in_order() to `take` in order, with their values of `reads`.
  static void give(const Stream& stream, const std::string& name, const std::vector<Attribute>& reads,
                   const std::function<void(std::uint64_t rows)>& progress,
                   const std::function<void(const OtherPoints&)>& take);
  /// Throws UsageError if a file lacks an attribute to read, or stores it in another way than the first file (type,
  /// count, scale, bias or width in bits), so that the files are no tiles of one cloud.
  void require_same_types() const;
  std::vector<std::uint64_t> counts() const;  ///< number of points of each file
  /// Returns the bytes of memory that give_in_order() needs. `value_bytes`: bytes of the read attributes of one point.
  static std::uint64_t working_bytes(unsigned threads, std::uint64_t value_bytes);

 private:
  std::string name_;
  std::vector<Attribute> reads_;
  std::unique_ptr<InputCloud> cloud_;
  std::vector<std::string> warnings_;
};

/// Returns, for each pass, the other cloud that it reads, if any.
std::vector<std::optional<OtherCloud>> open_others(const ChainPlan& plan, const InputCloud& cloud);

}  // namespace pointsweep
