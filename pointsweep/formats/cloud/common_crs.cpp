// SPDX-License-Identifier: MIT
/// One coordinate reference system for several inputs.
#include <algorithm>

#include "pointsweep/fail.h"
#include "pointsweep/formats/cloud/common_schema.h"
#include "pointsweep/formats/crs.h"

namespace pointsweep {
namespace {

/// Returns "b.las" or "b.las and 3 other inputs".
std::string names_of(const std::vector<const FileInfo*>& files) {
  const std::string first = files.front()->path.string();
  if (files.size() == 1) return first;
  return fmt::format("{} and {} other input{}", first, files.size() - 1, files.size() == 2 ? "" : "s");
}

std::string with_crs(const std::vector<const FileInfo*>& files) {
  return fmt::format("{} ({})", names_of(files), short_text(*files.front()->crs));
}

[[noreturn]] void refuse_different(const FileInfo& first, const FileInfo& other) {
  fail_usage(
      "{} is in {} and {} in {}: transform one of them first{}, or add --ignore-crs to merge the coordinates without a "
      "transformation.",
      first.path.string(), short_text(*first.crs), other.path.string(), short_text(*other.crs),
      way_to_transform(*first.crs));
}

}  // namespace

std::string way_to_transform(const Crs& to) {
  if (to.epsg == 0) return "";
  return fmt::format(", e.g. by 'pdal translate IN OUT reprojection --filters.reprojection.out_srs=EPSG:{}'", to.epsg);
}

CommonCrs stated_crs(const std::vector<std::shared_ptr<Reader>>& readers, const StatedCrs& stated) {
  CommonCrs common{.crs = stated.crs, .warnings = {}};
  for (const auto& reader : readers) {
    const FileInfo& info = reader->info();
    if (!info.crs) continue;
    if (stated.crs && compare(*stated.crs, *info.crs) == CrsAgreement::same) {
      common.crs = info.crs;  // the input may state more than a code
      if (common.crs->wkt.empty()) common.crs->wkt = stated.crs->wkt;
      continue;
    }
    if (stated.crs && !stated.replaces)
      fail_usage(
          "--crs: {} is given, and {} states {}; leave --crs out, or add --replace-crs if the file is wrong. The "
          "coordinates stay as they are in any case.",
          short_text(*stated.crs), info.path.string(), short_text(*info.crs));
    common.replaces = true;
  }
  if (common.replaces) common.crs = stated.crs;
  return common;
}

CommonCrs common_crs(const std::vector<std::shared_ptr<Reader>>& readers, bool ignore) {
  CommonCrs common;
  const auto states = [](const auto& reader) { return reader->info().crs.has_value(); };
  const auto first_with = std::ranges::find_if(readers, states);
  if (first_with == readers.end()) return common;
  const FileInfo& first = (*first_with)->info();
  common.crs = first.crs;
  std::vector<const FileInfo*> without, undecided, different;
  for (const auto& reader : readers) {
    const FileInfo& info = reader->info();
    if (!info.crs) {
      without.push_back(&info);
      continue;
    }
    const CrsAgreement agreement = compare(*first.crs, *info.crs);
    if (agreement == CrsAgreement::different && !ignore) refuse_different(first, info);
    // LAS point formats 6 to 10 need WKT, which the first input may lack.
    if (agreement == CrsAgreement::same && common.crs->wkt.empty()) common.crs->wkt = info.crs->wkt;
    if (agreement == CrsAgreement::different) different.push_back(&info);
    if (agreement == CrsAgreement::undecided) undecided.push_back(&info);
  }
  const std::string reference = fmt::format("{} of {}", short_text(*first.crs), first.path.string());
  if (!different.empty())
    common.warnings.push_back(
        fmt::format("--ignore-crs: coordinates of {} are merged without a transformation, as if they were in {}.",
                    with_crs(different), reference));
  if (!undecided.empty())
    common.warnings.push_back(
        fmt::format("The coordinate reference system of {} could not be compared with {}; it is taken to be the same.",
                    with_crs(undecided), reference));
  if (!without.empty())
    common.warnings.push_back(
        fmt::format("{}: no coordinate reference system is stated; {} is assumed.", names_of(without), reference));
  return common;
}

}  // namespace pointsweep
