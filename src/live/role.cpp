#include "live/role.h"

#include <random>

#include "base/live_clock.h"
#include "manager/manager.h"

namespace culprit::live {
namespace {

std::int64_t random_id() {
  std::random_device random;
  return std::int64_t{random()} << 31 ^ random();
}

std::string advising(const std::string& where) {
  return "another culprit manages this robot" + where + "; this one only says what it would do";
}

}  // namespace

std::set<ComponentId> adapted_components(const RuleSet& rules) {
  std::set<ComponentId> all;
  for (const Strategy& strategy : rules.strategies)
    all.insert(strategy.components.begin(), strategy.components.end());
  return all;
}

RoleOfCulprit::RoleOfCulprit(const RuleSet& rules, std::uint32_t domain, std::string key)
    : domain_(domain),
      lease_{rules.robot, wall_now(), random_id(), {}, std::move(key)},
      claim_(name_of_claim("robot-" + rules.robot)) {
  if (claim_.look()) return;
  role_ = Role::kAdvise;
  manager_before_ = claim_.holder_pid();
  reason_ = advising(" (" + claim_.holder() + ")");
}

Expected<std::optional<journal::StandingOrders>> RoleOfCulprit::told_orders(
    const link::LeaseLink* lease) const {
  using Told = std::optional<journal::StandingOrders>;
  const auto text = lease != nullptr ? lease->told_orders() : std::nullopt;
  if (!text && !had_elder_) return Told();
  const auto orders = text ? journal::orders_from_text(*text, journal::clocks_now(live_now()))
                           : Expected<journal::StandingOrders>(Error{"it did not send them"});
  if (!orders)
    return Error{"the orders of the culprit that managed this robot before are unknown (" +
                 orders.error() + ")"};
  return Told(*orders);
}

std::optional<Expected<journal::Inheritance>> RoleOfCulprit::told_inheritance(
    const link::LeaseLink* lease, const RuleSet& rules, Time now) const {
  const auto told = lease != nullptr ? lease->told_state() : std::nullopt;
  if (told) return journal::inheritance_from_text(told->text, rules, told->shift, now);
  if (!had_elder_) return std::nullopt;
  return Error{"it did not send them"};
}

std::string RoleOfCulprit::name_of_claim(const std::string& what) const {
  return "manages-" + std::to_string(domain_) + "-" + what;
}

bool RoleOfCulprit::has_changed(const link::LeaseLink* lease, Time now, Time joined) {
  const auto elder = lease != nullptr ? lease->elder() : std::nullopt;
  const bool is_ours = claim_.look();
  const Role role = elder || !is_ours ? Role::kAdvise : Role::kManage;
  if (role == Role::kAdvise) manager_before_ = elder ? 0 : claim_.holder_pid();
  if (role == role_) return false;
  if (role == Role::kManage) {
    if (now < later(joined, Manager::kDiscovery)) return false;
    reason_ = "the other culprit is gone; this one manages the robot from now on";
    // More than any that it may be back with.
    if (lease != nullptr) lease_.term = std::max(lease_.term, lease->highest_term());
    ++lease_.term;
  } else {
    had_elder_ = elder.has_value();
    reason_ = advising(elder ? ", on " + *elder : " (" + claim_.holder() + ")");
  }
  role_ = role;
  return true;
}

std::map<std::string, std::string> RoleOfCulprit::managed_elsewhere(
    const std::set<std::string>& nodes, const link::LeaseLink* lease) {
  std::erase_if(node_claims_, [&](const auto& each) { return !nodes.contains(each.first); });
  std::map<std::string, std::string> elsewhere;
  for (const std::string& node : nodes) {
    HostClaim& claim = node_claims_.try_emplace(node, name_of_claim("node-" + node)).first->second;
    if (!claim.look()) {
      elsewhere[node] = claim.holder();
    } else if (const auto host = lease != nullptr ? lease->elder_at(node) : std::nullopt) {
      elsewhere[node] = "on " + *host;
    }
  }
  return elsewhere;
}

std::vector<std::string> RoleOfCulprit::warnings(const link::LeaseLink* lease) {
  std::vector<std::string> lines;
  const auto warn = [&](const std::string& line) {
    constexpr std::size_t kMost = 100;  // strangers choose what they are called
    if (warned_.size() < kMost && warned_.insert(line).second) lines.push_back(line);
  };
  const auto strangers = lease != nullptr ? lease->strangers() : std::vector<std::string>();
  for (const std::string& host : strangers)
    warn("a culprit on " + host + " claims to manage this robot or a node of it, and does not " +
         (lease_.key.empty()
              ? "prove it: give both the same --lease-key, or end one of them; this one continues"
              : "know the key of --lease-key; this one continues"));
  const auto squatter = [&](const HostClaim& claim, const std::string& what) {
    if (!claim.stranger().empty())
      warn(claim.stranger() + " holds the name that marks the manager of " + what +
           " on this machine, without the right to; end it; this one continues");
  };
  squatter(claim_, "this robot");
  for (const auto& [node, claim] : node_claims_) squatter(claim, node);
  return lines;
}

}  // namespace culprit::live
