// SPDX-License-Identifier: MIT
/// Keeping the points inside a box or polygons.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/points/lower_case.h"
#include "pointsweep/points/text_file.h"
#include "pointsweep/polygons/polygon_index.h"
#include "pointsweep/polygons/polygon_text.h"

namespace pointsweep {
namespace {

const OptionTable<CropOptions>& crop_options() {
  static const OptionTable<CropOptions> table = {
      option("bounds", &CropOptions::bounds,
             "corners of a box: XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX, or XMIN,YMIN,XMAX,YMAX for any z; 'bounds=' may be left "
             "out",
             {.unit = "length", .positional = true, .sample = "0,0,10,10"}),
      option("polygon", &CropOptions::polygon,
             "file with polygons, or a polygon itself, as WKT or GeoJSON in the coordinates of the cloud; with bounds "
             "a point has to lie in both",
             {.kind = OptionKind::file, .sample = "POLYGON ((0 0, 10 0, 10 10, 0 0))"}),
      option("outside", &CropOptions::outside, "keep the points outside of the box and polygons instead",
             {.choices = {"false", "true"}}),
      option(
          "checksum", &CropOptions::checksum,
          "checksum of the file with polygons, as a processing record holds it; a file with other content is refused",
          {.kind = OptionKind::word, .sample = "baf74575be7585e0"})};
  return table;
}

/// Keeps a point if it lies in the box and in a polygon; a box or polygons that are not given exclude no point; with
/// CropOptions::outside, keeps all other points instead. Edges and faces count as inside in both cases. A point is in
/// no box or polygon if a coordinate needed for the test is not finite.
class Crop final : public SelectOperator {
 public:
  /// Reads the file with polygons, if there is one. Throws Error if the polygons cannot be read, are invalid or do not
  /// match CropOptions::checksum. Throws UsageError, beginning with `place`, if no option states a region, if the
  /// bounds are invalid, and for a checksum without polygons.
  explicit Crop(CropOptions options, std::string place = "crop");
  std::string name() const override { return "crop"; }
  void keep(const Neighborhoods& points, std::span<std::uint8_t> kept) const override {
    for (std::size_t i = 0; i < points.size(); ++i) kept[i] = is_inside(points.position(i)) != options_.outside;
  }
  /// Returns the box of the bounds in x and y, or, without bounds, the box of the polygons. Its z is 0. Returns nullopt
  /// with CropOptions::outside.
  std::optional<Box> extent() const override;

 private:
  void read_polygons();
  bool is_inside(Vec3 p) const;

  CropOptions options_;  ///< options, with the checksum of the file if one was read
  std::string place_;
  std::vector<Polygon> polygons_;
  std::optional<PolygonIndex> index_;
};

}  // namespace

OperatorDeclaration crop_declaration() {
  return {
      .name = "crop",
      .meaning = "keeps the points inside a box or polygons; later stages see neighbours among these",
      .options = crop_options().declarations(),
      .make = crop_options().maker<Crop>(),
      .formula =
          "In the box: XMIN <= x <= XMAX and YMIN <= y <= YMAX (and ZMIN <= z <= ZMAX).\n"
          "In a polygon: (x, y) lies on one of its edges, or a ray from it crosses its edges an odd number of times "
          "(even-odd rule over all its rings). Of several polygons: in any of them. Decided without rounding.",
      .source = "Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates (1997).",
      .undefined =
          "A point of which a coordinate that is compared is NaN or infinite lies outside; outside=true keeps it.",
      .cost = "a pass over the rows, without a search; about 50 ns for each point near many edges",
      .example = "knn(k=12) | crop([0,0,100,100]) | normals"};
}

ChainStage operators::crop(const CropOptions& options) { return std::make_shared<Crop>(options); }

Crop::Crop(CropOptions options, std::string place) : options_(std::move(options)), place_(std::move(place)) {
  const std::vector<double>& b = options_.bounds;
  if (b.empty() && options_.polygon.empty())
    fail_usage("{}: nothing says what is inside; give bounds=[XMIN,YMIN,XMAX,YMAX] or polygon=FILE.", place_);
  if (!b.empty() && b.size() != 4 && b.size() != 6)
    fail_usage("{}: bounds are 4 numbers, XMIN,YMIN,XMAX,YMAX, or 6 with ZMIN and ZMAX, not {}.", place_, b.size());
  for (std::size_t a = 0; a < b.size() / 2; ++a)
    if (const double low = b[a], high = b[a + b.size() / 2]; !(low <= high))
      fail_usage("{}: of the bounds the least {} is {}, more than the most, {}.", place_, "xyz"[a], low, high);
  if (options_.polygon.empty() && !options_.checksum.empty())
    fail_usage("{}: the checksum is that of a file with polygons; give polygon=FILE.", place_);
  if (!options_.polygon.empty()) read_polygons();
  crop_options().declare(*this, options_);
}

void Crop::read_polygons() {
  const bool is_file = !is_polygon_text(options_.polygon);
  const std::string extension = in_lower_case(std::filesystem::path(options_.polygon).extension().string());
  if (is_file && (extension == ".shp" || extension == ".gpkg"))
    fail("{0}: polygons are read as GeoJSON or WKT; convert the file: ogr2ogr -f GeoJSON polygons.geojson {0}.",
         options_.polygon);
  const std::string text = is_file ? read_text_file(options_.polygon, "polygons as WKT or GeoJSON") : options_.polygon;
  const std::string checksum = checksum_of_text(text), name = is_file ? options_.polygon : place_;
  if (!options_.checksum.empty() && options_.checksum != checksum)
    fail("{}: are not the polygons that the run read: their checksum is {}, not {}; give those, or leave checksum out.",
         name, checksum, options_.checksum);
  if (is_file) options_.checksum = checksum;
  polygons_ = polygons_of_text(text, name);
  index_.emplace(polygons_);
}

bool Crop::is_inside(Vec3 p) const {
  const std::vector<double>& b = options_.bounds;
  const std::size_t axes = b.size() / 2;
  for (std::size_t a = 0; a < axes; ++a)
    if (const double c = p[static_cast<int>(a)]; !(c >= b[a] && c <= b[a + axes])) return false;
  return !index_ || index_->covers({p.x, p.y});
}

std::optional<Box> Crop::extent() const {
  if (options_.outside) return std::nullopt;
  Box box;
  if (const std::vector<double>& b = options_.bounds; !b.empty()) {
    const std::size_t axes = b.size() / 2;
    for (const std::size_t corner : {std::size_t{0}, axes}) box.include(Vec3{b[corner], b[corner + 1], 0});
    return box;
  }
  for (const Polygon& polygon : polygons_)
    for (const Ring& ring : polygon.rings)
      for (const Point2& p : ring) box.include(Vec3{p.x, p.y, 0});
  return box;
}

}  // namespace pointsweep
