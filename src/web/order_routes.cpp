#include "web/order_routes.h"

#include <algorithm>

#include "base/closest.h"
#include "base/live_clock.h"
#include "base/name_grammar.h"
#include "robot/standing.h"

namespace culprit::web {
namespace {

using What = decltype(Order::what);

constexpr double kLongestSilence = 7 * 24 * 3600;  // s
constexpr double kLongestWait = 30;                // s
constexpr std::size_t kLongestText = 500;

// The number of the first thing of this name.
template <class I>
std::optional<I> find(const auto& things, const std::optional<std::string>& name) {
  if (!name) return std::nullopt;
  for (std::size_t i = 0; i < things.size(); ++i) {
    if (things[i].name == *name) return I(i);
  }
  return std::nullopt;
}

// Two rules may each have a strategy of one name.
std::optional<StrategyId> find_strategy(const Json& body, const RuleSet& rules) {
  const auto rule = find<RuleId>(rules.rules, http::text_of(body, "rule"));
  const auto name = http::text_of(body, "strategy");
  if (!rule || !name) return std::nullopt;
  for (const StrategyId id : rules[*rule].strategies) {
    if (rules[id].name == *name) return id;
  }
  return std::nullopt;
}

std::optional<Silenceable> find_silenceable(const Json& body, const RuleSet& rules) {
  if (const auto component = find<ComponentId>(rules.components, http::text_of(body, "component")))
    return *component;
  if (const auto rule = find<RuleId>(rules.rules, http::text_of(body, "rule"))) return *rule;
  return std::nullopt;
}

// "there is no component 'camra'; did you mean 'camera'?"; empty if no name was given.
std::string no_such(const char* kind, const std::optional<std::string>& name,
                    const std::vector<std::string_view>& known) {
  if (!name || name->empty()) return "";
  std::string text = "there is no " + std::string(kind) + " '" + printable(*name) + "'";
  const std::string near = closest(*name, known);
  return near.empty() ? text : text + "; did you mean '" + near + "'?";
}

std::vector<std::string_view> names_of_all(const auto& things) {
  std::vector<std::string_view> names;
  for (const auto& each : things) names.push_back(each.name);
  return names;
}

// Names the wrong part, with similar names, and the remedy.
Error unknown_strategy(const Json& body, const RuleSet& rules) {
  const std::string remedy = "name a 'rule' and one of its strategies as 'strategy'";
  const auto rule = find<RuleId>(rules.rules, http::text_of(body, "rule"));
  std::string what = no_such("rule", http::text_of(body, "rule"), names_of_all(rules.rules));
  if (rule) {
    std::vector<std::string_view> names;
    for (const StrategyId id : rules[*rule].strategies) names.push_back(rules[id].name);
    what = no_such(("strategy of " + rules[*rule].name).c_str(), http::text_of(body, "strategy"),
                   names);
  }
  return Error{what.empty() ? remedy : what + " (" + remedy + ")"};
}

Error unknown_silenceable(const Json& body, const RuleSet& rules) {
  const std::string remedy = "name a 'component' or a 'rule' of the rules";
  std::string what =
      no_such("component", http::text_of(body, "component"), names_of_all(rules.components));
  if (what.empty()) what = no_such("rule", http::text_of(body, "rule"), names_of_all(rules.rules));
  return Error{what.empty() ? remedy : what + " (" + remedy + ")"};
}

Expected<What> about_strategy(const std::string& word, const Json& body, const RuleSet& rules) {
  const auto strategy = find_strategy(body, rules);
  if (!strategy) return unknown_strategy(body, rules);
  if (word == "approve") return What(Approve{*strategy});
  if (word == "refuse") return What(Refuse{*strategy});
  if (word == "propose") return What(Propose{*strategy});
  return What(RunStrategy{*strategy});
}

Expected<What> about_silence(const std::string& word, const Json& body, const RuleSet& rules) {
  const auto what = find_silenceable(body, rules);
  if (!what) return unknown_silenceable(body, rules);
  if (word == "lift") return What(LiftSilence{*what});
  const auto seconds = body.find("seconds");
  if (seconds == body.end()) return What(Silence{*what});
  if (!seconds->is_number() || !(seconds->get<double>() > 0) ||
      seconds->get<double>() > kLongestSilence)
    return Error{"'seconds' has to be a number above 0, at most a week"};
  return What(Silence{*what, from_seconds(seconds->get<double>())});
}

Expected<What> about_learning(const Json& body, const RuleSet& rules) {
  if (!body.contains("rule")) return What(Forget{});
  const auto rule = find<RuleId>(rules.rules, http::text_of(body, "rule"));
  if (!rule) return Error{"there is no such 'rule'; without one, all is forgotten"};
  return What(Forget{*rule});
}

Expected<What> read(const Json& body, const RuleSet& rules) {
  const std::string word = http::text_of(body, "order").value_or("");
  if (word == "pause") return What(Pause{});
  if (word == "resume") return What(Resume{});
  if (word == "dry_run") {
    const auto on = body.find("on");
    if (on == body.end() || !on->is_boolean()) return Error{"say whether it is 'on'"};
    return What(SetDryRun{on->get<bool>()});
  }
  if (word == "approve" || word == "refuse" || word == "propose" || word == "run")
    return about_strategy(word, body, rules);
  if (word == "silence" || word == "lift") return about_silence(word, body, rules);
  if (word == "forget") return about_learning(body, rules);
  if (word == "revive") return What(Revive{});
  if (word == "end_started") return What(EndStarted{});
  return Error{
      "'order' has to be pause, resume, dry_run, approve, refuse, propose, silence, lift, run, "
      "forget, revive or end_started"};
}

Expected<Order> read_order(const Json& body, const RuleSet& rules, std::uint64_t number) {
  const auto what = read(body, rules);
  if (!what) return Error{what.error()};
  const std::string author = http::text_of(body, "author").value_or("");
  const std::string reason = http::text_of(body, "reason").value_or("");
  if (author.empty()) return Error{"name the author: 'author'"};
  if (author.size() > kLongestText || reason.size() > kLongestText)
    return Error{"keep 'author' and 'reason' short"};
  Order order{number, escape_controls(author), escape_controls(reason), *what};
  return order;
}

// The caller was answered meanwhile that the order failed: for example culprit was stopped, and
// goes on now.
bool is_late(const Order& order, const Json& body) {
  const auto until = body.find("valid_until");
  return until != body.end() && until->is_number() &&
         seconds(live_now().time_since_epoch()) > until->get<double>() &&
         standing_of(order) != Standing::kRestrains;
}

// The manager's reply to the order of this number; empty: none came in time.
std::optional<Json> word_on(std::uint64_t number, http::Hub& hub, std::uint64_t after,
                            double patience) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience);
  while (true) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    const http::Hub::Batch batch = hub.wait(after, std::max(left, std::chrono::milliseconds(0)));
    for (const http::Message& message : batch.messages) {
      after = message.number;
      if (message.kind != http::Kind::kEvent || message.data->find("\"order_") == std::string::npos)
        continue;
      Json event = parse_json(*message.data);
      const std::string type = event.value("type", "");
      const bool is_word = type == "order_accepted" || type == "order_refused";
      if (is_word && event.value("number", std::uint64_t{0}) == number) return event;
    }
    if (hub.is_closed()) return std::nullopt;
    if (batch.messages.empty() && std::chrono::steady_clock::now() >= end) return std::nullopt;
  }
}

