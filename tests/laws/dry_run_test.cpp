// SPDX-License-Identifier: MIT
/// The lines of --dry-run about the order in which stages take the points, for every operator of the registry.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/pipeline/run/preview.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/support/every_operator.h"

namespace pointsweep {
namespace {

const std::string kRows = "reads the rows in their order; no neighbours are searched";
const std::string kSearch = "neighbours all within 9";

std::string in_order(const std::string& along, const std::string& how) {
  return fmt::format("reads the points in order along {}, {}; no neighbours are searched", along, how);
}
std::string connecting(const std::string& op) {
  return kSearch + " / connects neighbours by edges, in the temporary folder; '" + op + "' is known after the pass";
}

/// Returns, by stage, the lines of the passes that the stage needs, written by hand. `axis`: the axis that --axis
/// names. `in_plane`: the axis of stages that ignore z.
std::map<std::string, std::string> lines_by_hand(const std::string& axis, const std::string& in_plane) {
  const std::string beside = in_order(axis, "beside those of the other cloud");
  const std::string disks = in_order(axis, "each held until all points within the radius have come");
  const std::string voxels = in_order(axis, "those of a voxel together");
  return {
      {"normals", kSearch},
      {"curvature", kSearch},
      {"splats", kSearch},
      {"fair", kRows + " / " + kSearch},
      {"features", kSearch},
      {"neighborhood_size", kSearch},
      {"where", kRows},
      {"crop", kRows},
      {"set", kRows},
      {"drop", kRows},
      {"transform", kRows},
      {"sor", kSearch + " / " + kRows},
      {"denoise", kSearch + " / " + kRows},
      {"ror", kSearch},
      {"lof", kSearch},
      {"density", kSearch},
      {"statistics", kSearch},
      {"unique", in_order(axis, "equal ones together")},
      {"head", kRows},
      {"decimate", kRows},
      {"sample", in_order(axis, "by the hash of their coordinates")},
      {"parts", kRows},
      {"voxel", voxels},
      {"voxel keep=centroid", voxels},
      {"poisson", disks},
      {"simplify", kRows + " / " + disks},
      {"level", in_order(axis, "three times: for their bounds, their levels, and to take them")},
      {"ground", in_order(in_plane, "those of a row of cells together")},
      {"height", in_order(in_plane, "beside those of the ground")},
      {"color", kRows + " / " + kRows},
      {"distance_to", beside},
      {"m3c2", beside},
      {"take", beside},
      {"components", connecting("components")},
      {"dbscan", connecting("clusters")},
      {"segments", connecting("segments")},
      {"orient", connecting("normal_signs") + " / " + kRows},
      {"reneighbor", kRows + " / " + kSearch},
      {"resort", kSearch},
  };
}

/// Returns the lines that kind and contract tell of a stage without lines by hand. A stage that needs more passes than
/// its kind gets lines by hand.
std::string lines_of_kind(const ChainStage& stage, const std::string& name, const std::string& axis,
                          const std::string& in_plane) {
  if (const auto* in_order_operator = std::get_if<std::shared_ptr<const InOrderOperator>>(&stage)) {
    const InOrderContract contract = (*in_order_operator)->in_order_contract();
    return in_order(contract.places == Places::in_plane ? in_plane : axis, contract.arrival);
  }
  if (std::holds_alternative<std::shared_ptr<const LocalOperator>>(stage) ||
      std::holds_alternative<std::shared_ptr<const SelectOperator>>(stage)) {
    const Contract contract = operator_of(stage)->contract();
    return contract.default_k > 0 || contract.all_within.has_value() ? kSearch : kRows;
  }
  return "add the lines of '" + name + "'";
}

class DryRun : public testing::Test {
 protected:
  DryRun() : other_(testing::TempDir() + fmt::format("pointsweep-dry-run-{}.csv", getpid())) {
    std::ofstream(other_) << "x,y,z,classification\n0,0,0,1\n1,1,1,2\n";
    for (const char* name : {"x", "y", "z"}) input_.schema.append(name, Type::f64);
    for (const char* name :
         {"nx", "ny", "nz", "k1", "splat_axis_x", "splat_axis_y", "splat_axis_z", "splat_length", "splat_ratio"})
      input_.schema.append(name, Type::f32);
    input_.schema.append("classification", Type::u8);
    input_.schema.append("intensity", Type::u16);
    input_.bytes.resize(8 * input_.schema.stride);
  }
  ~DryRun() override { std::filesystem::remove(other_); }

