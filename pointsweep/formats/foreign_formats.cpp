// SPDX-License-Identifier: MIT
#include "pointsweep/formats/foreign_formats.h"

#include "pointsweep/fail.h"
#include "pointsweep/formats/extension.h"

namespace pointsweep {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kWithMeshTool = "export its points as PLY, e.g. with MeshLab or CloudCompare";
constexpr std::string_view kUnpack = "unpack it first";

struct Magic {
  std::string_view bytes;
  std::string_view what;
  std::string_view remedy;
};
constexpr Magic kMagics[] = {
    {"\x1f\x8b"sv, "a gzip archive", kUnpack},
    {"PK\x03\x04"sv, "a zip archive", kUnpack},
    {"BZh"sv, "a bzip2 archive", kUnpack},
    {"\xfd\x37zXZ\0"sv, "an xz archive", kUnpack},
    {"\x28\xb5\x2f\xfd"sv, "a zstd archive", kUnpack},
    {"\x89HDF"sv, "an HDF5 file", "export its points as PLY or LAS"},
    {"glTF"sv, "a glTF file", kWithMeshTool},
    {"<VTKFile"sv, "a VTK XML file", "save it as legacy VTK or PLY"},
    {"solid "sv, "an STL file", kWithMeshTool},
    {"<?xml"sv, "an XML file", "give the file that holds the points"},
    {"{"sv, "a JSON file", "give the file that holds the points"},
    {"\xff\xfe"sv, "text in UTF-16", "save it as UTF-8"},
    {"\xfe\xff"sv, "text in UTF-16", "save it as UTF-8"},
};

/// Text formats without a magic number go by their extension.
constexpr Magic kExtensions[] = {
    {".ptx"sv, "a PTX file that does not begin with the ten lines of its header", "export it again"},
    {".stl"sv, "an STL file", kWithMeshTool},
};

[[noreturn]] void refuse(const std::filesystem::path& path, const Magic& magic) {
  fail("{}: is {}, which pointsweep does not read; {}.", path.string(), magic.what, magic.remedy);
}

}  // namespace

void refuse_foreign_format(const std::filesystem::path& path, std::string_view head, std::string_view known,
                           std::string_view asked_for) {
  for (const Magic& magic : kMagics) {
    if (head.starts_with(magic.bytes)) refuse(path, magic);
  }
  for (const Magic& magic : kExtensions) {
    if (extension_of(path) == magic.bytes) refuse(path, magic);
  }
  const std::size_t zero = head.find('\0');
  if (zero != head.npos) {
    fail(
        "{}: is binary (byte {} is 0) but neither {}; convert it to one of these, or, if it is nothing but float32 "
        "records, name their format with --format {}.",
        path.string(), zero, known, asked_for);
  }
}

}  // namespace pointsweep
