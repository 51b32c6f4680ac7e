#include "fleet/tally.h"

#include <utility>

#include "fleet/clean.h"
#include "fleet/incident_number.h"
#include "journal/json.h"

namespace culprit::fleet {
namespace {

std::string hex_of(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string digits;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    digits += {kDigits[byte >> 4], kDigits[byte & 15]};
  }
  return digits;
}

std::string digest_of_text(const std::string& text) {
  journal::Hasher hasher;
  return journal::to_hex(hasher.of(text)).substr(0, 16);
}

// The component that a decision holds responsible for this failure.
std::string blamed_in(const Json& body) {
  const Json suspects = body.value("suspects", Json::array());
  if (suspects.is_array() && !suspects.empty() && suspects[0].is_object())
    return clean(journal::text_of(suspects[0], "component"));
  const Json components = body.value("components", Json::array());
  if (components.is_array() && !components.empty() && components[0].is_string())
    return clean(components[0].get<std::string>());
  return "";
}

}  // namespace

bool Tally::begins_run(const journal::Entry& entry) {
  return entry.kind == journal::kind::kSession;
}

void Tally::take(const journal::Entry& entry, std::string_view hash) {
  last_row_ = entry.id;
  last_at_ = entry.at;
  if (begins_run(entry)) return begin(entry, hash);
  if (!run_) return;
  if (entry.kind == journal::kind::kEvent) {
    event(entry);
  } else if (entry.kind == journal::kind::kEnd) {
    for (auto& [rule, failure] : open_) close(failure, entry.at, "left");
    open_.clear();
  }
}

void Tally::begin(const journal::Entry& entry, std::string_view hash) {
  for (auto& [rule, failure] : open_) close(failure, last_at_, "left");
  open_.clear();
  is_new_.clear();
  counts_.clear();
  const Json body = parse_json(entry.body);
  Run run;
  run.id = hex_of(hash.substr(0, 16));
  run.row = entry.id;
  run.began = entry.at;
  run.culprit = clean(journal::text_of(body, "version"));
  run.model = clean(journal::text_of(body, "robot"));
  rules_text_ = journal::text_of(body, "rules_text");
  tells_incidents_ = journal::integer_of(body, "wall") > 0;
  run.rule_set = digest_of_text(rules_text_);
  if (body.is_object())
    run.context = clean(journal::text_of(body.value("fleet", Json()), "context"));
  run_ = std::move(run);
}

Failure* Tally::open_failure(const std::string& rule) {
  const auto found = open_.find(rule);
  if (found == open_.end()) return nullptr;
  is_new_[rule] = true;
  return &found->second;
}

void Tally::close(Failure& failure, std::int64_t at, const char* how) {
  if (failure.incident == 0) failure.incident = failure.row;
  failure.ended = at;
  failure.how = how;
  changed_.push_back(failure);
}

void Tally::event(const journal::Entry& entry) {
  const Json body = parse_json(entry.body);
  if (!body.is_object()) return;
  const std::string type = journal::text_of(body, "type");
  const std::string rule = clean(journal::text_of(body, "rule"));
  const std::string strategy = clean(journal::text_of(body, "strategy"));
  if (type == "outcome_counted") {
    const std::string as = journal::text_of(body, "as");
    if (as != "success" && as != "failure") return;
    Counts& counts = counts_[{rule, strategy}];
    ++(as == "success" ? counts.helped : counts.failed);
  } else if (type == "failure_detected") {
    if (open_.contains(rule)) return;
    if (open_.empty()) incident_ = entry.id;
    Failure failure;
    failure.row = entry.id;
    failure.incident = tells_incidents_ ? 0 : incident_;
    failure.rule = rule;
    failure.criticality = clean(journal::text_of(body, "criticality"));
    failure.began = entry.at;
    open_[rule] = std::move(failure);
    is_new_[rule] = true;
  } else if (type == "incident_opened" || type == "incident_changed") {
    take_incident(body);
  } else if (type == "incident_closed") {
    return;
  } else if (Failure* failure = open_failure(rule); failure == nullptr) {
    return;
  } else if (type == "strategy_chosen") {
    const std::string blamed = blamed_in(body);
    if (!blamed.empty()) failure->component = blamed;
    if (!journal::flag_of(body, "dry_run")) ++failure->strategies;
  } else if (type == "failure_held_back") {
    if (failure->component.empty()) failure->component = blamed_in(body);
  } else if (type == "strategy_failed") {
    ++failure->failed;
  } else if (type == "rule_exhausted") {
    failure->is_exhausted = true;
  } else if (type == "failure_resolved") {
    failure->repair_seconds = journal::number_of(body, "reaction_s", 0);
    failure->helped_by = strategy;
    close(*failure, entry.at, "resolved");
    open_.erase(rule);
  } else if (type == "failure_lost") {
    close(*failure, entry.at, "lost");
    open_.erase(rule);
  }
}

// A failure stays with the incident that it was part of first.
void Tally::take_incident(const Json& body) {
  const std::int64_t number = incident_number(journal::text_of(body, "incident"));
  const auto take = [&](const Json& rule) {
    const auto found = open_.find(rule.is_string() ? clean(rule.get<std::string>()) : "");
    if (found == open_.end() || found->second.incident != 0) return;
    found->second.incident = number == 0 ? found->second.row : number;
    is_new_[found->first] = true;
  };
  take(body.value("rule", Json()));
  for (const Json& rule : body.value("consequences", Json::array())) take(rule);
}

std::vector<Failure> Tally::take_failures() {
  std::vector<Failure> taken = std::move(changed_);
  changed_.clear();
  for (const auto& [rule, failure] : open_) {
    if (failure.incident != 0 && std::exchange(is_new_[rule], false)) taken.push_back(failure);
  }
  return taken;
}

}  // namespace culprit::fleet
