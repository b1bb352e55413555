// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/colors.h"

#include <algorithm>
#include <cmath>

namespace pointsweep::formulas {
namespace {

constexpr int kViridisKnots[] = {0x440154, 0x482878, 0x3e4a89, 0x31688e, 0x26828e,
                                 0x1f9e89, 0x35b779, 0x6dcd59, 0xb4de2c, 0xfde725};
constexpr int kClassColors[] = {0x969696, 0xbebebe, 0xa87038, 0xaad76e, 0x55b446, 0x147d32, 0xe14b3c, 0xdc28dc,
                                0x787878, 0x3c82e6, 0x7846a0, 0x4b505f, 0x787878, 0xfae15a, 0xf5be1e, 0xf08714,
                                0xc8a014, 0x00aab9, 0xff6eff, 0xffa08c, 0xd7af82, 0xcdebff, 0xebcdeb};
constexpr int kOtherClasses[] = {0x4269d0, 0xefb118, 0x6cc5b0, 0xa463f2, 0x9c6b4e, 0xff8ab7};
/// Coefficients of the polynomial for each channel of the scale turbo, from the highest power down.
constexpr double kTurboChannels[3][6] = {
    {59.28637943, -152.94239396, 132.13108234, -42.66032258, 4.61539260, 0.13572138},
    {2.82956604, 4.27729857, -14.18503333, 4.84296658, 2.19418839, 0.09140261},
    {27.34824973, -89.90310912, 110.36276771, -60.58204836, 12.64194608, 0.10667330}};

int channel_of(int color, std::size_t c) { return color >> (16 - 8 * static_cast<int>(c)) & 255; }
int nearest_byte(double v) { return static_cast<int>(std::floor(std::min(std::max(v, 0.0), 255.0) + 0.5)); }

}  // namespace

std::array<int, 3> color_of(double value, ColorScale scale, double lo, double hi) {
  std::array<int, 3> rgb{128, 128, 128};
  if (std::isnan(value)) return rgb;
  if (scale == ColorScale::classes) {
    const int code = nearest_byte(value);
    const int color = code < 23 ? kClassColors[code] : kOtherClasses[code % 6];
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = channel_of(color, c);
    return rgb;
  }
  double t = hi > lo ? (value - lo) / (hi - lo) : 0.0;
  if (std::isnan(t) || (hi <= lo && std::isinf(value))) return rgb;
  t = std::min(std::max(t, 0.0), 1.0);
  for (std::size_t c = 0; c < 3; ++c) {
    double v = t;
    if (scale == ColorScale::turbo) {
      v = 0;
      for (const double factor : kTurboChannels[c]) v = v * t + factor;
    }
    rgb[c] = nearest_byte(255 * v);
    if (scale != ColorScale::viridis) continue;
    const auto knot = std::min(static_cast<std::size_t>(t * 9), std::size_t{8});
    const int a = channel_of(kViridisKnots[knot], c), b = channel_of(kViridisKnots[knot + 1], c);
    rgb[c] = static_cast<int>(a + (b - a) * (t * 9 - static_cast<double>(knot)) + 0.5);
  }
  return rgb;
}

}  // namespace pointsweep::formulas
