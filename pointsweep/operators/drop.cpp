// SPDX-License-Identifier: MIT
#include "pointsweep/operators/drop.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/operators/declaration.h"

namespace pointsweep {

OperatorDeclaration drop_declaration() {
  return {.name = "drop",
          .meaning = "leaves attributes out of the output; later stages cannot read them",
          .options = {{.name = "attributes",
                       .kind = OptionKind::attributes,
                       .meaning = "attributes to leave out, of the input or computed by earlier stages; 'attributes=' "
                                  "may be left out",
                       .required = true,
                       .positional = true,
                       .sample = std::string("intensity")}},
          .make = [](const OptionValues& options,
                     const Facts&) { return std::make_shared<Drop>(words_of(options.word("attributes"))); },
          .undefined = "The coordinates x, y and z are never dropped.",
          .cost = "none: what is dropped is not computed either, unless a stage before reads it",
          .example = "knn(k=12) | normals | set(facing = nz * nz) | drop(normal)"};
}

Drop::Drop(std::vector<std::string> attributes) : attributes_(std::move(attributes)) {
  if (attributes_.empty() || std::ranges::any_of(attributes_, &std::string::empty))
    fail_usage("drop: names no attribute; write the names of those to leave out, as in drop(intensity, gps_time).");
}

Options Drop::own_options() const { return {{"attributes", fmt::format("{}", fmt::join(attributes_, ","))}}; }

void AllRows::apply(const Neighborhoods& in, Columns& out) const {
  std::fill_n(out.column<std::uint8_t>(0).begin(), in.size(), std::uint8_t{1});
}

}  // namespace pointsweep
