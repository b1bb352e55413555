// SPDX-License-Identifier: MIT
/// The declaration of `knn`, the neighbourhoods that its options define, and a check of neighbourhoods for operators
/// that count neighbours.
#include "pointsweep/fail.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/program/declaration.h"

namespace pointsweep {
namespace {

NeighborhoodDeclaration declare_neighborhood() {
  return {
      .name = "knn",
      .meaning =
          "neighbourhood for all stages: the k nearest points, all points within a radius, or the k nearest of these",
      .options =
          {{.name = "k",
            .kind = OptionKind::whole,
            .meaning = "number of neighbours, excluding the point; a radius without k means all points within it; "
                       "without both, the largest default of the operators in the pipeline",
            .least = 1},
           {.name = "radius",
            .kind = OptionKind::number,
            .meaning = "maximum distance of a neighbour, in the unit of the coordinates",
            .unit = "length",
            .is_radius = true},
           {.name = "k_from",
            .kind = OptionKind::attribute,
            .meaning =
                "attribute of the input that holds the number of neighbours of each point, at most k, which has to be "
                "given"},
           {.name = "radius_from",
            .kind = OptionKind::attribute,
            .meaning = "attribute of the input that holds the maximum distance of a neighbour for each point; k or "
                       "radius has to be given as a limit",
            .is_radius = true},
           {.name = "adaptive",
            .kind = OptionKind::choice,
            .preset = "none",
            .meaning = "choose the number of neighbours of each point, from k_min to k, by the least eigenentropy "
                       "(Weinmann 2014); k has to be given",
            .choices = {"none", "eigenentropy"}},
           {.name = "k_min",
            .kind = OptionKind::whole,
            .preset = std::uint64_t{10},
            .meaning = "smallest number of neighbours that adaptive=eigenentropy may choose",
            .least = 3}},
      .formula =
          "N_i: the k points of the cloud nearest to p_i without p_i itself, or all within the radius, or the k "
          "nearest of these. Distances are d² = ((dx² + dy²) + dz²) in double of the coordinates of the input; "
          "equal ones are ordered by x, y, z, then by input row. Within a radius R: d² <= R·R in double.\n"
          "k_from, radius_from: point i keeps the first neighbours that its own k or radius allows.\n"
          "adaptive=eigenentropy: the k from k_min on for which E = -Σ e_j ln e_j is least; e_1, e_2, e_3 are "
          "the eigenvalues of the covariance of p_i and its k nearest neighbours, divided by their sum.",
      .source =
          "Pajarola, Stream-Processing Points (IEEE Visualization 2005), Section 4.2.2; here exact. eigenentropy: "
          "Weinmann, Jutzi and Mallet, ISPRS Annals II-3 (2014)",
      .cost = "12 ns per neighbour up to k = 64, 15 ns beyond it; adaptive: 0.1 µs more for each k tried",
      .example = "knn(k=100, adaptive=eigenentropy, k_min=10) | normals"};
}

/// Throws UsageError unless k, or the radius if `radius_does`, limits the neighbours from which a rule chooses. The
/// default k of an operator is no such limit, since it is chosen for points that all have k neighbours.
void require_most(const OptionValues& options, const char* option, bool radius_does) {
  if (options.given("k") || (radius_does && options.given("radius"))) return;
  fail_usage("{}: {} needs {}, the most that any point may have, as in knn(k=64, {}={}).", options.where(), option,
             radius_does ? "k or radius" : "k", option, options.word(option));
}

SharedRule limits_of(const OptionValues& options) {
  AttributeLimits limits;
  if (options.given("k_from")) {
    require_most(options, "k_from", false);
    limits.k = options.word("k_from");
  }
  if (options.given("radius_from")) {
    require_most(options, "radius_from", true);
    limits.radius = options.word("radius_from");
  }
  return operators::limits_from_attributes(limits);
}

SharedRule adaptive_rule(const OptionValues& options) {
  require_most(options, "adaptive", false);
  const std::uint64_t least = options.whole("k_min"), most = options.whole("k");
  if (least > most)
    fail_usage("{}: k_min is {}, but k, the most there may be, is {}; give k_min of at most k.", options.where(), least,
               most);
  return operators::least_eigenentropy(least);
}

SharedRule rule_of(const OptionValues& options) {
  const bool adaptive = options.word("adaptive") != "none";
  const bool from_attributes = options.given("k_from") || options.given("radius_from");
  if (!adaptive && options.given("k_min"))
    fail_usage("{}: k_min is used only with adaptive=eigenentropy; add that, or leave it out.", options.where());
  if (adaptive && from_attributes)
    fail_usage("{}: adaptive chooses k itself; leave out k_from and radius_from, or adaptive.", options.where());
  if (adaptive) return adaptive_rule(options);
  return from_attributes ? limits_of(options) : SharedRule();
}

}  // namespace

const NeighborhoodDeclaration& neighborhood_declaration() {
  static const NeighborhoodDeclaration knn = declare_neighborhood();
  return knn;
}

Neighborhood make_neighborhood(const OptionValues& options) {
  Neighborhood neighborhood;
  if (options.given("k"))
    neighborhood.k = options.whole("k");
  else
    neighborhood.k = options.given("radius") ? Neighborhood::kUnlimited : Neighborhood::kOfOperators;
  if (options.given("radius")) neighborhood.radius = options.number("radius");
  neighborhood.rule = rule_of(options);
  return neighborhood;
}

void require_complete_lists(const Facts& facts, std::size_t k, double radius, const std::string& where) {
  if (!facts.neighborhood) return;
  const Neighborhood& has = *facts.neighborhood;
  const std::string remedy = k == Neighborhood::kUnlimited
                                 ? fmt::format("write knn(radius={}) before it", radius)
                                 : fmt::format("write knn(k={}) or knn(radius={}) before it", k, radius);
  if (has.rule)
    fail_usage("{}: counts the neighbours within {}, but each point keeps {}; {}.", where, radius, has.rule->meaning(),
               remedy);
  if (!(has.radius >= radius))
    fail_usage("{}: counts the neighbours within {}, but those within {} are known; {}.", where, radius, has.radius,
               remedy);
  if (has.k == Neighborhood::kOfOperators) return;
  if (has.k < k) fail_usage("{}: needs more neighbours than the {} nearest; {}.", where, has.k, remedy);
}

}  // namespace pointsweep
