#include "laboratory/study_runs.h"

namespace culprit::lab {

void ShardOptions::add_to(CLI::App& command) {
  command.add_option("--shard", shard, "Only the i-th of n parts, as 2/4")->capture_default_str();
  command.add_option("--shard-file", file,
                     "Keep each run there as it ends, and go on from there if interrupted");
}

}  // namespace culprit::lab
