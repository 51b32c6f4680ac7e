#include "incident_reports/journal_incidents.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "incident_reports/incident_reader.h"
#include "incident_reports/older_incidents.h"
#include "journal/session.h"
#include "language/checker.h"

namespace culprit::incident_reports {
namespace {

using journal::Entry;
using journal::Reader;

constexpr double kNanosecond = 1e-9;  // s

// The events that make up an incident. Most rows are something else, and are not parsed.
constexpr std::array<std::string_view, 13> kTelling = {
    "failure_detected", "failure_resolved", "failure_lost",   "strategy_chosen", "approval_asked",
    "action_held_back", "strategy_failed",  "rule_exhausted", "round_spent",     "component_lost",
    "incident_opened",  "incident_changed", "incident_closed"};

// Rows begin with their type (journal/event_json.h); the few that do not are about no incident.
bool is_telling(std::string_view body) {
  constexpr std::string_view kBegin = R"({"type":")";
  if (!body.starts_with(kBegin)) return false;
  body.remove_prefix(kBegin.size());
  return std::ranges::any_of(kTelling, [&](std::string_view type) {
    return body.starts_with(type) && body.substr(type.size()).starts_with('"');
  });
}

// The components of rules and strategies, by the rules of the reporting session.
class Names {
 public:
  void begin(const std::string& session) {
    if (session == text_) return;
    text_ = session;
    rules_.reset();
    is_checked_ = false;
    const Json json = parse_json(session);
    tells_incidents_ = journal::integer_of(json, "wall") > 0;
    goes_on_ = journal::flag_of(json, "continued");
  }
  // Its manager reports incidents.
  bool tells_incidents() const { return tells_incidents_; }
  // It continues with the manager of the session before.
  bool goes_on() const { return goes_on_; }
  // A rule that is missing, or in unreadable rules, has no components.
  std::vector<std::string> components_of(const std::string& rule, const std::string& strategy) {
    const RuleSet* rules = checked();
    if (rules == nullptr) return {};
    std::vector<std::string> names;
    for (std::size_t r = 0; r < rules->rules.size(); ++r) {
      const Rule& each = rules->rules[r];
      if (each.name != rule) continue;
      if (strategy.empty()) add(each.components, *rules, names);
      for (const StrategyId id : each.strategies) {
        if ((*rules)[id].name == strategy) add((*rules)[id].components, *rules, names);
      }
    }
    return names;
  }

 private:
  static void add(const auto& ids, const RuleSet& rules, std::vector<std::string>& names) {
    for (const ComponentId id : ids) names.push_back(rules[id].name);
  }
  // Only on request: many sessions have no incident.
  const RuleSet* checked() {
    if (!is_checked_) {
      is_checked_ = true;
      const auto session = journal::session_from_json(parse_json(text_));
      if (session) rules_ = check(Source(session->rules_path, session->rules_text)).rules;
    }
    return rules_ ? &*rules_ : nullptr;
  }

  std::string text_;
  bool is_checked_ = false;
  bool tells_incidents_ = false;
  bool goes_on_ = false;
  std::optional<RuleSet> rules_;
};

// The names of the newest session row before row `row`, which reported it.
Expected<Names> names_at(const Reader& journal, std::int64_t row) {
  Names names;
  const auto session = journal.newest(journal::kind::kSession, row);
  if (!session) return Error{session.error()};
  if (*session) names.begin((*session)->body);
  return names;
}

// When a run of culprit was last there, in seconds since 1970: by the row before `session`, with
// which the next run begins. 0: unknown.
Expected<double> last_sign_before(const Reader& journal, std::int64_t session) {
  const auto row = journal.entry(session - 1);
  if (!row) return Error{row.error()};
  // The next run writes of what is missing, before it begins.
  if (!*row || (*row)->kind == journal::kind::kGap) return 0.0;
  return kNanosecond * static_cast<double>((*row)->at);
}

struct Built {
  IncidentReader told;
  OlderIncidents older;
};

Expected<Built> build(const Reader& journal, std::int64_t from) {
  auto names = names_at(journal, from);
  if (!names) return Error{names.error()};
  auto rows = journal.entries(journal::Which::kReadable, from);
  if (!rows) return Error{rows.error()};
  const ComponentsOf components_of = [&](const std::string& rule, const std::string& strategy) {
    return names->components_of(rule, strategy);
  };
  Built built;
  Entry entry;
  auto more = rows->next(entry);
  for (; more && *more; more = rows->next(entry)) {
    if (entry.kind == journal::kind::kSession) {
      names->begin(entry.body);
      const auto until = last_sign_before(journal, entry.id);
      if (!until) return Error{until.error()};
      built.older.cut(*until);
      if (!names->goes_on()) built.told.cut(*until);
    }
    if (entry.kind != journal::kind::kEvent || !is_telling(entry.body)) continue;
    const Json event = parse_json(entry.body);
    const double robot = kNanosecond * static_cast<double>(journal::integer_of(event, "time"));
    const Told told{entry.id, kNanosecond * static_cast<double>(entry.at), robot, event};
    if (names->tells_incidents()) {
      built.told.add(told);
    } else {
      built.older.add(told, components_of);
    }
  }
  if (!more) return Error{more.error()};
  return built;
}

// The last row before `before` that begins like this; `before` if there is none.
Expected<std::int64_t> row_that_begins(const Reader& journal, const std::string& begin,
                                       std::int64_t before) {
  auto found = journal.database().prepare(
      "SELECT id FROM entry WHERE kind <> 'steps' AND kind = 'event' AND id < ?1 AND "
      "substr(body, 1, length(?2)) = ?2 ORDER BY id DESC LIMIT 1");
  if (!found) return Error{found.error()};
  found->bind(1, before).bind(2, std::string_view(begin));
  const auto row = found->step();
  if (!row) return Error{row.error()};
  return *row ? found->integer(0) : before;
}

// Rows between an incident's opening and its failure: both are written in the same step.
constexpr std::int64_t kRowsOfStep = 64;

std::string opening_of(const std::string& id) {
  return R"({"type":"incident_opened","incident":")" + id + '"';
}

