#include "language/place_index.h"

#include <string>

#include <gtest/gtest.h>

namespace culprit {
namespace {

struct Entry {
  std::string name;
};

TEST(PlaceIndex, FindsEachEntryByItsNameHoweverManyThereAre) {
  std::vector<Entry> table;
  PlaceIndex by_name;
  for (int i = 0; i < 1000; ++i) {
    by_name.add(name_hash(std::to_string(i)), table.size());
    table.push_back({std::to_string(i)});
  }
  for (std::uint32_t i = 0; i < 1000; ++i)
    EXPECT_EQ(place_of(std::to_string(i), table, by_name), i);
  EXPECT_FALSE(place_of("1000", table, by_name));
}

TEST(PlaceIndex, TellsEntriesOfOneHashApart) {
  PlaceIndex index;
  for (std::uint32_t place = 0; place < 20; ++place) index.add(7, place);
  for (std::uint32_t place = 0; place < 20; ++place)
    EXPECT_EQ(index.find(7, [&](std::uint32_t p) { return p == place; }), place);
  EXPECT_FALSE(index.find(7, [](std::uint32_t) { return false; }));
}

TEST(PlaceIndex, FindsNothingInNone) {
  EXPECT_FALSE(PlaceIndex().find(0, [](std::uint32_t) { return true; }));
}

}  // namespace
}  // namespace culprit
