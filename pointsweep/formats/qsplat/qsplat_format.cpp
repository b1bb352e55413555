// SPDX-License-Identifier: MIT
#include "pointsweep/formats/qsplat/qsplat_format.h"

#include "pointsweep/formats/qsplat/qsplat_reader.h"

namespace pointsweep {
namespace {

constexpr std::string_view kQsplatExtensions[] = {".qs"};

bool is_qsplat(std::string_view head) { return head.starts_with("QSplat"); }

}  // namespace

const Format kQsplatFormat = {.name = "QSplat",
                              .title = "QSplat",
                              .details = "#qsplat",
                              .reads = "version 11, leaves as points",
                              .writes = "no",
                              .extensions = kQsplatExtensions,
                              .is = is_qsplat,
                              .open = open_qsplat,
                              .states_bounds = true};

}  // namespace pointsweep
