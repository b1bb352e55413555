// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/folder_storage.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <functional>
#include <string_view>
#include <system_error>

#include "pointsweep/fail.h"
#include "pointsweep/storage/local/input_file.h"
#include "pointsweep/storage/local/output_file.h"
#include "pointsweep/storage/remote/remote_service.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kUnsealed = ".unsealed";

/// A file that gets its name when it is sealed.
class UnsealedFile final : public Unsealed {
 public:
  /// Makes the file `unsealed`, which becomes `path`. `fail_to_write` throws the Error for an errno. `flushed`: the
  /// folder if seal() must flush the file and its name to the disk, else null.
  UnsealedFile(fs::path path, const std::string& unsealed, mode_t mode, std::function<void(int)> fail_to_write,
               const LocalFolder* flushed)
      : path_(std::move(path)),
        unsealed_(unsealed),
        fail_to_write_(std::move(fail_to_write)),
        flushed_(flushed),
        file_(::open(unsealed_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, mode)) {
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
    if (flushed_ != nullptr) check(::fdatasync(file_.number()) == 0 ? 0 : errno);
    check(::rename(unsealed_.c_str(), path_.c_str()) == 0 ? 0 : errno);
    file_.close();
    if (flushed_ != nullptr) flushed_->flush();
  }

 private:
  void check(int error) const {
    if (error != 0) fail_to_write_(error);
  }

  fs::path path_, unsealed_;
  std::function<void(int)> fail_to_write_;
  const LocalFolder* flushed_;
  FileDescriptor file_;
  std::uint64_t end_ = 0;
};

/// Returns the names of all files in the folder except files of unsealed objects, ascending. Sets `error` if the folder
/// cannot be read.
std::vector<std::string> sealed_names(const fs::path& folder, std::error_code& error) {
  std::vector<std::string> names;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::string name = entry->path().filename().string();
    if (!name.ends_with(kUnsealed)) names.push_back(std::move(name));
  }
  std::ranges::sort(names);
  return names;
}

/// Returns a text that is unique among all processes of all machines whose host names differ.
std::string unique_suffix() {
  static std::atomic<unsigned> last = 0;
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  return "." + std::string(host.data()) + "-" + std::to_string(::getpid()) + "-" + std::to_string(++last);
}

/// A folder that several processes share, with objects as files. If two processes create objects with the same key, the
/// object sealed last remains. Files are not flushed to the disk: a power failure may damage an object, which a
/// checksum reveals (sealed_bytes()). A killed process may leave the file of an unsealed object.
class SharedFolder final : public Storage {
 public:
  /// Uses the folder `path`, which must exist.
  explicit SharedFolder(fs::path path) : path_(std::move(path)) {}

  std::unique_ptr<Source> open(const std::string& key) const override {
    return std::make_unique<InputFile>(path_ / key);
  }
  std::unique_ptr<Unsealed> create(const std::string& key) override {
    const std::string path = (path_ / key).string();
    const auto fail_to_write = [path](int error) {
      fail("{}: cannot be written: {}; free space there or name another scratch folder.", path, std::strerror(error));
    };
    return std::make_unique<UnsealedFile>(path, path + unique_suffix().append(kUnsealed), 0666, fail_to_write, nullptr);
  }
  std::vector<std::string> list() const override {
    std::error_code error;
    std::vector<std::string> names = sealed_names(path_, error);
    if (error) fail("{}: cannot be read: {}.", path_.string(), error.message());
    return names;
  }
  void remove(const std::string& key) override {
    std::error_code ignored;
    fs::remove(path_ / key, ignored);
  }

 private:
  fs::path path_;
};

/// A folder of a bucket.
class RemoteFolder final : public Storage {
 public:
  /// Uses the folder `url`, which must end in '/'.
  explicit RemoteFolder(std::string url) : url_(std::move(url)) {}

  std::unique_ptr<Source> open(const std::string& key) const override {
    return std::make_unique<InputFile>(url_ + key);
  }
  std::unique_ptr<Unsealed> create(const std::string& key) override {
    return std::make_unique<OutputFile>(url_ + key, true);
  }
  std::vector<std::string> list() const override {
    std::vector<std::string> names;
    for (const RemoteEntry& entry : list_remote(url_, false)) names.push_back(entry.url.substr(url_.size()));
    std::ranges::sort(names);
    return names;
  }
  void remove(const std::string& key) override {
    try {
      remove_remote(url_ + key);
    } catch (const Cancelled&) {
      throw;
    } catch (const Error&) {  // ignored: the object stays until the whole folder is removed
    }
  }

 private:
  std::string url_;
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
  const fs::path path = path_ / key;
  const auto fail_to_write = [this](int error) { this->fail_to_write(error); };
  return std::make_unique<UnsealedFile>(path, path.string().append(kUnsealed), 0600, fail_to_write, this);
}

std::vector<std::string> LocalFolder::list() const {
  std::error_code error;
  std::vector<std::string> names = sealed_names(path_, error);
  if (error && error != std::errc::no_such_file_or_directory)
    fail("cannot read the folder '{}': {}.", path_.string(), error.message());
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

std::unique_ptr<Storage> shared_storage(const fs::path& place) {
  if (!is_url(place)) return std::make_unique<SharedFolder>(place);
  return std::make_unique<RemoteFolder>((place / "").string());
}

}  // namespace pointsweep
