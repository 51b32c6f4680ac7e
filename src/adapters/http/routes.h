// The calls of the API, apart from how they travel: a method, a path, and what is answered to a
// JSON document. docs/web.md describes them for people, openapi.json for programs.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "http/access.h"
#include "json/json.h"

namespace culprit::http {

struct Answer {
  struct Text {
    std::string type;  // of the content, as HTTP names it
    std::string content;
    std::string policy{};  // what the content may do (CSP); empty: as the app
  };
  struct File {
    std::string path;
    std::string type;  // likewise
    std::string name;  // under which browsers keep it
  };
  int status = 200;
  Json body = Json::object();
  std::optional<Text> text{};  // instead of the body
  std::optional<File> file{};  // likewise; it is sent piece by piece, however large it is
};

// {"error": "..."}: the fault and the remedy.
Answer refuse(int status, const std::string& message);

enum class Method : std::uint8_t { kGet, kPost, kPut, kDelete };
// "get", "post", "put", "delete"
std::string_view to_string(Method method);

struct Route {
  Method method = Method::kGet;
  std::string path;  // "/api/rules"; nothing in it varies
  // `body` is what was sent, without a member that was sent twice; of kGet the texts behind the '?' of the address, by name; null if nothing was sent.
  // Called from many threads at once.
  std::function<Answer(const Json& body)> answer;
  // The role that it needs. Nothing: kLook for kGet, kAdminister for all others.
  std::optional<Role> needs{};

  Role role() const {
    return needs.value_or(method == Method::kGet ? Role::kLook : Role::kAdminister);
  }
};

// Whether the client of the request that this thread serves has shown a token, or is of culprit's own user.
bool client_has_token();

// The text at `member` of what was sent; nothing if it is none.
std::optional<std::string> text_of(const Json& body, const char* member);

}  // namespace culprit::http
