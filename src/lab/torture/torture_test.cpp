#include "torture/torture.h"

#include <gtest/gtest.h>

namespace culprit::torture {
namespace {

TEST(Torture, HundredsOfRobotsAreTreatedAsPromised) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    const Scenario scenario = draw(seed);
    if (run(scenario).violation) ADD_FAILURE() << report(shrink(scenario));
  }
}

TEST(Torture, WhatWasOnceFoundStaysMended) {
  for (const std::uint64_t seed : {485u, 1293u, 1982u, 4047u, 4284u, 5524u})
    EXPECT_FALSE(run(draw(seed)).violation) << report(shrink(draw(seed)));
}

TEST(Torture, TheSameSeedGivesTheSameRun) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    EXPECT_EQ(run(draw(seed)).timeline, run(draw(seed)).timeline) << seed;
}

TEST(Torture, MishapsLeaveTheirMark) {
  std::string all;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    for (const std::string& line : run(draw(seed)).timeline) all += line + "\n";
  }
  for (const char* part :
       {"is killed", "everything is killed", "is started again by its launcher", "was never seen",
        "the manager crashes", "comes and goes: detected", "culprit stood still", "resolved by",
        "did not resolve", "is held back", "is exhausted", "waits for approval",
        "the last resort is left", "is left where it is", "is silenced",
        "INTERLOCK moving == false is false", "was restarted a short while ago",
        "and no more are allowed"})
    EXPECT_NE(all.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace culprit::torture
