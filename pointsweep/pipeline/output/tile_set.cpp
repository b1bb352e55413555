// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/tile_set.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/known_values.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/order/source.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/pipeline/rows/input_source.h"
#include "pointsweep/row_error.h"
#include "pointsweep/storage/local/output_file.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

/// Returns a cloud of one of the inputs.
InputCloud cloud_of_input(const InputCloud& all, std::size_t input) {
  return InputCloud({all.readers()[input]}, {.crs = all.stated_crs()});
}

/// Returns the part of a selection that belongs to one input, whose rows begin at `first` in the whole cloud.
RowSelection selected_rows(std::shared_ptr<const RowSelection> all, std::uint64_t first, std::uint64_t rows) {
  return {rows, [all = std::move(all), first, rows](std::uint64_t block, std::span<std::byte> bits) {
            SelectionCursor kept(*all);
            std::ranges::fill(bits, std::byte{0});
            const std::uint64_t begin = block * RowSelection::kBlockRows;
            const std::uint64_t n = std::min(RowSelection::kBlockRows, rows - begin);
            for (std::uint64_t i = 0; i < n; ++i)
              if (kept.has(first + begin + i)) bits[i / 8] |= std::byte{1} << (i % 8);
          }};
}

/// Returns the index of the field of one input from which the field `name` of the whole cloud comes; nullopt if the
/// input has no such field.
std::optional<std::size_t> own_field(const Schema& own, const std::string& name) {
  const auto same = std::ranges::find(own.fields, name, &Field::name);
  if (same != own.fields.end()) return static_cast<std::size_t>(same - own.fields.begin());
  return own.find(library_name_of(name));
}

/// Returns the kept fields of one input.
KeptFields kept_of(const KeptFields& kept, const Schema& all, const Schema& own) {
  KeptFields mine = kept;
  if (!kept.input || all == own) return mine;
  mine.input->clear();
  for (const std::size_t f : *kept.input)
    if (const auto field = own_field(own, all.fields[f].name)) mine.input->push_back(*field);
  std::ranges::sort(*mine.input);
  for (std::string& name : mine.order)
    if (const auto field = all.find(name) ? own_field(own, name) : std::nullopt) name = own.fields[*field].name;
  return mine;
}

/// Returns the names in `replace` that mean a field of this input, or a made attribute with a field that this input
/// has, too. The other names belong to other inputs.
std::vector<std::string> replaced_in(const Schema& own, const std::vector<std::string>& replace,
                                     const std::vector<Attribute>& made) {
  std::vector<std::string> some;
  for (const std::string& name : replace) {
    bool is_there = own_field(own, name).has_value();
    for (const Attribute& a : made)
      if (a.name == name)
        for (const std::string& field : a.fields) is_there |= own_field(own, field).has_value();
    if (is_there) some.push_back(name);
  }
  return some;
}

Box bounds_of(InputCloud& cloud) {
  if (cloud.count() == 0) return {Vec3{}, Vec3{}};
  return survey(source_of(cloud), std::nullopt, true).bounds;
}

/// Returns whether a point of the tile has moved, or has a NaN coordinate. The rows of the tile begin at `first` in the
/// whole cloud.
bool has_moved_points(InputCloud& tile, const MovedPoints& moved, std::uint64_t first) {
  constexpr std::uint64_t kRows = 1 << 14;
  const std::size_t stride = tile.schema().stride, bytes = moved.rows->record_bytes();
  const PositionFields p = position_fields(tile.schema(), "the input");
  std::vector<std::byte> inputs, after;
  for (std::uint64_t row = 0; row < tile.count(); row += kRows) {
    stop_if_cancelled();
    const std::size_t n = std::min(kRows, tile.count() - row);
    inputs.resize(n * stride);
    after.resize(n * bytes);
    tile.read(row, inputs);
    moved.rows->read(first + row, after);
    for (std::size_t i = 0; i < n; ++i) {
      const std::byte* const own = inputs.data() + i * stride;
      const double was[3] = {value_of(p.x, own), value_of(p.y, own), value_of(p.z, own)};
      double is[3];
      std::memcpy(is, after.data() + i * bytes + moved.position, sizeof is);
      if (!std::equal(was, was + 3, is)) return true;
    }
  }
  return false;
}

/// Returns the names of attributes in the output of one input.
OutputNames names_of_tile(const TileRequest& request, const InputCloud& tile) {
  return {request.names.made, kept_of(request.names.kept, request.cloud.schema(), tile.schema()), {}};
}

/// The properties of a tile on which the checks of try_tile() depend.
struct KindOfTile {
  const Format* format;
  Schema schema;  ///< fields of the input, with Field::bias (the offset of a grid) set to 0

