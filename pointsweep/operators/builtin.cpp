// SPDX-License-Identifier: MIT
/// The typed functions of operators.h.
#include "pointsweep/operators/color.h"
#include "pointsweep/operators/connected_components.h"
#include "pointsweep/operators/crop.h"
#include "pointsweep/operators/curvature.h"
#include "pointsweep/operators/decimate.h"
#include "pointsweep/operators/density.h"
#include "pointsweep/operators/density_clusters.h"
#include "pointsweep/operators/distance_to.h"
#include "pointsweep/operators/drop.h"
#include "pointsweep/operators/fair.h"
#include "pointsweep/operators/features.h"
#include "pointsweep/operators/ground.h"
#include "pointsweep/operators/height.h"
#include "pointsweep/operators/least_eigenentropy.h"
#include "pointsweep/operators/limits_from_attributes.h"
#include "pointsweep/operators/local_outlier_factor.h"
#include "pointsweep/operators/m3c2.h"
#include "pointsweep/operators/neighbor_rows.h"
#include "pointsweep/operators/neighborhood_size.h"
#include "pointsweep/operators/normals.h"
#include "pointsweep/operators/orient.h"
#include "pointsweep/operators/outliers.h"
#include "pointsweep/operators/poisson.h"
#include "pointsweep/operators/radius_outliers.h"
#include "pointsweep/operators/segments.h"
#include "pointsweep/operators/set.h"
#include "pointsweep/operators/simplify.h"
#include "pointsweep/operators/splats.h"
#include "pointsweep/operators/unique.h"
#include "pointsweep/operators/voxel.h"
#include "pointsweep/operators/where.h"

namespace pointsweep::operators {

ChainStage normals(const NormalsOptions& options) { return std::make_shared<Normals>(options); }
ChainStage curvature() { return std::make_shared<Curvature>(); }
ChainStage splats(const SplatsOptions& options) { return std::make_shared<Splats>(options); }
ChainStage fair(const FairOptions& options) { return std::make_shared<Fair>(options); }
ChainStage fair_in_percent(const FairOptions& percent) { return std::make_shared<FairInPercent>(percent); }
ChainStage sor(double multiplier, OutlierDefinition definition) {
  return std::make_shared<StatisticalOutliers>(multiplier, definition);
}
ChainStage ror(double radius, std::uint64_t min_neighbors) {
  return std::make_shared<RadiusOutliers>(radius, min_neighbors);
}
ChainStage lof() { return std::make_shared<LocalOutlierFactor>(); }
ChainStage density(std::optional<double> radius) { return std::make_shared<Density>(radius); }
ChainStage where(std::string_view condition) { return std::make_shared<Where>(condition); }
ChainStage set(std::string_view assignments, std::optional<Type> type) {
  return std::make_shared<Set>(assignments, type);
}
ChainStage color(const ColorOptions& options) { return std::make_shared<Color>(options); }
ChainStage drop(const std::vector<std::string>& attributes) { return drop_of(attributes); }
ChainStage crop(const CropOptions& options) { return std::make_shared<Crop>(options); }
ChainStage unique() { return std::make_shared<Unique>(); }
ChainStage decimate(double share, std::uint64_t seed) { return std::make_shared<Decimate>(share, seed); }
ChainStage voxel(double size, VoxelKeep keep) { return std::make_shared<Voxel>(size, keep); }
ChainStage poisson(const PoissonOptions& options) { return std::make_shared<Poisson>(options); }
ChainStage simplify(const SimplifyOptions& options) { return std::make_shared<Simplify>(options); }
ChainStage ground(const GroundOptions& options) { return std::make_shared<Ground>(options); }
ChainStage height(std::uint64_t k) { return std::make_shared<Height>(k); }
ChainStage components(std::optional<double> distance) { return std::make_shared<ConnectedComponents>(distance); }
ChainStage dbscan(double eps, std::uint64_t min_points) { return std::make_shared<DensityClusters>(eps, min_points); }
ChainStage segments(double angle, std::optional<double> distance) {
  return std::make_shared<Segments>(angle, distance);
}
ChainStage orient(std::optional<Vec3> viewpoint) { return std::make_shared<OrientedNormals>(viewpoint); }
ChainStage orient_by_trajectory(const std::string& file) { return std::make_shared<OrientedNormals>(file, ""); }
ChainStage distance_to(const std::string& cloud, double most) { return std::make_shared<DistanceTo>(cloud, most); }
ChainStage m3c2(const M3c2Options& options) { return std::make_shared<M3c2>(options); }
ChainStage features(const FeaturesOptions& options) { return std::make_shared<Features>(options); }
ChainStage neighborhood_size() { return std::make_shared<NeighborhoodSize>(); }
ChainStage neighbors(std::size_t k, std::uint64_t points, bool distances) {
  return std::make_shared<NeighborRows>(k, points, distances);
}

SharedRule least_eigenentropy(std::size_t least) { return std::make_shared<LeastEigenentropy>(least); }
SharedRule limits_from_attributes(const AttributeLimits& limits) {
  return std::make_shared<LimitsFromAttributes>(limits);
}

}  // namespace pointsweep::operators
