// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/tile_state.h"

#include <cstdint>
#include <span>

#include "pointsweep/fail.h"
#include "pointsweep/formats/cloud/row_selection.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {
namespace {

constexpr Encoding kStateEncoding{"state of a tile", 2};
constexpr Encoding kValuesEncoding{"values of the cloud", 1};

}  // namespace

void TileState::encode(Encoder& out) const {
  out.begin(kStateEncoding);
  survey.encode(out);
  out.put_list(mask, [&](const std::vector<std::byte>& block) { out.put_bytes(block); });
  out.put_text(carried);
  out.put_list(saved_values, [&](const std::vector<std::byte>& value) { out.put_bytes(value); });
  out.put_text(swept);
}

TileState TileState::decode(Decoder& in) {
  in.begin(kStateEncoding);
  TileState state;
  state.survey = Survey::decode(in);
  const auto get = [&] { return in.get_bytes(); };
  state.mask = in.get_list<std::vector<std::byte>>(get);
  state.carried = in.get_text();
  state.saved_values = in.get_list<std::vector<std::byte>>(get);
  state.swept = in.get_text();
  for (const std::vector<std::byte>& block : state.mask)
    if (block.size() != RowSelection::kBlockBytes) fail("a block of a selection has {} bytes.", block.size());
  return state;
}

void TileState::seal(Storage& scratch, const std::string& name) const {
  seal_bytes(scratch, name + ".state", encoded(*this));
}

TileState TileState::left(const Storage& scratch, const std::string& name) {
  return sealed_value<TileState>(scratch, name + ".state");
}

void seal_values(Storage& scratch, const std::string& key, const CloudValues& values) {
  Encoder out;
  out.begin(kValuesEncoding);
  out.put_list(values, [&](const auto& value) {
    out.put<std::uint64_t>(value.first);
    out.put_numbers(std::span<const double>(value.second));
  });
  seal_bytes(scratch, key, out.bytes());
}

CloudValues sealed_values(const Storage& scratch, const std::string& key) {
  return sealed_value(scratch, key, [](Decoder& in) {
    CloudValues values;
    in.begin(kValuesEncoding);
    for (std::uint64_t i = 0, count = in.get_count(); i < count; ++i) {
      const auto number = in.get<std::uint64_t>();
      values[number] = in.get_numbers<double>();
    }
    return values;
  });
}

}  // namespace pointsweep
