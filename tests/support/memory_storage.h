// SPDX-License-Identifier: MIT
/// Storage in memory, and storage that fails.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// A storage whose objects are vectors in memory.
class MemoryStorage final : public Storage {
 public:
  std::unique_ptr<Source> open(const std::string& key) const override {
    const auto object = objects_.find(key);
    if (object == objects_.end()) fail("{}: no such object.", key);
    return std::make_unique<Opened>(key, object->second);
  }
  std::unique_ptr<Unsealed> create(const std::string& key) override { return std::make_unique<Begun>(objects_, key); }
  std::vector<std::string> list() const override {
    std::vector<std::string> keys;
    for (const auto& [key, bytes] : objects_) keys.push_back(key);
    return keys;
  }
  void remove(const std::string& key) override { objects_.erase(key); }

 private:
  using Objects = std::map<std::string, std::vector<std::byte>>;

  class Opened final : public Source {
   public:
    Opened(std::string key, std::vector<std::byte> bytes) : key_(std::move(key)), bytes_(std::move(bytes)) {}
    std::string name() const override { return key_; }
    std::uint64_t size() const override { return bytes_.size(); }
    void read_at(std::uint64_t offset, std::span<std::byte> bytes) const override {
      if (offset + bytes.size() > bytes_.size()) fail("{}: ends before byte {}.", key_, offset + bytes.size());
      std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), bytes.size(), bytes.begin());
    }

   private:
    std::string key_;
    std::vector<std::byte> bytes_;
  };
  class Begun final : public Unsealed {
   public:
    Begun(Objects& objects, std::string key) : objects_(objects), key_(std::move(key)) {}
    void append(std::span<const std::byte> bytes) override {
      write_at(end_, bytes);
      end_ += bytes.size();
    }
    void write_at(std::uint64_t offset, std::span<const std::byte> bytes) override {
      const std::lock_guard lock(mutex_);
      bytes_.resize(std::max<std::size_t>(bytes_.size(), offset + bytes.size()));
      std::ranges::copy(bytes, bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
    }
    void seal() override { objects_[key_] = std::move(bytes_); }

   private:
    Objects& objects_;
    std::string key_;
    std::mutex mutex_;  ///< guards bytes_
    std::vector<std::byte> bytes_;
    std::uint64_t end_ = 0;
  };

  Objects objects_;
};

/// A storage whose operation number `fails`, counted from 0, and all later ones throw Error. A failing write has
/// written half of its bytes, like on a full disk.
class FaultyStorage final : public Storage {
 public:
  FaultyStorage(Storage& storage, std::size_t fails) : storage_(storage), left_(fails) {}
  std::unique_ptr<Source> open(const std::string& key) const override {
    step();
    return std::make_unique<Opened>(*this, storage_.open(key));
  }
  std::unique_ptr<Unsealed> create(const std::string& key) override {
    step();
    return std::make_unique<Begun>(*this, storage_.create(key));
  }
  std::vector<std::string> list() const override {
    step();
    return storage_.list();
  }
  void remove(const std::string& key) override {
    step();
    storage_.remove(key);
  }

 private:
  class Opened final : public Source {
   public:
    Opened(const FaultyStorage& storage, std::unique_ptr<Source> source)
        : storage_(storage), source_(std::move(source)) {}
    std::string name() const override { return source_->name(); }
    std::uint64_t size() const override { return source_->size(); }
    void read_at(std::uint64_t offset, std::span<std::byte> bytes) const override {
      storage_.step();
      source_->read_at(offset, bytes);
    }

   private:
    const FaultyStorage& storage_;
    std::unique_ptr<Source> source_;
  };
  class Begun final : public Unsealed {
   public:
    Begun(const FaultyStorage& storage, std::unique_ptr<Unsealed> object)
        : storage_(storage), object_(std::move(object)) {}
    void append(std::span<const std::byte> bytes) override {
      if (storage_.left_ == 0) object_->append(bytes.first(bytes.size() / 2));
      storage_.step();
      object_->append(bytes);
    }
    void write_at(std::uint64_t offset, std::span<const std::byte> bytes) override {
      if (storage_.left_ == 0) object_->write_at(offset, bytes.first(bytes.size() / 2));
      storage_.step();
      object_->write_at(offset, bytes);
    }
    void seal() override {
      storage_.step();
      object_->seal();
    }

   private:
    const FaultyStorage& storage_;
    std::unique_ptr<Unsealed> object_;
  };

  void step() const {
    if (left_ == 0) fail("the storage has failed.");
    --left_;
  }

  Storage& storage_;
  mutable std::size_t left_;
};

}  // namespace pointsweep
