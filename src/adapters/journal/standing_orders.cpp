#include "journal/standing_orders.h"

#include <algorithm>
#include <tuple>

#include "base/invariant.h"
#include "base/name_grammar.h"
#include "journal/json.h"
#include "journal/order_reserve.h"
#include "journal/requests.h"
#include "journal/sealed_file.h"
#include "robot/standing.h"

namespace culprit::journal {
namespace {

using About = StandingOrders::About;
using Quiet = StandingOrders::Quiet;
using Said = StandingOrders::Said;

Json to_json(const Said& said) { return {{"author", said.author}, {"reason", said.reason}}; }

// Another machine's, or an older culprit's, may hold anything.
Said said_from(const Json& json) {
  return {escape_controls(text_of(json, "author")), escape_controls(text_of(json, "reason"))};
}

std::optional<Said> standing(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return said_from(json);
}

void erase(std::vector<Quiet>& silences, About about, const std::string& name) {
  std::erase_if(silences, [&](const Quiet& q) { return q.about == about && q.name == name; });
}

std::optional<Silenceable> find(const Quiet& quiet, const RuleSet& rules) {
  if (quiet.about == About::kRule) {
    const auto rule = find_rule(rules, quiet.name);
    return rule ? std::optional<Silenceable>(*rule) : std::nullopt;
  }
  const auto component = find_component(rules, quiet.name);
  return component ? std::optional<Silenceable>(*component) : std::nullopt;
}

std::pair<About, std::string> named(const Silenceable& what, const RuleSet& rules) {
  if (const auto* rule = std::get_if<RuleId>(&what)) return {About::kRule, rules[*rule].name};
  return {About::kComponent, rules[std::get<ComponentId>(what)].name};
}

}  // namespace

NamedOrder by_name(const Order& order, const RuleSet& rules) {
  CULPRIT_ASSERT(standing_of(order) != Standing::kNot);
  NamedOrder out{order.what, {order.author, order.reason}, About::kComponent, ""};
  if (const auto* silence = std::get_if<Silence>(&order.what))
    std::tie(out.about, out.name) = named(silence->what, rules);
  if (const auto* lift = std::get_if<LiftSilence>(&order.what))
    std::tie(out.about, out.name) = named(lift->what, rules);
  return out;
}

StandingOrders after(StandingOrders orders, const NamedOrder& order, Time now) {
  ++orders.revision;
  std::erase_if(orders.silences, [&](const Quiet& quiet) { return quiet.until <= now; });
  if (std::holds_alternative<Resume>(order.what)) orders.pause.reset();
  // The first person who ordered it is the one to ask about it.
  if (std::holds_alternative<Pause>(order.what) && !orders.pause) orders.pause = order.said;
  if (const auto* dry_run = std::get_if<SetDryRun>(&order.what)) {
    if (!dry_run->is_on) orders.dry_run.reset();
    if (dry_run->is_on && !orders.dry_run) orders.dry_run = order.said;
  }
  if (std::holds_alternative<LiftSilence>(order.what))
    erase(orders.silences, order.about, order.name);
  if (const auto* silence = std::get_if<Silence>(&order.what)) {
    erase(orders.silences, order.about, order.name);
    orders.silences.push_back({order.about, order.name, order.said,
                               silence->lasts ? later(now, *silence->lasts) : kNever});
  }
  return orders;
}

bool restrain_alike(const StandingOrders& a, const StandingOrders& b) {
  return a.pause == b.pause && a.dry_run == b.dry_run && a.silences == b.silences;
}

StandingOrders both(StandingOrders a, const StandingOrders& b) {
  if (!a.pause) a.pause = b.pause;
  if (!a.dry_run) a.dry_run = b.dry_run;
  a.revision = std::max(a.revision, b.revision);
  for (const Quiet& theirs : b.silences) {
    const auto ours = std::find_if(a.silences.begin(), a.silences.end(), [&](const Quiet& quiet) {
      return quiet.about == theirs.about && quiet.name == theirs.name;
    });
    if (ours == a.silences.end()) {
      a.silences.push_back(theirs);
    } else {
      ours->until = std::max(ours->until, theirs.until);
    }
  }
  return a;
}

std::vector<Order> restraints_beyond(const StandingOrders& ours, const StandingOrders& theirs,
                                     const RuleSet& rules, Time now) {
  std::vector<Order> orders;
  const auto add = [&](const Said& said, auto what) {
    orders.push_back({0, said.author, said.reason, what});
  };
  if (theirs.pause && !ours.pause) add(*theirs.pause, Pause{});
  if (theirs.dry_run && !ours.dry_run) add(*theirs.dry_run, SetDryRun{true});
  for (const Quiet& quiet : theirs.silences) {
    const bool is_known =
        std::any_of(ours.silences.begin(), ours.silences.end(), [&](const Quiet& own) {
          return own.about == quiet.about && own.name == quiet.name && own.until >= quiet.until;
        });
    const auto what = find(quiet, rules);
    if (is_known || !what || quiet.until <= now) continue;
    Silence silence{*what, {}};
    if (quiet.until != kNever) silence.lasts = quiet.until - now;
    add(quiet.said, silence);
  }
  return orders;
}

History to_past(const StandingOrders& orders, const RuleSet& rules, Time now) {
  History past;
  for (const Quiet& quiet : orders.silences) {
    const auto what = find(quiet, rules);
    if (!what || quiet.until <= now) continue;
    Silence silence{*what, {}};
    if (quiet.until != kNever) silence.lasts = quiet.until - now;
    past.push_back({now, OrderAccepted{{0, quiet.said.author, quiet.said.reason, silence}}});
  }
  return past;
}

std::vector<Quiet> silences_of(const History& past, const RuleSet& rules) {
  StandingOrders orders;
  for (const Event& event : past) {
    if (!is_about_silence(event)) continue;
    orders = after(std::move(orders), by_name(std::get<OrderAccepted>(event.what).order, rules),
                   event.at);
  }
  return orders.silences;
}

bool is_about_silence(const Event& event) {
  const auto* accepted = std::get_if<OrderAccepted>(&event.what);
  return accepted != nullptr && (std::holds_alternative<Silence>(accepted->order.what) ||
                                 std::holds_alternative<LiftSilence>(accepted->order.what));
}

std::string to_text(const StandingOrders& orders, const Clocks& now) {
  Json json = {
      {"boot", now.boot},
      {"robot", now.robot.time_since_epoch().count()},
      {"wall", now.wall},
      {"wall_is_set", now.is_wall_set},
      {"paused", orders.pause ? to_json(*orders.pause) : Json()},
      {"dry_run", orders.dry_run ? to_json(*orders.dry_run) : Json()},
      {"silences", Json::array()},
      {"revision", orders.revision},
  };
  for (const Quiet& quiet : orders.silences) {
    if (quiet.until <= now.robot) continue;
    Json each = to_json(quiet.said);
    each[quiet.about == About::kRule ? "rule" : "component"] = quiet.name;
    if (quiet.until != kNever) each["rest"] = (quiet.until - now.robot).count();
    json["silences"].push_back(std::move(each));
  }
  return to_line(json);
}

Expected<StandingOrders> orders_from_text(const std::string& text, const Clocks& now) {
  const Json json = parse_json(text);
  if (!json.is_object() || !json.contains("paused") || !json.contains("dry_run") ||
      !json.contains("silences") || !json["silences"].is_array())
    return Error{"these are no orders"};
  StandingOrders orders;
  orders.pause = standing(json["paused"]);
  orders.dry_run = standing(json["dry_run"]);
  orders.revision =
      static_cast<std::uint64_t>(std::max<std::int64_t>(0, integer_of(json, "revision")));
  const Clocks then{text_of(json, "boot"), Time(Duration(integer_of(json, "robot"))),
                    integer_of(json, "wall"), flag_of(json, "wall_is_set")};
  const Duration age = certain_age(then, now);
  for (const Json& each : json["silences"]) {
    const bool is_rule = each.is_object() && each.contains("rule");
    Quiet quiet{is_rule ? About::kRule : About::kComponent,
                text_of(each, is_rule ? "rule" : "component"), said_from(each), kNever};
    if (each.is_object() && each.contains("rest")) {
      const Duration rest(std::max<std::int64_t>(0, integer_of(each, "rest")));
      if (rest <= age) continue;
      quiet.until = later(now.robot, rest - age);
    }
    orders.silences.push_back(std::move(quiet));
  }
  return orders;
}

std::filesystem::path orders_beside(const std::filesystem::path& journal) {
  return journal.string() + "-orders";
}

Expected<void> write_orders(const std::filesystem::path& path, const StandingOrders& orders,
                            const Clocks& now) {
  const std::string text = to_text(orders, now) + "\n";
  auto written = write_sealed(path, text);
  if (!written && write_reserve(reserve_beside(path), text)) return {};
  return written;
}

Expected<std::optional<StandingOrders>> read_orders(const std::filesystem::path& path,
                                                    const Clocks& now) {
  const auto text = read_sealed(path);
  if (!text) return Error{text.error()};
  if (!*text) return std::optional<StandingOrders>();
  const auto orders = orders_from_text(**text, now);
  if (!orders) return Error{"cannot read '" + path.string() + "': " + orders.error()};
  const auto later = read_reserve(reserve_beside(path));
  const auto reserved = later ? orders_from_text(*later, now) : orders;
  return std::optional(reserved && reserved->revision > orders->revision ? *reserved : *orders);
}

}  // namespace culprit::journal
