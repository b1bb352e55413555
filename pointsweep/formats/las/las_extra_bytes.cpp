// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_extra_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "pointsweep/formats/field_names.h"
#include "pointsweep/points/lower_case.h"

namespace pointsweep {
namespace {

/// Bits of Descriptor::options: the descriptor states the least value, the greatest value, the scale, the offset.
constexpr std::uint8_t kHasLeast = 1 << 1, kHasMost = 1 << 2, kHasScale = 1 << 3, kHasOffset = 1 << 4;

/// A descriptor in the layout of the file.
struct Descriptor {
  std::uint8_t reserved[2];
  std::uint8_t type;
  std::uint8_t options;  ///< kHasLeast, ...; for type 0 the number of bytes
  char name[kLasNameBytes];
  std::uint8_t unused[4];
  std::uint8_t no_data[24], lo[24], hi[24];
  double scale[3], offset[3];
  char description[32];
};
static_assert(sizeof(Descriptor) == kExtraBytesDescriptor);
static_assert(offsetof(Descriptor, scale) == 112);

/// The types 1 to 10 of LAS in their order. Types 11 to 20 are pairs of these types, types 21 to 30 are triples.
constexpr Type kTypes[] = {Type::u8,  Type::i8,  Type::u16, Type::i16, Type::u32,
                           Type::i32, Type::u64, Type::i64, Type::f32, Type::f64};

/// An attribute with a usual name in LAS: the library's name, the name in LAS, and the description. If the description
/// is empty, the caller's description is written.
struct Words {
  std::string_view ours, las, description;
};
constexpr Words kWords[] = {
    {"nx", "NormalX", "unit surface normal, x"},
    {"ny", "NormalY", "unit surface normal, y"},
    {"nz", "NormalZ", "unit surface normal, z"},
    {"surface_variation", "Curvature", "smallest / sum of eigenvalues"},
    {"curvature", "Curvature", ""},
};

const Words* las_words_of(std::string_view name) {
  const auto words = std::ranges::find_if(kWords, [&](const Words& w) { return w.ours == name; });
  return words == std::end(kWords) ? nullptr : words;
}

std::vector<Descriptor> descriptors_of(std::span<const std::byte> bytes) {
  std::vector<Descriptor> all(bytes.size() / sizeof(Descriptor));
  if (!all.empty()) std::memcpy(all.data(), bytes.data(), all.size() * sizeof(Descriptor));
  return all;
}

void append_descriptor(const Descriptor& d, std::vector<std::byte>& all) {
  const auto* const bytes = reinterpret_cast<const std::byte*>(&d);
  all.insert(all.end(), bytes, bytes + sizeof d);
}

/// Returns the name up to its first NUL, without surrounding blanks. Control characters become '_', since they would
/// break the headers of other formats; an empty name becomes "extra_bytes".
std::string name_of(const Descriptor& d) {
  std::string name(d.name, std::find(d.name, d.name + kLasNameBytes, '\0'));
  const auto first = name.find_first_not_of(' ');
  name = first == std::string::npos ? "" : name.substr(first, name.find_last_not_of(' ') - first + 1);
  for (char& c : name) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '_';
  }
  return name.empty() ? "extra_bytes" : name;
}

double scale_of(const Descriptor& d, std::size_t component) {
  const double scale = d.scale[component];
  return (d.options & kHasScale) != 0 && std::isfinite(scale) && scale != 0 ? scale : 1;
}

double bias_of(const Descriptor& d, std::size_t component) {
  const double bias = d.offset[component];
  return (d.options & kHasOffset) != 0 && std::isfinite(bias) ? bias : 0;
}

/// Returns the first `most` bytes of `name`, or up to three fewer, so that no UTF-8 character is divided.
std::string_view cut_to(std::string_view name, std::size_t most) {
  if (name.size() <= most) return name;
  std::size_t end = most;
  while (end + 3 > most && end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;
  return name.substr(0, end);
}

/// Shortens `text` to at most `most` bytes: to the part before its first semicolon or comma, or else to whole words,
/// the last of them no word such as "of" or "the". A text whose first word is too long is cut inside the word.
std::string shortened(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  const std::size_t clause = text.find_first_of(";,");
  if (clause <= most) return std::string(text.substr(0, clause));
  constexpr std::string_view kNoEnd[] = {"a", "and", "of", "or", "over", "the", "to", "which", "with"};
  std::string_view rest = text.substr(0, most + 1);
  for (;;) {
    const std::size_t end = rest.find_last_of(' ');
    if (end == std::string_view::npos) return std::string(text.substr(0, most));
    rest = rest.substr(0, end);
    const std::string_view last = rest.substr(rest.find_last_of(' ') + 1);
    if (std::ranges::find(kNoEnd, last) == std::end(kNoEnd)) return std::string(rest);
  }
}

void append_fields(const Descriptor& d, Schema& schema) {
  const std::string name = name_of(d);
  if (d.type == 0) {
    if (d.options != 0) schema.append(unused_name(schema, name), Type::u8, d.options);
    return;
  }
  const Type type = kTypes[(d.type - 1) % 10];
  const std::uint32_t count = 1u + (d.type - 1u) / 10u;
  bool alike = true;
  for (std::uint32_t c = 1; c < count; ++c) {
    alike = alike && scale_of(d, c) == scale_of(d, 0) && bias_of(d, c) == bias_of(d, 0);
  }
  for (std::uint32_t c = 0; c < (alike ? 1 : count); ++c) {
    const std::string own = alike ? name : fmt::format("{}[{}]", name, c);
    Field& field = schema.fields[schema.append(unused_name(schema, own), type, alike ? count : 1)];
    field.scale = scale_of(d, c);
    field.bias = bias_of(d, c);
  }
}

}  // namespace

std::string las_dimension_name(const std::string& name) {
  const Words* words = las_words_of(name);
  return words != nullptr ? std::string(words->las) : std::string(cut_to(name, kLasNameBytes));
}

std::string extra_bytes_name(const Field& field, std::uint32_t component) {
  if (field.count == 1) return las_dimension_name(field.name);
  const std::string index = fmt::format("[{}]", component);
  return las_dimension_name(fmt::format("{}{}", cut_to(field.name, kLasNameBytes - index.size()), index));
}

std::optional<std::string> append_extra_bytes(std::span<const std::byte> descriptors, std::uint32_t record_length,
                                              Schema& schema) {
  if (descriptors.size() % kExtraBytesDescriptor != 0) {
    return fmt::format("its {} bytes are no multiple of {}", descriptors.size(), kExtraBytesDescriptor);
  }
  Schema extended = schema;
  for (const Descriptor& d : descriptors_of(descriptors)) {
    if (d.type > 30) return fmt::format("it has an attribute of the undefined type {}", d.type);
    append_fields(d, extended);
  }
  if (extended.stride > record_length) {
    return fmt::format("it describes {} bytes of each point, where there are {}", extended.stride - schema.stride,
                       record_length - schema.stride);
  }
  schema = std::move(extended);
  return std::nullopt;
}

std::optional<std::span<const std::byte>> find_extra_bytes(std::span<const std::byte> descriptors, const Field& field) {
  const std::vector<Descriptor> all = descriptors_of(descriptors);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Descriptor& d = all[i];
    if (d.type < 1 || d.type > 10 || field.count != 1 || kTypes[d.type - 1] != field.type) continue;
    if (name_of(d) == field.name && scale_of(d, 0) == field.scale && bias_of(d, 0) == field.bias)
      return descriptors.subspan(i * sizeof(Descriptor), sizeof(Descriptor));
  }
  return std::nullopt;
}

