// SPDX-License-Identifier: MIT
#include "pointsweep/arrays.h"

#include <algorithm>
#include <cstring>
#include <memory>

#include "pointsweep/cloud.h"
#include "pointsweep/fail.h"
#include "pointsweep/reader.h"
#include "pointsweep/writer.h"

namespace pointsweep {
namespace {

Cloud cloud_of(const PointsView& points) {
  return std::visit([](auto xyz) { return Cloud(std::make_unique<ArrayReader>(xyz)); }, points.xyz());
}

/// Collects whole output records in memory of the caller.
class RecordWriter final : public Writer {
 public:
  RecordWriter(const OutputPlan& plan, std::vector<std::byte>& records)
      : stride_(plan.schema.stride), records_(records) {
    records_.resize(plan.count * stride_);
  }

  void write(std::span<const std::byte> records) override {
    write_at(next_row_, records);
    next_row_ += records.size() / stride_;
  }
  bool can_write_at() const override { return true; }
  void write_at(std::uint64_t row, std::span<const std::byte> records) override {
    std::ranges::copy(records, records_.begin() + static_cast<std::ptrdiff_t>(row * stride_));
  }
  void finish() override {}

 private:
  std::size_t stride_;
  std::vector<std::byte>& records_;
  std::uint64_t next_row_ = 0;
};

/// Returns the fields of the made attribute `name`; if there is none, the field `name`. Throws UsageError for a field
/// that `schema` lacks.
std::vector<Field> fields_named(std::string_view name, const Schema& schema, const std::vector<Attribute>& made) {
  const auto attribute = std::ranges::find(made, name, &Attribute::name);
  const std::vector<std::string> names =
      attribute == made.end() ? std::vector<std::string>{std::string(name)} : attribute->fields;
  std::vector<Field> fields;
  for (const std::string& field : names) {
    const std::optional<std::size_t> found = schema.find(field);
    if (!found)
      fail_usage("'{}' is not among the results; name it in Chain::keep, or add the stage that makes it.", name);
    fields.push_back(schema.fields[*found]);
  }
  return fields;
}

}  // namespace

void ArrayResults::copy(std::string_view name, Type type, std::size_t bytes, std::byte* out) const {
  const std::vector<Field> fields = fields_named(name, schema_, made_);
  std::size_t values = 0;
  for (const Field& field : fields) values += field.count;
  if (fields.front().type != type || bytes != values * size_of(type))
    fail_usage("'{}' has {} of {} for each point; it cannot be taken as {} of {}.", name, values,
               name_of(fields.front().type), bytes / size_of(type), name_of(type));
  for (std::size_t row = 0; row < size(); ++row) {
    const std::byte* record = records_.data() + row * schema_.stride;
    for (const Field& field : fields) {
      const std::size_t width = field.count * size_of(type);
      std::memcpy(out, record + field.offset, width);
      out += width;
    }
  }
}

ArrayResults run(PointsView points, const Chain& chain, const RunOptions& options) {
  Cloud cloud = cloud_of(points);
  Schema schema;
  std::vector<Attribute> made;
  std::vector<std::byte> records;
  Outputs outputs;
  outputs.writer = [&](const OutputPlan& plan) {
    schema = plan.schema;
    made = plan.made;
    return std::make_unique<RecordWriter>(plan, records);
  };
  Statistics statistics = run(cloud, chain, outputs, options);
  return {std::move(schema), std::move(made), std::move(records), std::move(statistics)};
}

std::vector<std::array<float, 3>> normals(PointsView xyz, const NormalsOptions& options,
                                          const Neighborhood& neighborhood) {
  Cloud cloud = cloud_of(xyz);
  std::vector<std::array<float, 3>> found(cloud.count());
  Outputs outputs;
  outputs.writer = [&](const OutputPlan& plan) {
    return std::make_unique<ArrayWriter<float>>(plan, std::vector<std::string>{"nx", "ny", "nz"},
                                                std::span(found.front().data(), 3 * found.size()));
  };
  run(cloud, {.neighborhood = neighborhood, .stages = {operators::normals(options)}, .keep = {"normal"}}, outputs);
  return found;
}

}  // namespace pointsweep
