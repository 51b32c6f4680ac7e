#include "study/tables/claims_tables.h"

#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "study/paper_claims.h"
#include "study/tables/columns.h"

namespace culprit::study {
namespace {

// Claims that no run of ours can test, and the reason.
struct Untested {
  const char* claim;
  const char* reason;
};
constexpr std::array kUntested = {
    Untested{"the graph has almost no overhead", "docs/performance.md"},
    Untested{"180 faults cause 257 failures", "162 runs of three faults have more"},
    Untested{"without S a redeployment comes first", "follows from the cost"},
    Untested{"100 % is never learned", "follows from the update"},
    Untested{"learning pays in long deployments", "not measured there"},
};

// The planner, and its profile if not all have the same.
std::string group_of(const Ablation& ablation, const std::vector<Ablation>& all) {
  const bool is_one_profile = std::all_of(all.begin(), all.end(), [&](const Ablation& each) {
    return each.profile == ablation.profile;
  });
  return is_one_profile ? ablation.planner : played(ablation.planner, ablation.profile);
}

}  // namespace

void add_claim_cells(std::vector<Cell>& cells, const Claim& claim) {
  const bool is_against = claim.verdict == Verdict::kContradicted;
  const std::string parts =
      claim.parts.size() == 1 ? "" : fmt::format("{}/{}: ", claim.supported(), claim.parts.size());
  cells.push_back({parts + claim.decisive().shown});
  cells.push_back({p_value(is_against ? claim.p_against : claim.p)});
  cells.push_back({std::string(to_string(claim.verdict))});
}

std::vector<Column> claim_columns(const std::string& group) {
  return {{group, "ours", "", "", Align::kLeft},
          {group, "p"},
          {group, "verdict", "", "", Align::kLeft}};
}

std::vector<std::string> claim_notes() {
  return {
      "k/n: significant parts; then the weakest, or the strongest against the claim. g: Hedges' "
      "effect size.",
      "p: Holm over its column, against the claim if contradicted. Open: neither below 5 %."};
}

Table claims_table(const Findings& findings, const std::vector<Ablation>& ablations) {
  Table table{"claims",
              "Claims of the paper on SUNSET",
              {{"", "claim", "", "", Align::kLeft}, {"", "test", "", "", Align::kLeft}},
              {},
              claim_notes()};
  for (const Ablation& ablation : ablations) {
    for (Column& column : claim_columns(group_of(ablation, ablations)))
      table.columns.push_back(std::move(column));
    const std::vector<Claim> claims = paper_claims(findings, ablation);
    for (const Claim& claim : claims) {
      auto row = std::find_if(table.rows.begin(), table.rows.end(),
                              [&](const auto& cells) { return cells.front().text == claim.text; });
      if (row == table.rows.end()) {
        std::vector<Cell> cells = {{claim.text}, {claim.test}};
        cells.resize(table.columns.size() - 3, {"–"});
        row = table.rows.insert(table.rows.end(), std::move(cells));
      }
      add_claim_cells(*row, claim);
    }
    for (auto& cells : table.rows) cells.resize(table.columns.size(), {"–"});
  }
  for (const Untested& untested : kUntested) {
    auto& cells = table.rows.emplace_back();
    cells = {Cell{untested.claim}, Cell{"–"}};
    for (std::size_t i = 0; i < ablations.size(); ++i)
      cells.insert(cells.end(), {Cell{untested.reason}, Cell{"–"}, Cell{"not tested"}});
  }
  table.notes.push_back(
      "TOST: alike within half the paper's sd. Reaction times of one run count for less: they are "
      "not independent.");
  return table;
}

Table order_table(const std::vector<Ablation>& ablations) {
  Table table{"order",
              "Order of the eight configurations beside the paper's",
              {{"", "metric", "", "", Align::kLeft}, {"", "pairs that differ in the paper"}},
              {},
              {"Pairs of the 28 that differ significantly in the paper (Tukey's HSD on its "
               "summaries), and how many of them ours order the same way. Spearman's rho over all "
               "eight, with its exact p."}};
  for (const Ablation& ablation : ablations) {
    const std::string group = group_of(ablation, ablations);
    for (const char* title : {"same order", "rho", "p"}) table.columns.push_back({group, title});
    const auto agreements = order_agreement(ablation);
    for (std::size_t i = 0; i < agreements.size(); ++i) {
      const OrderAgreement& agreement = agreements[i];
      if (table.rows.size() == i) {
        table.rows.push_back(
            {{std::string(traits(agreement.metric).title)}, {fmt::format("{}", agreement.pairs)}});
      }
      table.rows[i].push_back({fmt::format("{}", agreement.same)});
      table.rows[i].push_back({agreement.spearman_rho ? number(*agreement.spearman_rho) : "–"});
      table.rows[i].push_back({agreement.p ? p_value(*agreement.p) : "–"});
    }
  }
  return table;
}

}  // namespace culprit::study
