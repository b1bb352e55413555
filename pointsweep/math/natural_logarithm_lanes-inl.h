// SPDX-License-Identifier: MIT
/// natural_logarithm.h in vector lanes: the same operations in the same order, hence the same bits. Included once per
/// instruction set.
#if defined(POINTSWEEP_MATH_NATURAL_LOGARITHM_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTSWEEP_MATH_NATURAL_LOGARITHM_LANES_INL_H_
#undef POINTSWEEP_MATH_NATURAL_LOGARITHM_LANES_INL_H_
#else
#define POINTSWEEP_MATH_NATURAL_LOGARITHM_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// floor(log2(x)) for normal x > 0, in lanes of double.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V BinaryExponent(D d, V x) {
  const hn::RebindToUnsigned<D> du;
  // The biased exponent in the low bits of 2^52 makes 2^52 + exponent.
  const auto biased = hn::Or(hn::ShiftRight<52>(hn::BitCast(du, x)), hn::Set(du, std::uint64_t{1075} << 52));
  return hn::Sub(hn::BitCast(d, biased), hn::Set(d, 0x1p52 + 1023));
}

/// ln(x) for normal x > 0 in lanes of double.
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
