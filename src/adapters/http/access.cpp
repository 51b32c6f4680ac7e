#include "http/access.h"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <random>
#include <sys/stat.h>

namespace culprit::http {
namespace {

constexpr std::size_t kShortestToken = 16;

// "[::1]:80" -> "::1", "localhost:80" -> "localhost"
std::string without_port(std::string_view host) {
  if (!host.empty() && host.front() == '[') {
    const auto end = host.find(']');
    return end == std::string_view::npos ? "" : std::string(host.substr(1, end - 1));
  }
  return std::string(host.substr(0, host.find(':')));
}

bool is_address(const std::string& text) {
  in6_addr address;
  return inet_pton(AF_INET, text.c_str(), &address) == 1 ||
         inet_pton(AF_INET6, text.c_str(), &address) == 1;
}

bool is_bearer_of(const std::string& token, std::string_view authorization) {
  const std::string expected = "Bearer " + token;
  if (token.empty() || authorization.size() != expected.size()) return false;
  unsigned char difference = 0;
  for (std::size_t i = 0; i < expected.size(); ++i)
    difference |= static_cast<unsigned char>(expected[i] ^ authorization[i]);
  return difference == 0;
}

}  // namespace

bool Access::allows_host(std::string_view host) const {
  const std::string name = without_port(host);
  return name == "localhost" || is_address(name) ||
         std::find(allowed_hosts.begin(), allowed_hosts.end(), name) != allowed_hosts.end();
}

bool Access::allows_origin(std::string_view origin, std::string_view host) const {
  return origin.empty() || origin == (is_encrypted ? "https://" : "http://") + std::string(host);
}

std::string_view to_string(Role role) {
  switch (role) {
    case Role::kLook:
      return "look";
    case Role::kOperate:
      return "operate";
    case Role::kAdminister:
      break;
  }
  return "administer";
}

std::optional<Role> Access::role_of(std::string_view authorization) const {
  std::optional<Role> role;
  // All are compared, so that the time does not show which one is near.
  if (is_bearer_of(look_token, authorization)) role = Role::kLook;
  if (is_bearer_of(operate_token, authorization)) role = Role::kOperate;
  if (is_bearer_of(token, authorization)) role = Role::kAdminister;
  return role;
}

bool is_loopback(std::string_view address) {
  return address == "localhost" || address == "::1" || address.substr(0, 4) == "127.";
}

std::string make_token() {
  std::random_device random;
  constexpr char kDigits[] = "0123456789abcdef";
  std::string token;
  for (int i = 0; i < 32; ++i) token += kDigits[random() % 16];
  return token;
}

Expected<std::string> read_secret(const std::string& path, const std::string& what) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0)
    return Error{"cannot read the " + what + " file '" + path + "': " + std::strerror(errno)};
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return Error{"others can read the " + what + " file '" + path + "'; chmod 600 it"};
  std::ifstream file(path);
  std::string token;
  std::getline(file, token);
  const bool has_blank = token.find_first_of(" \t\r") != std::string::npos;
  if (token.size() < kShortestToken || has_blank)
    return Error{"the " + what + " file '" + path + "' needs one line of " +
                 std::to_string(kShortestToken) + " characters or more, without blanks"};
  return token;
}

}  // namespace culprit::http
