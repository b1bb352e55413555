// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/shared_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <system_error>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/storage/local/descriptor.h"
#include "pointsweep/storage/local/input_file.h"
#include "pointsweep/storage/local/output_file.h"
#include "pointsweep/storage/remote/remote_service.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kNotSealed = ".unsealed";

/// Returns a text that is unique among all processes of all machines.
std::string unique_suffix() {
  static std::atomic<unsigned> last = 0;
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  return "." + std::string(host.data()) + "-" + std::to_string(::getpid()) + "-" + std::to_string(++last);
}

class SharedFile final : public Unsealed {
 public:
  explicit SharedFile(fs::path path)
      : path_(std::move(path)),
        unsealed_(path_.string().append(unique_suffix()).append(kNotSealed)),
        file_(::open(unsealed_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
    check(file_ ? 0 : errno);
  }
  ~SharedFile() override {
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
    check(::rename(unsealed_.c_str(), path_.c_str()) == 0 ? 0 : errno);
    file_.close();
  }

 private:
  void check(int error) const {
    if (error == 0) return;
    fail("{}: cannot be written: {}; free space there or name another scratch folder.", path_.string(),
         std::strerror(error));
  }

  fs::path path_, unsealed_;
  FileDescriptor file_;
  std::uint64_t end_ = 0;
};

}  // namespace

std::unique_ptr<Source> SharedFolder::open(const std::string& key) const {
  return std::make_unique<InputFile>(path_ / key);
}

std::unique_ptr<Unsealed> SharedFolder::create(const std::string& key) {
  return std::make_unique<SharedFile>(path_ / key);
}

std::vector<std::string> SharedFolder::list() const {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(path_, error), end; !error && entry != end; entry.increment(error)) {
    std::string name = entry->path().filename().string();
    if (!name.ends_with(kNotSealed)) names.push_back(std::move(name));
  }
  if (error) fail("{}: cannot be read: {}.", path_.string(), error.message());
  std::ranges::sort(names);
  return names;
}

void SharedFolder::remove(const std::string& key) {
  std::error_code ignored;
  fs::remove(path_ / key, ignored);
}

std::unique_ptr<Source> RemoteFolder::open(const std::string& key) const {
  return std::make_unique<InputFile>(url_ + key);
}

std::unique_ptr<Unsealed> RemoteFolder::create(const std::string& key) {
  return std::make_unique<OutputFile>(url_ + key, true);
}

std::vector<std::string> RemoteFolder::list() const {
  std::vector<std::string> names;
  for (const RemoteEntry& entry : list_remote(url_, false)) names.push_back(entry.url.substr(url_.size()));
  std::ranges::sort(names);
  return names;
}

void RemoteFolder::remove(const std::string& key) {
  try {
    remove_remote(url_ + key);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {  // the file is removed later, together with the whole folder
  }
}

std::unique_ptr<Storage> shared_storage(const fs::path& place) {
  if (!is_url(place)) return std::make_unique<SharedFolder>(place);
  return std::make_unique<RemoteFolder>((place / "").string());
}

}  // namespace pointsweep
