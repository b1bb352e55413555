// SPDX-License-Identifier: MIT
#include "pointsweep/formats/ply/ply_format.h"

#include "pointsweep/formats/format.h"

namespace pointsweep {
namespace {

constexpr std::string_view kPlyExtensions[] = {".ply"};

bool is_ply(std::string_view head) {
  return head.starts_with("ply") && head.size() > 3 && std::string_view("\r\n\t ").find(head[3]) != head.npos;
}

}  // namespace

const Format kPlyFormat = {.name = "PLY",
                           .title = "PLY",
                           .details = "",
                           .reads = "ascii, binary little- and big-endian",
                           .writes = "binary little-endian",
                           .extensions = kPlyExtensions,
                           .is = is_ply,
                           .open = open_ply,
                           .create = create_ply_writer,
                           .holds_crs = true,
                           .holds_provenance = true,
                           .is_sequential = true};

}  // namespace pointsweep
