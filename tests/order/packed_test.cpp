// SPDX-License-Identifier: MIT
#include "pointsweep/order/packed.h"

#include <gtest/gtest.h>

namespace pointsweep {
namespace {

TEST(Packed, GivesBackWhatWasPutInItsOrder) {
  Packer out;
  out.put(std::uint32_t{7});
  out.put(std::vector<double>{1.5, -2});
  out.put_text("a b");
  out.put(std::vector<std::byte>());
  out.put(true);
  Unpacker in(out.bytes());
  EXPECT_EQ(in.get<std::uint32_t>(), 7u);
  EXPECT_EQ(in.get_vector<double>(), (std::vector<double>{1.5, -2}));
  EXPECT_EQ(in.get_text(), "a b");
  EXPECT_TRUE(in.get_vector<std::byte>().empty());
  EXPECT_TRUE(in.get<bool>());
  EXPECT_TRUE(in.at_end());
}

TEST(Packed, ThatEndsTooEarlyIsAnErrorWhateverItClaims) {
  Packer out;
  out.put(~std::uint64_t{0});
  EXPECT_THROW(Unpacker(out.bytes()).get_vector<double>(), Error);
  EXPECT_THROW(Unpacker(out.bytes()).get_text(), Error);
  EXPECT_THROW(Unpacker(std::span(out.bytes()).first(7)).get<std::uint64_t>(), Error);
}

}  // namespace
}  // namespace pointsweep
