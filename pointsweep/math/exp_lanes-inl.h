// SPDX-License-Identifier: MIT
/// exp.h in vector lanes: the operations of exp.h in the same order, hence the same bits. Included once per instruction
/// set.
#if defined(POINTSWEEP_MATH_EXP_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTSWEEP_MATH_EXP_LANES_INL_H_
#undef POINTSWEEP_MATH_EXP_LANES_INL_H_
#else
#define POINTSWEEP_MATH_EXP_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cstdint>
#include <iterator>

#include "pointsweep/math/exp.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Returns exp(-x) for x >= 0 in lanes of double or of float.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V ExpNegative(D d, V x) {
  using C = ExpConstants<hn::TFromD<D>>;
  const hn::RebindToUnsigned<D> du;
  const auto q = [&](int i) HWY_ATTR { return hn::Set(d, C::kQ[i]); };
  const auto line = [&](int i, V y) HWY_ATTR { return hn::Add(q(i), hn::Mul(q(i + 1), y)); };
  const V largest = hn::Set(d, C::kLargest), round = hn::Set(d, C::kRound), one = hn::Set(d, hn::TFromD<D>{1});
  const V bounded = hn::Min(x, largest);
  const V shifted = hn::Add(hn::Mul(bounded, hn::Set(d, C::kLog2E)), round);
  const V n = hn::Sub(shifted, round);
  const V y = hn::Sub(hn::Mul(n, hn::Set(d, C::kLn2Low)), hn::Sub(bounded, hn::Mul(n, hn::Set(d, C::kLn2High))));
  const V y2 = hn::Mul(y, y), y4 = hn::Mul(y2, y2);
  V high = q(4);
  if constexpr (std::size(C::kQ) == 10)
    high = hn::Add(hn::Add(line(4, y), hn::Mul(line(6, y), y2)), hn::Mul(line(8, y), y4));
  const V sum = hn::Add(hn::Add(line(0, y), hn::Mul(line(2, y), y2)), hn::Mul(high, y4));
  const V mantissa = hn::Add(one, hn::Add(y, hn::Mul(y2, sum)));
  const V power = hn::BitCast(d, hn::Sub(hn::Set(du, C::kExponentOfOne << C::kMantissaBits),
                                         hn::ShiftLeft<C::kMantissaBits>(hn::BitCast(du, shifted))));
  return hn::IfThenZeroElse(hn::Gt(x, largest), hn::Mul(mantissa, power));
}

/// Returns floor(log2(x)) for normal x > 0, in lanes of double.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V BinaryExponent(D d, V x) {
  const hn::RebindToUnsigned<D> du;
  // The biased exponent, put into the low bits of 2^52, gives the double 2^52 + biased exponent.
  const auto biased = hn::Or(hn::ShiftRight<52>(hn::BitCast(du, x)), hn::Set(du, std::uint64_t{1075} << 52));
  return hn::Sub(hn::BitCast(d, biased), hn::Set(d, 0x1p52 + 1023));
}

/// Returns ln(x) for normal x > 0 in lanes of double.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V NaturalLogarithm(D d, V x) {
  const hn::RebindToUnsigned<D> du;
  const V one = hn::Set(d, 1.0);
  const auto fraction = hn::And(hn::BitCast(du, x), hn::Set(du, std::uint64_t{0xfffffffffffff}));
  const V m = hn::BitCast(d, hn::Or(fraction, hn::Set(du, std::uint64_t{1023} << 52)));
  const auto is_large = hn::Gt(m, hn::Set(d, 1.4142135623730951));
  const V mantissa = hn::IfThenElse(is_large, hn::Mul(m, hn::Set(d, 0.5)), m);
  const V exponent = hn::Add(BinaryExponent(d, x), hn::IfThenElseZero(is_large, one));
  const V z = hn::Div(hn::Sub(mantissa, one), hn::Add(mantissa, one)), z2 = hn::Mul(z, z);
  V sum = hn::Set(d, 1.0 / 19);
  for (const double odd : {17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0})
    sum = hn::Add(hn::Mul(sum, z2), hn::Set(d, 1.0 / odd));
  return hn::Add(hn::Mul(hn::Mul(hn::Set(d, 2.0), z), sum), hn::Mul(hn::Set(d, 0.69314718055994530942), exponent));
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
