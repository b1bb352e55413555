// SPDX-License-Identifier: MIT
#include <algorithm>
#include <optional>

#include "pointsweep/fail.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/program/nearest_names.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

/// A name that other programs give to an operation and that no operator of this library has, with advice.
struct OtherWord {
  std::string_view word, advice;
};

constexpr std::string_view kReproject =
    "pointsweep does not reproject coordinates, but 'pdal translate IN OUT reprojection "
    "--filters.reprojection.out_srs=EPSG:CODE' does";
constexpr std::string_view kCopy = "leave the stage out: a run without stages copies the points of all inputs";
constexpr std::string_view kDenoise = "'denoise' removes outliers, and sor, ror and lof mark them";
constexpr std::string_view kGround = "'ground' finds the ground by the method SMRF";
constexpr std::string_view kHeight = "'height' measures heights above the ground";
constexpr std::string_view kWhere = "'where' keeps the points for which a condition holds, as in where(z > 2)";
constexpr std::string_view kSet = "'set' assigns values, as in set(classification = 7)";
constexpr std::string_view kClusters = "'components' joins points that are near each other, and dbscan dense ones";
constexpr std::string_view kThin = "'voxel', 'poisson', 'decimate' and 'sample' thin a cloud";
constexpr std::string_view kRaster =
    "pointsweep makes no rasters, but 'pdal translate IN OUT.tif --writers.gdal.resolution=1' does";
constexpr OtherWord kOtherWords[] = {
    {"reproject", kReproject}, {"reprojection", kReproject},
    {"merge", kCopy},          {"copy", kCopy},
    {"convert", kCopy},        {"translate", kCopy},
    {"outlier", kDenoise},     {"outliers", kDenoise},
    {"noise", kDenoise},       {"smrf", kGround},
    {"csf", kGround},          {"pmf", kGround},
    {"hag", kHeight},          {"hag_nn", kHeight},
    {"hag_delaunay", kHeight}, {"range", kWhere},
    {"expression", kWhere},    {"filter", kWhere},
    {"assign", kSet},          {"ferry", kSet},
    {"cluster", kClusters},    {"subsample", kThin},
    {"thin", kThin},           {"downsample", kThin},
    {"raster", kRaster},       {"dtm", kRaster},
    {"dsm", kRaster},          {"clip", "'crop' keeps the points inside a box or polygons"},
};

}  // namespace

const std::vector<OperatorDeclaration>& all_operators() {
#define POINTSWEEP_CALL(name) name##_declaration(),
  static const std::vector<OperatorDeclaration> operators = {POINTSWEEP_OPERATORS(POINTSWEEP_CALL)};
#undef POINTSWEEP_CALL
  return operators;
}

std::string_view advice_for(std::string_view word) {
  const auto* const found = std::ranges::find(kOtherWords, word, &OtherWord::word);
  return found == std::end(kOtherWords) ? std::string_view() : found->advice;
}

const OperatorDeclaration* declaration_of(std::string_view name) {
  const auto found = std::ranges::find(all_operators(), name, &OperatorDeclaration::name);
  return found == all_operators().end() ? nullptr : &*found;
}

const OperatorDeclaration& find_operator(const StageText& stage) {
  if (const OperatorDeclaration* found = declaration_of(stage.name)) return *found;
  if (const std::string_view advice = advice_for(stage.name); !advice.empty())
    fail_usage("{}: no operator is called '{}'; {}.", stage.place, stage.name, advice);
  std::vector<std::string> names = {neighborhood_declaration().name};
  for (const OperatorDeclaration& declaration : all_operators()) names.push_back(declaration.name);
  const std::optional<std::string> meant = probable_name(stage.name, names);
  fail_usage("{}: no operator is called '{}'; {}.", stage.place, stage.name,
             meant ? fmt::format("the nearest is '{}'", *meant) : "'pointsweep operators' lists all");
}

OperatorDeclaration neighbors_declaration() { return neighbor_rows_declaration(); }

}  // namespace pointsweep
