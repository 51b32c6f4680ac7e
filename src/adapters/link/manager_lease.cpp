#include "link/manager_lease.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <utility>

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include "base/ros_names.h"
#include "ros2/service_mapping.h"

namespace culprit::link {
namespace {

std::optional<std::int64_t> number_in(std::string_view text) {
  std::int64_t number = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_whole = failed == std::errc() && end == text.data() + text.size();
  return is_whole ? std::optional(number) : std::nullopt;
}

std::string claim_text(const std::string& robot, std::int64_t since, std::int64_t id,
                       std::int64_t term, std::string_view nodes) {
  return "robot=" + robot + ";since=" + std::to_string(since) + ";id=" + std::to_string(id) +
         ";term=" + std::to_string(term) + ";nodes=" + std::string(nodes) + ";";
}

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> names;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(','), text.size());
    names.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return names;
}

// In hexadecimal. `kind`: so that none can be taken for the other.
std::string proof_of(const char* kind, std::string_view text, const rtps::GuidPrefix& participant,
                     const std::string& key) {
  std::string signed_text = std::string("culprit ") + kind + "\n" + std::string(text);
  signed_text.append(reinterpret_cast<const char*>(participant.bytes.data()),
                     participant.bytes.size());
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()),
       reinterpret_cast<const unsigned char*>(signed_text.data()), signed_text.size(),
       digest.data(), &size);
  std::string proof;
  constexpr const char* kDigits = "0123456789abcdef";
  for (unsigned i = 0; i < size; ++i) {
    proof += kDigits[digest[i] >> 4];
    proof += kDigits[digest[i] & 0xf];
  }
  return proof;
}

constexpr const char* kClaim = "lease";
constexpr const char* kBeat = "beat";
constexpr const char* kState = "state";
constexpr std::int64_t kStateVersion = 1;

// Takes "key value;" from the beginning of `rest`; empty, and nothing taken, if it does not begin so.
std::string_view take(std::string_view key, std::string_view& rest) {
  if (!rest.starts_with(key)) return {};
  const std::size_t end = rest.find(';');
  if (end == std::string_view::npos) return {};
  const std::string_view value = rest.substr(key.size(), end - key.size());
  rest.remove_prefix(end + 1);
  return value;
}

bool are_same(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

bool is_same_node(const std::string& a, const std::string& b) {
  const bool any_namespace = a.starts_with("*/") || b.starts_with("*/");
  return any_namespace ? own_name(a) == own_name(b) : a == b;
}

bool has_node(const std::vector<std::string>& nodes, const std::string& node) {
  return std::any_of(nodes.begin(), nodes.end(),
                     [&](const std::string& each) { return is_same_node(each, node); });
}

}  // namespace

std::vector<std::string> ManagerLease::announcements() const {
  constexpr std::size_t kRoom = 600;  // of the 1024 bytes that are read (participant.h)
  std::vector<std::string> parts(1);
  for (const std::string& node : own_.nodes) {
    if (!parts.back().empty() && parts.back().size() + node.size() > kRoom) parts.emplace_back();
    parts.back() += (parts.back().empty() ? "" : ",") + node;
  }
  for (std::string& part : parts) {
    part = claim_text(own_.robot, own_.since, own_.id, own_.term, part);
    if (!own_.key.empty()) part += "proof=" + proof_of(kClaim, part, self_, own_.key) + ";";
  }
  return parts;
}

bool ManagerLease::concerns_us(const Other& other) const {
  return other.robot == own_.robot ||
         std::any_of(other.nodes.begin(), other.nodes.end(),
                     [&](const std::string& node) { return has_node(own_.nodes, node); });
}

