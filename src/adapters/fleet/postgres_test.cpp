#include "fleet/postgres.h"

#include <gtest/gtest.h>

namespace culprit::fleet {
namespace {

TEST(FleetAddress, IsALibpqAddressWithoutAPassword) {
  for (const char* good :
       {"postgresql://fleet.example.org/robots?sslmode=verify-full", "service=fleet",
        "postgresql://rover@db/robots?passfile=/etc/culprit/pgpass", "host=db user=rover"})
    EXPECT_TRUE(address_from(good)) << good;
}

// Nor does the error repeat it: printed text ends up in logs.
TEST(FleetAddress, WithAPasswordIsRefusedWithTheRemedy) {
  for (const char* bad :
       {"postgresql://rover:hunter2@db/robots", "postgresql://db/robots?password=hunter2",
        "host=db password=hunter2", "host=db sslpassword=hunter2"}) {
    const auto address = address_from(bad);
    ASSERT_FALSE(address) << bad;
    EXPECT_NE(address.error().find("pgpass"), std::string::npos);
    EXPECT_EQ(address.error().find("hunter2"), std::string::npos);
  }
}

TEST(FleetAddress, WhatIsNoneIsNotRepeated) {
  for (const char* bad : {"", "postgresql://rover:hunter2@[db", "hunter2",
                          "postgresql://db:hunter2x/", "nonsense=hunter2"}) {
    const auto address = address_from(bad);
    if (address) continue;  // libpq takes an empty one: all of it is in the environment
    EXPECT_EQ(address.error().find("hunter2"), std::string::npos) << address.error();
  }
}

TEST(FleetServer, ThatIsNotThereIsAnErrorInOneLine) {
  const std::atomic<bool> stop = false;
  const auto server = Postgres::connect({"postgresql:///x?host=/nowhere/at/all"}, stop);
  ASSERT_FALSE(server);
  EXPECT_EQ(server.error().find('\n'), std::string::npos);
  EXPECT_NE(server.error().find("/nowhere/at/all"), std::string::npos) << server.error();
}

}  // namespace
}  // namespace culprit::fleet
