#include "cli/running_culprit.h"

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <pwd.h>
#include <string_view>
#include <unistd.h>

#include <fmt/core.h>

#include "base/environment.h"
#include "base/name_grammar.h"
#include "base/process_stat.h"
#include "ros2/options.h"

namespace culprit::cli {
namespace {

using live::LocalSocket;

std::string name_of_user(std::uint32_t user) {
  const passwd* entry = getpwuid(user);
  return entry != nullptr ? entry->pw_name : std::to_string(user);
}

std::string why_silent(const LocalSocket& socket, const std::string& error) {
  const std::string name =
      fmt::format("the culprit of process {} (domain {})", socket.process, socket.domain);
  if (socket.state == LocalSocket::State::kLeft)
    return name +
           " has ended without a word: it was killed, or crashed; culprit log shows what it did";
  if (const auto stat = process_stat(std::to_string(socket.process)); stat && stat->state == 'T')
    return fmt::format("{} is stopped and does nothing: kill -CONT {} lets it go on", name,
                       socket.process);
  return fmt::format("{} does not answer: {}", name, error);
}

// How to ask those of another user.
std::string of_other_user(std::uint32_t user) {
  const std::string name = name_of_user(user);
  if (geteuid() == 0)
    return fmt::format("a socket of the user {0} was not asked: culprit status --user {0} asks it",
                       name);
  return fmt::format("a culprit of the user {0} runs here: sudo -u {0} culprit status", name);
}

std::string of_other_domain(std::uint32_t domain) {
  return fmt::format("a culprit on domain {0} was not asked: culprit status --domain {0} asks it",
                     domain);
}

Expected<std::uint32_t> user_called(const std::string& name) {
  if (const passwd* entry = getpwnam(name.c_str()); entry != nullptr) return entry->pw_uid;
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error == std::errc() && end == name.data() + name.size()) return number;
  return Error{"there is no user '" + printable(name) + "'"};
}

// The user behind sudo is asked, too: sudo says who that is, and only root could make it up.
Expected<live::CulpritQuery> query_of(const WhichCulprit& which) {
  live::CulpritQuery query;
  query.is_everybody = which.all;
  for (const std::string& name : {which.user, environment("SUDO_UID")}) {
    if (name.empty()) continue;
    const auto user = user_called(name);
    if (!user) return Error{user.error()};
    query.users.push_back(*user);
  }
  return query;
}

// Nothing: every domain is meant.
Expected<std::optional<std::uint32_t>> domain_meant(const WhichCulprit& which) {
  if (which.domain || which.all) return which.domain;
  const auto options = ros2::options_from_environment([](const char* name) -> const char* {
    return std::string_view(name) == "ROS_DOMAIN_ID" ? std::getenv(name) : nullptr;
  });
  if (!options) return Error{options.error()};
  return std::optional(options->domain);
}

void add_once(std::vector<std::string>& lines, std::string line) {
  if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(std::move(line));
}

std::string text_in(const Json& json, const char* member) {
  return http::text_of(json, member).value_or("");
}

}  // namespace

std::string RunningCulprit::name() const {
  const std::string robot = text_in(about, "robot");
  return fmt::format("culprit{} (process {}, domain {}, node /{})",
                     robot.empty() ? "" : " of " + printable(robot), process,
                     about.contains("domain") ? to_line(about["domain"]) : "?",
                     printable(text_in(about, "node")));
}

void WhichCulprit::add_to(CLI::App& command) {
  const std::string kGroup = "Where several culprits run on this machine";
  command
      .add_option("--domain", domain,
                  "The culprit on this DDS domain (default: ROS_DOMAIN_ID, or 0)")
      ->check(CLI::Range(0, 232))
      ->group(kGroup);
  command
      .add_option("--node-name", node_name, "The culprit with this node name, such as culprit_2")
      ->group(kGroup);
  command
      .add_option("--user", user,
                  "For root: the culprit of this user (default: root's, or that in /run/culprit)")
      ->type_name("USER")
      ->group(kGroup);
}

void WhichCulprit::add_all_to(CLI::App& command) {
  command.add_flag("--all", all,
                   "Each culprit of this machine: of every domain and, for root, of every user");
}

Expected<CulpritsHere> culprits_here(const WhichCulprit& which) {
  ::signal(SIGPIPE, SIG_IGN);  // the other side may hang up
  const auto query = query_of(which);
  if (!query) return Error{query.error()};
  const auto domain = domain_meant(which);
  if (!domain) return Error{domain.error()};
  CulpritsHere here;
  std::vector<LocalSocket> asked;
  std::vector<http::LocalClient> clients;
  for (LocalSocket& socket : live::local_sockets(*query)) {
    const bool is_meant = !*domain || socket.domain == **domain;
    if (socket.state == LocalSocket::State::kForbidden) {
      add_once(here.not_meant, of_other_user(socket.user));
    } else if (!is_meant) {
      if (socket.state == LocalSocket::State::kListens)
        add_once(here.not_meant, of_other_domain(socket.domain));
    } else if (socket.state == LocalSocket::State::kLeft) {
      here.others.push_back(why_silent(socket, ""));
    } else {
      clients.emplace_back(socket.path, kPatienceWithCulprit, socket.user);
      asked.push_back(std::move(socket));
    }
  }
  auto answers =
      http::LocalClient::ask_all(clients, http::Method::kGet, "/api/about", {}, kTimeToAnswer);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const LocalSocket& socket = asked[i];
    if (!answers[i] || answers[i]->status != 200) {
      here.others.push_back(
          why_silent(socket, answers[i] ? "it refuses to name itself" : answers[i].error()));
    } else if (Json& about = answers[i]->body;
               which.node_name.empty() || text_in(about, "node") == which.node_name) {
      here.answering.push_back({socket.process, std::move(about), std::move(clients[i])});
    }
  }
  return here;
}

std::string none_to_ask(const CulpritsHere& here) {
  std::string text = "no culprit on this machine answers";
  for (const auto* list : {&here.others, &here.not_meant}) {
    for (const std::string& each : *list) text += "\n  " + each;
  }
  if (here.others.empty() && here.not_meant.empty())
    text += "; start one with: culprit run my.rules";
  return text;
}

std::string several_to_choose(const CulpritsHere& here) {
  std::string text = "several culprits run here; choose one by --domain or --node-name:";
  for (const RunningCulprit& each : here.answering) text += "\n  " + each.name();
  return text;
}

Expected<RunningCulprit> the_culprit(const WhichCulprit& which) {
  auto here = culprits_here(which);
  if (!here) return Error{here.error()};
  if (here->answering.empty()) return Error{none_to_ask(*here)};
  if (here->answering.size() == 1) return std::move(here->answering.front());
  return Error{several_to_choose(*here)};
}

}  // namespace culprit::cli
