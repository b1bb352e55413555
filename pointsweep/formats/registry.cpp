// SPDX-License-Identifier: MIT
/// The list of formats: readers told apart by content, writers by extension.
#include <algorithm>
#include <array>

#include "pointsweep/error.h"
#include "pointsweep/formats/extension.h"
#include "pointsweep/formats/files/input_file.h"
#include "pointsweep/formats/foreign_formats.h"
#include "pointsweep/formats/las/las_reader.h"
#include "pointsweep/formats/las/las_writer.h"
#include "pointsweep/formats/las/laz_writer.h"
#include "pointsweep/formats/pcd/pcd_reader.h"
#include "pointsweep/formats/ply/ply_reader.h"
#include "pointsweep/formats/ply/ply_writer.h"
#include "pointsweep/formats/qsplat/qsplat_reader.h"
#include "pointsweep/formats/reader.h"
#include "pointsweep/formats/text/text_reader.h"
#include "pointsweep/formats/text/text_writer.h"
#include "pointsweep/formats/writer.h"

namespace pointsweep {
namespace {

/// The first bytes of a file, enough to tell what it is.
std::string head_of(const std::filesystem::path& path) {
  const InputFile file(path);
  if (file.size() == 0) fail("{}: is empty (0 bytes); it was perhaps not written or copied completely.", path.string());
  std::string head(4096, '\0');
  head.resize(file.read_some(0, std::as_writable_bytes(std::span(head))));
  return head;
}

bool starts_as_ply(std::string_view head) {
  return head.starts_with("ply") && head.size() > 3 && std::string_view("\r\n\t ").find(head[3]) != head.npos;
}

struct WriterOf {
  std::string_view extension;
  std::unique_ptr<Writer> (*create)(const OutputPlan& plan);
};
constexpr WriterOf kWriters[] = {
    {".ply", create_ply_writer},  {".las", create_las_writer},  {".laz", create_laz_writer},
    {".xyz", create_text_writer}, {".txt", create_text_writer}, {".csv", create_text_writer},
    {".asc", create_text_writer}, {".pts", create_text_writer},
};

}  // namespace

std::unique_ptr<Reader> open_reader(const std::filesystem::path& path) {
  const std::string head = head_of(path);
  if (starts_as_ply(head)) return open_ply(path);
  if (head.starts_with("LASF")) return open_las(path);
  if (head.starts_with("QSplat")) return open_qsplat(path);
  if (starts_as_pcd(head)) return open_pcd(path);
  refuse_foreign_format(path, head);
  return open_text(path);
}

std::unique_ptr<Writer> create_writer(const OutputPlan& plan) {
  const std::string extension = extension_of(plan.path);
  std::string known;
  for (const WriterOf& writer : kWriters) {
    if (writer.extension == extension) return writer.create(plan);
    known += fmt::format("{}{}", known.empty() ? "" : ", ", writer.extension);
  }
  fail_usage("{}: {} is no format that can be written; the extension may be one of {}.", plan.path.string(),
             extension.empty() ? "a name without extension" : fmt::format("'{}'", extension), known);
}

std::vector<std::string_view> writable_extensions() {
  std::vector<std::string_view> extensions;
  for (const WriterOf& writer : kWriters) extensions.push_back(writer.extension);
  return extensions;
}

}  // namespace pointsweep
