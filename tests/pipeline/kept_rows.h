// SPDX-License-Identifier: MIT
/// A check of stages that select rows: the rest of the pipeline sees a cloud of the kept rows alone.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/moving_clouds.h"

namespace pointsweep {

/// Expects that `pipeline` over `input` gives the bytes of `rest` over `kept`, in both orders and for all ways to run.
inline void expect_as_over(const Records& input, const std::string& pipeline, const Records& kept,
                           const std::string& rest) {
  for (const Order order : {Order::input, Order::sweep}) {
    for (const EngineOptions& options : ways_to_run(order)) {
      SCOPED_TRACE(pipeline + (order == Order::input ? ", input order" : ", sweep order"));
      const RunResult expected = run_text(kept, rest, options), got = run_text(input, pipeline, options);
      ASSERT_EQ(got.schema, expected.schema);
      ASSERT_TRUE(got.records == expected.records);
      ASSERT_EQ(got.statistics.points, input.size());
      ASSERT_EQ(got.statistics.points_written, expected.statistics.points_written);
    }
  }
}

}  // namespace pointsweep
