// SPDX-License-Identifier: MIT
/// `verify` of outputs whose pipelines drop rows after other stages: right outputs pass; a changed value, a missing row
/// and a surplus row are found.
#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

constexpr int kRows = 900;

class VerifySelects : public Tool {
 protected:
  using Cells = std::vector<std::string>;

  /// Writes a plane with noise, a slope and scattered points. Some rows come twice.
  void write_all() {
    std::mt19937_64 random(5);
    const auto number = [&](double most) { return most * static_cast<double>(random() % 10'000) / 10'000; };
    std::string text = "x y z level\n";
    for (int i = 0; i < kRows; ++i) {
      const double x = number(6), y = number(6);
      const double z = i % 5 == 0 ? number(4) : i % 3 == 0 ? 0.5 * x + 2 : 0.01 * number(1);
      const std::string line = fmt::format("{} {} {} {}\n", x, y, z, i % 6);
      text += line;
      if (i % 100 == 50) text += line;
    }
    write("all.txt", text);
  }
  /// Returns the numbers of a text file, and stores the lines before them in head_.
  std::vector<Cells> rows_of(const std::string& name) {
    std::istringstream text(contents(folder_ / name));
    std::vector<Cells> rows;
    head_.clear();
    for (std::string line; std::getline(text, line);) {
      std::istringstream words(line);
      Cells cells;
      for (std::string word; words >> word;) cells.push_back(word);
      const bool is_row = !cells.empty() && cells[0].find_first_not_of("-+.0123456789e") == std::string::npos;
      is_row ? rows.push_back(cells) : void(head_ += line + "\n");
    }
    return rows;
  }
  void write_rows(const std::string& name, const std::vector<Cells>& rows) {
    std::string text = head_;
    for (const Cells& cells : rows) {
      for (const std::string& cell : cells) text += cell + " ";
      text.back() = '\n';
    }
    write(name, text);
  }
  Result verified(const std::string& name) { return tool("verify " + name + " --memory 1G"); }
  void wrong(const std::vector<Cells>& rows, const std::string& message, const std::string& what) {
    write_rows("wrong.txt", rows);
    const Result result = verified("wrong.txt");
    EXPECT_EQ(result.status, 1) << what << result.out;
    EXPECT_NE(result.err.find(message), std::string::npos) << what << ": " << message << "\n" << result.err;
  }

  void checks(const std::string& pipeline) {
    write_all();
    const std::vector<Cells> all = rows_of("all.txt");
    made("run all.txt out.txt --force --quiet --pipeline '" + pipeline + "'");
    const Result right = verified("out.txt");
    EXPECT_EQ(right.status, 0) << pipeline << right.out << right.err;
    const std::string told = fmt::format("whether a row stays was checked for {0} of {0} rows", all.size());
    EXPECT_NE(right.out.find(told), std::string::npos) << pipeline << right.out;
    EXPECT_EQ(right.out.find("not checked"), std::string::npos) << pipeline << right.out;
    const std::vector<Cells> kept = rows_of("out.txt");
    ASSERT_LT(kept.size(), all.size()) << pipeline;
    ASSERT_GT(kept.size(), all.size() / 8) << pipeline;

    std::vector<Cells> less = kept;
    less.erase(less.begin() + static_cast<std::ptrdiff_t>(kept.size() / 2));
    wrong(less, "is left out, and the conditions hold for it", pipeline);

    std::vector<Cells> more = kept, changed = kept;
    for (std::size_t row = 0, place = 0; row < all.size() && more.size() == kept.size(); ++row) {
      const bool is_here = place < kept.size() && std::equal(all[row].begin(), all[row].end(), kept[place].begin());
      if (is_here) ++place;
      if (is_here || row < all.size() / 2) continue;
      Cells gone = kept[place - 1];
      std::ranges::copy(all[row], gone.begin());
      more.insert(more.begin() + static_cast<std::ptrdiff_t>(place), gone);
    }
    wrong(more, "is in the output, and a condition does not hold for it", pipeline);

    if (kept[0].size() == all[0].size()) return;
    std::string& cell = changed[kept.size() / 3].back();
    cell = fmt::format("{}", std::stod(cell) + 1);
    wrong(changed, " by brute force", pipeline);
  }

 private:
  std::string head_;
};

TEST_F(VerifySelects, OutliersByTheMeanDistancesOfAllRows) {
  checks("sor | where(outlier == 0)");
  checks("knn(k=4) | sor(multiplier=0.5) | where(outlier == 0) | drop(outlier, mean_distance)");
  checks("knn(radius=0.6) | ror(radius=0.6, min_neighbors=9) | where(outlier == 0)");
}

TEST_F(VerifySelects, LargeSegmentsByTheGraphOfAllRows) {
  checks("knn(k=12) | normals | segments(angle=20) | where(segment_size > 50)");
  checks("knn(k=12) | normals | segments(angle=20) | where(segment_size > 50 && segment_residual < 0.02)");
  checks("knn(radius=0.5) | dbscan(eps=0.25) | where(cluster >= 0)");
}

TEST_F(VerifySelects, HeightsAboveGroundThatIsNotWritten) {
  checks("ground(cell=0.5, window=4) | height | where(height < 1)");
  checks("ground(cell=0.5, window=4) | where(classification == 2)");
}

TEST_F(VerifySelects, SeveralAndOthers) {
  checks("normals | where(nz > 0.9 || level < 3)");
  checks("sor | where(outlier == 0) | set(q = z * 2) | where(q > 0.005)");
  checks("reneighbor | where(z < 0.5)");
  checks("normals | where(level in (1, 2, 5) and not nz between 0.1 and 0.2)");
  checks("set(q = max(abs(x - 3), exp(-y))) | where(q < 2 or atan2(y, x) > 1 and log(x + 1) < 1)");
  checks("normals | orient | where(nz > 0.5)");
}

/// Stages after `reneighbor` are named as not checked; stages before it are checked.
TEST_F(VerifySelects, NameWhatTheyCannotTell) {
  write_all();
  made("run all.txt out.txt -q --pipeline 'where(level > 0) | sor | where(outlier == 0) | normals | where(nz > 0.5)'");
  const Result partly = verified("out.txt");
  EXPECT_EQ(partly.status, 3) << partly.out << partly.err;
  EXPECT_NE(partly.out.find("not checked        which rows 'where' leaves out"), std::string::npos) << partly.out;
  EXPECT_NE(partly.out.find("0 wrong: mean_distance outlier"), std::string::npos) << partly.out;
  made("run all.txt out.txt -f -q --order sweep --pipeline 'sor | where(outlier == 0)'");
  const Result sweep = verified("out.txt");
  EXPECT_EQ(sweep.status, 2);
  EXPECT_NE(sweep.err.find("in the order of the sweep"), std::string::npos) << sweep.err;
  made("run all.txt out.txt -f -q --pipeline 'sor | where(outlier == 0)'");
  const Result little = tool("verify out.txt --memory 10k --sample 50");
  EXPECT_EQ(little.status, 3) << little.out << little.err;
  EXPECT_NE(little.out.find("outlier: the mean distance of all points needs --memory"), std::string::npos)
      << little.out;
}

}  // namespace
}  // namespace pointsweep
