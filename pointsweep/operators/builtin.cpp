// SPDX-License-Identifier: MIT
/// The typed functions of operators.h.
#include "pointsweep/operators/change/distance_to.h"
#include "pointsweep/operators/change/m3c2.h"
#include "pointsweep/operators/declare/least_eigenentropy.h"
#include "pointsweep/operators/declare/limits_from_attributes.h"
#include "pointsweep/operators/graph/connected_components.h"
#include "pointsweep/operators/graph/density_clusters.h"
#include "pointsweep/operators/graph/orient.h"
#include "pointsweep/operators/graph/segments.h"
#include "pointsweep/operators/ground/ground.h"
#include "pointsweep/operators/ground/height.h"
#include "pointsweep/operators/rows/color.h"
#include "pointsweep/operators/rows/crop.h"
#include "pointsweep/operators/rows/decimate.h"
#include "pointsweep/operators/rows/drop.h"
#include "pointsweep/operators/rows/set.h"
#include "pointsweep/operators/rows/unique.h"
#include "pointsweep/operators/rows/where.h"
#include "pointsweep/operators/statistics/density.h"
#include "pointsweep/operators/statistics/local_outlier_factor.h"
#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/operators/statistics/neighborhood_size.h"
#include "pointsweep/operators/statistics/outliers.h"
#include "pointsweep/operators/statistics/radius_outliers.h"
#include "pointsweep/operators/surface/curvature.h"
#include "pointsweep/operators/surface/fair.h"
#include "pointsweep/operators/surface/features.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/operators/surface/splats.h"
#include "pointsweep/operators/thinning/poisson.h"
#include "pointsweep/operators/thinning/simplify.h"
#include "pointsweep/operators/thinning/voxel.h"

namespace pointsweep::operators {

ChainStage normals(const NormalsOptions& options) { return std::make_shared<Normals>(options); }
ChainStage curvature() { return std::make_shared<Curvature>(); }
ChainStage splats(const SplatsOptions& options) { return std::make_shared<Splats>(options); }
ChainStage fair(const FairOptions& options) { return std::make_shared<Fair>(options); }
ChainStage fair_in_percent(const FairPercent& percent) { return std::make_shared<FairInPercent>(percent); }
ChainStage sor(const SorOptions& options) { return std::make_shared<StatisticalOutliers>(options); }
ChainStage ror(const RorOptions& options) { return std::make_shared<RadiusOutliers>(options); }
ChainStage lof() { return std::make_shared<LocalOutlierFactor>(); }
ChainStage density(const DensityOptions& options) { return std::make_shared<Density>(options); }
ChainStage where(std::string_view condition) { return std::make_shared<Where>(condition); }
ChainStage set(std::string_view assignments, std::optional<Type> type) {
  return std::make_shared<Set>(assignments, type);
}
ChainStage color(const ColorOptions& options) { return std::make_shared<Color>(options); }
ChainStage drop(const std::vector<std::string>& attributes) { return drop_of(attributes); }
ChainStage crop(const CropOptions& options) { return std::make_shared<Crop>(options); }
ChainStage unique() { return std::make_shared<Unique>(); }
ChainStage decimate(const DecimateOptions& options) { return std::make_shared<Decimate>(options); }
ChainStage voxel(const VoxelOptions& options) { return std::make_shared<Voxel>(options); }
ChainStage poisson(const PoissonOptions& options) { return std::make_shared<Poisson>(options); }
ChainStage simplify(const SimplifyOptions& options) { return std::make_shared<Simplify>(options); }
ChainStage ground(const GroundOptions& options) { return std::make_shared<Ground>(options); }
ChainStage height(const HeightOptions& options) { return std::make_shared<Height>(options); }
ChainStage components(const ComponentsOptions& options) { return std::make_shared<ConnectedComponents>(options); }
ChainStage dbscan(const DbscanOptions& options) { return std::make_shared<DensityClusters>(options); }
ChainStage segments(const SegmentsOptions& options) { return std::make_shared<Segments>(options); }
ChainStage orient(const OrientOptions& options) { return std::make_shared<OrientedNormals>(options); }

ChainStage distance_to(const DistanceToOptions& options) { return std::make_shared<DistanceTo>(options); }
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