Expected<std::int64_t> first_row_after(const Reader& journal, double since) {
  auto before = journal.database().prepare(
      "SELECT id FROM entry WHERE kind <> 'steps' AND at < ?1 ORDER BY id DESC LIMIT 1");
  if (!before) return Error{before.error()};
  before->bind(1, static_cast<std::int64_t>(since / kNanosecond));
  const auto row = before->step();
  if (!row) return Error{row.error()};
  return *row ? before->integer(0) + 1 : 1;
}

}  // namespace

Expected<Found> incidents_of(const Reader& journal, double since,
                             const std::set<std::string>& open_now) {
  const auto oldest = journal.database().number(
      "SELECT coalesce(min(at), 0) FROM (SELECT at FROM entry ORDER BY id LIMIT 1)");
  if (!oldest) return Error{oldest.error()};
  const auto newest = journal.database().number(
      "SELECT coalesce(max(at), 0) FROM (SELECT at FROM entry ORDER BY id DESC LIMIT 1)");
  if (!newest) return Error{newest.error()};
  auto from = first_row_after(journal, since);
  if (!from) return Error{from.error()};
  // An incident that began before and ended after `since` is reported from its beginning. Before that, an earlier one may have begun.
  constexpr int kMostSteps = 8;
  for (int i = 0;; ++i) {
    const auto built = build(journal, *from);
    if (!built) return Error{built.error()};
    std::int64_t earlier = *from;
    for (const std::string& rule : built->older.begun_before()) {
      const auto row =
          row_that_begins(journal, R"({"type":"failure_detected","rule":")" + rule + '"', *from);
      if (!row) return Error{row.error()};
      earlier = std::min(earlier, *row);
    }
    std::set<std::string> opened_before = built->told.begun_before();
    for (const std::string& id : open_now) {
      if (!built->told.has(id)) opened_before.insert(id);
    }
    for (const std::string& id : opened_before) {
      const auto row = row_that_begins(journal, opening_of(id), *from);
      if (!row) return Error{row.error()};
      if (*row < *from) earlier = std::min(earlier, std::max<std::int64_t>(1, *row - kRowsOfStep));
    }
    if (earlier == *from || i == kMostSteps) {
      std::vector<Incident> all = built->older.incidents();
      all.insert(all.end(), built->told.incidents().begin(), built->told.incidents().end());
      std::erase_if(all, [since](const Incident& each) {
        return each.is_over && each.began + each.seconds < since;
      });
      std::ranges::stable_sort(all, comes_before);
      return Found{std::move(all), kNanosecond * static_cast<double>(*oldest),
                   kNanosecond * static_cast<double>(*newest)};
    }
    from = earlier;
  }
}

Expected<std::optional<double>> opened_at(const Reader& journal, const std::string& id) {
  auto found = journal.database().prepare(
      "SELECT at FROM entry WHERE kind <> 'steps' AND kind = 'event' AND "
      "substr(body, 1, length(?1)) = ?1 ORDER BY id LIMIT 1");
  if (!found) return Error{found.error()};
  const std::string begin = opening_of(id);
  found->bind(1, std::string_view(begin));
  const auto row = found->step();
  if (!row) return Error{row.error()};
  if (!*row) return std::optional<double>();
  return std::optional(kNanosecond * static_cast<double>(found->integer(0)));
}

Expected<std::optional<journal::Session>> session_at(const Reader& journal, std::int64_t row) {
  const auto found = journal.newest(journal::kind::kSession, row);
  if (!found) return Error{found.error()};
  if (!*found) return std::optional<journal::Session>();
  auto session = journal::session_from_json(parse_json((*found)->body));
  if (!session) return std::optional<journal::Session>();
  return std::optional(std::move(*session));
}

Expected<std::vector<ToldEvent>> events_of(const Reader& journal, std::int64_t first,
                                           std::int64_t last) {
  auto names = names_at(journal, first);
  if (!names) return Error{names.error()};
  auto rows = journal.entries(journal::Which::kReadable, first);
  if (!rows) return Error{rows.error()};
  std::vector<ToldEvent> told;
  Entry entry;
  double wall_of_robot = 0;  // when the robot's clock was 0
  auto more = rows->next(entry);
  for (; more && *more && entry.id <= last && told.size() < kMostTold; more = rows->next(entry)) {
    if (entry.kind == journal::kind::kSession) names->begin(entry.body);
    if (entry.kind != journal::kind::kEvent) continue;
    Json event = parse_json(entry.body);
    if (journal::text_of(event, "text").empty()) continue;  // for culprit itself
    const double robot = kNanosecond * static_cast<double>(journal::integer_of(event, "time"));
    if (told.empty()) wall_of_robot = kNanosecond * static_cast<double>(entry.at) - robot;
    auto components =
        names->components_of(journal::text_of(event, "rule"), journal::text_of(event, "strategy"));
    if (!event.contains("strategy")) components.clear();
    told.push_back({entry.id, wall_of_robot + robot, std::move(event), std::move(components)});
  }
  if (!more) return Error{more.error()};
  return told;
}

}  // namespace culprit::incident_reports
