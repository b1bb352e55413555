// SPDX-License-Identifier: MIT
/// NumPy arrays of neighbours and distances: read as rows of values, written from one field (format version 1.0).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/npy/npy_format.h"
#include "pointsweep/formats/records/record_readers.h"
#include "pointsweep/formats/records/record_writer.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kMostNeighborColumns = 1 << 16;

class NpyReader final : public ColumnsReader {
 public:
  explicit NpyReader(const std::filesystem::path& path) {
    auto file = std::make_shared<const InputFile>(path);
    const std::string name = path.string();
    const NpyHeader header = read_npy_header(*file, 0, file->size(), name);
    info_.path = path;
    info_.format = "NumPy array";
    info_.bytes = file->size();
    if (header.fortran_order && header.shape.size() > 1) fail("{}: is in Fortran order; save it in C order.", name);
    const std::uint64_t columns = header.shape.size() < 2 ? 1 : header.shape[1];
    if (header.shape.empty() || header.shape.size() > 2 || columns == 0 || columns > kMostNeighborColumns)
      fail("{}: its shape ({}) is not that of rows of neighbours.", name, fmt::join(header.shape, ", "));
    info_.count = header.shape[0];
    const Type type = type_of(header);
    for (std::uint64_t c = 0; c < columns; ++c)
      info_.schema.append(fmt::format("{}_{}", type == Type::f64 ? "distance" : "neighbor", c), type);
    has_records(std::move(file), header.data);
  }

 private:
  Type type_of(const NpyHeader& header) const {
    for (const auto& [description, type] : {std::pair{"<u4", Type::u32}, {"<u8", Type::u64}, {"<f8", Type::f64}})
      if (header.description == description) return type;
    fail("{}: holds '{}', which is neither neighbours ('<u4' or '<u8') nor distances ('<f8').", info_.path.string(),
         header.description);
  }
};

/// NumPy's type strings, in the order of Type.
constexpr const char* kTypeStrings[] = {"|i1", "|u1", "<i2", "<u2", "<i4", "<u4", "<i8", "<u8", "<f4", "<f8"};

/// Returns the header of a file: magic, version, length and the dictionary, padded with spaces to a multiple of 64
/// bytes as the format requires.
std::string npy_header(const OutputPlan& plan) {
  if (plan.schema.fields.size() != 1 || !plan.schema.fields[0].is_plain()) {
    fail_usage("{}: a .npy file holds one attribute, but {} were to be written to it.", plan.path.string(),
               plan.schema.fields.size());
  }
  const Field& field = plan.schema.fields[0];
  const bool is_list = field.count != 1 || (plan.made.size() == 1 && plan.made.front().is_list());
  const std::string columns = is_list ? fmt::format(" {}", field.count) : "";
  std::string dictionary = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({},{}), }}",
                                       kTypeStrings[static_cast<std::size_t>(field.type)], plan.count, columns);
  constexpr std::size_t kPrefix = 10;
  dictionary.append(63 - (kPrefix + dictionary.size()) % 64, ' ');
  dictionary += '\n';
  std::string header = "\x93NUMPY";
  header += {'\x01', '\x00', static_cast<char>(dictionary.size() & 0xff), static_cast<char>(dictionary.size() >> 8)};
  return header + dictionary;
}

Schema npy_schema(const OutputPlan& plan) {
  Schema stored;
  for (const Field& field : plan.schema.fields) stored.append(field.name, field.type, field.count);
  return stored;
}

constexpr std::string_view kNpyExtensions[] = {".npy"};

}  // namespace

std::unique_ptr<Reader> open_npy(const std::filesystem::path& path) { return std::make_unique<NpyReader>(path); }

std::unique_ptr<Writer> create_npy_writer(const OutputPlan& plan) {
  return std::make_unique<RecordWriter>(plan, npy_header(plan), npy_schema(plan));
}

const Format kNpyFormat = {.name = "NumPy array",
                           .title = "NumPy array",
                           .details = "#numpy",
                           .reads = "by `verify`: neighbours, distances",
                           .writes = "one attribute: neighbours, distances",
                           .extensions = kNpyExtensions,
                           .open = open_npy,
                           .create = create_npy_writer,
                           .content = Format::Content::array};

}  // namespace pointsweep
