// SPDX-License-Identifier: MIT
/// Reads the stored corpus of the fuzzers in every run of the tests, also under sanitizers.
#include <gtest/gtest.h>

#include <string>

#include "pointsweep/formats/e57/e57_format.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/las/las_reader.h"
#include "pointsweep/formats/npy/npy_format.h"
#include "pointsweep/formats/pcd/pcd_format.h"
#include "pointsweep/formats/ply/ply_format.h"
#include "pointsweep/formats/text/text_format.h"
#include "pointsweep/program/pipeline.h"
#include "tests/fuzz/decode_everything.h"
#include "tests/fuzz/read_everything.h"
#include "tests/support/contents.h"

namespace pointsweep {
namespace {

/// Calls use(bytes) with every file of the corpus of a fuzzer.
template <class Use>
void for_each_kept(const std::string& fuzzer, Use use) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(POINTSWEEP_SOURCE_DIR "/tests/fuzz/corpus/" + fuzzer)) {
    SCOPED_TRACE(entry.path().filename().string());
    EXPECT_NO_THROW(use(contents(entry.path())));
    ++files;
  }
  EXPECT_GT(files, 0u);
}

TEST(FuzzCorpus, EveryFileIsReadWholeOrRefused) {
  using Open = std::unique_ptr<Reader> (*)(const std::filesystem::path&);
  const std::pair<const char*, Open> readers[] = {
      {"ply", open_ply},        {"las", open_las},         {"text", open_text}, {"qsplat", kQsplatFormat.open},
      {"pcd", open_pcd},        {"e57", open_e57},         {"npy", open_npy},   {"ptx", kPtxFormat.open},
      {"vtk", kVtkFormat.open}, {"numpy", open_npy_points}};
  for (const auto& [name, open] : readers) {
    for_each_kept(name, [open = open](const std::string& bytes) {
      read_everything(open, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    });
  }
}

TEST(FuzzCorpus, EveryPipelineIsRefusedOrSaysTheSameAgain) {
  for_each_kept("pipeline", [](const std::string& text) {
    try {
      const auto stages = parse_pipeline(text);
      EXPECT_EQ(parse_pipeline(to_text(stages)), stages);
    } catch (const UsageError&) {
    }
  });
}

TEST(FuzzCorpus, EveryStoredValueIsDecodedOrRefused) {
  for_each_kept("values", [](const std::string& bytes) {
    decode_everything(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  });
}

}  // namespace
}  // namespace pointsweep
