#include <memory>

#include "language/checker.h"
#include "rule_test/plan_report.h"
#include "rule_test/state.h"
#include "web/aside.h"
#include "web/calls.h"
#include "web/rule_desk.h"

namespace culprit::web {
namespace {

std::string rendered(std::vector<Diagnostic> diagnostics, const Source& source) {
  std::erase_if(diagnostics, [](const Diagnostic& d) { return d.severity != Severity::kError; });
  return render(diagnostics, source);
}

http::Answer what_if(const Json& body, const PlannerFactory& planner, const RuleLoader& load) {
  const auto rule_text = http::text_of(body, "rules");
  const auto state_text = http::text_of(body, "state");
  if (!rule_text || !state_text) return http::refuse(400, "send the texts 'rules' and 'state'");
  const Expansion rules = expand(Source(kTextOfPage, *rule_text), load);
  const Checked checked = check(rules);
  if (!checked.rules) return http::refuse(422, rendered(checked.diagnostics, rules.source));
  const Source state_source("state", *state_text);
  std::vector<Diagnostic> diagnostics;
  const rule_test::State state = rule_test::read_state(state_source, *checked.rules, diagnostics);
  if (!diagnostics.empty()) return http::refuse(422, rendered(diagnostics, state_source));
  const rule_test::Watched watched = rule_test::watch(state, *checked.rules);
  return {200, rule_test::plan_as_json(
                   {*planner(), watched.failures, *watched.knowledge, watched.held_back})};
}

}  // namespace

http::Route what_if_route(PlannerFactory planner, RuleLoader load) {
  return {
      http::Method::kPost, "/api/what-if",
      [planner = std::move(planner), load = std::move(load), few = std::make_shared<FewAtOnce>()](
          const Json& body) { return few->make([&] { return what_if(body, planner, load); }); },
      http::Role::kLook};
}

}  // namespace culprit::web
