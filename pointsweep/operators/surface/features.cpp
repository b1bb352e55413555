// SPDX-License-Identifier: MIT
#include "pointsweep/operators/surface/features.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"

namespace pointsweep {
namespace {

struct FeatureText {
  const char* name;
  const char* meaning;
  int power;                    ///< exponent of the length in the unit
  bool of_eigenvalues = false;  ///< true if `power` is that of raw eigenvalues; other scales have less
};

/// Names, meanings and units in the order of Feature.
constexpr std::array<FeatureText, kFeatures> kTexts = {{
    {"linearity", "(λ1 - λ2) / λ1, in [0, 1]", 0},
    {"planarity", "(λ2 - λ3) / λ1, in [0, 1]", 0},
    {"sphericity", "λ3 / λ1, in [0, 1]", 0},
    {"omnivariance", "∛(λ1 λ2 λ3)", 2, true},
    {"anisotropy", "(λ1 - λ3) / λ1, in [0, 1]", 0},
    {"eigenentropy", "-Σ λ ln λ", 2, true},
    {"eigenvalue_sum", "λ1 + λ2 + λ3", 2, true},
    {"surface_variation", "λ3 / (λ1 + λ2 + λ3), in [0, 1/3]", 0},
    {"verticality", "1 - |e3 · z|, in [0, 1]: 0 for a horizontal plane, 1 for a vertical one", 0},
    {"moment1_axis1", "|Σ (p - p_i) · e1|", 1},
    {"moment1_axis2", "|Σ (p - p_i) · e2|", 1},
    {"moment2_axis1", "Σ ((p - p_i) · e1)²", 2},
    {"moment2_axis2", "Σ ((p - p_i) · e2)²", 2},
    {"height_range", "max z - min z", 1},
    {"number_of_neighbors", "n, the number of points", 0},
}};

std::vector<std::string> names_of_features() {
  std::vector<std::string> names;
  for (const FeatureText& text : kTexts) names.emplace_back(text.name);
  return names;
}

Attribute attribute_of(Feature feature, EigenvalueScale scale) {
  const FeatureText& text = kTexts[static_cast<std::size_t>(feature)];
  const int lost = scale == EigenvalueScale::raw ? 0 : scale == EigenvalueScale::root ? 1 : 2;
  const int power = text.of_eigenvalues ? text.power - lost : text.power;
  const Type type = feature == Feature::number_of_neighbors ? Type::u32 : Type::f32;
  return scalar(text.name, type, power == 0 ? "1" : power == 1 ? "length" : "length^2", text.meaning);
}

std::vector<Feature> features_named(const std::vector<std::string>& names) {
  std::vector<Feature> features;
  for (std::size_t f = 0; f < kFeatures; ++f)
    if (names.empty() || std::ranges::find(names, kTexts[f].name) != names.end())
      features.push_back(static_cast<Feature>(f));
  return features;
}

std::vector<AttributeNote> notes() {
  std::vector<AttributeNote> notes;
  for (const FeatureText& text : kTexts) {
    const bool always = std::string_view(text.name) == "number_of_neighbors";
    notes.push_back({.name = text.name, .meaning = std::string(text.meaning) + (always ? "" : "; undefined: 0")});
  }
  return notes;
}

const OptionTable<FeaturesOptions>& features_options() {
  static const OptionTable<FeaturesOptions> table = {
      option("names", &FeaturesOptions::names,
             "features to compute, as in [linearity,planarity]; without this option, all of them",
             {.kind = OptionKind::names, .choices = names_of_features(), .sample = "linearity,planarity"}),
      option("eigenvalues", &FeaturesOptions::eigenvalues,
             "what the features are made of: the eigenvalues themselves, their square roots, or the eigenvalues "
             "divided by their sum",
             {.choices = {"raw", "sqrt", "normalized"}}),
      option("with_point", &FeaturesOptions::with_point, "count the point itself among the points of its neighbourhood",
             {.choices = {"yes", "no"}})};
  return table;
}

}  // namespace

OperatorDeclaration features_declaration() {
  return {
      .name = "features",
      .meaning =
          "features of the shape of neighbourhoods, from the eigenvalues of their covariance: like a line, a "
          "plane or a volume",
      .options = features_options().declarations(),
      .make = features_options().maker<Features>(),
      .formula =
          "P: the neighbours, and p_i with with_point=yes; n = |P|, p̄ their mean\n"
          "Σ = 1/n Σ_P (p - p̄)(p - p̄)^T, eigenvalues l1 >= l2 >= l3, eigenvectors e1, e2, e3\n"
          "eigenvalues=raw: λ = l, in length²; sqrt: λ = √l, in length;\n"
          "eigenvalues=normalized: λ = l / (l1 + l2 + l3)\n"
          "Moments are sums over P. In eigenentropy 0 ln 0 is 0; of raw values and roots it "
          "depends on the unit of length.\n"
          "CloudCompare: raw, with_point=yes; its '1st order moment' is "
          "moment1_axis2² / moment2_axis2.\n"
          "jakteristics: the same with n - 1 for n, which changes omnivariance, eigenentropy and "
          "eigenvalue_sum alone.\n"
          "PDAL: sqrt, with_point=yes, n - 1 for n; its Scattering is sphericity, its "
          "DemantkeVerticality verticality; its Verticality (Guinard and Landrieu 2017) is another.",
      .source =
          "Weinmann et al., Semantic point cloud interpretation based on optimal neighborhoods, relevant features "
          "and efficient classifiers (ISPRS Journal 105, 2015); Hackel, Wegner, Schindler, Fast semantic segmentation "
          "of 3D point clouds with strongly varying density (2016), whose first moments have an arbitrary sign that is "
          "left out here",
      .undefined =
          "Points all in one place, or a neighbour without a finite place: all but number_of_neighbors is 0. Points on "
          "a line, vertical ones too: verticality is 0, since e3 is any direction across it. Points without a finite "
          "place: all is 0.",
      .degenerate = "have too few neighbours, or only neighbours on a line; the features that need more are 0",
      .cost = "at k = 10 as much as normals, after the search; logarithms and axes only where an attribute needs them",
      .neighbor_ns = 3,
      .attributes = notes(),
      .example = "knn(radius=0.5) | features(names=[linearity,planarity,verticality])"};
}

ChainStage operators::features(const FeaturesOptions& options) { return std::make_shared<Features>(options); }

/// Puts the names in the order of Feature, and removes all names if every feature is named, so that equal operators
/// have equal options.
Features::Features(FeaturesOptions options) : options_(std::move(options)), made_(features_named(options_.names)) {
  const std::vector<std::string> known = names_of_features();
  const auto place = [&](const std::string& name) { return std::ranges::find(known, name) - known.begin(); };
  std::ranges::sort(options_.names, {}, place);
  if (options_.names == known) options_.names.clear();
  features_options().declare(*this, options_);
}

Contract Features::contract() const {
  Contract contract{.default_k = 32};
  for (const Feature f : made_) contract.makes.push_back(attribute_of(f, options_.eigenvalues));
  return contract;
}

void Features::apply(const Neighborhoods& in, Columns& out) const {
  FeatureColumns columns{.numbers = {}, .eigenvalues = options_.eigenvalues, .with_point = options_.with_point};
  columns.marks_without_extent = made_.front() < Feature::height_range;
  columns.marks_lines = std::ranges::find(made_, Feature::verticality) != made_.end();
  for (std::size_t m = 0; m < made_.size(); ++m) {
    if (!out.wanted(m)) continue;
    if (made_[m] != Feature::number_of_neighbors) {
      columns.numbers[static_cast<std::size_t>(made_[m])] = out.column<float>(m);
      continue;
    }
    const std::span<std::uint32_t> counts = out.column<std::uint32_t>(m);
    for (std::size_t i = 0; i < in.size(); ++i)
      counts[i] = static_cast<std::uint32_t>(in.count(i)) + (options_.with_point ? 1 : 0);
  }
  features(in, columns, out.degenerate());
}

}  // namespace pointsweep
