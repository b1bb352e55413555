// SPDX-License-Identifier: MIT
/// The codec of LAZ alone: THREADS threads encode the records of a LAS file in memory in chunks of 50,000, and decode
/// them again. Prints both times as JSON; fails if the decoded records differ.
///   codec_alone IN.las THREADS
#include <array>
#include <atomic>
#include <cstdio>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "bench/formats/measured.h"
#include "bench/normals/las.h"
#include "pointsweep_codecs.h"

namespace bench {
namespace {

constexpr std::size_t kChunk = 50'000;

struct Encoded {
  std::uint8_t* bytes = nullptr;
  std::size_t size = 0;
};

void require(int status, const psc_error& error) {
  if (status != 0) give_up(error.text);
}

/// Calls work(chunk) for all chunks on `threads` threads.
void for_chunks(std::size_t chunks, unsigned threads, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::vector<std::jthread> pool;
  for (unsigned t = 0; t < threads; ++t)
    pool.emplace_back([&] {
      for (std::size_t i; (i = next++) < chunks;) work(i);
    });
}

struct Codec {
  Las las;
  psc_laz* laz = nullptr;
  std::vector<Encoded> chunks;
  std::vector<std::uint8_t> decoded;

  explicit Codec(const std::string& path) : las(path), decoded(las.bytes.size()) {
    static constexpr std::array<std::uint16_t, 11> kRecordBytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
    psc_error error{};
    const auto format = las.entry<std::uint8_t>(104);
    require(psc_laz_for_format(format, std::uint16_t(las.stride - kRecordBytes.at(format)), kChunk, &laz, &error),
            error);
    chunks.resize((las.count + kChunk - 1) / kChunk);
  }
  Codec(const Codec&) = delete;
  Codec& operator=(const Codec&) = delete;
  ~Codec() {
    for (const Encoded& chunk : chunks) psc_free_bytes(chunk.bytes, chunk.size);
    psc_laz_free(laz);
  }

  std::size_t begin(std::size_t chunk) const { return chunk * kChunk * las.stride; }
  std::size_t bytes(std::size_t chunk) const { return std::min(kChunk * las.stride, las.bytes.size() - begin(chunk)); }

  void encode(std::size_t chunk) {
    psc_error error{};
    const auto* records = reinterpret_cast<const std::uint8_t*>(las.bytes.data()) + begin(chunk);
    require(psc_laz_encode(laz, records, bytes(chunk), &chunks[chunk].bytes, &chunks[chunk].size, &error), error);
  }

  void decode(std::size_t chunk) {
    psc_error error{};
    psc_laz_decoder* decoder = nullptr;
    const auto read = [](void* of, std::uint64_t offset, std::uint8_t* into, std::size_t size) {
      std::memcpy(into, static_cast<Encoded*>(of)->bytes + offset, size);
      return std::ptrdiff_t(size);
    };
    require(psc_laz_decoder_open(laz, read, &chunks[chunk], 0, chunks[chunk].size, &decoder, &error), error);
    require(psc_laz_decode(decoder, decoded.data() + begin(chunk), bytes(chunk), &error), error);
    psc_laz_decoder_free(decoder);
  }
};

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  using namespace bench;
  if (argc != 3) return std::fprintf(stderr, "usage: %s IN.las THREADS\n", argv[0]), 2;
  Codec codec(argv[1]);
  const auto threads = unsigned(std::stoul(argv[2]));
  const Seconds encode =
      measured([&] { for_chunks(codec.chunks.size(), threads, [&](std::size_t i) { codec.encode(i); }); });
  const Seconds decode =
      measured([&] { for_chunks(codec.chunks.size(), threads, [&](std::size_t i) { codec.decode(i); }); });
  if (std::memcmp(codec.decoded.data(), codec.las.bytes.data(), codec.decoded.size()) != 0)
    give_up(std::string(argv[1]) + ": other records come back");
  std::printf(
      "{\"encode\": {\"wall_seconds\": %.6f, \"cpu_seconds\": %.6f}, \"decode\": {\"wall_seconds\": %.6f, "
      "\"cpu_seconds\": %.6f}}\n",
      encode.wall, encode.cpu, decode.wall, decode.cpu);
}