void ManagerLease::apply(const ros2::DiscoveryEvent& event, Time now) {
  if (const auto* endpoint = std::get_if<rtps::EndpointInfo>(&event)) {
    if (endpoint->topic != kTopic || endpoint->guid.is_reader()) return;
    const auto value = [&](const char* key) {
      return ros2::user_data_value(endpoint->user_data, key);
    };
    const auto since = number_in(value("since"));
    const auto id = number_in(value("id"));
    const auto term = number_in(value("term"));
    if (!since || !id || !term) return;
    Other other{std::string(value("robot")), *term, {*since, *id}, split(value("nodes")), false};
    if (!concerns_us(other)) return;
    const std::string claim = claim_text(other.robot, *since, *id, *term, value("nodes"));
    const rtps::GuidPrefix prefix = endpoint->guid.prefix();
    other.is_proven =
        !own_.key.empty() && are_same(value("proof"), proof_of(kClaim, claim, prefix, own_.key));
    if (!other.is_proven) {
      // A stranger that uses the GUID of a proven writer does not cancel its proof.
      const auto known = others_.find(endpoint->guid);
      const bool is_borrowed = known != others_.end() && known->second.is_proven;
      if (is_borrowed || strangers().size() >= kMostStrangers) return;
    }
    if (other.is_proven) {
      lives_.try_emplace(prefix, Life{now});
      has_friends_ = true;
      if (other.robot == own_.robot) highest_term_ = std::max(highest_term_, other.term);
    }
    others_[endpoint->guid] = std::move(other);
  } else if (const auto* gone = std::get_if<rtps::EndpointGone>(&event)) {
    others_.erase(gone->guid);
  } else if (const auto* left = std::get_if<ros2::ParticipantGone>(&event)) {
    std::erase_if(others_,
                  [&](const auto& other) { return other.first.prefix() == left->guid.prefix(); });
    lives_.erase(left->guid.prefix());
    rounds_.erase(left->guid.prefix());
  }
}

std::optional<std::string> ManagerLease::beat(Time now, bool hears, bool manages,
                                              const std::string& orders) {
  if (!hears || now > later(ticked_, kAway)) hears_since_ = now;
  ticked_ = now;
  manages_ = manages;
  if (own_.key.empty() || !hears) return std::nullopt;
  if (said_ && now > later(*said_, kAway)) listens_until_ = later(now, kListen);
  said_ = now;
  std::string text =
      "count=" + std::to_string(++beats_) + ";manages=" + (manages ? "1" : "0") + ";";
  if (manages && orders.size() <= kLongestBeat - 1024) text += "orders=" + orders;
  return "proof=" + proof_of(kBeat, text, self_, own_.key) + ";" + text;
}

void ManagerLease::take_over(std::int64_t term) {
  own_.term = term;
  told_orders_.reset();
  told_state_.reset();
  rounds_.clear();
}

// ---- what a successor has to know

void ManagerLease::tell_state(std::string state) {
  if (state.size() > kLongestState) state.clear();
  if (state == state_) return;
  state_ = std::move(state);
  is_state_new_ = true;
}

// A round that has begun is sent to its end, however often there is something new.
std::vector<std::string> ManagerLease::state_parts(Time now) {
  std::vector<std::string> parts;
  if (own_.key.empty() || !manages_ || !has_friends_) return parts;
  if (next_part_ == parts_) {
    const bool is_due = is_state_new_ || now >= later(round_began_, kStatePeriod);
    if (!is_due || state_.empty()) return parts;
    is_state_new_ = false;
    round_state_ = state_;
    round_began_ = now;
    ++round_;
    next_part_ = 0;
    parts_ = (round_state_.size() + kLongestPart - 1) / kLongestPart;
  }
  for (; next_part_ < parts_ && parts.size() < kPartsAtOnce; ++next_part_) {
    std::string text = "state=" + std::to_string(kStateVersion) +
                       ";round=" + std::to_string(round_) + ";part=" + std::to_string(next_part_) +
                       ";of=" + std::to_string(parts_) +
                       ";clock=" + std::to_string(now.time_since_epoch().count()) + ";";
    text += round_state_.substr(next_part_ * kLongestPart, kLongestPart);
    parts.push_back("proof=" + proof_of(kState, text, self_, own_.key) + ";" + text);
  }
  return parts;
}

// `part`: the text after the proof. Its clock is of when it was written, so that the way here is
// all that the shift is wrong by.
void ManagerLease::hear_state(const rtps::GuidPrefix& participant, std::string_view proof,
                              std::string_view part, Time now) {
  if (!are_same(proof, proof_of(kState, part, participant, own_.key))) return;
  std::string_view rest = part;
  const auto version = number_in(take("state=", rest));
  const auto number = number_in(take("round=", rest));
  const auto place = number_in(take("part=", rest));
  const auto count = number_in(take("of=", rest));
  const auto clock = number_in(take("clock=", rest));
  const auto most = static_cast<std::int64_t>(kMostParts);
  if (version != kStateVersion || !number || !place || !count || !clock) return;
  if (*number <= 0 || *count < 1 || *count > most || *place < 0 || *place >= *count) return;
  std::int64_t shift = 0;
  if (__builtin_sub_overflow(now.time_since_epoch().count(), *clock, &shift)) return;
  Round& round = rounds_[participant];
  if (static_cast<std::uint64_t>(*number) < round.number) return;
  if (static_cast<std::uint64_t>(*number) > round.number) {
    round.number = static_cast<std::uint64_t>(*number);
    round.parts.assign(static_cast<std::size_t>(*count), std::nullopt);
  }
  if (round.parts.size() != static_cast<std::size_t>(*count)) return;
  round.parts[static_cast<std::size_t>(*place)] = std::string(rest);
  std::string text;
  for (const auto& each : round.parts) {
    if (!each) return;
    text += *each;
  }
  told_state_ = {std::move(text), Duration(shift)};
  round.parts.clear();  // complete
}

