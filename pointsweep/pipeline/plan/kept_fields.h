// SPDX-License-Identifier: MIT
/// Lists of attribute names, as in Chain::keep and Drop, resolved against the fields of the input and of made
/// attributes.
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

struct KeptFields {
  std::vector<std::string> attributes;            ///< names of the made attributes with a written field
  std::set<std::string> left_out;                 ///< fields of `attributes` that are not written
  std::optional<std::vector<std::size_t>> input;  ///< indices of the input's fields, ascending; absent: all fields
  std::vector<std::string> order = {};  ///< names of the fields that Chain::keep names, in its order, each once
};

/// Returns `schema`, the fields of an output with the made attributes `made`, sorted for Chain::keep: first the fields
/// of the input that Chain::keep does not name, and x, y and z unless all three are named; then the named fields, in
/// the order of Chain::keep; last the other made fields. Offsets do not change.
Schema in_named_order(Schema schema, const KeptFields& kept, const std::vector<Attribute>& made);

/// Returns the fields that `names` keep. A name means the first match of: a made attribute ("normal") or a field of one
/// ("nx"); a field of the input, under its name or the name of its column in the output; then one of these in another
/// spelling that files use ("NormalX", in any case). The named made fields are kept, or all if none is named. The named
/// fields of the input are kept, or all if none is named. x, y and z are always kept together; if points are moved,
/// they are the moved coordinates. Throws UsageError for a name without a match.
KeptFields kept_fields(const std::vector<std::string>& names, const std::vector<Attribute>& made, const Schema& input);

/// The fields that a list of names means, found as in kept_fields().
struct NamedFields {
  std::set<std::string> made;   ///< fields of made attributes
  std::set<std::size_t> input;  ///< indices of the input's fields
};

/// Returns the fields that `names` mean. Throws UsageError for a name without a match; its message says that the name
/// cannot be `done`, such as "dropped".
NamedFields named_fields(const std::vector<std::string>& names, const std::vector<Attribute>& made, const Schema& input,
                         const std::string& done);

/// For outputs without a prefix for made attributes: removes the fields of the input that a made attribute would
/// replace if it were written in full. So an old ny is never written beside a new nx.
KeptFields without_replaced(KeptFields kept, const Schema& input);

/// Removes `prefix` from names of made attributes and fields, as used in outputs with a prefix: "p_nx" becomes "nx".
/// Positions have no prefix.
std::vector<std::string> without_prefix(std::vector<std::string> names, const std::string& prefix,
                                        const std::vector<Attribute>& made);

}  // namespace pointsweep
