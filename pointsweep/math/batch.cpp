// SPDX-License-Identifier: MIT
#include "pointsweep/math/batch.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

#include "pointsweep/math/instruction_sets.h"
#include "pointsweep/program/process.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/math/batch.cpp"
#include <hwy/foreach_target.h>
// The following headers must be included for each target.
#include "pointsweep/math/eigen3_lanes-inl.h"
#include "pointsweep/math/exp.h"
#include "pointsweep/math/exp_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

using Lanes = hn::ScalableTag<double>;

constexpr std::size_t kLanes = hn::MaxLanes(Lanes());

/// One matrix per lane. Put() fills the first six rows with the entries of the matrices; Take() fills all twelve rows
/// with three eigenvalues and three eigenvectors, and copies them to `out`.
struct MatrixGroup {
  HWY_ALIGN double lanes[12][kLanes];

  void Put(std::span<const Symmetric3> matrices) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      const Symmetric3 m = l < matrices.size() ? matrices[l] : Symmetric3{};
      const double entries[] = {m.xx, m.xy, m.xz, m.yy, m.yz, m.zz};
      for (std::size_t e = 0; e < 6; ++e) lanes[e][l] = entries[e];
    }
  }
  auto InLanes() const {
    const Lanes d;
    return Symmetric3Lanes<hn::Vec<Lanes>>{hn::Load(d, lanes[0]), hn::Load(d, lanes[1]), hn::Load(d, lanes[2]),
                                           hn::Load(d, lanes[3]), hn::Load(d, lanes[4]), hn::Load(d, lanes[5])};
  }
  void Take(const Eigen3Lanes<hn::Vec<Lanes>>& e, std::span<Eigen3> out) {
    std::size_t row = 0;
    for (const auto& v : {e.value0, e.value1, e.value2, e.vector0.x, e.vector0.y, e.vector0.z, e.vector1.x, e.vector1.y,
                          e.vector1.z, e.vector2.x, e.vector2.y, e.vector2.z})
      hn::Store(v, Lanes(), lanes[row++]);
    for (std::size_t l = 0; l < std::min(kLanes, out.size()); ++l)
      out[l] = {{lanes[0][l], lanes[1][l], lanes[2][l]},
                {{{lanes[3][l], lanes[4][l], lanes[5][l]},
                  {lanes[6][l], lanes[7][l], lanes[8][l]},
                  {lanes[9][l], lanes[10][l], lanes[11][l]}}}};
  }
};

void EigenSymmetric3Of(std::span<const Symmetric3> matrices, std::span<Eigen3> out) {
  for (std::size_t first = 0; first < matrices.size(); first += 2 * kLanes) {
    const std::size_t second = std::min(first + kLanes, matrices.size());
    MatrixGroup a, b;
    a.Put(matrices.subspan(first));
    b.Put(matrices.subspan(second));
    const auto eigen = EigenSymmetric3(Lanes(), a.InLanes(), b.InLanes());
    a.Take(eigen[0], out.subspan(first));
    b.Take(eigen[1], out.subspan(second));
  }
}

void ExpNegativeOf(std::span<const double> x, std::span<double> out) {
  const Lanes d;
  std::size_t i = 0;
  for (; i + kLanes <= x.size(); i += kLanes) hn::StoreU(ExpNegative(d, hn::LoadU(d, &x[i])), d, &out[i]);
  for (; i < x.size(); ++i) out[i] = exp_negative(x[i]);
}

void NaturalLogarithmOf(std::span<const double> x, std::span<double> out) {
  const Lanes d;
  std::size_t i = 0;
  for (; i + kLanes <= x.size(); i += kLanes) hn::StoreU(NaturalLogarithm(d, hn::LoadU(d, &x[i])), d, &out[i]);
  for (; i < x.size(); ++i) out[i] = natural_logarithm(x[i]);
}

const char* NameOfTarget() { return hwy::TargetName(HWY_TARGET); }

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointsweep {

HWY_EXPORT(EigenSymmetric3Of);
HWY_EXPORT(ExpNegativeOf);
HWY_EXPORT(NaturalLogarithmOf);
HWY_EXPORT(NameOfTarget);

void batch_eigen_symmetric3(std::span<const Symmetric3> matrices, std::span<Eigen3> out) {
  assert(matrices.size() == out.size());
  HWY_DYNAMIC_DISPATCH(EigenSymmetric3Of)(matrices, out);
}

void batch_exp_negative(std::span<const double> x, std::span<double> out) {
  assert(x.size() == out.size());
  HWY_DYNAMIC_DISPATCH(ExpNegativeOf)(x, out);
}

void batch_natural_logarithm(std::span<const double> x, std::span<double> out) {
  assert(x.size() == out.size());
  HWY_DYNAMIC_DISPATCH(NaturalLogarithmOf)(x, out);
}

std::string_view instruction_set_in_use() { return HWY_DYNAMIC_DISPATCH(NameOfTarget)(); }

}  // namespace pointsweep
#endif
