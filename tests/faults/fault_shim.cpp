// SPDX-License-Identifier: MIT
/// A library to be preloaded into the tool. It makes operations on files fail where a test wants it.
///
///   FAULTS_FOLDERS  only operations on paths under these folders count (separated by colons)
///   FAULTS_KIND     enospc  fails with "no space left", and so does whatever needs space afterwards
///                   eio     fails once with an input/output error
///                   short   reads or writes half of what was asked for, always from then on
///                   eintr   is interrupted once before anything is done
///                   shrink, grow, rewrite, remove   halves, lengthens or overwrites (in its middle) the file
///                           FAULTS_TARGET, or removes that folder, first
///                   kill, int, term        the process gets this signal first
///   FAULTS_AT       which operation, from 1; none if it is absent
///   FAULTS_LOG      one line for each operation that counts: its number, name and path
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <string_view>

namespace {

std::string_view setting(const char* name) {
  const char* value = getenv(name);
  return value == nullptr ? "" : value;
}

std::atomic<long> operations{0};

template <class Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

bool is_watched(std::string_view path) {
  for (std::string_view folders = setting("FAULTS_FOLDERS"); !folders.empty();) {
    const std::size_t end = folders.find(':');
    if (path.starts_with(folders.substr(0, end))) return true;
    folders = end == folders.npos ? std::string_view() : folders.substr(end + 1);
  }
  return false;
}

/// The path of an open file. Standard streams get a name under which no folder lies, even if a test redirects them to
/// files.
struct PathOf {
  explicit PathOf(int descriptor) {
    strcpy(text, "/standard stream");
    if (descriptor <= STDERR_FILENO) return;
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    const long length = syscall(SYS_readlinkat, AT_FDCWD, link, text, sizeof text - 1);
    text[length < 0 ? 0 : length] = 0;
  }
  char text[4096];
};

/// A path as an absolute path.
struct WholePath {
  explicit WholePath(const char* path) {
    char folder[4000] = "";
    if (*path != '/' && syscall(SYS_getcwd, folder, sizeof folder) > 0) strcat(folder, "/");
    snprintf(text, sizeof text, "%s%s", folder, path);
  }
  char text[8192];
};

void log_operation(long number, const char* name, const char* path) {
  const char* log = getenv("FAULTS_LOG");
  if (log == nullptr) return;
  char line[8300];
  const int length = snprintf(line, sizeof line, "%ld %s %s\n", number, name, path);
  const long descriptor = syscall(SYS_openat, AT_FDCWD, log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  syscall(SYS_write, descriptor, line, length);
  syscall(SYS_close, descriptor);
}

void change_target(std::string_view kind) {
  const char* target = getenv("FAULTS_TARGET");
  struct stat status {};
  if (kind == "remove") {
    char command[4400];
    snprintf(command, sizeof command, "rm -rf '%s'", target);
    unsetenv("LD_PRELOAD");
    if (system(command) != 0) abort();
  } else if (stat(target, &status) == 0) {
    const off_t half = status.st_size / 2;
    if (kind == "rewrite") {
      const long descriptor = syscall(SYS_openat, AT_FDCWD, target, O_WRONLY | O_CLOEXEC, 0);
      if (syscall(SYS_pwrite64, descriptor, "0123456789", 10, half) != 10) abort();
      syscall(SYS_close, descriptor);
    } else if (truncate(target, kind == "shrink" ? half : status.st_size + 1000) != 0) {
      abort();
    }
  }
}

enum Needs : unsigned { kNothing = 0, kSpace = 1, kTransfer = 2 };
enum class Fault { none, error, half };

/// Returns the fault of an operation, before which it is called. Sets errno if the fault is `error`.
Fault fault_at(const char* name, const char* given, unsigned needs) {
  const WholePath whole(given);
  const char* path = whole.text;
  if (!is_watched(path)) return Fault::none;
  const long number = ++operations;
  log_operation(number, name, path);
  const std::string_view at = setting("FAULTS_AT"), kind = setting("FAULTS_KIND");
  if (at.empty() || number < atol(at.data())) return Fault::none;
  if (kind == "enospc" && (needs & kSpace)) return errno = ENOSPC, Fault::error;
  if (kind == "short" && (needs & kTransfer)) return Fault::half;
  if (number > atol(at.data())) return Fault::none;
  if (kind == "eio") return errno = EIO, Fault::error;
  if (kind == "eintr" && (needs & kTransfer)) return errno = EINTR, Fault::error;
  if (kind == "shrink" || kind == "grow" || kind == "rewrite" || kind == "remove") change_target(kind);
  if (kind == "kill") raise(SIGKILL);
  if (kind == "int") raise(SIGINT);
  if (kind == "term") raise(SIGTERM);
  return Fault::none;
}

size_t part_of(size_t count, Fault fault) { return fault == Fault::half && count > 1 ? count / 2 : count; }

int open_at(const char* name, int folder, const char* path, int flags, mode_t mode) {
  const bool creates = (flags & O_CREAT) != 0;
  if (fault_at(creates ? "create" : "open", path, creates ? kSpace : kNothing) == Fault::error) return -1;
  return real<int (*)(int, const char*, int, ...)>(name)(folder, path, flags, mode);
}

mode_t mode_of(int flags, va_list arguments) { return (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0; }

ssize_t transfer_at(const char* name, const char* call, int descriptor, void* bytes, size_t count, off_t offset) {
  const Fault fault = fault_at(name, PathOf(descriptor).text, *name == 'w' ? kSpace | kTransfer : kTransfer);
  if (fault == Fault::error) return -1;
  return real<ssize_t (*)(int, void*, size_t, off_t)>(call)(descriptor, bytes, part_of(count, fault), offset);
}

ssize_t transfer(const char* name, int descriptor, void* bytes, size_t count) {
  const Fault fault = fault_at(name, PathOf(descriptor).text, *name == 'w' ? kSpace | kTransfer : kTransfer);
  if (fault == Fault::error) return -1;
  return real<ssize_t (*)(int, void*, size_t)>(name)(descriptor, bytes, part_of(count, fault));
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return open_at("openat", AT_FDCWD, path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return open_at("openat64", AT_FDCWD, path, flags, mode);
}

ssize_t read(int descriptor, void* bytes, size_t count) { return transfer("read", descriptor, bytes, count); }
ssize_t write(int descriptor, const void* bytes, size_t count) {
  return transfer("write", descriptor, const_cast<void*>(bytes), count);
}
ssize_t pread(int descriptor, void* bytes, size_t count, off_t offset) {
  return transfer_at("read", "pread", descriptor, bytes, count, offset);
}
ssize_t pread64(int descriptor, void* bytes, size_t count, off64_t offset) {
  return transfer_at("read", "pread64", descriptor, bytes, count, offset);
}
ssize_t pwrite(int descriptor, const void* bytes, size_t count, off_t offset) {
  return transfer_at("write", "pwrite", descriptor, const_cast<void*>(bytes), count, offset);
}
ssize_t pwrite64(int descriptor, const void* bytes, size_t count, off64_t offset) {
  return transfer_at("write", "pwrite64", descriptor, const_cast<void*>(bytes), count, offset);
}

int mkdir(const char* path, mode_t mode) {
  if (fault_at("mkdir", path, kSpace) == Fault::error) return -1;
  return real<int (*)(const char*, mode_t)>("mkdir")(path, mode);
}
int rename(const char* from, const char* to) {
  if (fault_at("rename", to, kSpace) == Fault::error) return -1;
  return real<int (*)(const char*, const char*)>("rename")(from, to);
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  if (fault_at("rename", to, kSpace) == Fault::error) return -1;
  return real<int (*)(int, const char*, int, const char*, unsigned)>("renameat2")(from_folder, from, to_folder, to,
                                                                                  flags);
}
int link(const char* from, const char* to) {
  if (fault_at("link", to, kSpace) == Fault::error) return -1;
  return real<int (*)(const char*, const char*)>("link")(from, to);
}
int ftruncate(int descriptor, off_t size) {
  if (fault_at("truncate", PathOf(descriptor).text, kSpace) == Fault::error) return -1;
  return real<int (*)(int, off_t)>("ftruncate")(descriptor, size);
}
int fallocate(int descriptor, int mode, off_t offset, off_t length) {
  if (fault_at("fallocate", PathOf(descriptor).text, kSpace) == Fault::error) return -1;
  return real<int (*)(int, int, off_t, off_t)>("fallocate")(descriptor, mode, offset, length);
}
int fdatasync(int descriptor) {
  if (fault_at("sync", PathOf(descriptor).text, kSpace) == Fault::error) return -1;
  return real<int (*)(int)>("fdatasync")(descriptor);
}
/// Closes the descriptor even if the fault is an error: network file systems report failures of earlier writes when a
/// file is closed.
int close(int descriptor) {
  const Fault fault = fault_at("close", PathOf(descriptor).text, kSpace);
  const int error = errno;
  const int answer = real<int (*)(int)>("close")(descriptor);
  if (fault != Fault::error) return answer;
  errno = error;
  return -1;
}

}  // extern "C"