  friend bool operator==(const KindOfTile&, const KindOfTile&) = default;
};

KindOfTile kind_of(const TileRequest& request, std::size_t tile) {
  KindOfTile kind{format_of_output(request.outputs.tiles[tile]), request.cloud.readers()[tile]->info().schema};
  for (Field& field : kind.schema.fields) field.bias = 0;
  return kind;
}

/// Checks a tile: the names of its attributes, and its file, which is opened and removed again.
void try_tile(const TileRequest& request, std::size_t tile) {
  const fs::path& output = request.outputs.tiles[tile];
  const InputCloud cloud = cloud_of_input(request.cloud, tile);
  const OutputNames names = names_of_tile(request, cloud);
  name_outputs(cloud.schema(), cloud.readers().front()->info().path.string(), names.made, names.kept, output,
               {"", replaced_in(cloud.schema(), request.options.replace, names.made)});
  const Box somewhere{Vec3{}, Vec3{}};
  OutputSet(cloud, names, {.points = output}, request.options, {somewhere, nullptr});
}

}  // namespace

void require_writable_tiles(const TileRequest& request, const FinishedTiles& finished, MadeFolders& folders) {
  const std::vector<fs::path>& tiles = request.outputs.tiles;
  if (tiles.size() != request.cloud.readers().size())
    fail_usage("{} outputs are named for {} inputs; name one for each.", tiles.size(), request.cloud.readers().size());
  for (const fs::path& tile : tiles) folders.make_for(tile);
  std::vector<KindOfTile> tried;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    stop_if_cancelled();
    if (finished.has(t, tiles[t])) continue;
    OutputFile::require_possible(tiles[t], request.options.overwrite);
    KindOfTile kind = kind_of(request, t);
    if (std::ranges::find(tried, kind) != tried.end()) continue;
    try_tile(request, t);
    tried.push_back(std::move(kind));
  }
}

/// A tile that receives rows or is being completed. If an earlier process has finished it, its rows are skipped.
struct TileSet::Tile {
  Tile(std::size_t t, std::uint64_t first_row, InputCloud of_tile)
      : number(t), first(first_row), cloud(std::move(of_tile)) {}

  std::size_t number;
  std::uint64_t first;  ///< its first row among the selected rows of the whole cloud
  InputCloud cloud;
  std::optional<OutputSet> files;            ///< absent if an earlier process has finished the tile
  std::uint64_t done = 0;                    ///< number of rows written or skipped
  std::optional<ParallelRows> input_rows;    ///< reads rows without made attributes
  std::optional<BackgroundTask> completing;  ///< last member, so that the task ends before the members that it uses
};

TileSet::TileSet(const TileRequest& request, FinishedTiles finished)
    : request_(request),
      outputs_(request.outputs.tiles.size(), [&](std::size_t i) { return request.outputs.tiles[i]; }),
      finished_(std::move(finished)) {
  std::uint64_t row = 0;
  for (const auto& reader : request.cloud.readers()) {
    first_row_.push_back(row);
    row += reader->info().count;
  }
}

TileSet::~TileSet() = default;

void TileSet::open_next() {
  const std::size_t t = next_++;
  tile_.reset(new Tile(t, rows_opened_, cloud_of_input(request_.cloud, t)));
  InputCloud& cloud = tile_->cloud;
  if (const auto& all = request_.cloud.selection())
    cloud = cloud.selected(selected_rows(all, first_row_[t], cloud.count()));
  const fs::path& output = request_.outputs.tiles[t];
  const std::uint64_t first = std::exchange(rows_opened_, rows_opened_ + cloud.count());
  if (cloud.count() == 0) empty_.push_back(output.string());
  if (finished_.has(t, output)) return void(++complete_);
  OutputPlace place = place_of_tile(cloud, format_of_output(output), first);
  place.scratch = request_.scratch;
  tile_->files.emplace(cloud, names_of_tile(request_, cloud), Outputs{.points = output}, request_.options,
                       std::move(place), request_.provenance(cloud, t));
}

/// Returns the bounds and values that the format needs. Tiles with moved points share one grid; other tiles keep the
/// grid of their input.
OutputPlace TileSet::place_of_tile(InputCloud& cloud, const Format* format, std::uint64_t first) const {
  const FileLayout& layout = request_.options.layout;
  const std::shared_ptr<KnownValues> values =
      values_if_needed(format, cloud, layout, [](std::uint64_t) { stop_if_cancelled(); });
  if (!request_.moved || !values) {
    const bool needed = needs_bounds(format, cloud.schema(), layout);
    return {needed ? std::optional(bounds_of(cloud)) : std::nullopt, values};
  }
  if (!has_moved_points(cloud, *request_.moved, first)) return {bounds_of(cloud), values};
  values->grid = request_.moved->grid;
  return {request_.moved->bounds, values};
}

