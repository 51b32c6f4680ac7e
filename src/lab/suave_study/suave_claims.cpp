#include "suave_study/suave_claims.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/core.h>

#include "base/invariant.h"
#include "study/tables/claims_tables.h"
#include "suave_study/published.h"

namespace culprit::study {
namespace {

constexpr double kMarginSd = 0.5;
constexpr double kShareMargin = 0.1;
constexpr double kReactionMargin = 0.5;  // of the printed mean

enum class Of : std::uint8_t {
  kSearch,
  kDistance,
  kEverySearch,  // no run is left out
  kEveryDistance,
  kVisibility,
  kThruster,
  kBattery
};

// One mission, ours and the paper's.
class Mission {
 public:
  explicit Mission(const SuaveResult& result) : result_(result) {}

  Group ours(const std::string& manager, Of what) const {
    const SuaveRow& row = this->row(manager);
    switch (what) {
      case Of::kSearch:
        return {manager, row.search_s};
      case Of::kDistance:
        return {manager, row.distance_m};
      case Of::kEverySearch:
        return {manager, row.searched_s};
      case Of::kEveryDistance:
        return {manager, row.last_distance_m};
      case Of::kVisibility:
        return {manager, row.visibility.answered_s};
      case Of::kThruster:
        return {manager, row.thruster.answered_s};
      case Of::kBattery:
        break;
    }
    return {manager, row.battery.answered_s};
  }
  // The printed search or distance.
  Group paper(const std::string& manager, Of what) const {
    const auto* row = published::find_suave(result_.campaign.plan->name, manager);
    CULPRIT_ASSERT(row != nullptr);
    return {"paper", what == Of::kSearch ? row->search_s : row->distance_m};
  }
  ClaimPart more(const std::string& larger, const std::string& smaller, Of what) const {
    return is_more(ours(larger, what), ours(smaller, what));
  }
  ClaimPart alike(const std::string& manager, Of what) const {
    return is_alike(ours(kCulprit, what), ours(manager, what), margin(manager, what));
  }
  // As printed.
  ClaimPart printed(const std::string& manager, Of what) const {
    return is_alike(ours(manager, what), paper(manager, what), margin(manager, what));
  }
  // The printed reaction times, which have no deviations.
  std::vector<ClaimPart> reactions(const std::string& manager) const {
    const auto* row = published::find_suave(result_.campaign.plan->name, manager);
    CULPRIT_ASSERT(row != nullptr);
    std::vector<ClaimPart> parts;
    const auto add = [&](Of what, std::optional<double> mean) {
      if (mean) parts.push_back(is_near(ours(manager, what), *mean, kReactionMargin * *mean));
    };
    add(Of::kVisibility, row->visibility_s);
    add(Of::kThruster, row->thruster_s);
    add(Of::kBattery, row->battery_s);
    return parts;
  }
  ClaimPart left_out(double share) const {
    const SuaveRow& own = row(kCulprit);
    const auto runs = static_cast<double>(own.runs);
    const double ours = static_cast<double>(own.outliers) / runs;
    return is_near({"left out", Moments::of_summary(ours, std::sqrt(ours * (1 - ours)), own.runs)},
                   share, kShareMargin);
  }

 private:
  const SuaveRow& row(const std::string& manager) const {
    const auto found = std::find_if(result_.rows.begin(), result_.rows.end(),
                                    [&](const SuaveRow& each) { return each.manager == manager; });
    CULPRIT_ASSERT(found != result_.rows.end());
    return *found;
  }
  double margin(const std::string& manager, Of what) const {
    return kMarginSd * paper(manager, what).values.sample_sd();
  }

