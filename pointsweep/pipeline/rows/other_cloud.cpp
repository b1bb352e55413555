// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/other_cloud.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/cloud/common_schema.h"
#include "pointsweep/formats/crs.h"
#include "pointsweep/operators/expressions/named_values.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/order/working_record.h"
#include "pointsweep/pipeline/rows/input_source.h"
#include "pointsweep/pipeline/rows/ordered_output.h"
#include "pointsweep/points/promised_type.h"
#include "pointsweep/storage/local/place.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kSlabPoints = 32768, kBufferBytes = 8u << 20;

StreamOptions stream_options(int axis, const SpillPlace& spill) {
  return {.axis = axis, .slab_points = kSlabPoints, .canonical = true, .spill = spill, .buffer_bytes = kBufferBytes};
}

/// Returns the indices of the fields that an operator reads. Throws Error if a field is missing or has another type.
std::vector<std::size_t> fields_of(const std::vector<Attribute>& reads, const Schema& schema, const std::string& name) {
  std::vector<std::size_t> fields;
  for (const Attribute& a : reads) {
    const auto field = std::ranges::find(schema.fields, a.name, &Field::name);
    if (field == schema.fields.end() || type_of_values(*field) != a.type)
      fail("{}: '{}' is not what it was when the run began; the file has changed.", name, a.name);
    fields.push_back(static_cast<std::size_t>(field - schema.fields.begin()));
  }
  return fields;
}

}  // namespace

OtherCloud::OtherCloud(const std::string& name, std::vector<Attribute> reads, const InputCloud& cloud)
    : name_(name), reads_(std::move(reads)), cloud_(opened_cloud(name, cloud.ignores_crs())) {
  if (cloud_->count() == 0) fail("{}: has no points to compare with.", name);
  if (!reads_.empty()) warnings_ = cloud_->missing_attributes();
  const std::optional<Crs>&mine = cloud.crs(), &other = cloud_->crs();
  if (!mine || !other) return;
  const CrsAgreement agreement = compare(*mine, *other);
  if (agreement == CrsAgreement::different && !cloud.ignores_crs())
    fail_usage(
        "{} is in {} and the input in {}: transform one of them first{}, or add --ignore-crs to compare the "
        "coordinates without a transformation.",
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

std::vector<std::uint64_t> OtherCloud::counts() const {
  std::vector<std::uint64_t> all;
  for (const auto& reader : cloud_->readers()) all.push_back(reader->info().count);
  return all;
}

void OtherCloud::require_same_types() const {
  const FileInfo& first = cloud_->readers().front()->info();
  for (const auto& reader : cloud_->readers()) {
    for (const Attribute& a : reads_) {
      const auto of_first = first.schema.find(a.name), of_file = reader->info().schema.find(a.name);
      const auto stored = [](const Field& f) { return std::tuple(f.type, f.count, f.scale, f.bias, f.bit_width); };
      const bool same = of_first && of_file &&
                        stored(first.schema.fields[*of_first]) == stored(reader->info().schema.fields[*of_file]);
      if (!same)
        fail_usage(
            "{}: stores '{}' in another way than {}; write all files of {} with one run of 'pointsweep convert' first.",
            reader->info().path.string(), a.name, first.path.string(), name_);
    }
  }
}

std::string OtherCloud::identity() const {
  std::string text;
  for (std::size_t i = 0; i < cloud_->readers().size(); ++i) {
    const FileInfo& info = cloud_->readers()[i]->info();
    text += fmt::format("other cloud '{}' with {} points, {}\n", whole_name(info.path), info.count,
                        cloud_->states()[i].text());
  }
  return text;
}

/// Counts the buffers twice, which leaves room for the survey's sample, and the records of three slabs for each thread
/// and of three more.
std::uint64_t OtherCloud::working_bytes(unsigned threads, std::uint64_t value_bytes) {
  constexpr std::uint64_t kRecordBytes = 32;
  return 2 * kBufferBytes + (threads + 1) * 3 * kSlabPoints * (kRecordBytes + value_bytes);
}

void OtherCloud::give_in_order(int axis, const SpillPlace& spill,
                               const std::function<void(std::uint64_t rows)>& progress,
                               const std::function<void(const OtherPoints&)>& take) {
  const Stream stream = in_order(*cloud_, name_, reads_, axis, spill, progress);
  cloud_->require_unchanged();
  give(stream, name_, reads_, progress, take);
}

Stream OtherCloud::in_order(InputCloud& cloud, const std::string& name, const std::vector<Attribute>& reads, int axis,
                            const SpillPlace& spill, const std::function<void(std::uint64_t rows)>& progress) {
  const PointSource source = source_of(cloud);
  StreamOptions options = stream_options(axis, spill);
  options.payload = fields_of(reads, source.schema, name);
  options.progress = progress;
  return Stream(source, survey(source, axis, false), options);
}

Stream OtherCloud::in_order(const PointSource& numbered, int axis, const SpillPlace& spill) {
  StreamOptions options = stream_options(axis, spill);
  options.numbered = true;
  return Stream(numbered, survey(numbered, axis, false), options);
}

void OtherCloud::give(const Stream& stream, const std::string& name, const std::vector<Attribute>& reads,
                      const std::function<void(std::uint64_t rows)>& progress,
                      const std::function<void(const OtherPoints&)>& take) {
  const Schema& schema = stream.record_schema();
  const PositionFields fields = position_fields(schema, name);
  std::vector<PromisedType> values_of;
  for (const Attribute& a : reads) values_of.emplace_back(schema.fields[schema.find(a.name).value()], a.type);
  const std::size_t value_bytes = bytes_of(reads);
  FirstRowError none;  // stays empty, since the fields have the types of the attributes
  std::vector<double> x, y, z;
  std::vector<Vec3> positions;
  std::vector<std::uint64_t> rows;
  std::vector<std::byte> values;
  const auto give = [&](std::span<const std::byte> records) {
    const std::size_t n = records.size() / schema.stride;
    x.resize(n), y.resize(n), z.resize(n);
    decode_positions(fields, records.data(), schema.stride, n, x.data(), y.data(), z.data());
    positions.clear(), rows.clear(), values.clear();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 p{x[i], y[i], z[i]};
      if (!is_finite(p)) continue;
      positions.push_back(p);
      const std::byte* const record = records.data() + i * schema.stride;
      rows.push_back(row_of(schema, record));
      values.resize(values.size() + value_bytes);
      std::byte* to = values.data() + values.size() - value_bytes;
      for (std::size_t v = 0; v < values_of.size(); to += size_of(reads[v++].type))
        values_of[v].convert(record, rows.back(), to, none);
    }
    take({positions, rows, values});
  };
  write_in_order(stream, schema.stride, give, progress);
}

std::vector<std::optional<OtherCloud>> open_others(const ChainPlan& plan, const InputCloud& cloud) {
  std::vector<std::optional<OtherCloud>> others(plan.passes.size());
  for (std::size_t p = 0; p < others.size(); ++p) {
    const InOrderOperator* op = plan.passes[p].in_order();
    if (op != nullptr && !op->other_cloud().empty()) others[p].emplace(op->other_cloud(), op->other_reads(), cloud);
  }
  return others;
}

}  // namespace pointsweep
