#include "cli/what_if_route.h"

#include "cli/plan_report.h"
#include "language/checker.h"
#include "rule_test/state.h"

namespace culprit::cli {
namespace {

std::string rendered(const std::vector<Diagnostic>& diagnostics, const Source& source) {
  std::string text;
  for (const Diagnostic& d : diagnostics) {
    if (d.severity == Severity::kError) text += render(d, source);
  }
  return text;
}

web::Answer what_if(const web::Json& body, const PlannerFactory& planner) {
  const auto rule_text = web::text_of(body, "rules");
  const auto state_text = web::text_of(body, "state");
  if (!rule_text || !state_text) return web::refuse(400, "send the texts 'rules' and 'state'");
  const Source rule_source("rules", *rule_text);
  const Checked checked = check(rule_source);
  if (!checked.rules) return web::refuse(422, rendered(checked.diagnostics, rule_source));
  const Source state_source("state", *state_text);
  std::vector<Diagnostic> diagnostics;
  const rule_test::State state = rule_test::read_state(state_source, *checked.rules, diagnostics);
  if (!diagnostics.empty()) return web::refuse(422, rendered(diagnostics, state_source));
  const rule_test::Watched watched = rule_test::watch(state, *checked.rules);
  return {200, plan_as_json({*planner(), watched.failures, *watched.knowledge, watched.held_back})};
}

}  // namespace

web::Route what_if_route(PlannerFactory planner) {
  return {web::Method::kPost, "/api/what-if",
          [planner = std::move(planner)](const web::Json& body) { return what_if(body, planner); }};
}

}  // namespace culprit::cli
