#include "rtps/cdr.h"

#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::rtps {
namespace {

// One field of every kind that messages are made of.
struct Inner {
  std::uint8_t small = 0;
  std::string text;
  static void visit(auto& self, auto& each) { each(self.small, self.text); }
  bool operator==(const Inner&) const = default;
};

struct Everything {
  bool flag = false;
  std::int8_t i8 = 0;
  std::uint16_t u16 = 0;
  std::int32_t i32 = 0;
  std::uint64_t u64 = 0;
  float f32 = 0;
  double f64 = 0;
  std::string text;
  std::array<std::int16_t, 3> fixed{};
  std::vector<std::uint8_t> bytes;
  std::vector<bool> flags;
  std::vector<double> numbers;
  std::vector<std::string> texts;
  std::vector<Inner> inners;
  static void visit(auto& self, auto& each) {
    each(self.flag, self.i8, self.u16, self.i32, self.u64, self.f32, self.f64, self.text,
         self.fixed, self.bytes, self.flags, self.numbers, self.texts, self.inners);
  }
  bool operator==(const Everything&) const = default;
};

struct Empty {};

struct HoldsEmpty {
  Empty nothing;
  std::uint8_t after = 0;
  static void visit(auto& self, auto& each) { each(self.nothing, self.after); }
};

// rapidcheck's own strings have no NUL in the middle, and its doubles no NaN; neither would compare
// equal anyway.
rc::Gen<Inner> any_inner() {
  return rc::gen::build<Inner>(rc::gen::set(&Inner::small),
                               rc::gen::set(&Inner::text, rc::gen::string<std::string>()));
}

rc::Gen<Everything> anything() {
  return rc::gen::build<Everything>(
      rc::gen::set(&Everything::flag), rc::gen::set(&Everything::i8),
      rc::gen::set(&Everything::u16), rc::gen::set(&Everything::i32),
      rc::gen::set(&Everything::u64), rc::gen::set(&Everything::f32),
      rc::gen::set(&Everything::f64),
      rc::gen::set(&Everything::text, rc::gen::string<std::string>()),
      rc::gen::set(&Everything::fixed), rc::gen::set(&Everything::bytes),
      rc::gen::set(&Everything::flags), rc::gen::set(&Everything::numbers),
      rc::gen::set(&Everything::texts),
      rc::gen::set(&Everything::inners, rc::gen::container<std::vector<Inner>>(any_inner())));
}

TEST(Cdr, AlignsEachFieldToItsSizeCountedFromTheBody) {
  CdrWriter writer;
  writer(std::uint8_t{1}, std::uint16_t{2}, std::uint8_t{3}, std::uint32_t{4}, std::uint8_t{5},
         std::uint64_t{6});
  EXPECT_EQ(writer.take(), (Bytes{0, 1, 0, 0,                 //
                                  1, 0, 2, 0,                 // u8, padding, u16
                                  3, 0, 0, 0, 4, 0, 0, 0,     // u8, padding, u32
                                  5, 0, 0, 0,                 // u8, padding to offset 16
                                  6, 0, 0, 0, 0, 0, 0, 0}));  // u64
}

TEST(Cdr, WritesStringsWithTheirLengthAndNul) {
  CdrWriter writer;
  writer.write_string("ab");
  EXPECT_EQ(writer.take(), (Bytes{0, 1, 0, 0, 3, 0, 0, 0, 'a', 'b', 0}));
}

TEST(Cdr, WritesBigEndianWhenAsked) {
  EXPECT_EQ(encode(Inner{7, "x"}, Endianness::kBig),
            (Bytes{0, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0, 2, 'x', 0}));
}

TEST(Cdr, WritesADummyByteForAnEmptyMessage) { EXPECT_EQ(encode(Empty{}), (Bytes{0, 1, 0, 0, 0})); }

TEST(Cdr, ReadsAnEmptyMessageWithoutItsDummyByte) { EXPECT_TRUE(decode<Empty>(Bytes{0, 1, 0, 0})); }

TEST(Cdr, ReadsWhatFollowsAnEmptyStruct) {
  const auto read = decode<HoldsEmpty>(Bytes{0, 1, 0, 0, 0, 9});
  ASSERT_TRUE(read);
  EXPECT_EQ(read->after, 9);
}

TEST(Cdr, AnEmptySequenceDoesNotAlignForItsElements) {
  CdrWriter writer;
  writer(std::vector<double>{}, std::uint8_t{9});
  EXPECT_EQ(writer.take(), (Bytes{0, 1, 0, 0, 0, 0, 0, 0, 9}));

  std::vector<double> numbers;
  std::uint8_t after = 0;
  const Bytes payload{0, 1, 0, 0, 0, 0, 0, 0, 9};
  CdrReader reader(payload);
  reader(numbers, after);
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(after, 9);
}

TEST(Cdr, IgnoresWhatFollowsTheLastField) {
  const auto read = decode<Inner>(Bytes{0, 1, 0, 0, 7, 0, 0, 0, 2, 0, 0, 0, 'x', 0, 0xff, 0xff});
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, (Inner{7, "x"}));
}

