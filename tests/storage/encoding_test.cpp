// SPDX-License-Identifier: MIT
#include "pointsweep/storage/encoding.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/storage/written_bytes.h"

namespace pointsweep {
namespace {

constexpr Encoding kThing{"thing", 3};

TEST(Encoding, IsLittleEndianWithoutGaps) {
  Encoder out;
  out.begin(kThing);
  out.put<std::uint8_t>(7);
  out.put<std::uint16_t>(0x0102);
  out.put<std::int32_t>(-2);
  out.put<std::uint64_t>(0x0102030405060708);
  out.put<float>(1.5f);
  out.put<double>(-2);
  out.put_bool(true);
  out.put_text("a b");
  out.put_bytes({});
  out.put_point({1, 0, 2});
  out.put_numbers<std::uint32_t>(std::vector<std::uint32_t>{9, 10});
  EXPECT_EQ(hex(out.bytes()), hex(written("05 'thing' 0300"
                                          "07 0201 feffffff 0807060504030201 0000c03f 00000000000000c0 01"
                                          "0300000000000000 'a b' 0000000000000000"
                                          "000000000000f03f 0000000000000000 0000000000000040"
                                          "0200000000000000 09000000 0a000000")));
  Decoder in(out.bytes());
  in.begin(kThing);
  EXPECT_EQ(in.get<std::uint8_t>(), 7);
  EXPECT_EQ(in.get<std::uint16_t>(), 0x0102);
  EXPECT_EQ(in.get<std::int32_t>(), -2);
  EXPECT_EQ(in.get<std::uint64_t>(), 0x0102030405060708u);
  EXPECT_EQ(in.get<float>(), 1.5f);
  EXPECT_EQ(in.get<double>(), -2);
  EXPECT_TRUE(in.get_bool());
  EXPECT_EQ(in.get_text(), "a b");
  EXPECT_TRUE(in.get_bytes().empty());
  EXPECT_EQ(in.get_point(), (Vec3{1, 0, 2}));
  EXPECT_EQ(in.get_numbers<std::uint32_t>(), (std::vector<std::uint32_t>{9, 10}));
  in.finish();
}

TEST(Encoding, KeepsEveryBitOfANumber) {
  for (const double value : {-0.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::denorm_min(),
                             std::bit_cast<double>(std::uint64_t{0x7ff0000000000123})}) {
    Encoder out;
    out.put<double>(value);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(Decoder(out.bytes()).get<double>()), std::bit_cast<std::uint64_t>(value));
  }
}

std::string refusal_of(const std::string& bytes, const std::function<void(Decoder&)>& decode) {
  const std::vector<std::byte> all = written(bytes);
  Decoder in(all);
  try {
    in.begin(kThing);
    decode(in);
    in.finish();
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

TEST(Encoding, IsRefusedInOneSentence) {
  const auto nothing = [](Decoder&) {};
  const std::string cause = ": they are damaged, or another version of pointsweep has made them.";
  EXPECT_EQ(refusal_of("05 'thing' 0300", nothing), "none");
  EXPECT_EQ(refusal_of("05 'think' 0300", nothing),
            "The bytes of an encoded 'thing' hold 'think' of version 3 where 'thing' of version 3 is expected" + cause);
  EXPECT_EQ(refusal_of("05 'thing' 0400", nothing),
            "The bytes of an encoded 'thing' hold 'thing' of version 4 where 'thing' of version 3 is expected" + cause);
  EXPECT_EQ(refusal_of("05 'thing' 03", nothing), "The bytes of an encoded 'thing' end too early" + cause);
  EXPECT_EQ(refusal_of("05 'thing' 0300 00", nothing),
            "The bytes of an encoded 'thing' go on for 1 bytes after its end" + cause);
}

TEST(Encoding, OfAListThatCannotBeThereTakesNoMemory) {
  const std::string claim = "05 'thing' 0300 ffffffffffffff7f";
  EXPECT_NE(refusal_of(claim, [](Decoder& in) { in.get_numbers<double>(); }), "none");
  EXPECT_NE(refusal_of(claim, [](Decoder& in) { in.get_text(); }), "none");
  EXPECT_NE(refusal_of(claim, [](Decoder& in) { in.get_bytes(); }), "none");
}

}  // namespace
}  // namespace pointsweep
