// SPDX-License-Identifier: MIT
/// Formulas of attributes that operators of operators/thinning/ make: the means of `voxel` and the levels of `level`.
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "pointsweep/verify/formulas/thinning.h"
#include "pointsweep/verify/values/cloud_formula.h"

namespace pointsweep {
namespace {

using formulas::Estimate;

struct VoxelHash {
  std::size_t operator()(const formulas::Coordinates& voxel) const {
    return static_cast<std::size_t>(formulas::hash_of(voxel, 0));
  }
};

/// An attribute that becomes a mean, and the number of read attributes that are its components.
struct MeanAttribute {
  Attribute made;
  std::size_t reads = 1;
};

std::vector<MeanAttribute> mean_attributes(const Contract& contract) {
  std::vector<MeanAttribute> all;
  std::size_t read = 0;
  for (const Attribute& made : contract.makes) {
    if (made.name == position_attribute().name || made.name == selection_attribute().name) continue;
    all.push_back({made, made.fields.size() / contract.reads[read].fields.size()});
    read += all.back().reads;
  }
  return all;
}

class MeanFormula final : public CloudFormula {
 public:
  MeanFormula(const Contract& contract, double size)
      : reads_(contract.reads), averaged_(mean_attributes(contract)), size_(size) {}

  void prepare(const CloudInput& in) override {
    if (in.before_means == nullptr) throw NotTold("its voxels are not known");
    fields_.clear();
    for (const Attribute& read : reads_)
      for (const std::string& name : read.fields) {
        const auto at = in.before_means->schema().find(name);
        if (!at) throw NotTold("it averages what earlier stages made");
        fields_.push_back(in.before_means->schema().fields[*at]);
      }
  }

  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput& in) override {
    std::unordered_map<formulas::Coordinates, std::vector<formulas::Mean>, VoxelHash> means;
    for (const CloudPoint& p : points) means.try_emplace(voxel_of(p.at.position), 3 + fields_.size());
    RowSource source(*in.before_means);
    const PositionFields position = position_fields(source.schema(), source.name());
    for_each_row(source, "averaging", in.rows.progress(), [&](std::uint64_t, const std::byte* record) {
      const Vec3 p = position_in(position, record);
      if (!is_finite(p)) return;
      const auto found = means.find(voxel_of(p));
      if (found == means.end()) return;
      for (std::size_t a = 0; a < 3; ++a) found->second[a].add(p[static_cast<int>(a)]);
      for (std::size_t f = 0; f < fields_.size(); ++f) found->second[3 + f].add(value_of(fields_[f], record));
    });
    std::vector<Estimates> made;
    for (const CloudPoint& p : points) made.push_back(estimates_of_means(means.at(voxel_of(p.at.position))));
    return made;
  }

  /// Returns the position and the averaged attributes, all unchanged. An attribute is read as a whole or component by
  /// component.
  std::optional<Estimates> unplaced(const CloudPoint& point) const override {
    const Vec3 p = point.at.position;
    Estimates made = {{.value = {p.x, p.y, p.z}}};
    std::size_t read = 0;
    for (const MeanAttribute& a : averaged_) {
      Estimate own = point.reads[read];
      if (a.reads == 3) own.value.y = point.reads[read + 1].value.x, own.value.z = point.reads[read + 2].value.x;
      made.push_back(own);
      read += a.reads;
    }
    return made;
  }

 private:
  formulas::Coordinates voxel_of(Vec3 p) const {
    formulas::Coordinates voxel = formulas::voxel_of({p.x, p.y, p.z}, size_);
    for (double& v : voxel) v += 0.0;
    return voxel;
  }

  /// Returns the mean position, then the mean of each attribute.
  Estimates estimates_of_means(const std::vector<formulas::Mean>& means) const {
    Estimates made = {formulas::mean_vector({means[0], means[1], means[2]})};
    std::size_t next = 3;
    for (const MeanAttribute& a : averaged_) {
      const Type type = a.made.type;
      if (a.made.kind == Kind::normal)
        made.push_back(formulas::mean_direction({means[next], means[next + 1], means[next + 2]}));
      else
        made.push_back(type == Type::f64   ? means[next].real()
                       : type == Type::f32 ? means[next].single()
                                           : means[next].whole());
      next += a.made.fields.size();
    }
    return made;
  }

  std::vector<Attribute> reads_;
  std::vector<MeanAttribute> averaged_;
  double size_;
  std::vector<Field> fields_;  ///< fields of the input, grouped by attribute
};

/// Makes the formula of the means of voxel(keep=centroid). Returns null for a voxel that only keeps rows.
std::unique_ptr<CloudFormula> voxel_formula(const FormulaSetup& stage) {
  if (stage.options.word("keep") != "centroid") return nullptr;
  return std::make_unique<MeanFormula>(stage.contract, stage.options.number("size"));
}

class LevelFormula final : public CloudFormula {
 public:
  explicit LevelFormula(const FormulaSetup&) {}

  void prepare(const CloudInput& in) override {
    require_memory(in.rows.count() * formulas::kLevelBytes, in.rows);
    std::vector<formulas::Coordinates> points;
    in.rows.for_each({}, [&](std::uint64_t row, Vec3 p, std::span<const double>) {
      number_.resize(row + 1);
      number_[row] = points.size();
      if (is_finite(p)) points.push_back({p.x, p.y, p.z});
    });
    levels_ = formulas::levels_of(points);
  }

  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput&) override {
    std::vector<Estimates> made;
    for (const CloudPoint& p : points) made.push_back({formulas::exactly(levels_[number_[p.at.row]])});
    return made;
  }
  std::optional<Estimates> unplaced(const CloudPoint&) const override { return {{formulas::exactly(255)}}; }

 private:
  std::vector<std::size_t> number_;  ///< for each row, its number among the points with finite coordinates
  std::vector<std::uint8_t> levels_;
};

}  // namespace

std::vector<NamedCloudFormula> thinning_formulas() {
  return {{"voxel", voxel_formula}, {"level", cloud_formula_made<LevelFormula>}};
}

}  // namespace pointsweep
