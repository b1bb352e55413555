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
  for (const char* option : {"--size 64x64 --view top", "--size 64x64 --up y", "--size 64x64 --color x",
                             "--size 64x64 --background black", "--size 65x64"}) {
    EXPECT_NE(made("render a.xyz b.png -f " + std::string(option), "b.png"), plain) << option;
  }
  EXPECT_EQ(made("render a.xyz b.png -f --size 64x64 --view 0,0 --up z --color height --background ffffff", "b.png"),
            plain);
}

TEST_F(Render, SaysWhatTheColorsMean) {
  const Result result = tool("render a.xyz a.png --size 64x64 --color x");
  EXPECT_NE(result.err.find("5 points, coloured by x, violet 0 to yellow 1"), std::string::npos) << result.err;
}

TEST_F(Render, RefusesInOneSentence) {
  refused(2, "render a.xyz a.ply", "pictures are PNG");
  refused(2, "render a.xyz", "name at least one file to read");
  refused(2, "render a.xyz a.png --size 64", "WIDTHxHEIGHT");
  refused(2, "render a.xyz a.png --size 64x0", "no size of a picture");
  refused(2, "render a.xyz a.png --background pink", "RRGGBB");
  refused(2, "render a.xyz a.png --up w", "not x, y or z");
  refused(2, "render a.xyz a.png --view back", "AZIMUTH,ELEVATION");
  refused(2, "render a.xyz a.png --color age", "nothing called 'age'");
  EXPECT_FALSE(exists("a.png"));
  write("a.png", "");
  refused(1, "render a.xyz a.png", "a.png");
}

}  // namespace
}  // namespace pointsweep