std::string extra_bytes_description(const Attribute& attribute, std::size_t component) {
  const std::string_view field = attribute.fields[component];
  std::string suffix;
  if (attribute.fields.size() > 1) {
    suffix = fmt::format(", {}", field.back());
  } else if (attribute.unit != "1" && !attribute.unit.empty()) {
    suffix = fmt::format(" [{}]", attribute.unit);
  }
  const std::string meaning = shortened(attribute.meaning, kLasNameBytes);
  if (meaning.size() + suffix.size() <= kLasNameBytes) return meaning + suffix;
  return attribute.fields.size() > 1 ? shortened(attribute.meaning, kLasNameBytes - suffix.size()) + suffix : meaning;
}

bool ExtraBytesVlr::has(std::string_view name) const {
  const std::vector<Descriptor> all = descriptors_of(bytes_);
  return std::ranges::any_of(all,
                             [&](const Descriptor& d) { return in_lower_case(name_of(d)) == in_lower_case(name); });
}

std::string ExtraBytesVlr::unused(std::string_view name) const {
  std::string candidate(name.substr(0, kLasNameBytes));
  for (int number = 2; has(candidate); ++number) {
    const std::string suffix = fmt::format("_{}", number);
    candidate = fmt::format("{}{}", name.substr(0, kLasNameBytes - suffix.size()), suffix);
  }
  return candidate;
}

void ExtraBytesVlr::make_way_for(std::string_view name) {
  std::vector<Descriptor> all = descriptors_of(bytes_);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (in_lower_case(name_of(all[i])) != in_lower_case(name)) continue;
    const std::string other = unused(fmt::format("{}_input", name.substr(0, kLasNameBytes - 6)));
    std::memset(all[i].name, 0, kLasNameBytes);
    std::memcpy(all[i].name, other.data(), other.size());
    std::memcpy(bytes_.data() + i * sizeof(Descriptor), &all[i], sizeof(Descriptor));
  }
}

void ExtraBytesVlr::append_one(std::string name, const Field& field, std::string_view description) {
  Descriptor d{};
  if (const Words* words = las_words_of(name); words != nullptr && !words->description.empty())
    description = words->description;
  std::copy_n(description.begin(), std::min(description.size(), sizeof d.description), std::begin(d.description));
  name = las_dimension_name(name);
  make_way_for(name);
  std::memcpy(d.name, name.data(), name.size());
  const auto type = std::ranges::find(kTypes, field.type);
  d.type = static_cast<std::uint8_t>(type - std::begin(kTypes) + 1);
  if (field.scale != 1 || field.bias != 0) {
    d.options = kHasScale | kHasOffset;
    d.scale[0] = field.scale;
    d.offset[0] = field.bias;
  }
  append_descriptor(d, bytes_);
}

void ExtraBytesVlr::append_again(std::span<const std::byte> descriptor) {
  Descriptor d;
  std::memcpy(&d, descriptor.data(), sizeof d);
  make_way_for(name_of(d));
  d.options = static_cast<std::uint8_t>(d.options & ~(kHasLeast | kHasMost));
  append_descriptor(d, bytes_);
}

void ExtraBytesVlr::append(const Field& field, std::string_view description) {
  if (field.count == 1) return append_one(field.name, field, description);
  for (std::uint32_t c = 0; c < field.count; ++c) append_one(extra_bytes_name(field, c), field, description);
}

void ExtraBytesVlr::append_undocumented(std::uint32_t count) {
  while (count != 0) {
    Descriptor d{};
    d.options = static_cast<std::uint8_t>(std::min(count, 255u));
    const std::string name = unused("undocumented");
    std::memcpy(d.name, name.data(), name.size());
    append_descriptor(d, bytes_);
    count -= d.options;
  }
}

}  // namespace pointsweep
