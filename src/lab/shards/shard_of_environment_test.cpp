#include "shards/shard_of_environment.h"

#include <map>

#include <gtest/gtest.h>

namespace culprit::study {
namespace {

using Variables = std::map<std::string, std::string>;

Expected<Shard> shard_in(std::string_view text, const Variables& variables) {
  return shard_of(text, [&](const char* name) {
    const auto found = variables.find(name);
    return found == variables.end() ? "" : found->second;
  });
}

Variables slurm(const char* id, const char* least, const char* count, const char* step = "1") {
  return {{"SLURM_ARRAY_TASK_ID", id},
          {"SLURM_ARRAY_TASK_MIN", least},
          {"SLURM_ARRAY_TASK_COUNT", count},
          {"SLURM_ARRAY_TASK_STEP", step}};
}

TEST(ShardOfEnvironment, IsWhatIsSaidIfItIsSaid) {
  EXPECT_EQ(*shard_in("2/4", slurm("1", "1", "8")), (Shard{2, 4}));
}

TEST(ShardOfEnvironment, IsTheTaskOfASlurmArrayHoweverThatCounts) {
  EXPECT_EQ(*shard_in("auto", slurm("1", "1", "8")), (Shard{1, 8}));
  EXPECT_EQ(*shard_in("auto", slurm("7", "0", "8")), (Shard{8, 8}));
  EXPECT_EQ(*shard_in("auto", slurm("30", "10", "4", "10")), (Shard{3, 4}));
  EXPECT_FALSE(shard_in("auto", slurm("7", "1", "3"))) << "--array=1,3,7";
  EXPECT_FALSE(shard_in("auto", {{"SLURM_ARRAY_TASK_ID", "1"}}));
}

// sbatch --array=7 of a campaign of 8 is not all of it.
TEST(ShardOfEnvironment, OneTaskThatIsRunAgainIsNotTakenForAll) {
  const auto shard = shard_in("auto/8", slurm("7", "7", "1"));
  ASSERT_FALSE(shard);
  EXPECT_NE(shard.error().find("--shard 2/8"), std::string::npos) << shard.error();
}

TEST(ShardOfEnvironment, OfKubernetesAndGnuParallelNeedsTheCount) {
  EXPECT_EQ(*shard_in("auto/8", {{"JOB_COMPLETION_INDEX", "0"}}), (Shard{1, 8}));
  EXPECT_EQ(*shard_in("auto/8", {{"PARALLEL_SEQ", "8"}}), (Shard{8, 8}));
  EXPECT_FALSE(shard_in("auto", {{"JOB_COMPLETION_INDEX", "0"}}));
  EXPECT_FALSE(shard_in("auto/8", {{"JOB_COMPLETION_INDEX", "8"}}));
  EXPECT_FALSE(shard_in("auto/8", {{"PARALLEL_SEQ", "0"}}));
  EXPECT_FALSE(shard_in("auto/8", {{"PARALLEL_SEQ", "-1"}}));
}

TEST(ShardOfEnvironment, GuessesNothing) {
  EXPECT_FALSE(shard_in("auto", {}));
  EXPECT_FALSE(shard_in("auto/0", {{"PARALLEL_SEQ", "1"}}));
  EXPECT_FALSE(shard_in("auto8", {{"PARALLEL_SEQ", "1"}}));
  Variables both = slurm("1", "1", "8");
  both["PARALLEL_SEQ"] = "2";
  EXPECT_NE(shard_in("auto/8", both).error().find("SLURM_ARRAY_TASK_ID and PARALLEL_SEQ"),
            std::string::npos);
}

}  // namespace
}  // namespace culprit::study
