// SPDX-License-Identifier: MIT
/// The built-in operators and rules of neighbourhoods as typed functions. docs/operators.md has their formulas, sources
/// and costs, docs/attributes.md their attributes. All of them throw UsageError for options out of their ranges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/export.h"
#include "pointsweep/geometry.h"
#include "pointsweep/neighborhood.h"

namespace pointsweep {

/// The choice between the two directions of a normal. If a rule cannot decide (a dot product of 0), `none` is used.
enum class Orient {
  none,       ///< the component of largest magnitude (the first of equally large components) is positive
  up,         ///< the normal points up: nz >= 0
  viewpoint,  ///< the normal points towards NormalsOptions::viewpoint, which is required
  input,      ///< the normal agrees with the normal in the file
};

struct NormalsOptions {
  Orient orient = Orient::none;
  std::optional<Vec3> viewpoint = {};  ///< viewpoint in the coordinates of the cloud, for Orient::viewpoint only
};

/// The matrix that determines the direction and the ratio of a splat's ellipse.
enum class SplatAxes {
  automatic,  ///< uses curvature if an earlier stage makes it, else positions
  positions,  ///< M_i of Equation 1: ellipses are long in the direction of the widest spread of neighbours
  curvature,  ///< C_i of Equation 2, by k1, k2 and k1_direction: ellipses are long along ridges and valleys
};

struct SplatsOptions {
  SplatAxes axes = SplatAxes::automatic;
};

/// Standard deviations of the two Gaussians of Equation 3, f(r) = exp(-r² / 2 f²). The paper sets "the variance" of
/// both to 0.5 % of the diagonal of the bounding box (Section 7.3). Since a variance is a squared length, the paper is
/// taken to mean the standard deviation.
struct FairOptions {
  double f = 0;  ///< width of the Gaussian of |p_j - p_i|, which is the range of smoothing; > 0
  /// Width of the Gaussian of |Π_j(p_i) - p_i|, the distance of a point from a neighbour's tangent plane up to which
  /// the neighbour moves it; > 0.
  double g = 0;
};

/// Widths of FairOptions in percent of the diagonal of the box around the finite points of the input, 1e-6 to 100 each.
struct FairPercent {
  double f = 0.5;
  double g = 0.5;
};

/// The program whose definition of a statistical outlier sor() follows; docs/pipelines.md has the five definitions.
enum class OutlierDefinition { pointsweep, pdal, pcl, open3d, cloudcompare };

struct SorOptions {
  /// A point is an outlier if its mean distance is more than this many deviations above the mean; >= 0.
  double multiplier = 2;
  OutlierDefinition definition = OutlierDefinition::pointsweep;
};

/// Options of ror(). `radius` is required.
struct RorOptions {
  double radius = 0;                ///< radius within which neighbours are counted, inclusive; > 0
  std::uint64_t min_neighbors = 2;  ///< a point with fewer neighbours is an outlier; >= 1
};

/// Options of statistics(). `of` is required.
struct StatisticsOptions {
  /// Names of the attributes to make, each once: ATTRIBUTE_STATISTIC, with mean, median, min, max, range, deviation,
  /// majority or count, as in "z_range"; or "count".
  std::vector<std::string> of = {};
  std::string where = {};  ///< condition for the neighbours that count; empty if all count
};

struct DensityOptions {
  std::optional<double> radius = {};  ///< radius of the ball, > 0; if absent, the distance to the farthest neighbour
};

/// The values that the formulas of features() call λ.
enum class EigenvalueScale {
  raw,         ///< eigenvalues of the covariance, in length² (CloudCompare, jakteristics)
  root,        ///< square roots of the eigenvalues, in length (PDAL's default)
  normalized,  ///< eigenvalues divided by their sum (Weinmann et al. 2015)
};

struct FeaturesOptions {
  std::vector<std::string> names = {};  ///< names of the attributes to make, each once; empty for all
  EigenvalueScale eigenvalues = EigenvalueScale::raw;
  bool with_point = true;  ///< true if the covariance includes the point itself
};

/// Names of attributes that limit each point's neighbourhood: scalars of any type, converted to double. An empty name
/// means no limit.
struct AttributeLimits {
  std::string k = {};       ///< attribute with the number of neighbours to keep, which is rounded down
  std::string radius = {};  ///< attribute with the radius of the neighbours to keep, inclusive, in length units
};

/// The choice of the point of a voxel that is kept.
enum class VoxelKeep {
  center,  ///< the point nearest to the centre of the voxel
  hash,    ///< the point whose coordinates have the smallest hash: a random choice
  /// The point nearest to the centre, moved to the mean of the points of the voxel. Its normal, colours, intensity and
  /// single floating-point values become means, too; classes, arrays and other attributes stay.
  centroid,
};

/// Options of head(). `number` is required.
struct HeadOptions {
  std::uint64_t number = 0;  ///< number of first rows to keep; >= 1
};

/// Options of decimate(). `share` is required.
struct DecimateOptions {
  double share = std::numeric_limits<double>::quiet_NaN();  ///< fraction of the points to keep, 0 to 1
  std::uint64_t seed = 0;                                   ///< another seed keeps other points
};

/// Options of sample(). `number` is required.
struct SampleOptions {
  std::uint64_t number = 0;  ///< number of points to keep; >= 1
  bool rest = false;         ///< true to keep all other points instead
  std::uint64_t seed = 0;    ///< another seed keeps other points
};

/// Options of parts(). `number` is required.
struct PartsOptions {
  std::uint64_t number = 0;  ///< number of parts; 1 to 65,536
  std::uint64_t seed = 0;    ///< another seed makes other parts
};

/// Options of voxel(). `size` is required.
struct VoxelOptions {
  double size = 0;  ///< edge length of the cubes of the grid, whose faces lie at its multiples; > 0
  VoxelKeep keep = VoxelKeep::center;
};

struct PoissonOptions {
  /// Kept points are farther apart than this; with `radius_from`, the upper limit of the radii; > 0.
  double radius = 0;
  std::string radius_from = {};  ///< name of an attribute with the radius of each point (0 for NaN and below 0)
};

/// Options of simplify(), which are lengths.
struct SimplifyOptions {
  double error = 0;  ///< largest distance of a kept point from the tangent plane of a point that it represents; > 0
  /// The largest distance of a kept point from a point that it represents, as on flat parts; > 0. If absent, 32 times
  /// `error`.
  std::optional<double> most = {};
  /// Lower limit of the distance within which a kept point represents other points, for places where noise looks like
  /// curvature; 0 to `most`.
  double least = 0;
};

/// Options of crop(). `bounds` or `polygon` is required; if both are given, a point inside lies in both.
struct CropOptions {
  std::vector<double> bounds = {};  ///< corners of a box: xmin, ymin, zmin, xmax, ymax, zmax, or without z
  std::string polygon = {};         ///< name of a file with polygons as WKT or GeoJSON, or the WKT or GeoJSON itself
  bool outside = false;             ///< true to keep the points outside instead of the points inside
  std::string checksum = {};        ///< checksum that the polygon file must have; empty for any
};

/// Options of distance_to(). `cloud` is required.
struct DistanceToOptions {
  std::string cloud = {};           ///< the other cloud: a file, a folder or a pattern
  std::optional<double> most = {};  ///< largest distance that counts, > 0; absent for no limit
};

/// Options of m3c2() (Lague et al. 2013). `cloud`, `cylinder` and `depth` are required.
struct M3c2Options {
  std::string cloud = {};   ///< the other cloud: a file, a folder or a pattern
  double cylinder = 0;      ///< diameter of the cylinder along the normal, length; > 0
  double depth = 0;         ///< reach of the cylinder to each side of the point, length; > 0
  double registration = 0;  ///< error of the registration of the two clouds, length; >= 0
};

/// The choice of the value that the k nearest points of another cloud give to a point.
enum class TakeVote {
  majority,  ///< the most frequent value; among equally frequent values, the value of the nearest point
  mean,      ///< the mean of the values
  nearest,   ///< the value of the nearest point; k must be 1
};

/// Options of take(). `cloud` and `attributes` are required.
struct TakeOptions {
  std::string cloud = {};                    ///< the other cloud: a file, a folder or a pattern
  std::vector<std::string> attributes = {};  ///< attributes of the other cloud, each once, in any spelling
  std::uint64_t k = 1;                       ///< number of the nearest points that vote; 1 to 1,000
  TakeVote vote = TakeVote::majority;
  std::optional<double> most = {};     ///< largest distance of a point that votes, > 0; absent for no limit
  std::optional<double> missing = {};  ///< value of points for which no point votes; needs `most`
};

/// Options of transform(). At least one of `matrix`, `scale` and `translate` is required; they apply in this order.
struct TransformOptions {
  /// Name of a file with 4 rows of 4 numbers, the last row 0 0 0 1, or the first 12 or all 16 numbers themselves, row
  /// by row.
  std::string matrix = {};
  double scale = 1;                    ///< factor of the coordinates; > 0
  std::optional<Vec3> translate = {};  ///< lengths that are added to the coordinates
  bool inverse = false;                ///< true to move the points by the inverse map
};

/// The map from numbers to colours of color().
enum class ColorMap { viridis, turbo, gray, classes /**< colours of the classes of LAS */ };

/// The number of bits of a channel of color().
enum class ColorBits {
  automatic,  ///< 16 bits if the input has colours of 16 bits or fields of LAS, else 8
  eight,
  sixteen,
};

struct ColorOptions {
  std::string by = {};  ///< name of an attribute of the input, of a component of a made attribute, or x, y or z
  ColorMap map = ColorMap::viridis;
  std::vector<double> range = {};  ///< the two ends of the map; empty for the least and the greatest value of the cloud
  ColorBits bits = ColorBits::automatic;
};

/// Options of ground(): SMRF (Pingel et al. 2013), with the defaults of the paper for metres.
struct GroundOptions {
  double cell = 1;           ///< edge length of a cell of the raster; > 0
  double slope = 0.15;       ///< steepest slope of the ground, rise over run
  double window = 18;        ///< radius of the largest disk of the filter, a length; at most 1,000 cells
  double threshold = 0.5;    ///< largest distance of a ground point from a level surface, a length
  double scalar = 1.25;      ///< length that is added to `threshold` for each unit of the slope
  bool all_returns = false;  ///< true if all returns take part instead of last returns only
  bool noise = false;        ///< true if points of the noise classes 7 and 18 take part, too
};

struct HeightOptions {
  std::uint64_t k = 1;  ///< number of nearest ground points over which the height of the ground is averaged; 1 to 1,024
};

struct ComponentsOptions {
  std::optional<double> distance = {};  ///< largest distance of joined points, >= 0; absent for no limit
};

/// Options of dbscan(). `eps` is required.
struct DbscanOptions {
  double eps = 0;                ///< the distance within which points are neighbours, inclusive; > 0
  std::uint64_t min_points = 5;  ///< number of points within eps that make a core point, itself included; >= 1
};

struct SegmentsOptions {
  double angle = 5;  ///< the angle between the normals of joined points is below this, in degrees; > 0, at most 90
  std::optional<double> distance = {};  ///< largest distance of joined points, >= 0; absent for no limit
};

/// The way in which orient() finds the signs of normals.
enum class OrientMethod {
  mst,         ///< the minimum spanning forest of the graph of neighbours (Hoppe et al. 1992)
  trajectory,  ///< the place of the sensor at the gps_time of the point
};

struct OrientOptions {
  OrientMethod method = OrientMethod::mst;
  std::optional<Vec3> viewpoint = {};  ///< viewpoint that most normals of each component face, for `mst` only
  std::string trajectory = {};         ///< file with lines of time, x, y, z, for `trajectory` only
  std::string checksum = {};           ///< checksum that the trajectory file must have; empty for any
};

namespace operators {

/// Makes "normal": the unit normal of the surface the points were taken from (paper Section 3.2, Equation 1).
POINTSWEEP_EXPORT ChainStage normals(const NormalsOptions& options = {});
/// Makes "k1", "k2", "k1_direction" and derived attributes (paper Section 4.3.2, Equation 2). Needs "normal".
POINTSWEEP_EXPORT ChainStage curvature();
/// Makes "splat_axis", "splat_length" and "splat_ratio", ellipses that together cover the surface (paper Section
/// 4.3.3). Needs "normal"; with SplatAxes::curvature also curvature().
POINTSWEEP_EXPORT ChainStage splats(const SplatsOptions& options = {});
/// Moves the points: feature-preserving smoothing in one pass (paper Section 4.3.4, Equation 3). Needs "normal" and
/// splats(). Widths are in length units. Throws UsageError unless both are positive.
POINTSWEEP_EXPORT ChainStage fair(const FairOptions& options);
/// Returns fair() with widths in percent of the diagonal of the box around the input.
POINTSWEEP_EXPORT ChainStage fair_in_percent(const FairPercent& percent = {});
/// Makes "mean_distance" and "outlier", which is 1 if the mean distance to the neighbours exceeds its mean over the
/// cloud by more than `multiplier` standard deviations, by one of five definitions.
POINTSWEEP_EXPORT ChainStage sor(const SorOptions& options = {});
/// Drops the outliers of sor() and makes no attribute.
POINTSWEEP_EXPORT ChainStage denoise(const SorOptions& options = {});
/// Makes "outlier": 1 if fewer than `min_neighbors` neighbours lie within `radius`. Neighbourhoods must have a k of at
/// least `min_neighbors` and a radius of at least `radius`.
POINTSWEEP_EXPORT ChainStage ror(const RorOptions& options);
/// Makes "k_distance", "reachability_density" and "lof", the local outlier factor (Breunig et al. 2000).
POINTSWEEP_EXPORT ChainStage lof();
/// Makes "surface_density" and "volume_density" in the ball up to the farthest neighbour, or in a ball with a radius.
/// In the latter case, neighbourhoods must contain all points of the ball.
POINTSWEEP_EXPORT ChainStage density(const DensityOptions& options = {});
/// Makes the statistics of the neighbours' attributes that are named, in float64; min, max and majority in the type of
/// the attribute, count in uint32. Throws UsageError for a name that ends in no statistic.
POINTSWEEP_EXPORT ChainStage statistics(const StatisticsOptions& options);
/// Keeps the rows for which a condition on attributes holds, e.g. "classification == 2 && z < 100"
/// (docs/pipelines.md). Throws UsageError for a text that is no condition.
POINTSWEEP_EXPORT ChainStage where(std::string_view condition);
/// Assigns numbers to attributes, e.g. "classification = 7 where outlier == 1"; commas separate several assignments.
/// `type`: type of new attributes; if absent, the type of the LAS field with that name, else float64. Throws UsageError
/// for a text that assigns nothing.
POINTSWEEP_EXPORT ChainStage set(std::string_view assignments, std::optional<Type> type = std::nullopt);
/// Moves the points by a matrix, turns their normals and other directions, and scales lengths. Throws Error for a file
/// that is no matrix of 4 rows of 4 numbers, and UsageError for a matrix that is singular.
POINTSWEEP_EXPORT ChainStage transform(const TransformOptions& options);
/// Makes the attribute "color", with the fields red, green and blue, from the values of another attribute.
POINTSWEEP_EXPORT ChainStage color(const ColorOptions& options);
/// Removes attributes from the output and from the view of later stages.
POINTSWEEP_EXPORT ChainStage drop(const std::vector<std::string>& attributes);
/// Keeps the points inside a box, polygons, or both. Throws Error for a file that cannot be read.
POINTSWEEP_EXPORT ChainStage crop(const CropOptions& options);
/// Keeps, among points with equal coordinates, only the point with the first row.
POINTSWEEP_EXPORT ChainStage unique();
/// Keeps the first `number` rows of the cloud, whose rows are the rows of the inputs, one input after another.
POINTSWEEP_EXPORT ChainStage head(const HeadOptions& options);
/// Keeps a share of the points, chosen by a hash of their coordinates.
POINTSWEEP_EXPORT ChainStage decimate(const DecimateOptions& options);
/// Keeps a number of points, chosen by a hash of their coordinates, or, with SampleOptions::rest, all other points.
POINTSWEEP_EXPORT ChainStage sample(const SampleOptions& options);
/// Makes "level", the level of detail at which a point is first drawn: points of low levels are a thinned cloud.
POINTSWEEP_EXPORT ChainStage level();
/// Makes "part", a number from 0, by a hash of the coordinates.
POINTSWEEP_EXPORT ChainStage parts(const PartsOptions& options);
/// Keeps one point in each cube of a grid.
POINTSWEEP_EXPORT ChainStage voxel(const VoxelOptions& options);
/// Makes "classification": 2 for points of the ground, by a morphological filter of the raster of the lowest points.
POINTSWEEP_EXPORT ChainStage ground(const GroundOptions& options = {});
/// Makes "height": z of the point minus the mean z, weighted by 1 / distance² in x and y, of the k points of class 2
/// that are nearest in x and y. Needs "classification", of the input or of ground().
POINTSWEEP_EXPORT ChainStage height(const HeightOptions& options = {});
/// Makes "component" and "component_size": connected components of the graph in which points are joined to their
/// neighbours, or, with a distance, to all points within this distance, which neighbourhoods must then contain.
POINTSWEEP_EXPORT ChainStage components(const ComponentsOptions& options = {});
/// Makes "core", "cluster" and "cluster_size" by DBSCAN, with border points in the cluster of the nearest core point.
/// Neighbourhoods must contain all points within eps.
POINTSWEEP_EXPORT ChainStage dbscan(const DbscanOptions& options);
/// Makes "segment" and "segment_size": connected components of neighbours with an angle between normals below a limit
/// and a distance within a limit; and "segment_residual", the root mean square distance of the points of a segment to
/// its plane. Needs "normal".
POINTSWEEP_EXPORT ChainStage segments(const SegmentsOptions& options = {});
/// Makes "normal_turned" and "normal": normals with signs that are consistent over each component of the graph of
/// neighbours, by its minimum spanning forest (Hoppe et al. 1992). With a viewpoint, most normals face it; without one,
/// normals point out of closed surfaces, and up on open surfaces. With OrientMethod::trajectory makes only "normal":
/// normals that face the sensor. Needs "normal", and "gps_time" for a trajectory. Throws Error for a file that cannot
/// be read.
POINTSWEEP_EXPORT ChainStage orient(const OrientOptions& options = {});
/// Makes "cloud_distance": the distance to the nearest point of another cloud, or NaN if that point is farther than
/// `most`.
POINTSWEEP_EXPORT ChainStage distance_to(const DistanceToOptions& options);
/// Gives the points attributes of the nearest points of another cloud.
POINTSWEEP_EXPORT ChainStage take(const TakeOptions& options);
/// Makes "m3c2_distance", the change to another cloud along the normal, "m3c2_lod", its level of detection, and the
/// spreads and numbers of points from which both are computed. Needs "normal".
POINTSWEEP_EXPORT ChainStage m3c2(const M3c2Options& options);
/// Makes features of the shape of neighbourhoods from the eigenvalues of their covariance: "linearity", "planarity",
/// "sphericity" and more (docs/operators.md).
POINTSWEEP_EXPORT ChainStage features(const FeaturesOptions& options = {});
/// Keeps points that are far apart: points are visited in the order of a hash of their coordinates, and a point is kept
/// unless a kept point lies within its radius.
POINTSWEEP_EXPORT ChainStage poisson(const PoissonOptions& options);
/// Keeps few points where the surface is flat: applies poisson() with "simplify_radius", which it makes. Needs
/// curvature().
POINTSWEEP_EXPORT ChainStage simplify(const SimplifyOptions& options);
/// Makes "neighbor_count", |N_i|, and "neighbor_radius", the distance to the farthest neighbour.
POINTSWEEP_EXPORT ChainStage neighborhood_size();
/// Makes "neighbors", N×k: the rows of the k nearest neighbours among `points` points (Cloud::count()), as u32, or u64
/// from 2^32 - 1 points on; with `distances`, also "distances", N×k f64. The chain must have the same `k`.
POINTSWEEP_EXPORT ChainStage neighbors(std::size_t k, std::uint64_t points, bool distances = false);

/// Returns a rule for Neighborhood::rule: each point keeps the number of neighbours, from `least` to Neighborhood::k,
/// for which their eigenentropy is least (Weinmann et al. 2014), so that they resemble a line, a plane or a volume
/// most. Throws UsageError if `least` < 3.
POINTSWEEP_EXPORT SharedRule least_eigenentropy(std::size_t least = 10);
/// Returns a rule for Neighborhood::rule: attributes of each point limit the number of its neighbours or their
/// distance. k and radius of the Neighborhood remain upper limits. Throws UsageError if no attribute is named.
POINTSWEEP_EXPORT SharedRule limits_from_attributes(const AttributeLimits& limits);

}  // namespace operators
}  // namespace pointsweep
