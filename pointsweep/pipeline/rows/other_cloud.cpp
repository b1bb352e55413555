// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/other_cloud.h"

#include <fmt/format.h>

#include "pointsweep/fail.h"
#include "pointsweep/files.h"
#include "pointsweep/formats/cloud/common_schema.h"
#include "pointsweep/formats/crs.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/order/working_record.h"
#include "pointsweep/pipeline/rows/cloud_source.h"
#include "pointsweep/pipeline/rows/ordered_output.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kSlabPoints = 32768, kBufferBytes = 8u << 20;

std::unique_ptr<InputCloud> open_other(const std::string& name, bool ignore_crs) {
  std::vector<std::filesystem::path> paths;
  for (const ListedFile& file : list_inputs({name}, false).files) paths.push_back(file.path);
  return std::make_unique<InputCloud>(paths, CloudOptions{.ignore_crs = ignore_crs});
}

}  // namespace

OtherCloud::OtherCloud(const std::string& name, const InputCloud& cloud)
    : name_(name), cloud_(open_other(name, cloud.ignores_crs())) {
  if (cloud_->count() == 0) fail("{}: has no points to compare with.", name);
  const std::optional<Crs>&mine = cloud.crs(), &other = cloud_->crs();
  if (!mine || !other) return;
  const CrsAgreement agreement = compare(*mine, *other);
  if (agreement == CrsAgreement::different && !cloud.ignores_crs())
    fail_usage(
        "{} is in {} and the input in {}: transform one of them first{}, or add --ignore-crs to compare the "
        "coordinates "
        "without a transformation.",
        name, short_text(*other), short_text(*mine), way_to_transform(*mine));
  if (agreement == CrsAgreement::undecided)
    warnings_.push_back(fmt::format(
        "The coordinate reference system of {} could not be compared with that of the input; it is taken to be the "
        "same.",
        name));
}

std::vector<std::filesystem::path> OtherCloud::files() const {
  std::vector<std::filesystem::path> all;
  for (const auto& reader : cloud_->readers()) all.push_back(reader->info().path);
  return all;
}

std::string OtherCloud::identity() const {
  std::string text;
  for (std::size_t i = 0; i < cloud_->readers().size(); ++i) {
    const FileInfo& info = cloud_->readers()[i]->info();
    text += fmt::format("other cloud '{}' with {} points, {}\n",
                        std::filesystem::absolute(info.path).lexically_normal().string(), info.count,
                        cloud_->states()[i].text());
  }
  return text;
}

/// The buffer, slabs on their way into order on each thread, and the survey's sample.
std::uint64_t OtherCloud::working_bytes(unsigned threads) {
  constexpr std::uint64_t kRecordBytes = 32;
  return 2 * kBufferBytes + (threads + 1) * 3 * kSlabPoints * kRecordBytes;
}

void OtherCloud::give_in_order(int axis, const SpillPlace& spill,
                               const std::function<void(std::uint64_t rows)>& progress,
                               const std::function<void(std::span<const Vec3>, std::span<const std::uint64_t>)>& take) {
  const PointSource source = source_of(*cloud_, [](std::size_t) {});
  const Survey sample = survey(source, axis, false);
  const Stream stream(source, sample,
                      {.axis = axis,
                       .slab_points = kSlabPoints,
                       .canonical = true,
                       .payload = {},
                       .spill = spill,
                       .buffer_bytes = kBufferBytes,
                       .progress = progress});
  cloud_->require_unchanged();
  const Schema& schema = stream.record_schema();
  const PositionFields fields = position_fields(schema, name_);
  std::vector<double> x, y, z;
  std::vector<Vec3> positions;
  std::vector<std::uint64_t> rows;
  const auto give = [&](std::span<const std::byte> records) {
    const std::size_t n = records.size() / schema.stride;
    x.resize(n), y.resize(n), z.resize(n);
    decode_positions(fields, records.data(), schema.stride, n, x.data(), y.data(), z.data());
    positions.clear(), rows.clear();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 p{x[i], y[i], z[i]};
      if (!is_finite(p)) continue;
      positions.push_back(p);
      rows.push_back(row_of(schema, records.data() + i * schema.stride));
    }
    take(positions, rows);
  };
  write_in_order(stream, schema.stride, give, progress);
}

std::vector<std::optional<OtherCloud>> open_others(const ChainPlan& plan, const InputCloud& cloud) {
  std::vector<std::optional<OtherCloud>> others(plan.passes.size());
  for (std::size_t p = 0; p < others.size(); ++p) {
    const InOrderOperator* op = plan.passes[p].in_order();
    if (op != nullptr && !op->other_cloud().empty()) others[p].emplace(op->other_cloud(), cloud);
  }
  return others;
}

}  // namespace pointsweep
