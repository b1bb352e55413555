// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/local_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <system_error>

#include "pointsweep/fail.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kUnsealed = ".unsealed";

/// A file that gets its name when it is sealed.
class UnsealedFile final : public Unsealed {
 public:
  UnsealedFile(const LocalFolder& folder, const std::string& key)
      : folder_(folder),
        path_(folder.path() / key),
        unsealed_(path_.string().append(kUnsealed)),
        file_(::open(unsealed_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600)) {
    check(file_ ? 0 : errno);
  }
  ~UnsealedFile() override {
    if (file_) ::unlink(unsealed_.c_str());
  }
  void append(std::span<const std::byte> bytes) override {
    write_at(end_, bytes);
    end_ += bytes.size();
  }
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes) override {
    check(file_.write_at(offset, bytes));
  }
  void seal() override {
    check(::fdatasync(file_.number()) == 0 ? 0 : errno);
    check(::rename(unsealed_.c_str(), path_.c_str()) == 0 ? 0 : errno);
    file_.close();
    folder_.flush();
  }

 private:
  void check(int error) const {
    if (error != 0) folder_.fail_to_write(error);
  }

  const LocalFolder& folder_;
  fs::path path_, unsealed_;
  FileDescriptor file_;
  std::uint64_t end_ = 0;
};

}  // namespace

LocalFolder::LocalFolder(const fs::path& path, const std::string& object, const std::string& option)
    : path_(path), object_(object), option_(option) {
  if (::mkdir(path.c_str(), 0700) != 0 && errno != EEXIST)
    fail("cannot make the folder '{}': {}; name a place where that is possible with {}.", path.string(),
         std::strerror(errno), option);
  folder_ = open_folder(path, true);
  if (!folder_) fail("'{}' is no folder that can be used: {}.", path.string(), std::strerror(errno));
  if (lock(folder_) == EWOULDBLOCK)
    fail("another run is working in '{}'; wait for it, or name another folder with {}.", path.string(), option);
}

std::unique_ptr<Source> LocalFolder::open(const std::string& key) const {
  return std::make_unique<InputFile>(path_ / key);
}

std::unique_ptr<Unsealed> LocalFolder::create(const std::string& key) {
  return std::make_unique<UnsealedFile>(*this, key);
}

std::vector<std::string> LocalFolder::list() const {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(path_, error), end; !error && entry != end; entry.increment(error)) {
    std::string name = entry->path().filename().string();
    if (!name.ends_with(kUnsealed)) names.push_back(std::move(name));
  }
  if (error && error != std::errc::no_such_file_or_directory)
    fail("cannot read the folder '{}': {}.", path_.string(), error.message());
  std::ranges::sort(names);
  return names;
}

void LocalFolder::remove(const std::string& key) {
  std::error_code ignored;
  for (const std::string_view suffix : {std::string_view(), kUnsealed}) {
    fs::path file = path_ / key;
    fs::remove(file += suffix, ignored);
  }
}

void LocalFolder::flush(const std::string& key) const {
  const FileDescriptor file(::open((path_ / key).c_str(), O_RDWR | O_CLOEXEC));
  if (!file || ::fdatasync(file.number()) != 0) fail_to_write(errno);
}

void LocalFolder::flush() const { ::fsync(folder_.number()); }

void LocalFolder::fail_to_write(int error) const {
  fail("cannot write {} into '{}': {}; free space there or name another folder with {}.", object_, path_.string(),
       std::strerror(error), option_);
}

void LocalFolder::remove_folder() { ::rmdir(path_.c_str()); }

}  // namespace pointsweep
