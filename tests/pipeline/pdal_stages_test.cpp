// SPDX-License-Identifier: MIT
/// Translations of PDAL pipelines, written from the documentation of PDAL 2.

#include <gtest/gtest.h>

#include "pointsweep/chain.h"
#include "pointsweep/error.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

std::string in_our_words(const std::string& json) { return to_text(parse_pipeline(json)); }

std::string refusal_of_pdal(const std::string& json) {
  try {
    return "accepted: " + in_our_words(json);
  } catch (const UsageError& error) {
    return error.what();
  }
}

TEST(PdalStages, OfAWholePipelineKeepTheirOrderAndNeighborhoods) {
  EXPECT_EQ(
      in_our_words(R"~({"pipeline": ["in.laz",
                    {"type": "filters.range", "limits": "Classification![7:7],Z(-5:1000]"},
                    {"type": "filters.outlier", "mean_k": 12, "multiplier": 2.2},
                    {"type": "filters.normal", "knn": 12},
                    {"type": "filters.dbscan", "eps": 2, "min_points": 9},
                    {"type": "writers.las", "filename": "out.laz"}]})~"),
      R"~(knn(k=12) | where("(!(Classification >= 7 && Classification <= 7)) && ((Z > -5 && Z <= 1000))") | )~"
      R"~(sor(multiplier=2.2, definition=pdal) | set("classification = 7 where outlier == 1") | )~"
      R"~(drop([outlier,mean_distance]) | normals(orient=up) | reneighbor(radius=2) | dbscan(eps=2, min_points=9))~");
}

TEST(PdalStages, BecomeStagesOfOurs) {
  const std::pair<const char*, const char*> pairs[] = {
      {R"~("filters.expression", "expression": "Z > 3 && Classification == 2")~",
       R"~(where("Z > 3 && Classification == 2"))~"},
      {R"~("filters.range", "limits": "Classification[2:2], Classification[9:9]")~",
       R"~(where("((Classification >= 2 && Classification <= 2) || (Classification >= 9 && Classification <= 9))"))~"},
      {R"~("filters.range", "limits": "Z[:10)")~", R"~(where("((Z < 10))"))~"},
      {R"~("filters.crop", "bounds": "([0, 300], [10,200])")~", "crop(bounds=[0,10,300,200], outside=false)"},
      {R"~("filters.crop", "polygon": "POLYGON ((0 0, 4 0, 4 4, 0 0))", "outside": "true")~",
       R"~(crop(polygon="POLYGON ((0 0, 4 0, 4 4, 0 0))", outside=true))~"},
      {R"~("filters.head", "count": 20)~", "head(number=20)"},
      {R"~("filters.head")~", "head(number=10)"},
      {R"~("filters.assign", "value": "Classification = 2 WHERE Z > 3")~",
       R"~(set("Classification = 2 where Z > 3"))~"},
      {R"~("filters.transformation", "matrix": "1 0 0 5  0 1 0 6  0 0 1 7  0 0 0 1")~",
       "transform(matrix=[1,0,0,5,0,1,0,6,0,0,1,7,0,0,0,1])"},
      {R"~("filters.sample", "radius": 0.5)~", "poisson(radius=0.5)"},
      {R"~("filters.voxelcenternearestneighbor", "cell": 2)~", "voxel(size=2, keep=center)"},
      {R"~("filters.smrf", "cell": 2)~", "ground(cell=2, slope=0.15, window=18, threshold=0.5, scalar=1.25)"},
      {R"~("filters.hag_nn", "count": 3)~", "height(k=3)"},
      {R"~("filters.lof", "minpts": 20)~", "knn(k=20) | lof"},
      {R"~("filters.outlier", "method": "radius", "radius": 2, "min_k": 4, "class": 18)~",
       "knn(radius=2) | ror(radius=2, min_neighbors=4) | set(\"classification = 18 where outlier == 1\") | "
       "drop(outlier)"}};
  for (const auto& [pdal, text] : pairs) {
    const std::string json = std::string("[{\"type\": ") + pdal + "}]";
    EXPECT_EQ(parse_pipeline(json), parse_pipeline(text)) << in_our_words(json);
    EXPECT_NO_THROW(build_chain(parse_pipeline(json), Facts{})) << pdal;
  }
}

TEST(PdalStages, ThatWeLackAreNamed) {
  EXPECT_NE(refusal_of_pdal(R"~(["a.las", {"type": "filters.csf"}, "b.las"])~")
                .find("stage 2: filters.csf is a stage of PDAL without a counterpart here"),
            std::string::npos);
  EXPECT_NE(refusal_of_pdal(R"~([{"type": "filters.smrf", "ignore": "Classification[7:7]"}])~")
                .find("the option 'ignore' of filters.smrf is not known here"),
            std::string::npos);
  EXPECT_NE(
      refusal_of_pdal(R"~([{"type": "writers.las", "filename": "a.las", "scale_x": 0.01}, {"type": "filters.merge"}])~")
          .find("'scale_x' of writers.las is not known here; give the option of the command"),
      std::string::npos);
  EXPECT_NE(refusal_of_pdal(R"~([{"type": "filters.range", "limits": "Z 1 to 3"}])~").find("are not ranges such as"),
            std::string::npos);
  EXPECT_NE(refusal_of_pdal(R"~([{"type": "filters.crop", "bounds": "([0,1],[0,1],[0,1])"}])~").find("([xmin,xmax]"),
            std::string::npos);
  EXPECT_NE(refusal_of_pdal(R"~([{"type": "filters.range"}])~").find("filters.range needs its option 'limits'"),
            std::string::npos);
}

}  // namespace
}  // namespace pointsweep