void ManagerLease::hear(const rtps::GuidPrefix& participant, std::string_view beat, Time now) {
  const auto life = lives_.find(participant);
  const auto other = std::find_if(others_.begin(), others_.end(), [&](const auto& each) {
    return each.first.prefix() == participant && each.second.is_proven;
  });
  if (life == lives_.end() || other == others_.end() || beat.size() > kLongestBeat) return;
  std::string_view rest = beat;
  const std::string_view proof = take("proof=", rest);
  if (rest.starts_with("state=")) {
    if (other->second.robot == own_.robot) hear_state(participant, proof, rest, now);
    return;
  }
  if (!are_same(proof, proof_of(kBeat, rest, participant, own_.key))) return;
  const auto count = number_in(take("count=", rest));
  const bool manages = take("manages=", rest) == "1";
  if (!count || static_cast<std::uint64_t>(*count) <= life->second.beats) return;
  life->second = {now, static_cast<std::uint64_t>(*count)};
  if (!manages || other->second.robot != own_.robot) return;
  constexpr std::string_view kOrders = "orders=";
  told_orders_ = rest.starts_with(kOrders) ? std::string(rest.substr(kOrders.size())) : "";
}

Time ManagerLease::sure_until(Time now) const {
  if (!has_friends_ || !manages_ || !said_) return kNever;
  return now < listens_until_ ? kLongAgo : later(*said_, kAway);
}

// While nothing is received, no other culprit counts as exited.
bool ManagerLease::is_alive(const rtps::GuidPrefix& participant, Time now) const {
  const bool slept = now > later(ticked_, kAway);
  const auto life = lives_.find(participant);
  return slept || life == lives_.end() ||
         now <= later(std::max(life->second.heard, hears_since_), kPatience);
}

// A claim of the same age is of this process, which rejoins the domain at times.
template <class Predicate, class Order>
std::optional<rtps::GuidPrefix> ManagerLease::first(Time now, const IsLeftOut& is_left_out,
                                                    Predicate is_rival, Order order) const {
  std::optional<rtps::GuidPrefix> found;
  auto best = order(Other{own_.robot, own_.term, own_age(), {}, true});
  for (const auto& [guid, other] : others_) {
    if (!other.is_proven || other.age == own_age() || order(other) >= best || !is_rival(other))
      continue;
    if (!is_alive(guid.prefix(), now)) continue;
    if (is_left_out && is_left_out(guid.prefix())) continue;
    best = order(other);
    found = guid.prefix();
  }
  return found;
}

std::optional<rtps::GuidPrefix> ManagerLease::elder(Time now, const IsLeftOut& is_left_out) const {
  return first(
      now, is_left_out, [&](const Other& other) { return other.robot == own_.robot; },
      [](const Other& other) { return other.rank(); });
}

std::optional<rtps::GuidPrefix> ManagerLease::elder_at(const std::string& node, Time now,
                                                       const IsLeftOut& is_left_out) const {
  return first(
      now, is_left_out,
      [&](const Other& other) { return other.robot != own_.robot && has_node(other.nodes, node); },
      [](const Other& other) { return other.age; });
}

std::vector<rtps::GuidPrefix> ManagerLease::strangers(const IsLeftOut& is_left_out) const {
  std::vector<rtps::GuidPrefix> found;
  for (const auto& [guid, other] : others_) {
    const bool is_own = other.age == own_age();
    if (other.is_proven || is_own || (is_left_out && is_left_out(guid.prefix()))) continue;
    found.push_back(guid.prefix());
  }
  return found;
}

}  // namespace culprit::link
