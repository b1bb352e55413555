// SPDX-License-Identifier: MIT
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/npy/npy_array.h"
#include "pointsweep/formats/npy/npy_points.h"

namespace pointsweep {
namespace {

constexpr std::string_view kNpyExtensions[] = {".npy"}, kNpzExtensions[] = {".npz"};

std::unique_ptr<Writer> create_npy_writer(const OutputPlan& plan) { return std::make_unique<NpyWriter>(plan); }

}  // namespace

const Format kNpyFormat = {.name = "NumPy array",
                           .title = "NumPy array",
                           .details = "#numpy",
                           .reads = "by `verify`: neighbours, distances",
                           .writes = "one attribute: neighbours, distances",
                           .extensions = kNpyExtensions,
                           .open = open_npy,
                           .create = create_npy_writer,
                           .content = Format::Content::array};

const Format kNpyPointsFormat = {
    .name = "NumPy array",
    .title = "NumPy points",
    .details = "#numpy",
    .reads = "`.npy` of three columns or more, or of a structured type; `.npz` that is stored",
    .writes = "no",
    .extensions = kNpzExtensions,
    .is = starts_as_npy_points,
    .open = open_npy_points};

}  // namespace pointsweep
