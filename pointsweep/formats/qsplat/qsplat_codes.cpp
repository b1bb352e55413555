// SPDX-License-Identifier: MIT
#include "pointsweep/formats/qsplat/qsplat_codes.h"

#include <cmath>
#include <vector>

namespace pointsweep {
namespace {

constexpr int kGrid = 13;
constexpr unsigned kPlaces = 52;

/// tan((2 i + 1 - 52) / 52 · π/4) as QSplat's floats have it: places lie closer in the middle of a face.
constexpr std::array<float, kPlaces> kUnwarped = {
    -0.97023958f,  -0.913248599f, -0.859318495f,  -0.808118105f,  -0.759358764f,  -0.712786794f, -0.668178618f,
    -0.625336111f, -0.584082663f, -0.544260144f,  -0.505726278f,  -0.468352348f,  -0.432021499f, -0.396627009f,
    -0.362070829f, -0.328262657f, -0.295118511f,  -0.262560338f,  -0.23051466f,   -0.198912367f, -0.16768764f,
    -0.136777759f, -0.106122367f, -0.0756629109f, -0.0453424528f, -0.0151049234f, 0.0151050175f, 0.0453424528f,
    0.0756629556f, 0.106122419f,  0.136777848f,   0.167687744f,   0.198912367f,   0.230514705f,  0.262560397f,
    0.29511863f,   0.328262746f,  0.362070888f,   0.396627069f,   0.432021618f,   0.468352467f,  0.505726278f,
    0.544260204f,  0.584082782f,  0.62533623f,    0.668178797f,   0.712786794f,   0.759358823f,  0.808118284f,
    0.859318614f,  0.913248599f,  0.970239699f};

/// Centres and radii of the codes, relative to a parent of centre 0 and radius 1.
std::vector<QsplatSphere> relative_spheres() {
  std::vector<QsplatSphere> spheres;
  const float step = 1.0f / static_cast<float>(kGrid), sqrt3 = std::sqrt(3.0f);
  for (int size = 1; size <= kGrid; ++size) {
    const float radius = static_cast<float>(size) * step;
    const float reach = 1.0f + sqrt3 * radius;
    const auto center = [&](int place) { return static_cast<float>(size + 2 * place) * step - 1.0f; };
    for (int x = 0; x <= kGrid - size; ++x) {
      for (int y = 0; y <= kGrid - size; ++y) {
        for (int z = 0; z <= kGrid - size; ++z) {
          const QsplatSphere sphere{center(x), center(y), center(z), radius};
          if (sphere.x * sphere.x + sphere.y * sphere.y + sphere.z * sphere.z > reach * reach) continue;
          spheres.push_back(sphere);
        }
      }
    }
  }
  return spheres;
}

}  // namespace

std::optional<QsplatSphere> qsplat_sphere(unsigned code, const QsplatSphere& parent) {
  static const std::vector<QsplatSphere> spheres = relative_spheres();
  if (code >= spheres.size()) return std::nullopt;
  const QsplatSphere& s = spheres[code];
  return QsplatSphere{parent.x + parent.radius * s.x, parent.y + parent.radius * s.y, parent.z + parent.radius * s.z,
                      parent.radius * s.radius};
}

std::array<float, 3> qsplat_normal(unsigned code) {
  const unsigned face = code / (kPlaces * kPlaces);
  if (face >= 6) return {0, 0, 1};
  const float u = kUnwarped[code / kPlaces % kPlaces], v = kUnwarped[code % kPlaces];
  const float rest = 1.0f - u * u - v * v;
  if (!(rest >= 0)) return {0, 0, 0};
  const float out = face % 2 == 0 ? std::sqrt(rest) : -std::sqrt(rest);
  const unsigned axis = face / 2;  // u and v belong to the two axes that follow it
  std::array<float, 3> normal{};
  normal[axis] = out;
  normal[(axis + 1) % 3] = u;
  normal[(axis + 2) % 3] = v;
  return normal;
}

std::array<std::uint8_t, 3> qsplat_color(unsigned code) {
  const unsigned r = code >> 11 & 31, g = code >> 5 & 63, b = code & 31;
  const auto byte = [](unsigned value) { return static_cast<std::uint8_t>(value); };
  return {byte(r << 3 | r >> 2), byte(g << 2 | g >> 4), byte(b << 3 | b >> 2)};
}

}  // namespace pointsweep
