#include "ros2/manager_lease.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <utility>

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include "language/ros_names.h"
#include "ros2/service_mapping.h"

namespace culprit::ros2 {
namespace {

std::optional<std::int64_t> number_in(std::string_view text) {
  std::int64_t number = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_whole = failed == std::errc() && end == text.data() + text.size();
  return is_whole ? std::optional(number) : std::nullopt;
}

std::string claim_text(const std::string& robot, std::int64_t since, std::int64_t id,
                       std::string_view nodes) {
  return "robot=" + robot + ";since=" + std::to_string(since) + ";id=" + std::to_string(id) +
         ";nodes=" + std::string(nodes) + ";";
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

// In hexadecimal.
std::string proof_of(const std::string& claim, const GuidPrefix& participant,
                     const std::string& key) {
  std::string signed_text = "culprit lease\n" + claim;
  signed_text.append(reinterpret_cast<const char*>(participant.bytes.data()),
                     participant.bytes.size());
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()),
       reinterpret_cast<const unsigned char*>(signed_text.data()), signed_text.size(),
       digest.data(), &size);
  std::string text;
  constexpr const char* kDigits = "0123456789abcdef";
  for (unsigned i = 0; i < size; ++i) {
    text += kDigits[digest[i] >> 4];
    text += kDigits[digest[i] & 0xf];
  }
  return text;
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
    part = claim_text(own_.robot, own_.since, own_.id, part);
    if (!own_.key.empty()) part += "proof=" + proof_of(part, self_, own_.key) + ";";
  }
  return parts;
}

bool ManagerLease::concerns_us(const Other& other) const {
  return other.robot == own_.robot ||
         std::any_of(other.nodes.begin(), other.nodes.end(),
                     [&](const std::string& node) { return has_node(own_.nodes, node); });
}

void ManagerLease::apply(const DiscoveryEvent& event) {
  if (const auto* endpoint = std::get_if<EndpointInfo>(&event)) {
    if (endpoint->topic != kTopic || endpoint->guid.is_reader()) return;
    const auto value = [&](const char* key) { return user_data_value(endpoint->user_data, key); };
    const auto since = number_in(value("since"));
    const auto id = number_in(value("id"));
    if (!since || !id) return;
    Other other{std::string(value("robot")), {*since, *id}, split(value("nodes")), false};
    if (!concerns_us(other)) return;
    const std::string claim = claim_text(other.robot, *since, *id, value("nodes"));
    other.is_proven = !own_.key.empty() &&
                      are_same(value("proof"), proof_of(claim, endpoint->guid.prefix(), own_.key));
    if (other.is_proven || strangers().size() < kMostStrangers)
      others_[endpoint->guid] = std::move(other);
  } else if (const auto* gone = std::get_if<EndpointGone>(&event)) {
    others_.erase(gone->guid);
  } else if (const auto* left = std::get_if<ParticipantGone>(&event)) {
    std::erase_if(others_,
                  [&](const auto& other) { return other.first.prefix() == left->guid.prefix(); });
  }
}

// A claim of the same rank is of this process, which joins the domain anew at times.
template <class Predicate>
std::optional<GuidPrefix> ManagerLease::first(const IsLeftOut& is_left_out,
                                              Predicate is_rival) const {
  std::optional<GuidPrefix> found;
  Rank best(own_.since, own_.id);
  for (const auto& [guid, other] : others_) {
    if (!other.is_proven || other.rank >= best || !is_rival(other)) continue;
    if (is_left_out && is_left_out(guid.prefix())) continue;
    best = other.rank;
    found = guid.prefix();
  }
  return found;
}

std::optional<GuidPrefix> ManagerLease::elder(const IsLeftOut& is_left_out) const {
  return first(is_left_out, [&](const Other& other) { return other.robot == own_.robot; });
}

std::optional<GuidPrefix> ManagerLease::elder_at(const std::string& node,
                                                 const IsLeftOut& is_left_out) const {
  return first(is_left_out, [&](const Other& other) {
    return other.robot != own_.robot && has_node(other.nodes, node);
  });
}

std::vector<GuidPrefix> ManagerLease::strangers(const IsLeftOut& is_left_out) const {
  std::vector<GuidPrefix> found;
  for (const auto& [guid, other] : others_) {
    const bool is_own = other.rank == Rank(own_.since, own_.id);
    if (other.is_proven || is_own || (is_left_out && is_left_out(guid.prefix()))) continue;
    found.push_back(guid.prefix());
  }
  return found;
}

}  // namespace culprit::ros2
