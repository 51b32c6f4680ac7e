#include "suave_study/campaign.h"

#include <algorithm>

#include <fmt/core.h>

#include "study/ordered_work.h"

namespace culprit::study {
namespace {

// The paper's rule: one-sided, on the search time.
bool is_outlier(const SuaveRun& run, const Moments& search) {
  return run.search_s > search.mean() + 2 * search.sample_sd();
}

void add(const suave::model::Reactions& of_run, SuaveReactions& all) {
  for (const double answered : of_run.answered_s) all.answered_s.add(answered);
  all.unanswered += static_cast<std::int64_t>(of_run.unanswered_s.size());
}

SuaveRow fold(const std::string& manager, const suave::model::MissionPlan& plan,
              const std::vector<SuaveRun>& runs) {
  SuaveRow row;
  row.manager = manager;
  Moments search;
  for (const SuaveRun& run : runs) search.add(run.search_s);
  const bool has_outliers = manager == kCulprit;
  for (const SuaveRun& run : runs) {
    ++row.runs;
    row.found += run.is_found ? 1 : 0;
    row.successes += run.is_success ? 1 : 0;
    row.searched_s.add(run.found_s);
    row.last_distance_m.add(run.distance_m);
    row.whole_distance_m.add(run.whole_distance_m);
    add(run.visibility, row.visibility);
    add(run.thruster, row.thruster);
    if (plan.needs_battery) add(run.battery, row.battery);
    if (has_outliers && is_outlier(run, search)) {
      ++row.outliers;
      continue;
    }
    row.search_s.add(run.search_s);
    row.distance_m.add(run.distance_m);
  }
  return row;
}

SuaveRun play(const SuaveCampaign& campaign, RunId id, SuaveTelling* telling) {
  const std::uint64_t seed = simulation::mix(campaign.seed) + id.run;
  const suave::model::MissionPlan plan =
      campaign.settings ? drawn(*campaign.plan, *campaign.settings, seed, id.run) : *campaign.plan;
  return play_suave(campaign.managers[id.row], *campaign.generation, plan, campaign.vehicle, seed,
                    telling);
}

std::string describe(const simulation::Fault& fault) {
  if (std::holds_alternative<simulation::Killed>(fault.what)) return fault.node + " is killed";
  if (std::holds_alternative<simulation::Hung>(fault.what)) return fault.node + " hangs";
  return fault.node + " has a fault";
}

}  // namespace

Expected<void> check_managers(const std::vector<std::string>& managers) {
  if (managers.empty()) return Error{"there is no manager"};
  std::string known;
  std::vector<std::string> left;
  for (const SuaveContender& each : suave_contenders()) {
    known += (known.empty() ? "" : ", ") + each.name;
    left.push_back(each.name);
  }
  for (const std::string& manager : managers) {
    if (std::erase(left, manager) == 1) continue;
    if (std::count(managers.begin(), managers.end(), manager) > 1)
      return Error{"manager '" + manager + "' is there twice"};
    return Error{"there is no manager '" + manager + "'; there are " + known};
  }
  return {};
}

SuaveFold::SuaveFold(SuaveCampaign campaign) { result_.campaign = std::move(campaign); }

void SuaveFold::add(SuaveRun run) {
  const SuaveCampaign& campaign = result_.campaign;
  runs_.push_back(std::move(run));
  const RunId id = campaign[next_++];
  if (runs_.size() < campaign.runs) return;
  result_.rows.push_back(fold(campaign.managers[id.row], *campaign.plan, runs_));
  runs_.clear();
}

SuaveRun play(const SuaveCampaign& campaign, RunId id) { return play(campaign, id, nullptr); }

SuaveResult run_campaign(const SuaveCampaign& campaign, unsigned jobs) {
  SuaveFold fold(campaign);
  work_in_order(
      0, campaign.size(), jobs, [&](std::uint64_t i) { return play(campaign, campaign[i]); },
      [&](std::uint64_t, SuaveRun run) {
        fold.add(std::move(run));
        return true;
      });
  return std::move(fold).result();
}

std::vector<Track> first_tracks(const SuaveCampaign& campaign) {
  std::vector<Track> tracks;
  for (std::uint32_t row = 0; row < campaign.managers.size(); ++row) {
    SuaveTelling telling;
    (void)play(campaign, RunId{row, 0}, &telling);
    tracks.push_back(std::move(telling.track));
  }
  return tracks;
}

SingleRun single_run(const SuaveCampaign& campaign, RunId id) {
  SuaveTelling telling;
  (void)play(campaign, id, &telling);
  const double begin_s = seconds(telling.begin.time_since_epoch());
  SingleRun run;
  run.scenario =
      fmt::format("the {} mission, which begins at {:.1f} s", campaign.plan->name, begin_s);
  run.is_told = has_rules(campaign.managers[id.row]);
  run.rules = rules_for(*campaign.plan);
  for (const simulation::Fault& fault : campaign.plan->faults)
    run.incidents.push_back(
        {begin_s + seconds(fault.at.time_since_epoch()), Happening::kFault, "", describe(fault)});
  for (const TrackMark& mark : telling.track.marks)
    run.incidents.push_back({begin_s + mark.time_s, mark.kind, "", mark.what});
  std::stable_sort(
      run.incidents.begin(), run.incidents.end(),
      [](const TimelineEntry& a, const TimelineEntry& b) { return a.time_s < b.time_s; });
  run.events = std::move(telling.events);
  run.end_s = seconds(telling.end.time_since_epoch());
  return run;
}

}  // namespace culprit::study
