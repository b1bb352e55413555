// SPDX-License-Identifier: MIT
#include "pointsweep/shapes/registry.h"

#include <string>

#include "pointsweep/fail.h"

namespace pointsweep {

std::vector<std::unique_ptr<Shape>> all_shapes() {
  std::vector<std::unique_ptr<Shape>> shapes;
  shapes.push_back(make_plane());
  shapes.push_back(make_sphere());
  shapes.push_back(make_cylinder());
  shapes.push_back(make_torus());
  shapes.push_back(make_statue());
  shapes.push_back(make_terrain());
  shapes.push_back(make_tls());
  shapes.push_back(make_volume());
  return shapes;
}

std::unique_ptr<Shape> create_shape(std::string_view name) {
  std::string known;
  for (auto& shape : all_shapes()) {
    if (shape->name() == name) return std::move(shape);
    known += (known.empty() ? "" : ", ") + shape->name();
  }
  fail_usage("no shape is called '{}'; choose one of {}.", name, known);
}

}  // namespace pointsweep
