// SPDX-License-Identifier: MIT
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class Render : public Tool {
 protected:
  Render() { write("a.xyz", "0 0 0\n1 0 0\n0 2 0\n0 0 3\n1 1 1\n"); }
};

TEST_F(Render, WritesAPngOfTheSizeAskedFor) {
  const std::string png = made("render a.xyz a.png --size 64x48 --view iso", "a.png");
  ASSERT_GE(png.size(), 24u);
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\0\x40\0\0\0\x30", 8));
}

TEST_F(Render, EveryOptionChangesThePicture) {
  const std::string plain = made("render a.xyz a.png --size 64x64", "a.png");
  for (const char* option :
       {"--size 64x64 --view top", "--size 64x64 --up -z", "--size 64x64 --up y", "--size 64x64 --color x",
        "--size 64x64 --background black", "--size 65x64", "--size 64x64 --point-size 9"}) {
    EXPECT_NE(made("render a.xyz b.png -f " + std::string(option), "b.png"), plain) << option;
  }
  EXPECT_EQ(made("render a.xyz b.png -f --size 64x64 --view 30,25 --up z --color height --background ffffff", "b.png"),
            plain);
}

TEST_F(Render, SaysWhatTheColorsMean) {
  const Result result = tool("render a.xyz a.png --size 64x64 --color x");
  EXPECT_NE(result.err.find("5 points from azimuth 30, elevation 25 with z up, coloured by x, violet 0 to yellow 1"),
            std::string::npos)
      << result.err;
}

TEST_F(Render, ColorsAreNamedInAnySpelling) {
  made("generate terrain t.las -n 500");
  made("ground t.las g.las");
  for (const char* word : {"classification", "Classification", "Height", "RGB"}) {
    const bool is_there = std::string_view(word) != "RGB";
    EXPECT_EQ(tool(std::string("render g.las p.png --force --color ") + word).status, is_there ? 0 : 2) << word;
  }
  EXPECT_EQ(made("render g.las a.png --color Classification", "a.png"),
            made("render g.las b.png --color classification", "b.png"));
}

TEST_F(Render, WritesALegendUnlessToldNotTo) {
  const std::string with = made("render a.xyz a.png --size 640x480 --color x", "a.png");
  EXPECT_NE(made("render a.xyz b.png --size 640x480 --color x --no-legend", "b.png"), with);
}

TEST_F(Render, ColorsThatAreAllTheSameAreReplacedAndItSaysSo) {
  write("b.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
        "red\nproperty uchar green\nproperty uchar blue\nend_header\n0 0 0 0 0 0\n1 0 0 0 0 0\n1 1 1 0 0 0\n");
  const Result result = tool("render b.ply b.png --size 64x64");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("all points have the same colour (0, 0, 0)"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("coloured by height"), std::string::npos) << result.err;
}

TEST_F(Render, AnAirborneScanIsSeenFromAbove) {
  ASSERT_EQ(tool("generate terrain t.ply -n 5000").status, 0);
  const Result result = tool("render t.ply t.png --size 64x64");
  EXPECT_NE(result.err.find("azimuth 0, elevation 90 with z up"), std::string::npos) << result.err;
}

TEST_F(Render, RefusesInOneSentence) {
  refused(2, "render a.xyz a.ply", "pictures are PNG");
  refused(2, "render a.xyz", "name at least one input file");
  refused(2, "render a.xyz a.png --size 64", "WIDTHxHEIGHT");
  refused(2, "render a.xyz a.png --size 64x0", "no size of a picture");
  refused(2, "render a.xyz a.png --background pink", "RRGGBB");
  refused(2, "render a.xyz a.png --up w", "not auto, x, y, z, -x, -y or -z");
  refused(2, "render a.xyz a.png --view back", "AZIMUTH,ELEVATION");
  refused(2, "render a.xyz a.png --color age", "nothing called 'age'");
  EXPECT_FALSE(exists("a.png"));
  write("a.png", "");
  refused(1, "render a.xyz a.png", "a.png");
}

}  // namespace
}  // namespace pointsweep
