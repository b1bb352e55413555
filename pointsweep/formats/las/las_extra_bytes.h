// SPDX-License-Identifier: MIT
/// The extra-bytes VLR of LAS (user LASF_Spec, record 4), which describes attributes after the fields of the point
/// format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Bytes of a descriptor, and the largest number of descriptors in a VLR.
inline constexpr std::size_t kExtraBytesDescriptor = 192;
inline constexpr std::size_t kMaxExtraBytes = 65535 / kExtraBytesDescriptor;

/// Largest number of bytes of an attribute's name.
inline constexpr std::size_t kLasNameBytes = 32;
/// Returns the name of an attribute in LAS outputs: NormalX for nx, ..., else `name`, cut to kLasNameBytes.
std::string las_dimension_name(const std::string& name);
/// Returns the name of component `component` of an attribute in LAS outputs: that of the field, or `name[0]`, ... for
/// an attribute of several values.
std::string extra_bytes_name(const Field& field, std::uint32_t component);

/// Appends the attributes that `descriptors` (the content of the VLR) describe to `schema`, the fields of the point
/// format. Types 1 to 10 become one field each, the deprecated arrays 11 to 30 become a field of count 2 or 3 (several
/// fields `name[0]`, ... where scale or offset differ), and type 0 becomes a field of as many uint8 as the descriptor
/// states. A number is appended to a name that another field has. Returns nothing on success, else the reason why the
/// VLR does not describe records of `record_length` bytes; `schema` is then unchanged.
std::optional<std::string> append_extra_bytes(std::span<const std::byte> descriptors, std::uint32_t record_length,
                                              Schema& schema);

/// Returns the descriptor of a single value that has the name and the stored form of `field`; none if there is no such
/// descriptor.
std::optional<std::span<const std::byte>> find_extra_bytes(std::span<const std::byte> descriptors, const Field& field);

/// Returns the description of component `component` of a made attribute, in at most 32 bytes: the beginning of the
/// meaning, then the axis of the component, or for an attribute of one component the unit, if there is room.
std::string extra_bytes_description(const Attribute& attribute, std::size_t component);

/// Builds the content of the VLR.
class ExtraBytesVlr {
 public:
  ExtraBytesVlr() = default;
  /// Continues the VLR that a file already has.
  explicit ExtraBytesVlr(std::span<const std::byte> descriptors) : bytes_(descriptors.begin(), descriptors.end()) {}

  /// Adds a descriptor of `field`. The descriptor gets the usual name in LAS (NormalX for nx, ...) or the name of the
  /// field, cut to 32 bytes. An older attribute of this name is renamed to `<name>_input`; both stay in the file. A
  /// field of several values becomes `name[0]`, `name[1]`, ... `description` (at most 32 bytes) states its meaning,
  /// unless LAS outputs have a fixed description for an attribute of this name.
  void append(const Field& field, std::string_view description = {});
  /// Adds a copy of `descriptor`, which an input has for a field of one value. The copy states no range of values. An
  /// older attribute of its name is renamed as by append().
  void append_again(std::span<const std::byte> descriptor);
  /// Adds descriptors of type 0, each for at most 255 bytes: `count` bytes without a known meaning.
  void append_undocumented(std::uint32_t count);

  std::size_t size() const { return bytes_.size() / kExtraBytesDescriptor; }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  void append_one(std::string name, const Field& field, std::string_view description);
  void make_way_for(std::string_view name);
  bool has(std::string_view name) const;
  std::string unused(std::string_view name) const;

  std::vector<std::byte> bytes_;
};

}  // namespace pointsweep
