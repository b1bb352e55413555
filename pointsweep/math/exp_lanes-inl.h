// SPDX-License-Identifier: MIT
/// exp.h in vector lanes: the same operations in the same order, hence the same bits. Included once per instruction
/// set.
#if defined(POINTSWEEP_MATH_EXP_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTSWEEP_MATH_EXP_LANES_INL_H_
#undef POINTSWEEP_MATH_EXP_LANES_INL_H_
#else
#define POINTSWEEP_MATH_EXP_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "pointsweep/math/exp.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// exp(-x) for x >= 0, 0 for x > 708.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V ExpNegative(D d, V x) {
  using namespace exp_constants;
  const hn::RebindToUnsigned<D> du;
  const auto q = [&](int i) HWY_ATTR { return hn::Set(d, kQ[i]); };
  const auto line = [&](int i, V y) HWY_ATTR { return hn::Add(q(i), hn::Mul(q(i + 1), y)); };
  const V largest = hn::Set(d, kLargest), round = hn::Set(d, kRound);
  const V bounded = hn::Min(x, largest);
  const V shifted = hn::Add(hn::Mul(bounded, hn::Set(d, kLog2E)), round);
  const V n = hn::Sub(shifted, round);
  const V y = hn::Sub(hn::Mul(n, hn::Set(d, kLn2Low)), hn::Sub(bounded, hn::Mul(n, hn::Set(d, kLn2High))));
  const V y2 = hn::Mul(y, y), y4 = hn::Mul(y2, y2);
  const V low = hn::Add(line(0, y), hn::Mul(line(2, y), y2));
  const V high = hn::Add(line(4, y), hn::Mul(line(6, y), y2));
  const V sum = hn::Add(low, hn::Mul(hn::Add(high, hn::Mul(line(8, y), y4)), y4));
  const V mantissa = hn::Add(hn::Set(d, 1.0), hn::Add(y, hn::Mul(y2, sum)));
  const V power =
      hn::BitCast(d, hn::Sub(hn::Set(du, std::uint64_t{1023} << 52), hn::ShiftLeft<52>(hn::BitCast(du, shifted))));
  return hn::IfThenZeroElse(hn::Gt(x, largest), hn::Mul(mantissa, power));
}

/// exp(-x) in single precision for x >= 0, 0 for x > 87.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V ExpNegativeF32(D d, V x) {
  using namespace exp_constants_f32;
  const hn::RebindToUnsigned<D> du;
  const auto q = [&](int i) HWY_ATTR { return hn::Set(d, kQ[i]); };
  const V largest = hn::Set(d, kLargest), round = hn::Set(d, kRound);
  const V bounded = hn::Min(x, largest);
  const V shifted = hn::Add(hn::Mul(bounded, hn::Set(d, kLog2E)), round);
  const V n = hn::Sub(shifted, round);
  const V y = hn::Sub(hn::Mul(n, hn::Set(d, kLn2Low)), hn::Sub(bounded, hn::Mul(n, hn::Set(d, kLn2High))));
  const V y2 = hn::Mul(y, y);
  const V low = hn::Add(hn::Add(q(0), hn::Mul(q(1), y)), hn::Mul(hn::Add(q(2), hn::Mul(q(3), y)), y2));
  const V sum = hn::Add(low, hn::Mul(q(4), hn::Mul(y2, y2)));
  const V mantissa = hn::Add(hn::Set(d, 1.0f), hn::Add(y, hn::Mul(y2, sum)));
  const V power =
      hn::BitCast(d, hn::Sub(hn::Set(du, std::uint32_t{127} << 23), hn::ShiftLeft<23>(hn::BitCast(du, shifted))));
  return hn::IfThenZeroElse(hn::Gt(x, largest), hn::Mul(mantissa, power));
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
