#include "alerts/settings.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <set>
#include <stdexcept>
#include <sys/stat.h>

#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include "base/closest.h"
#include "base/joined.h"
#include "base/name_grammar.h"
#include "base/text_file.h"

namespace culprit::alerts {
namespace {

constexpr std::size_t kLongestFile = 64 << 10;  // bytes
constexpr Duration kLongestWait = std::chrono::hours(1);

// Leaves the reader at the first thing that is wrong; yaml-cpp's own errors leave it likewise.
struct WrongSettings : std::runtime_error {
  WrongSettings(const YAML::Mark& at, const std::string& what)
      : std::runtime_error(what), mark(at) {}
  YAML::Mark mark;
};

[[noreturn]] void refuse(const YAML::Node& at, const std::string& what) {
  throw WrongSettings(at.Mark(), what);
}

std::string word_of(const YAML::Node& node, const std::string& what) {
  if (!node.IsScalar() || node.Scalar().empty()) refuse(node, what + " is not a word");
  return node.Scalar();
}

// The keys of a mapping are of these, each once.
void check_keys(const YAML::Node& map, const std::vector<std::string_view>& known) {
  if (!map.IsMap()) refuse(map, "this has to be a mapping: 'key: value'");
  std::set<std::string> seen;
  for (const auto& entry : map) {
    const std::string key = word_of(entry.first, "a key");
    const std::string near = closest(key, known);
    if (std::find(known.begin(), known.end(), key) == known.end())
      refuse(entry.first,
             "there is no setting '" + printable(key) + "'; " +
                 (near.empty() ? "there are " + joined(known) : "did you mean '" + near + "'?"));
    if (!seen.insert(key).second) refuse(entry.first, key + " is there twice");
  }
}

void read_webhook(const YAML::Node& node, Destination::Kind kind, Destination& destination) {
  destination.kind = kind;
  destination.url = word_of(node, "the address");
  if (const auto url = read_url(destination.url); !url) refuse(node, url.error());
}

void read_command(const YAML::Node& node, Destination& destination) {
  destination.kind = Destination::Kind::kCommand;
  if (!node.IsSequence() || node.size() == 0)
    refuse(node, "a command is a list, the program first: [/usr/bin/logger, --priority, alert]");
  for (const YAML::Node& word : node) {
    if (!word.IsScalar()) refuse(word, "an argument has to be a word");
    destination.command.push_back(word.Scalar());
  }
  if (destination.command.front().empty()) refuse(node, "the program has no name");
}

Destination read_destination(const YAML::Node& node) {
  check_keys(node, {"slack", "alertmanager", "json", "command", "ca", "when"});
  Destination destination;
  int kinds = 0;
  for (const auto& [key, kind] : {std::pair("slack", Destination::Kind::kSlack),
                                  std::pair("alertmanager", Destination::Kind::kAlertmanager),
                                  std::pair("json", Destination::Kind::kJson)}) {
    if (!node[key]) continue;
    read_webhook(node[key], kind, destination);
    ++kinds;
  }
  if (node["command"]) {
    read_command(node["command"], destination);
    ++kinds;
  }
  if (kinds != 1) refuse(node, "name one of slack, alertmanager, json and command");
  if (node["ca"]) destination.ca = word_of(node["ca"], "ca");
  if (node["when"]) {
    const std::string when = word_of(node["when"], "when");
    if (when != "person" && when != "always") refuse(node["when"], "'when' is person, or always");
    destination.only_for_person = when == "person";
  }
  return destination;
}

Settings read_document(const YAML::Node& root) {
  check_keys(root, {"page", "wait", "to"});
  Settings settings;
  if (root["page"]) {
    settings.page = word_of(root["page"], "page");
    if (const auto url = read_url(settings.page); !url) refuse(root["page"], url.error());
  }
  if (root["wait"]) {
    const auto wait = parse_duration(word_of(root["wait"], "wait"));
    if (!wait) refuse(root["wait"], wait.error());
    if (*wait < Duration::zero() || *wait > kLongestWait)
      refuse(root["wait"], "'wait' is from 0s to " + to_string(kLongestWait));
    settings.wait = *wait;
  }
  if (!root["to"] || !root["to"].IsSequence() || root["to"].size() == 0)
    refuse(root, "there has to be a list 'to' of where alerts go, as in docs/alerts.md");
  for (const YAML::Node& each : root["to"]) settings.to.push_back(read_destination(each));
  return settings;
}

}  // namespace

std::string Destination::name() const {
  constexpr const char* kWords[] = {"slack", "alertmanager", "json", "command"};
  const std::string word = kWords[static_cast<std::size_t>(kind)];
  if (kind == Kind::kCommand) return word + " " + printable(command.front());
  const auto read = read_url(url);
  return word + " at " + (read ? printable(read->host) : "?");
}

Expected<Url> read_url(const std::string& text) {
  const bool is_plain = text.starts_with("http://");
  if (!is_plain && !text.starts_with("https://"))
    return Error{"an address begins with http:// or https://"};
  const std::size_t begin = is_plain ? 7 : 8;
  const std::size_t end = std::min(text.find_first_of("/?#", begin), text.size());
  const std::string authority = text.substr(begin, end - begin);
  const bool is_odd = text.find_first_of(" \t\r\n\"<>\\") != std::string::npos ||
                      authority.find('@') != std::string::npos;
  if (authority.empty() || is_odd)
    return Error{"an address has a host, and neither blanks nor a user: https://example.org/hook"};
  // [::1]:80
  const std::size_t colon = authority.find(':', authority.front() == '[' ? authority.find(']') : 0);
  if (colon != std::string::npos) {
    int port = 0;
    const char* last = authority.data() + authority.size();
    const auto [stop, error] = std::from_chars(authority.data() + colon + 1, last, port);
    if (error != std::errc() || stop != last || port < 1 || port > 65535)
      return Error{"the port of an address is a number from 1 to 65535"};
  }
  std::string path = text.substr(end);
  if (path.empty() || path.front() != '/') path.insert(0, "/");
  return Url{text.substr(0, end), authority.substr(0, colon), path.substr(0, path.find('#'))};
}

Expected<Settings> read_settings(const std::string& path) {
  if (path.ends_with(".rules"))
    return Error{fmt::format(
        "'{}' is a rule file; the receivers of alerts stand in a file of their own", path)};
  if (read_url(path))
    return Error{
        "an address is a secret: write it into a private file, and name that (docs/alerts.md)"};
  struct stat status {};
  if (stat(path.c_str(), &status) != 0)
    return Error{fmt::format(
        "cannot read '{}': {}; name the file with the receivers of alerts (docs/alerts.md)", path,
        std::strerror(errno))};
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return Error{fmt::format(
        "others can read '{}', and the addresses in it are secrets; chmod 600 it", path)};
  const auto text = read_text(path);
  if (!text) return Error{text.error()};
  if (text->size() > kLongestFile) return Error{fmt::format("'{}' is too long to be read", path)};
  try {
    return read_document(YAML::Load(*text));
  } catch (const WrongSettings& wrong) {
    return Error{fmt::format("{}:{}: {}", path, std::max(wrong.mark.line + 1, 1), wrong.what())};
  } catch (const YAML::Exception& error) {
    // Not its what(): that may hold the line, and the line a secret.
    return Error{fmt::format("{}:{}: this is no YAML: {}", path, error.mark.line + 1, error.msg)};
  }
}

}  // namespace culprit::alerts