  /// Returns the lines about the order in which the passes take the points, separated by " / ".
  std::string passages(const std::string& pipeline, std::optional<int> axis) const {
    InputCloud cloud = input_.cloud();
    EngineOptions options;
    options.axis = axis;
    std::istringstream lines(to_text(preview(cloud, build_chain(parse_pipeline(pipeline), cloud), options)));
    std::string text;
    for (std::string line; std::getline(lines, line);) {
      const std::size_t word = line.find(' '), rest = line.find_first_not_of(' ', word);
      const std::string title = line.substr(0, word);
      if (title != "reads" && title != "neighbours" && title != "connects") continue;
      text += (text.empty() ? "" : " / ") + title + " " + line.substr(rest);
    }
    return text;
  }

  std::string other_;
  Records input_;
};

/// Stores the axis along which the places of its points should ascend, and checks that they ascend.
class AxisNote final : public InOrderOperator {
 public:
  explicit AxisNote(bool in_plane) : in_plane_(in_plane) {}
  std::string name() const override { return "axis"; }
  InOrderContract in_order_contract() const override {
    return {.makes = {scalar("noted", Type::u8, "1", "")},
            .places = in_plane_ ? Places::in_plane : Places::of_operator};
  }
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override {
    class Ascending final : public InOrderWork {
     public:
      explicit Ascending(int axis) : axis_(axis) {}
      void add(unsigned, const OrderedPoints& points, Findings&) override {
        EXPECT_TRUE(std::ranges::is_sorted(points.places, {}, [&](Vec3 p) { return p[axis_]; }));
      }

     private:
      int axis_;
    };
    axis = setup.axis;
    return std::make_unique<Ascending>(setup.axis);
  }
  mutable int axis = -1;

 private:
  bool in_plane_;
};

TEST(Axis, OfOperatorsThatTakePointsInOrderIsTheOneThatWasAskedForUnlessTheyLieInAPlane) {
  std::vector<Vec3> points;
  for (int i = 0; i < 50; ++i) points.push_back({double(i * 7 % 50), double(i * 11 % 50) / 2, double(i * 3 % 50) / 4});
  for (const bool in_plane : {false, true})
    for (const int asked : {0, 1, 2}) {
      const auto note = std::make_shared<AxisNote>(in_plane);
      EngineOptions options;
      options.axis = asked;
      run_in_memory(points, {{}, {note}}, options);
      EXPECT_EQ(note->axis, in_plane && asked == 2 ? 0 : asked);
    }
}

TEST_F(DryRun, SaysHowEveryOperatorTakesThePointsAndAlongWhichAxis) {
  const EveryOperator every({"normal", "k1", "splat_axis", "splat_length", "splat_ratio", "classification"},
                            "knn(radius=9)", other_);
  for (const std::optional<int> axis : {std::optional<int>(), std::optional(1), std::optional(2)}) {
    const std::string along = axis ? std::string(1, "xyz"[*axis]) : "their longest axis";
    const std::string in_plane = axis == 1 ? "y" : "x or y";
    std::map<std::string, std::string> by_hand = lines_by_hand(along, in_plane);
    for (const OperatorDeclaration& declaration : all_operators()) {
      OptionValues values = every.values_of(declaration);
      const auto ask = [&](const std::string& name) {
        const std::string pipeline = every.case_of(declaration, values).pipeline;
        const auto found = by_hand.extract(name);
        EXPECT_EQ(passages(pipeline, axis),
                  found.empty() ? lines_of_kind(declaration.make(values, {}), name, along, in_plane) : found.mapped())
            << pipeline;
      };
      ask(declaration.name);
      if (declaration.name == "voxel" && values.give("keep", "centroid")) ask("voxel keep=centroid");
    }
    EXPECT_TRUE(by_hand.empty()) << "no operator is called '" << by_hand.begin()->first << "'";
  }
}

}  // namespace
}  // namespace pointsweep
