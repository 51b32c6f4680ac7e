#include "terminal/other_tools.h"

#include <algorithm>
#include <array>
#include <utility>

namespace culprit {
namespace {

using OtherWords = std::vector<std::pair<std::string_view, std::string_view>>;

// The first meaning of `word` whose own first word is known; empty: there is none.
std::string_view translated(std::string_view word, const OtherWords& words,
                            const std::vector<std::string_view>& known) {
  for (const auto& [theirs, ours] : words) {
    const std::string_view first = ours.substr(0, ours.find(' '));
    if (theirs == word && std::ranges::find(known, first) != known.end()) return ours;
  }
  return "";
}

}  // namespace

std::string_view command_of_other_tools(std::string_view word,
                                        const std::vector<std::string_view>& known) {
  static const OtherWords kWords = {{"start", "run"},
                                    {"launch", "run"},
                                    {"up", "run"},
                                    {"apply", "run"},
                                    {"deploy", "run"},
                                    {"monitor", "run"},
                                    {"daemon", "run"},
                                    {"service", "run"},
                                    {"stop", "pause"},
                                    {"continue", "resume"},
                                    {"unpause", "resume"},
                                    {"ps", "status"},
                                    {"list", "status"},
                                    {"show", "status"},
                                    {"get", "status"},
                                    {"describe", "status"},
                                    {"watch", "top"},
                                    {"history", "log"},
                                    {"events", "log"},
                                    {"logs", "log"},
                                    {"journal", "log"},
                                    {"journalctl", "log"},
                                    {"tail", "log -f"},
                                    {"why", "explain"},
                                    {"lint", "check"},
                                    {"validate", "check"},
                                    {"verify", "check"},
                                    {"diagnose", "doctor"},
                                    {"disable", "mute"},
                                    {"unmute", "mute NAME --lift"},
                                    {"unsilence", "mute NAME --lift"},
                                    {"enable", "mute NAME --lift"},
                                    {"format", "fmt"},
                                    {"diff", "fmt --diff"},
                                    {"draft", "init"},
                                    {"generate", "init"},
                                    {"new", "init"},
                                    {"simulate", "test"},
                                    {"reject", "refuse"},
                                    {"deny", "refuse"},
                                    {"nodes", "graph"},
                                    {"topics", "graph"},
                                    {"restart", "run-strategy STRATEGY"},
                                    {"redeploy", "run-strategy STRATEGY"},
                                    {"repair", "run-strategy STRATEGY"},
                                    {"bag", "info"},
                                    {"web-ui", "web"},
                                    {"ui", "web"},
                                    {"edit", "web"}};
  return translated(word, kWords, known);
}

std::string_view option_of_other_tools(std::string_view option,
                                       const std::vector<std::string_view>& known) {
  static const OtherWords kWords = {
      {"--seconds", "--for"},   {"--seconds", "--wait"},     {"--duration", "--for"},
      {"--duration", "--wait"}, {"--time", "--for"},         {"--time", "--wait"},
      {"--timeout", "--wait"},  {"--follow", "--watch"},     {"--lines", "--last"},
      {"--out", "--output"},    {"--simulate", "--dry-run"}, {"--fault", "--kinds"},
      {"--until", "--for"},     {"--tail", "--lines"},       {"--count", "--lines"},
      {"--noop", "--dry-run"},  {"--name", "--component"},   {"--size", "--record-budget"},
      {"--only", "--filter"},   {"--follow", "--for"},       {"--node", "--component"},
      {"--faults", "--kinds"},  {"--component", "--only"},   {"--live", "--robot"},
      {"-n", "--dry-run"},      {"--token", "--token-file"}, {"--level", "--kind"},
      {"--limit", "--lines"},   {"-c", "--config"},          {"--host", "--address"},
      {"--name", "--filter"},   {"-k", "--filter"},          {"--last", "--since"},
      {"--timeout", "--for"},   {"--baseline", "--against"}, {"--severity", "--fail-on"},
      {"--level", "--fail-on"}, {"--remove", "--lift"},      {"--off", "--lift"},
      {"--cancel", "--lift"},   {"--end", "--lift"}};
  return translated(option, kWords, known);
}

std::string_view advice_about(std::string_view option, std::string_view command) {
  struct Advice {
    std::string_view option, command, text;  // command: empty for all
  };
  constexpr std::string_view kDomain = "set ROS_DOMAIN_ID, which every command heeds";
  constexpr std::string_view kEvents = "culprit log -f shows each event as it comes";
  constexpr std::string_view kService = "run it as a service of systemd (docs/install.md)";
  constexpr std::string_view kFile = "write > FILE behind the command";
  constexpr std::string_view kRosArguments =
      "leave it out, for culprit takes no arguments of ROS; see culprit run --help";
  constexpr std::string_view kList = "write mute list";
  constexpr std::string_view kAboutWarnings = "write --fail-on warning";
  constexpr std::string_view kLasting =
      "a pause lasts until culprit resume; culprit mute NAME --for 5min leaves one part alone";
  constexpr std::string_view kSends = "alerts only sends a test";
  constexpr std::string_view kWrites = "fmt writes the file unless --check or --diff is given";
  constexpr std::string_view kFindings =
      "doctor changes nothing; culprit explain and a code, such as D012, says what to do";
  constexpr std::string_view kLatest =
      "incident without an ID lists all; then write the ID of one of them";
  constexpr std::string_view kChecks =
      "culprit check RULES checks the file; run --dry-run only reports decisions";
  constexpr std::string_view kAtOnce = "leave it out: replay decides as fast as it can";
  constexpr auto kAdvice = std::to_array<Advice>({{"--werror", "check", kAboutWarnings},
                                                  {"--warnings-as-errors", "check", kAboutWarnings},
                                                  {"-W", "check", kAboutWarnings},
                                                  {"--for", "pause", kLasting},
                                                  {"--watch", "top", "leave it out: top is live"},
                                                  {"-d", "run", kService},
                                                  {"-d", "", kDomain},
                                                  {"--domain", "", kDomain},
                                                  {"--domain-id", "", kDomain},
                                                  {"--verbose", "run", kEvents},
                                                  {"-v", "run", kEvents},
                                                  {"--debug", "run", kEvents},
                                                  {"--log-level", "run", kEvents},
                                                  {"--ros-args", "", kRosArguments},
                                                  {"--write", "fmt", kWrites},
                                                  {"--in-place", "fmt", kWrites},
                                                  {"-i", "fmt", kWrites},
                                                  {"--dry-run", "alerts", kSends},
                                                  {"--list", "mute", kList},
                                                  {"--daemon", "run", kService},
                                                  {"--background", "run", kService},
                                                  {"--no-color", "", "set NO_COLOR=1"},
                                                  {"--fix", "doctor", kFindings},
                                                  {"--fix", "fmt", kWrites},
                                                  {"--last", "incident", kLatest},
                                                  {"--check", "run", kChecks},
                                                  {"--speed", "replay", kAtOnce},
                                                  {"--rate", "replay", kAtOnce},
                                                  {"--output", "", kFile},
                                                  {"-o", "", kFile}});
  for (const Advice& each : kAdvice) {
    if (each.option == option && (each.command.empty() || each.command == command))
      return each.text;
  }
  return "";
}

}  // namespace culprit
