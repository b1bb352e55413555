// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/task_values.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/cloud/row_selection.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {
namespace {

constexpr Encoding kStateEncoding{"state of a tile", 2};
constexpr Encoding kValuesEncoding{"values of the cloud", 1};
constexpr Encoding kPiecesEncoding{"pieces of a range", 1};
constexpr Encoding kFilesEncoding{"files of a division", 1};

void put_file(Encoder& out, const DividedFile& file) {
  out.put<std::int64_t>(file.key.first);
  out.put<std::int64_t>(file.key.second);
  out.put<std::uint64_t>(file.own);
  out.put<std::uint64_t>(file.all);
}

DividedFile get_file(Decoder& in) {
  DividedFile file;
  file.key.first = in.get<std::int64_t>();
  file.key.second = in.get<std::int64_t>();
  file.own = in.get<std::uint64_t>();
  file.all = in.get<std::uint64_t>();
  if (file.own > file.all) fail("a piece counts {} points of a tile, but only {} in all.", file.own, file.all);
  return file;
}

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

void PiecesOfRange::encode(Encoder& out) const {
  out.begin(kPiecesEncoding);
  out.put_list(pieces, [&](const DividedFile& piece) { put_file(out, piece); });
}

PiecesOfRange PiecesOfRange::decode(Decoder& in) {
  in.begin(kPiecesEncoding);
  return {in.get_list<DividedFile>([&] { return get_file(in); })};
}

void FilesOfRanges::encode(Encoder& out) const {
  out.begin(kFilesEncoding);
  out.put_list(ranges, [&](const std::string& name) { out.put_text(name); });
  out.put_list(files, [&](const DividedFile& file) { put_file(out, file); });
  out.put_list(pieces, [&](const std::vector<PieceOfFile>& of_file) {
    out.put_list(of_file, [&](const PieceOfFile& piece) {
      for (const std::uint64_t number : {piece.range, piece.first, piece.count}) out.put<std::uint64_t>(number);
    });
  });
}

FilesOfRanges FilesOfRanges::decode(Decoder& in) {
  in.begin(kFilesEncoding);
  FilesOfRanges all;
  all.ranges = in.get_list<std::string>([&] { return in.get_text(); });
  all.files = in.get_list<DividedFile>([&] { return get_file(in); });
  all.pieces = in.get_list<std::vector<PieceOfFile>>([&] {
    return in.get_list<PieceOfFile>([&] {
      PieceOfFile piece{};
      for (std::uint64_t* const number : {&piece.range, &piece.first, &piece.count}) *number = in.get<std::uint64_t>();
      if (piece.range >= all.ranges.size()) fail("a piece is of range {} of {}.", piece.range, all.ranges.size());
      return piece;
    });
  });
  if (all.pieces.size() != all.files.size()) fail("{} files have pieces of {}.", all.files.size(), all.pieces.size());
  for (std::size_t i = 0; i < all.files.size(); ++i) {
    std::uint64_t left = all.files[i].all;
    for (const PieceOfFile& piece : all.pieces[i]) {
      if (piece.count > left) fail("a file has more points in its pieces than its {}.", all.files[i].all);
      left -= piece.count;
    }
    if (left > 0) fail("a file lacks {} points in its pieces.", left);
  }
  return all;
}

/// Divides the points of all files into equal shares, one for each task. A task writes the files that begin in its
/// share.
std::vector<std::size_t> FilesOfRanges::of_task(std::size_t task, std::size_t tasks) const {
  double points = 0, before = 0;
  for (const DividedFile& file : files) points += static_cast<double>(file.all);
  std::vector<std::size_t> own;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto begins_in = static_cast<std::size_t>(before / points * static_cast<double>(tasks));
    if (std::min(begins_in, tasks - 1) == task) own.push_back(i);
    before += static_cast<double>(files[i].all);
  }
  return own;
}

FilesOfRanges files_of(const std::vector<std::string>& names, std::span<const PiecesOfRange> pieces) {
  std::map<FileKey, std::pair<DividedFile, std::vector<PieceOfFile>>> files;
  for (std::size_t range = 0; range < pieces.size(); ++range) {
    std::uint64_t first = 0;
    for (const DividedFile& piece : pieces[range].pieces) {
      auto& [file, of_file] = files[piece.key];
      file.key = piece.key;
      file.own += piece.own;
      file.all += piece.all;
      of_file.push_back({range, first, piece.all});
      first += piece.all;
    }
  }
  FilesOfRanges all{names, {}, {}};
  for (auto& [_, known] : files) {
    all.files.push_back(known.first);
    all.pieces.push_back(std::move(known.second));
  }
  return all;
}

}  // namespace pointsweep
