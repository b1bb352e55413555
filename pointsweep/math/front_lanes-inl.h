// SPDX-License-Identifier: MIT
/// Movement of chosen lanes of a vector to its front. Included once per instruction set.
#if defined(POINTSWEEP_MATH_FRONT_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTSWEEP_MATH_FRONT_LANES_INL_H_
#undef POINTSWEEP_MATH_FRONT_LANES_INL_H_
#else
#define POINTSWEEP_MATH_FRONT_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Moves the lanes that a mask chooses to the front of vectors of 32- or 64-bit lanes; the lanes behind the chosen
/// lanes are unspecified. Vectors of up to eight lanes use a table: GCC would copy the table of Highway 1.0.3's own
/// Compress onto the stack every time. Sixteen lanes need one instruction.
template <class D>
class Front {
  using Numbers = hn::RebindToUnsigned<D>;
  using Number = hn::TFromD<Numbers>;
  static constexpr std::size_t kLanes = hn::MaxLanes(D());
  static constexpr bool kByTable = kLanes > 1 && kLanes <= 8;

  // One byte per lane keeps the table small; with 64-bit lanes, SSE4 and AVX2 would need several instructions to widen
  // bytes.
  static constexpr bool kBytes = sizeof(Number) == 4 || kLanes == 8;

  struct Table {
    using Entry = std::conditional_t<kBytes, std::uint8_t, Number>;
    HWY_ALIGN Entry lanes[kByTable ? std::size_t{1} << kLanes : 1][kLanes] = {};
    constexpr Table() {
      for (std::size_t mask = 0; kByTable && mask < std::size_t{1} << kLanes; ++mask) {
        std::size_t n = 0;
        for (std::size_t l = 0; l < kLanes; ++l) {
          if (mask >> l & 1) lanes[mask][n++] = static_cast<Entry>(l);
        }
      }
    }
  };
  static constexpr Table kTable{};

 public:
  explicit HWY_INLINE Front(hn::Mask<D> mask) : mask_(mask) {
    if constexpr (kByTable) {
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(D(), mask, bits);
      if constexpr (kBytes) {
        const hn::Rebind<std::uint32_t, Numbers> d32;
        const auto bytes = hn::LoadU(hn::Rebind<std::uint8_t, Numbers>(), kTable.lanes[bits[0]]);
        if constexpr (sizeof(Number) == 4)
          numbers_ = hn::PromoteTo(d32, bytes);
        else
          numbers_ = hn::PromoteTo(Numbers(), hn::PromoteTo(d32, bytes));
      } else {
        numbers_ = hn::LoadU(Numbers(), kTable.lanes[bits[0]]);
      }
    }
  }
  template <class V>
  HWY_INLINE V operator()(V v) const {
    const hn::DFromV<V> d;
    if constexpr (kByTable)
      return hn::TableLookupLanes(v, hn::IndicesFromVec(d, numbers_));
    else
      return hn::Compress(v, hn::RebindMask(d, mask_));
  }

 private:
  hn::Mask<D> mask_;
  hn::Vec<Numbers> numbers_;
};

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
