#include "cli/running_culprit.h"

#include <csignal>
#include <fstream>
#include <pwd.h>
#include <unistd.h>

#include <fmt/core.h>

#include "base/name_grammar.h"

namespace culprit::cli {
namespace {

using live::LocalSocket;

std::string name_of_user(std::uint32_t user) {
  const passwd* entry = getpwuid(user);
  return entry != nullptr ? entry->pw_name : std::to_string(user);
}

// 'T' of a process that is stopped; 0: unknown. After the name, which may hold anything but ends with
// the last bracket (proc(5)).
char state_of_process(int process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(file, text);
  const std::size_t end = text.rfind(')');
  return end == std::string::npos || end + 2 >= text.size() ? '\0' : text[end + 2];
}

std::string why_silent(const LocalSocket& socket, const std::string& error) {
  const std::string who =
      fmt::format("the culprit of process {} (domain {})", socket.process, socket.domain);
  switch (socket.state) {
    case LocalSocket::State::kForbidden:
      return fmt::format("{} is of the user {}: sudo -u {} culprit status", who,
                         name_of_user(socket.user), name_of_user(socket.user));
    case LocalSocket::State::kLeft:
      return who +
             " has ended without a word: it was killed, or crashed; culprit log shows what it did";
    case LocalSocket::State::kListens:
      break;
  }
  if (state_of_process(socket.process) == 'T')
    return fmt::format("{} is stopped and does nothing: kill -CONT {} lets it go on", who,
                       socket.process);
  return fmt::format("{} does not answer: {}", who, error);
}

std::string text_in(const Json& json, const char* member) {
  return web::text_of(json, member).value_or("");
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
  command.add_option("--domain", domain, "The one on this DDS domain")
      ->check(CLI::Range(0, 232))
      ->group(kGroup);
  command.add_option("--node-name", node_name, "The one whose own node is called so: culprit_2")
      ->group(kGroup);
}

CulpritsHere culprits_here(const WhichCulprit& which) {
  ::signal(SIGPIPE, SIG_IGN);  // whoever is asked may hang up
  CulpritsHere here;
  for (const LocalSocket& socket : live::local_sockets()) {
    if (which.domain && socket.domain != *which.domain) continue;
    if (socket.state != LocalSocket::State::kListens) {
      here.others.push_back(why_silent(socket, ""));
      continue;
    }
    web::LocalClient client(socket.path, kPatienceWithCulprit);
    auto about = client.get("/api/about");
    if (!about) {
      here.others.push_back(why_silent(socket, about.error()));
    } else if (which.node_name.empty() || text_in(*about, "node") == which.node_name) {
      here.answering.push_back({socket.process, std::move(*about), std::move(client)});
    }
  }
  return here;
}

std::string none_to_ask(const CulpritsHere& here) {
  std::string text = "no culprit on this machine answers";
  for (const std::string& each : here.others) text += "\n  " + each;
  if (here.others.empty())
    text += ": none runs, or none that was asked for; culprit run my.rules starts one";
  return text;
}

Expected<RunningCulprit> the_culprit(const WhichCulprit& which) {
  CulpritsHere here = culprits_here(which);
  if (here.answering.empty()) return Error{none_to_ask(here)};
  if (here.answering.size() == 1) return std::move(here.answering.front());
  std::string text = "several culprits run here; choose one by --domain or --node-name:";
  for (const RunningCulprit& each : here.answering) text += "\n  " + each.name();
  return Error{text};
}

}  // namespace culprit::cli