  const SuaveResult& result_;
};

// culprit reacts later than `fastest`, and sooner than each of `slower`.
std::vector<ClaimPart> second_to(const Mission& mission, const std::string& fastest,
                                 const std::vector<std::string>& slower,
                                 const std::vector<Of>& reactions) {
  std::vector<ClaimPart> parts;
  for (const Of reaction : reactions) {
    parts.push_back(mission.more(kCulprit, fastest, reaction));
    for (const std::string& each : slower) parts.push_back(mission.more(each, kCulprit, reaction));
  }
  return parts;
}

// culprit searches shorter than each of `others`.
std::vector<ClaimPart> searches_shortest(const Mission& mission,
                                         const std::vector<std::string>& others, Of search) {
  std::vector<ClaimPart> parts;
  for (const std::string& each : others) parts.push_back(mission.more(each, kCulprit, search));
  return parts;
}

// culprit inspects less than BT, and more than the others.
std::vector<ClaimPart> inspects_second(const Mission& mission, Of distance) {
  std::vector<ClaimPart> parts = {mission.more("bt", kCulprit, distance)};
  for (const char* each : {"none", "metacontrol", "rosa"})
    parts.push_back(mission.more(kCulprit, each, distance));
  return parts;
}

// Rows beside the printed ones, in both columns.
std::vector<ClaimPart> as_printed(const Mission& mission,
                                  const std::vector<std::string>& managers) {
  std::vector<ClaimPart> parts;
  for (const std::string& manager : managers)
    for (const Of what : {Of::kSearch, Of::kDistance})
      parts.push_back(mission.printed(manager, what));
  return parts;
}

std::vector<ClaimPart> joined(const std::vector<std::vector<ClaimPart>>& all) {
  std::vector<ClaimPart> parts;
  for (const std::vector<ClaimPart>& each : all)
    parts.insert(parts.end(), each.begin(), each.end());
  return parts;
}

}  // namespace

std::vector<Claim> suave_claims(const SuaveResult& first, const SuaveResult& second) {
  using enum Of;
  const Mission standard(first);
  const Mission extended(second);
  std::vector<Claim> claims;
  const auto add = [&](std::string text, std::string test, std::vector<ClaimPart> parts) {
    claims.push_back({std::move(text), std::move(test), std::move(parts), 1, 1, Verdict::kOpen});
  };
  add("None, BT as printed", "TOST", as_printed(standard, {"none", "bt"}));
  add("Metacontrol, ROSA as printed", "TOST", as_printed(standard, {"metacontrol", "rosa"}));
  add("extended: BT, ROSA as printed", "TOST", as_printed(extended, {"bt", "rosa"}));
  add("Ours as printed", "TOST",
      joined({as_printed(standard, {kCulprit}), as_printed(extended, {kCulprit})}));
  add("reactions of BT, Metacontrol, ROSA", "TOST",
      joined({standard.reactions("bt"), standard.reactions("metacontrol"),
              standard.reactions("rosa"), extended.reactions("bt"), extended.reactions("rosa")}));
  add("reactions of Ours", "TOST",
      joined({standard.reactions(kCulprit), extended.reactions(kCulprit)}));
  add("9 and 7 of 100 own runs are outliers", "TOST",
      {standard.left_out(0.09), extended.left_out(0.07)});
  add("Ours: shortest search", "Welch",
      searches_shortest(standard, {"none", "bt", "metacontrol", "rosa"}, kSearch));
  add("no difference from BT, Metacontrol, ROSA", "TOST",
      {standard.alike("bt", kSearch), standard.alike("metacontrol", kSearch),
       standard.alike("rosa", kSearch), standard.alike("bt", kDistance),
       standard.alike("metacontrol", kDistance), standard.alike("rosa", kDistance)});
  add("inspects second to BT", "Welch", inspects_second(standard, kDistance));
  add("reacts second to BT", "Welch",
      second_to(standard, "bt", {"metacontrol", "rosa"}, {kVisibility, kThruster}));
  add("extended: searches shorter than BT, ROSA", "Welch",
      searches_shortest(extended, {"bt", "rosa"}, kSearch));
  add("extended: inspects more than ROSA", "Welch", {extended.more(kCulprit, "rosa", kDistance)});
  add("extended: inspects as much as BT", "TOST", {extended.alike("bt", kDistance)});
  add("extended: reacts second to BT", "Welch",
      second_to(extended, "bt", {"rosa"}, {kVisibility, kThruster, kBattery}));
  add("all runs: shortest search, both missions", "Welch",
      joined({searches_shortest(standard, {"none", "bt", "metacontrol", "rosa"}, kEverySearch),
              searches_shortest(extended, {"bt", "rosa"}, kEverySearch)}));
  add("all runs: inspects second to BT; extended: more than ROSA", "Welch",
      joined({inspects_second(standard, kEveryDistance),
              {extended.more(kCulprit, "rosa", kEveryDistance)}}));
  judge(claims);
  return claims;
}

Table suave_claims_table(const SuaveResult& standard, const SuaveResult& extended) {
  Table table{"suave-claims",
              "Claims of the paper on SUAVE",
              {{"", "claim", "", "", Align::kLeft}, {"", "test", "", "", Align::kLeft}},
              {},
              claim_notes()};
  for (Column& column : claim_columns("")) table.columns.push_back(std::move(column));
  for (const Claim& claim : suave_claims(standard, extended)) {
    std::vector<Cell> cells = {{claim.text}, {claim.test}};
    add_claim_cells(cells, claim);
    table.rows.push_back(std::move(cells));
  }
  table.notes.push_back(
      fmt::format("All runs: without the rule that leaves out long searches of Ours only. TOST: "
                  "alike within half the paper's sd, reactions within half its mean. {} runs of "
                  "each manager, seed {}.",
                  standard.campaign.runs, standard.campaign.seed));
  return table;
}

}  // namespace culprit::study
