#include "drill/priors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "journal/writer.h"

namespace culprit::drill {
namespace {

struct DrillPriors : testing::Test {
  void write(const std::filesystem::path& path, const journal::Learned& learned) const {
    auto writer = journal::Writer::open(path, {});
    ASSERT_TRUE(writer) << writer.error();
    ASSERT_TRUE(writer->append({{}, learned}, 1, journal::Durability::kPowerFailure));
  }
  journal::Learned learned_in(const std::filesystem::path& path) const {
    return *journal::Writer::open(path, {})->learned();
  }

  test::TestFolder folder;
  std::filesystem::path drilled = folder.path() / "drilled.journal";
  std::filesystem::path robot = folder.path() / "robot.journal";
};

TEST_F(DrillPriors, AreAddedToWhatTheRobotLearnedButSuccessRatesAreNot) {
  write(robot, {{}, {{"CameraDead", "FusionDead", {2, 1, 0.5}}}, {}});
  write(drilled,
        {{{"CameraDead", "redeploy", {3, 1}, {1, 1}}},
         {{"CameraDead", "FusionDead", {5, 0, 2}}, {"drill_abort_1", "FusionDead", {1, 0}}},
         {{"FusionDead", 4, 0.1, 0.3},
          journal::named("FusionDead", Transients::Seen{3, 1, std::chrono::seconds(5)})[0]}});
  const auto added = add_priors(drilled, robot, 2);
  ASSERT_TRUE(added) << added.error();
  EXPECT_EQ(added->couplings, 1u);
  EXPECT_EQ(added->latencies, 1u);
  const journal::Learned now = learned_in(robot);
  ASSERT_EQ(now.couplings.size(), 1u);
  EXPECT_EQ(now.couplings[0].coupling, (Coupling{7, 1, 2.5}));
  ASSERT_EQ(now.latencies.size(), 1u);
  EXPECT_EQ(now.latencies[0].rule, "FusionDead");
  EXPECT_TRUE(now.beliefs.empty());
}

TEST_F(DrillPriors, OfAJournalThatIsNotThereAreAnError) {
  EXPECT_FALSE(add_priors(drilled, robot, 2));
  EXPECT_FALSE(std::filesystem::exists(robot));
}

}  // namespace
}  // namespace culprit::drill
