#include "shards/shard_of_environment.h"

#include <charconv>
#include <optional>
#include <vector>

namespace culprit::study {
namespace {

std::optional<std::uint32_t> natural_in(std::string_view text) {
  std::uint32_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (text.empty() || error != std::errc() || stop != end) return std::nullopt;
  return value;
}

struct Scheduler {
  const char* variable;  // that says which one this is
  std::uint32_t first;   // of the first one
};
constexpr const char* kSlurm = "SLURM_ARRAY_TASK_ID";
constexpr Scheduler kSchedulers[] = {{kSlurm, 0}, {"JOB_COMPLETION_INDEX", 0}, {"PARALLEL_SEQ", 1}};

struct Place {
  const char* variable = nullptr;
  std::uint64_t number = 0;  // from 1 on
  std::uint32_t count = 0;   // 0: it is not said
};

// An array may begin anywhere, and leave numbers out: --array=10-40:10
Expected<Place> of_slurm(std::uint32_t id, const Variable& variable) {
  const auto least = natural_in(variable("SLURM_ARRAY_TASK_MIN"));
  const auto count = natural_in(variable("SLURM_ARRAY_TASK_COUNT"));
  const std::uint32_t step = natural_in(variable("SLURM_ARRAY_TASK_STEP")).value_or(1);
  if (!least || !count || step == 0 || id < *least || (id - *least) % step != 0)
    return Error{"the tasks of this Slurm array have no even numbering; use --array=1-N"};
  return Place{kSlurm, std::uint64_t{(id - *least) / step} + 1, *count};
}

Expected<Place> place_in(const Variable& variable) {
  std::vector<Scheduler> set;
  std::string names;
  for (const Scheduler& each : kSchedulers) {
    if (variable(each.variable).empty()) continue;
    set.push_back(each);
    names += (names.empty() ? "" : " and ") + std::string(each.variable);
  }
  if (set.empty())
    return Error{
        "no scheduler says which shard this is (Slurm: SLURM_ARRAY_TASK_ID, Kubernetes: "
        "JOB_COMPLETION_INDEX, GNU parallel: PARALLEL_SEQ); say it, as in --shard 2/4"};
  if (set.size() > 1)
    return Error{names + " are both set, and either may be meant; say which shard this is, as in " +
                 "--shard 2/4"};
  const auto id = natural_in(variable(set[0].variable));
  if (!id || *id < set[0].first)
    return Error{std::string(set[0].variable) + " is '" + variable(set[0].variable) +
                 "', which is no number of a task"};
  if (set[0].variable == kSlurm) return of_slurm(*id, variable);
  return Place{set[0].variable, std::uint64_t{*id} + 1 - set[0].first, 0};
}

}  // namespace

Expected<Shard> shard_of(std::string_view text, const Variable& variable) {
  constexpr std::string_view kAuto = "auto";
  if (!text.starts_with(kAuto)) return parse_shard(text);
  text.remove_prefix(kAuto.size());
  std::uint32_t said = 0;
  if (!text.empty()) {
    const auto count = text.front() == '/' ? natural_in(text.substr(1)) : std::nullopt;
    if (!count || *count == 0 || *count > kMostShards)
      return Error{"'auto" + std::string(text) + "' is no shard; write auto, or auto/N"};
    said = *count;
  }
  const auto place = place_in(variable);
  if (!place) return Error{place.error()};
  if (said == 0 && place->count == 0)
    return Error{std::string(place->variable) +
                 " does not say how many shards there are; say it, as in --shard auto/8"};
  // A part of an array that is run again says less: then the count has to be said.
  if (said != 0 && place->count != 0 && place->count != said)
    return Error{"the Slurm array has " + std::to_string(place->count) +
                 " tasks, and --shard says " + std::to_string(said) +
                 "; to run one again, say which, as in --shard 2/" + std::to_string(said)};
  const std::uint32_t count = said != 0 ? said : place->count;
  if (place->number > count)
    return Error{std::string(place->variable) + " is '" + variable(place->variable) +
                 "', beyond the " + std::to_string(count) + " shards"};
  return Shard{static_cast<std::uint32_t>(place->number), count};
}

}  // namespace culprit::study
