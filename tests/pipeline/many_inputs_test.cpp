// SPDX-License-Identifier: MIT
/// The memory of very many open inputs is part of the budget.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/memory/run_memory.h"
#include "pointsweep/pipeline/run/preview.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

/// Many inputs of one point each.
class ManyInputs {
 public:
  explicit ManyInputs(std::size_t inputs) {
    std::vector<std::unique_ptr<Reader>> readers;
    for (std::size_t i = 0; i < inputs; ++i) {
      xyz_.push_back(std::make_unique<float[]>(3));
      xyz_.back()[0] = static_cast<float>(i);
      readers.push_back(std::make_unique<ArrayReader>(std::span<const float>(xyz_.back().get(), 3)));
    }
    cloud = std::make_unique<InputCloud>(std::move(readers));
  }

  std::unique_ptr<InputCloud> cloud;

 private:
  std::vector<std::unique_ptr<float[]>> xyz_;
};

EngineOptions within(std::uint64_t megabytes) {
  EngineOptions options;
  options.resources.memory_bytes = megabytes << 20;
  options.resources.threads = 1;
  return options;
}

TEST(ManyInputs, ArePartOfThePlannedMemory) {
  const Chain chain = build_chain(parse_pipeline("knn(k=1) | normals"), Facts{});
  const auto expected = [&](std::size_t inputs) {
    const ManyInputs many(inputs);
    return preview(*many.cloud, chain, within(1000)).memory.expected_bytes;
  };
  const std::uint64_t few = expected(100), more = expected(2100);
  EXPECT_GE(more, few + (2000 * 4000)) << "of each input after the first hundred";
  EXPECT_LE(more, few + (2000 * 5000));
}

TEST(ManyInputs, AreRefusedWhereTheBudgetHasNoRoomForThem) {
  const TemporaryFolder folder;
  const ManyInputs many(3100);
  const Outputs outputs{.points = folder / "out.ply"};
  for (const Chain& chain : {Chain{}, build_chain(parse_pipeline("knn(k=1) | normals"), Facts{})}) {
    const std::string said = sentence_of<Error>([&] { run(*many.cloud, chain, outputs, within(30)); });
    EXPECT_EQ(said,
              "A memory budget of 30 MB is too small for 3100 inputs, which take 11 MB while they are open: give "
              "--memory 36M or more.");
    EXPECT_EQ(sentence_of<Error>([&] { preview(*many.cloud, chain, within(30), outputs); }), said);
    EXPECT_FALSE(std::filesystem::exists(outputs.points));
  }
  EXPECT_EQ(open_input_bytes(*ManyInputs(100).cloud), 0u) << "the first hundred";
  run(*many.cloud, Chain{}, outputs, within(36));
  EXPECT_EQ(InputCloud({outputs.points}).count(), 3100u);
}

}  // namespace
}  // namespace pointsweep
