// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/divided_writer.h"

#include <string>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/pipeline/output/divided_files.h"

namespace pointsweep {

DividedWriter::DividedWriter(OutputPlan plan, const OutputDivision& division, DivisionRoom room)
    : progress_(std::exchange(plan.progress, {})),
      divider_(std::move(plan), division),
      room_(std::move(room)),
      records_(divider_, divider_.plan().count, room_.bytes / 2, room_.scratch) {
  divider_.require_writable();
}

void DividedWriter::finish() {
  const OutputPlan& plan = divider_.plan();
  if (records_.came() != plan.count)
    fail("{}: {} points were announced, but {} came; nothing was written.", plan.path.string(), plan.count,
         records_.came());
  require_files_possible(divider_, records_.files());
  const auto progress = [&](double share) {
    progress_(static_cast<std::uint64_t>(share * static_cast<double>(records_.came())));
  };
  DividedFiles files(divider_, records_.files(), room_.bytes, progress_ ? progress : std::function<void(double)>());
  records_.for_each([&](std::uint32_t file, std::span<const std::byte> records) { files.take(file, records); });
  files.finish();
  complete_ = files.complete();
  bytes_written_ = files.bytes_written();
  for (const std::string& sentence : files.warnings()) add_warning(sentence);
}

}  // namespace pointsweep
