// Decides which request is allowed. Web pages of other sites reach a server on this machine through
// the user's browser, so the source address alone does not decide.
//
// - Host has to name this server: an address, "localhost", or a name that was allowed. A page that
//   had its own name resolved to this machine (DNS rebinding) still sends its own name.
// - Origin, where a browser sends it, has to be this server's.
// - A token allows the calls of its role (look < operate < administer). A call that changes
//   anything needs one; from beyond this machine, every call does.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/expected.h"

namespace culprit::http {

// The rights of a token, in ascending order: each includes those before it.
enum class Role : std::uint8_t {
  kLook,       // see all, and ask about rules that are not in force
  kOperate,    // give orders, and have recordings made
  kAdminister  // change the rules, and reload them
};
// "look", "operate", "administer"
std::string_view to_string(Role role);

struct Access {
  std::string token;                       // to administer; never empty
  std::vector<std::string> allowed_hosts;  // names, beside addresses and "localhost"
  bool is_local = true;                    // only this machine can reach the server
  std::string operate_token{};             // empty: there is none
  std::string look_token{};                // likewise
  bool is_encrypted = false;               // the server speaks TLS

  // "Host: 127.0.0.1:8642"
  bool allows_host(std::string_view host) const;
  // `origin` as a browser sends it, empty if it sent none, with the Host of the same request.
  bool allows_origin(std::string_view origin, std::string_view host) const;
  // The role of "Authorization: Bearer <token>"; nothing: it is no token of this server. Takes as long for any wrong
  // token of the same length.
  std::optional<Role> role_of(std::string_view authorization) const;
};

bool is_loopback(std::string_view address);

// 128 random bits, as hexadecimal digits.
std::string make_token();

// The only line of a file that no other user can read: at least 16 characters without blanks.
// `what` it is, for messages. Errors: it cannot be read, is readable by others, or holds no such
// line.
Expected<std::string> read_secret(const std::string& path, const std::string& what = "token");

}  // namespace culprit::http
