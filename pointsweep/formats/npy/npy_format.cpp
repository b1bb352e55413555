// SPDX-License-Identifier: MIT
#include "pointsweep/formats/npy/npy_format.h"

#include "pointsweep/formats/npy/npy_reader.h"
#include "pointsweep/formats/npy/npy_writer.h"

namespace pointsweep {
namespace {

constexpr std::string_view kNpyExtensions[] = {".npy"};

std::unique_ptr<Writer> create_npy_writer(const OutputPlan& plan) { return std::make_unique<NpyWriter>(plan); }

}  // namespace

const Format kNpyFormat = {.name = "NumPy array",
                           .title = "NumPy array",
                           .details = "",
                           .reads = "by `verify`: neighbours, distances",
                           .writes = "one attribute: neighbours, distances",
                           .extensions = kNpyExtensions,
                           .open = open_npy,
                           .create = create_npy_writer,
                           .content = Format::Content::array};

}  // namespace pointsweep
