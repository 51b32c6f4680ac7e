#include "journal/order_reserve.h"

#include <fstream>

#include <gtest/gtest.h>

#include "base/test_folder.h"

namespace culprit::journal {
namespace {

namespace fs = std::filesystem;

struct OrderReserve : testing::Test {
  // Bytes of the record `which`, from `at` on.
  void damage(int which, int at) const {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(which * (16 << 10) + at);
    file << "\xff";
  }

  const test::TestFolder folder;
  const fs::path path = reserve_beside(folder / "a.journal-orders");
};

TEST_F(OrderReserve, IsWrittenOnlyWhereItsRoomWasTaken) {
  EXPECT_EQ(path.filename(), "a.journal-orders-reserve");
  EXPECT_FALSE(write_reserve(path, "paused"));
  EXPECT_EQ(read_reserve(path), std::nullopt);
  ASSERT_TRUE(make_reserve(path));
  EXPECT_EQ(fs::file_size(path), 32u << 10);
  EXPECT_EQ(read_reserve(path), std::nullopt);
  ASSERT_TRUE(write_reserve(path, "paused"));
  ASSERT_TRUE(make_reserve(path)) << "what it holds stays";
  EXPECT_EQ(read_reserve(path), "paused");
  ASSERT_TRUE(clear_reserve(path));
  EXPECT_EQ(read_reserve(path), std::nullopt);
}

TEST_F(OrderReserve, HoldsTheLastRecordThatIsWhole) {
  ASSERT_TRUE(make_reserve(path));
  for (int i = 0; i < 12; ++i) {
    ASSERT_TRUE(write_reserve(path, std::to_string(i)));
    EXPECT_EQ(read_reserve(path), std::to_string(i));
  }
  EXPECT_EQ(fs::file_size(path), 32u << 10);
  // As a power failure leaves it that came while the last one was written.
  damage(1, 100);
  damage(1, 40);
  EXPECT_EQ(read_reserve(path), "10");
  ASSERT_TRUE(write_reserve(path, "12"));
  EXPECT_EQ(read_reserve(path), "12");
  damage(0, 40);
  EXPECT_EQ(read_reserve(path), "12");
}

TEST_F(OrderReserve, TakesNoMoreThanItsRoom) {
  ASSERT_TRUE(make_reserve(path));
  ASSERT_TRUE(write_reserve(path, "paused"));
  EXPECT_FALSE(write_reserve(path, std::string(16 << 10, 'x')));
  EXPECT_EQ(read_reserve(path), "paused");
}

TEST_F(OrderReserve, IsNoLinkAndNoDevice) {
  fs::create_symlink("/dev/zero", path);
  EXPECT_FALSE(make_reserve(path));
  EXPECT_EQ(read_reserve(path), std::nullopt);
}

}  // namespace
}  // namespace culprit::journal