void TileSet::complete() {
  tile_->cloud.readers().front()->rest();  // frees memory and the open file for the next inputs
  if (!tile_->files) return void(tile_.reset());
  require_unchanged_inputs();
  Tile& tile = *completing_.emplace_back(std::move(tile_));
  tile.completing.emplace([this, &tile] { finish_files(tile); });
  while (completing_.size() > request_.completing) wait_for_first();
}

/// Calls `work()`. Adds the first row of the tile to the row number of a RowError, which then counts rows of the whole
/// cloud.
template <class Work>
void TileSet::with_rows_of_cloud(const Tile& tile, const Work& work) {
  try {
    work();
  } catch (const RowError& error) {
    throw error.numbered(tile.first + error.row());
  }
}

/// Writes the last rows of a tile and renames its file. Runs in the background.
void TileSet::finish_files(Tile& tile) {
  const fs::path& output = request_.outputs.tiles[tile.number];
  with_rows_of_cloud(tile, [&] {
    tile.files->flush();
    finished_.begin(tile.number, output);
    tile.files->finish(tile.cloud);
  });
  finished_.end(tile.number, output);
  ++complete_;
}

void TileSet::wait_for_first() {
  const Tile& tile = *completing_.front();
  completing_.front()->completing->wait();
  warnings_.add(tile.files->warnings(), request_.outputs.tiles[tile.number]);
  bytes_written_ += tile.files->bytes_written();
  completing_.pop_front();
}

/// Before the first tile that this process completes, checks all inputs, since the results were computed from all of
/// them. Before a later tile, checks only the input of that tile, whose rows were read again.
void TileSet::require_unchanged_inputs() {
  if (std::exchange(all_inputs_were_checked_, true))
    request_.cloud.require_unchanged(tile_->number);
  else
    request_.cloud.require_unchanged();
}

/// Divides the next `rows` rows of the cloud among their tiles. Calls write(tile, row, skip, part) for each tile,
/// except tiles that an earlier process has finished: the tile gets `part` rows, from its row `row` on, after earlier
/// tiles got `skip` of the `rows`.
void TileSet::for_each_part(std::uint64_t rows, const WriteRows& write) {
  for (std::uint64_t skip = 0; skip < rows;) {
    if (!tile_) open_next();
    const std::uint64_t part = std::min(rows - skip, tile_->cloud.count() - tile_->done);
    if (part > 0 && tile_->files) {
      with_rows_of_cloud(*tile_, [&] { write(*tile_, tile_->done, skip, part); });
    }
    tile_->done += part;
    skip += part;
    if (tile_->done == tile_->cloud.count()) complete();
  }
}

void TileSet::write_results(std::span<const std::byte> results) {
  const std::size_t bytes = bytes_of(request_.names.made);
  for_each_part(results.size() / bytes, [&](Tile& tile, std::uint64_t row, std::uint64_t skip, std::uint64_t rows) {
    tile.files->write_results(tile.cloud, row, results.subspan(skip * bytes, rows * bytes));
  });
}

void TileSet::write_inputs(std::uint64_t rows) {
  for_each_part(rows, [&](Tile& tile, std::uint64_t row, std::uint64_t, std::uint64_t part) {
    std::vector<std::byte> records(part * tile.cloud.schema().stride);
    if (!tile.input_rows) tile.input_rows.emplace(source_of(tile.cloud));
    tile.input_rows->read(row, records);
    tile.files->write_inputs(row, records);
  });
}

void TileSet::finish() {
  while (tile_ || next_ < request_.outputs.tiles.size()) {
    stop_if_cancelled();
    if (!tile_) open_next();
    complete();
  }
  while (!completing_.empty()) wait_for_first();
  request_.cloud.require_unchanged();
}

std::string TileSet::progress() {
  completing_.clear();  // the destructors wait for the tasks
  return complete_outputs_text(complete_, request_.outputs.tiles.size());
}

std::vector<std::string> TileSet::warnings() const {
  std::vector<std::string> all = warnings_.sentences();
  if (empty_.size() == 1) all.push_back(fmt::format("no point passed; {} is empty.", empty_.front()));
  if (empty_.size() > 1)
    all.push_back(
        fmt::format("no point passed for {} outputs, which are empty, the first {}.", empty_.size(), empty_.front()));
  return all;
}

}  // namespace pointsweep
