#include "journal/inheritance.h"

#include <algorithm>
#include <map>

#include "journal/session.h"

namespace culprit::journal {
namespace {

constexpr std::int64_t kVersion = 1;

// Without reasons, which were for people.
Json row_of(const Event& event, const RuleSet& rules) {
  Event told = event;
  if (auto* chosen = std::get_if<StrategyChosen>(&told.what))
    *chosen = {chosen->strategy, {}, {}, chosen->dry_run, {}, {}};
  if (auto* failed = std::get_if<StrategyFailed>(&told.what)) failed->reason.clear();
  if (auto* done = std::get_if<AdaptationDone>(&told.what)) done->remark.clear();
  return to_json(History{std::move(told)}, rules).front();
}

// The whole row but its time.
std::string without_time(const Event& event, const RuleSet& rules) {
  Json json = row_of(event, rules);
  json.erase("time");
  json.erase("reaction_s");  // is not read back
  return to_line(json);
}

}  // namespace

bool is_inherited(const Event& event) {
  const auto* accepted = std::get_if<OrderAccepted>(&event.what);
  const bool is_silence =
      accepted != nullptr && !std::holds_alternative<RunStrategy>(accepted->order.what);
  return is_remembered(event) && !is_silence &&
         !std::holds_alternative<ComponentFound>(event.what) &&
         !std::holds_alternative<OutcomePending>(event.what) &&
         !std::holds_alternative<OutcomeCounted>(event.what);
}

void Bequest::add(const Event& event) {
  if (!is_inherited(event)) return;
  add_row(event);
  if (past_.size() < 2 * Inheritance::kMostEvents) return;
  History kept = still_counting(past_, event.at, rules_);
  const std::size_t spare = kept.size() - std::min(kept.size(), Inheritance::kMostEvents);
  past_.clear();
  rows_.clear();
  for (std::size_t i = spare; i < kept.size(); ++i) add_row(kept[i]);
}

void Bequest::add_row(const Event& event) {
  past_.push_back(event);
  rows_.push_back(to_line(row_of(event, rules_)));
}

std::string Bequest::text(const Learned& learned, std::size_t most) const {
  std::string text = "{\"version\":" + std::to_string(kVersion) +
                     ",\"learned\":" + to_line(to_json(learned)) + ",\"past\":[";
  constexpr std::string_view kEnd = "]}";
  std::size_t size = text.size() + kEnd.size();
  if (size > most) return {};
  std::size_t first = rows_.size();
  while (first > 0 && rows_.size() - first < Inheritance::kMostEvents) {
    size += rows_[first - 1].size() + 1;  // and a comma
    if (size > most) break;
    --first;
  }
  for (std::size_t i = first; i < rows_.size(); ++i) text += (i == first ? "" : ",") + rows_[i];
  return text.append(kEnd);
}

std::string to_text(const Inheritance& inheritance, const RuleSet& rules, std::size_t most) {
  Bequest bequest(rules);
  for (const Event& event : inheritance.past) bequest.add(event);
  return bequest.text(inheritance.learned, most);
}

Expected<Inheritance> inheritance_from_text(const std::string& text, const RuleSet& rules,
                                            Duration shift, Time now) {
  const Json json = parse_json(text);
  if (!json.is_object()) return Error{"it cannot be read"};
  if (integer_of(json, "version") != kVersion) return Error{"it is of another version of culprit"};
  auto learned = learned_from_json(json.value("learned", Json()));
  if (!learned) return Error{learned.error()};
  Inheritance inheritance{std::move(*learned), {}};
  for (Event& event : history_from_json(json.value("past", Json()), rules)) {
    if (!is_inherited(event) || inheritance.past.size() >= Inheritance::kMostEvents) continue;
    std::int64_t at = 0;
    if (__builtin_add_overflow(event.at.time_since_epoch().count(), shift.count(), &at)) continue;
    event.at = std::min(now, Time(Duration(at)));
    inheritance.past.push_back(std::move(event));
  }
  std::ranges::stable_sort(inheritance.past, {}, &Event::at);
  return inheritance;
}

void inherit(Learned& ours, const Learned& theirs) {
  for (const LearnedBelief& each : theirs.beliefs) {
    const auto known = std::ranges::find_if(ours.beliefs, [&](const LearnedBelief& o) {
      return o.rule == each.rule && o.strategy == each.strategy;
    });
    if (known == ours.beliefs.end()) {
      ours.beliefs.push_back(each);
    } else {
      *known = each;
    }
  }
  for (const LearnedCoupling& each : theirs.couplings) {
    const auto known = std::ranges::find_if(ours.couplings, [&](const LearnedCoupling& o) {
      return o.cause == each.cause && o.effect == each.effect;
    });
    if (known == ours.couplings.end()) {
      ours.couplings.push_back(each);
    } else {
      *known = each;
    }
  }
  for (const LearnedLatency& each : theirs.latencies) {
    const auto known = std::ranges::find(ours.latencies, each.rule, &LearnedLatency::rule);
    if (known == ours.latencies.end()) {
      ours.latencies.push_back(each);
    } else {
      *known = each;
    }
  }
  for (const LearnedCoincidence& each : theirs.coincidences) {
    const auto known = std::ranges::find_if(ours.coincidences, [&](const LearnedCoincidence& o) {
      return o.rule == each.rule && o.other == each.other;
    });
    if (known == ours.coincidences.end()) {
      ours.coincidences.push_back(each);
    } else {
      *known = each;
    }
  }
}

History joined(const History& ours, const History& theirs, const RuleSet& rules) {
  constexpr Duration kWay = std::chrono::seconds(2);
  std::multimap<std::string, Time> known;
  for (const Event& event : ours) known.emplace(without_time(event, rules), event.at);
  History all = ours;
  for (const Event& event : theirs) {
    const auto [first, last] = known.equal_range(without_time(event, rules));
    const auto same = std::find_if(first, last, [&](const auto& each) {
      const Duration apart = event.at - each.second;
      return apart > -kWay && apart < kWay;
    });
    if (same == last) {
      all.push_back(event);
    } else {
      known.erase(same);
    }
  }
  std::ranges::stable_sort(all, {}, &Event::at);
  return all;
}

}  // namespace culprit::journal