const RuleSet& no_rules() {
  static const RuleSet rules;
  return rules;
}

}  // namespace

void OrderDesk::open(const RuleSet& rules, std::function<void(Order)> submit) {
  const MutexLock lock(mutex_);
  rules_ = &rules;
  submit_ = std::move(submit);
  if (waiting_) submit_(*std::exchange(waiting_, std::nullopt));
}

void OrderDesk::close() {
  const MutexLock lock(mutex_);
  rules_ = nullptr;
  submit_ = nullptr;
}

void OrderDesk::submit(Order order) {
  if (rules_ != nullptr) return submit_(std::move(order));
  if (std::holds_alternative<Pause>(order.what)) waiting_ = std::move(order);
}

http::Answer OrderDesk::take(const Json& body) {
  // The rules that an order was read with must still be those of the manager that gets it.
  MutexLock lock(mutex_);
  const RuleSet& rules = rules_ == nullptr ? no_rules() : *rules_;
  auto order = read_order(body, rules, last_ + 1);
  const bool is_pause = order && std::holds_alternative<Pause>(order->what);
  if (rules_ == nullptr && !is_pause)
    return http::refuse(503, "the rules are being reloaded; ask again");
  if (!order) return http::refuse(400, order.error());
  if (is_late(*order, body))
    return http::refuse(408, "the order came too late, and is not followed");
  const std::uint64_t number = ++last_;
  if (standing_of(*order) != Standing::kNot) {
    const live::KeepOrder keep_it = keeping_(*order, rules);
    lock.unlock();
    return keep(keep_it, body, number);
  }
  submit(std::move(*order));
  // The manager decides; an event of this number says how.
  return {202, {{"number", number}}};
}

// Without the lock, for a disk may take its time, and nothing may delay a pause. So the rules may
// have been replaced before the order is given: it is read anew.
http::Answer OrderDesk::keep(const live::KeepOrder& keep, const Json& body, std::uint64_t number) {
  const live::Kept kept = keep([&] {
    const MutexLock lock(mutex_);
    auto order = read_order(body, rules_ == nullptr ? no_rules() : *rules_, number);
    if (order) submit(std::move(*order));
  });
  if (!kept.is_given)
    return http::refuse(
        503, "nothing changes, for the next culprit would not know of it: " + kept.why_not);
  return {202,
          {{"number", number},
           {"kept", kept.is_kept},
           {"text", kept.is_kept ? "kept" : "in force, not kept: " + kept.why_not}}};
}

http::Answer give_order(OrderDesk& desk, http::Hub& hub, const Json& body) {
  const std::uint64_t before = hub.last();
  http::Answer answer = desk.take(body);
  const auto wait = body.is_object() ? body.find("wait_s") : body.end();
  if (answer.status != 202 || wait == body.end() || !wait->is_number()) return answer;
  const double patience = std::clamp(wait->get<double>(), 0.0, kLongestWait);
  const auto word = word_on(answer.body["number"], hub, before, patience);
  if (!word) return answer;
  if (word->value("type", "") == "order_refused")
    return http::refuse(409, word->value("refused_because", "it is refused"));
  answer.status = 200;
  answer.body["order"] = word->value("text", "");
  return answer;
}

std::vector<http::Route> order_routes(OrderDesk& desk, http::Hub& hub) {
  return {{http::Method::kPost, "/api/orders",
           [&desk, &hub](const Json& body) { return give_order(desk, hub, body); },
           http::Role::kOperate}};
}

}  // namespace culprit::web
