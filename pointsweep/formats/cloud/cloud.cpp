// SPDX-License-Identifier: MIT
#include "pointsweep/cloud.h"

#include <utility>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/cloud/reader_adapters.h"

namespace pointsweep {
namespace {

std::vector<std::unique_ptr<Reader>> only(std::unique_ptr<Reader> reader) {
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::move(reader));
  return readers;
}

std::vector<std::unique_ptr<Reader>> unnumbered(std::vector<std::unique_ptr<Reader>> readers) {
  for (const auto& reader : readers) require_unnumbered(*reader);
  return readers;
}

}  // namespace

Cloud::Cloud(const std::vector<std::filesystem::path>& files, CloudOptions options)
    : inputs_(std::make_unique<InputCloud>(files, options)) {}

Cloud::Cloud(std::initializer_list<std::filesystem::path> files, CloudOptions options)
    : Cloud(std::vector<std::filesystem::path>(files), options) {}

Cloud::Cloud(std::unique_ptr<Reader> reader, CloudOptions options) : Cloud(only(std::move(reader)), options) {}

Cloud::Cloud(std::vector<std::unique_ptr<Reader>> readers, CloudOptions options)
    : inputs_(std::make_unique<InputCloud>(unnumbered(std::move(readers)), options)) {}

Cloud::Cloud(Cloud&&) noexcept = default;
Cloud& Cloud::operator=(Cloud&&) noexcept = default;
Cloud::~Cloud() = default;

std::uint64_t Cloud::count() const { return inputs_->count(); }
const Schema& Cloud::schema() const { return inputs_->schema(); }
std::size_t Cloud::input_count() const { return inputs_->readers().size(); }
const FileInfo& Cloud::input(std::size_t i) const { return inputs_->readers().at(i)->info(); }
const std::optional<Crs>& Cloud::crs() const { return inputs_->crs(); }
const std::vector<std::string>& Cloud::warnings() const { return inputs_->warnings(); }

std::size_t Cloud::read(std::uint64_t row, std::span<std::byte> records) { return inputs_->read(row, records); }

}  // namespace pointsweep