TEST(Cdr, ReadsAStringWithoutNulOrLength) {
  EXPECT_EQ(decode<Inner>(Bytes{0, 1, 0, 0, 7, 0, 0, 0, 1, 0, 0, 0, 'x'})->text, "x");
  EXPECT_EQ(decode<Inner>(Bytes{0, 1, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0})->text, "");
}

TEST(Cdr, RefusesOtherEncapsulations) {
  for (const std::uint8_t kind : {2, 3, 4, 0x0c, 0x16, 0xff})
    EXPECT_FALSE(decode<Empty>(Bytes{0, kind, 0, 0, 0})) << int{kind};
  EXPECT_FALSE(decode<Empty>(Bytes{1, 1, 0, 0, 0}));
  EXPECT_FALSE(decode<Empty>(Bytes{0, 1, 0}));
  EXPECT_FALSE(decode<Empty>(Bytes{}));
}

TEST(Cdr, FailsForGoodAndReadsZeros) {
  const Bytes payload{0, 1, 0, 0, 1};
  CdrReader reader(payload);
  EXPECT_EQ(reader.read<std::uint32_t>(), 0u);
  EXPECT_FALSE(reader.ok());
  EXPECT_EQ(reader.read<std::uint8_t>(), 0u);
  EXPECT_EQ(reader.read_string(), "");
  EXPECT_EQ(reader.left(), 0u);
}

TEST(Cdr, DoesNotAllocateForAFalseCount) {
  // Four billion doubles, strings, structs: none of them there.
  const Bytes payload{0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff};
  EXPECT_FALSE(decode<std::vector<double>>(payload));
  EXPECT_FALSE(decode<std::vector<std::string>>(payload));
  EXPECT_FALSE(decode<std::vector<Inner>>(payload));
  EXPECT_FALSE(decode<std::string>(payload));
}

TEST(Cdr, ReadsAnyNonZeroByteAsTrue) {
  const Bytes payload{0, 1, 0, 0, 0x80};
  EXPECT_TRUE(CdrReader(payload).read<bool>());
}

TEST(CdrDeathTest, EveryElementTakesBytes) {
  const Bytes payload(100, 1);
  CdrReader reader(payload);
  EXPECT_DEATH(reader.read_count(0), "'smallest_element > 0' does not hold");
}

TEST(Cdr, SkipsWithoutOverflow) {
  const Bytes payload(100, 1);
  CdrReader reader(payload);
  reader.skip(8, std::numeric_limits<std::uint64_t>::max());
  EXPECT_FALSE(reader.ok());
}

RC_GTEST_PROP(Cdr, DecodesWhatItEncodesInBothEndiannesses, ()) {
  const auto message = *anything();
  RC_ASSERT(decode<Everything>(encode(message, Endianness::kLittle)) == message);
  RC_ASSERT(decode<Everything>(encode(message, Endianness::kBig)) == message);
}

RC_GTEST_PROP(Cdr, AnyBytesAreReadOrRefused, (Bytes bytes)) {
  // Some of them at least should get past the encapsulation.
  if (bytes.size() >= 2) bytes[0] = 0, bytes[1] &= 1;
  decode<Everything>(bytes);
}

RC_GTEST_PROP(Cdr, EveryCutPayloadIsRefused, ()) {
  const Bytes whole = encode(*anything());
  const auto size = *rc::gen::inRange<std::size_t>(0, whole.size());
  RC_ASSERT(!decode<Everything>(ByteView(whole).first(size)));
}

}  // namespace
}  // namespace culprit::rtps
