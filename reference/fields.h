// SPDX-License-Identifier: MIT
/// The fields that a point has while it is active, and their places (paper Section 5.1 and Figure 10).
///
/// A field is one place in the point: an operator that makes an attribute again, with as many bytes, overwrites it, as
/// in the paper. The buffers and their copies prevent an operator from reading a value that was overwritten too early
/// (the paper's FairOpFields).
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/points/promised_type.h"
#include "pointsweep/points/schema.h"
#include "reference/stream_point.h"

namespace pointsweep::reference {

/// A field of a point: `bytes` from `offset` of its fields, or its position.
struct Field {
  std::size_t offset = 0;
  std::size_t bytes = 0;
  bool is_position = false;

  std::byte* in(StreamPoint& p) const {
    return is_position ? reinterpret_cast<std::byte*>(&p.position) : p.fields.get() + offset;
  }
};

/// A field of which a buffer keeps a copy for the neighbours of a point, because its operator or a later one overwrites
/// the field.
struct Copy {
  Field from, to;
};

/// An operator and the fields it works on.
struct Stage {
  StageOperator op;
  std::vector<Field> reads, reads_neighbors, makes;
  Field neighbor_position;
  std::vector<Copy> copies;
  bool waits = false;  ///< true if the operator reads attributes of neighbours or moves points; needs a PreBuffer
  bool moves = false;  ///< true if the operator moves points; needs a PrePostBuffer
  bool moved = false;  ///< true if an earlier operator moves points; the search used the old positions
};

/// All fields of a chain of operators (AllFields): the record of the file (InputFields), then the fields of operators
/// (OpFields, OpOutFields).
class Fields {
 public:
  /// `record`: working records of the stream. The chain must have been checked: every attribute that an operator reads
  /// is made before or is in the record, and the attributes that the rule (may be null) reads are in the record.
  /// `kept`: attributes whose values make up a result record.
  Fields(const Schema& record, const SharedRule& rule, const std::vector<StageOperator>& chain,
         const std::vector<Attribute>& kept);

  const std::vector<Stage>& stages() const { return stages_; }
  /// Returns the fields that the rule reads; no operator overwrites them.
  const std::vector<Field>& rule_reads() const { return rule_reads_; }
  std::size_t bytes() const { return bytes_; }

  /// Gives the point its fields and fills in the fields of the file. Stores in `refused` the error of a value that an
  /// operator cannot read.
  void fill(StreamPoint& point, const std::byte* record, FirstRowError& refused) const;
  const std::byte* record(const StreamPoint& point) const { return point.fields.get(); }
  /// Writes the kept attributes of the point into `out`, one after another.
  void result(StreamPoint& point, std::vector<std::byte>& out) const;

 private:
  struct FileAttribute {
    Field to;
    Type type;
    std::vector<PromisedType> from;
  };
  Field add(std::size_t bytes);
  Field find(const Attribute& attribute);
  Field add_from_file(const Attribute& attribute);
  Stage plan(const StageOperator& op);
  void plan_copies();

  Schema record_;
  std::size_t bytes_;
  std::map<std::string, Field> latest_;  ///< field of each attribute, by its name
  std::vector<FileAttribute> file_;
  std::vector<Field> rule_reads_;
  std::vector<Stage> stages_;
  std::vector<Field> kept_;
};

}  // namespace pointsweep::reference
