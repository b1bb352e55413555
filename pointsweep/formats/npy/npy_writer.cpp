// SPDX-License-Identifier: MIT
#include "pointsweep/formats/npy/npy_writer.h"

#include <string>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

/// NumPy's type strings, in the order of Type.
constexpr const char* kTypeStrings[] = {"|i1", "|u1", "<i2", "<u2", "<i4", "<u4", "<i8", "<u8", "<f4", "<f8"};

/// Magic, version, length and the dictionary, padded with spaces to a multiple of 64 bytes as the format asks.
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

}  // namespace

NpyWriter::NpyWriter(const OutputPlan& plan) : RecordWriter(plan, npy_header(plan), npy_schema(plan)) {}

}  // namespace pointsweep
