#include "laboratory/study_runs.h"

#include "base/environment.h"
#include "shards/shard_of_environment.h"

namespace culprit::lab {

Expected<study::Shard> ShardOptions::which() const {
  return study::shard_of(shard, [](const char* name) { return environment(name); });
}

std::string ShardOptions::file_of(const study::Shard& its) const {
  std::string name = file;
  const auto place = name.find('%');
  if (place != std::string::npos) name.replace(place, 1, std::to_string(its.number));
  return name;
}

void ShardOptions::add_to(CLI::App& command) {
  command
      .add_option(
          "--shard", shard,
          "Only the i-th of n parts, as 2/4; auto, or auto/4: the one that Slurm, Kubernetes "
          "or GNU parallel says (examples/cluster)")
      ->capture_default_str();
  command
      .add_option(
          "--shard-file", file,
          "Keep finished runs in this file, and resume from it; % stands for the shard's number")
      ->type_name("FILE");
}

}  // namespace culprit::lab
