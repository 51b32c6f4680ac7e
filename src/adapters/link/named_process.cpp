#include "link/named_process.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <span>
#include <sys/stat.h>
#include <system_error>

#include "base/component_mark.h"

namespace culprit::link {
namespace {

namespace fs = std::filesystem;

using Words = std::span<const std::string>;

std::vector<std::string> command_line_of(const fs::path& process) {
  std::vector<std::string> words;
  std::ifstream file(process / "cmdline", std::ios::binary);
  for (std::string word; std::getline(file, word, '\0');) words.push_back(word);
  return words;
}

bool is_of(unsigned user, const fs::path& process) {
  struct stat owner {};
  return stat(process.c_str(), &owner) == 0 && owner.st_uid == user;
}

// In the environment that the process was started with.
bool has_mark(const fs::path& process, const std::string& mark) {
  const std::string wanted = std::string(kComponentVariable) + "=" + mark;
  std::ifstream file(process / "environ", std::ios::binary);
  for (std::string variable; std::getline(file, variable, '\0');) {
    if (variable == wanted) return true;
  }
  return false;
}

// The parent: "4711".
std::string starter_of(const fs::path& process) {
  std::ifstream file(process / "stat");
  std::string stat;
  std::getline(file, stat);
  const std::size_t end = stat.rfind(')');  // of the name, which may hold anything
  if (end == std::string::npos || end + 4 >= stat.size()) return "none";
  return stat.substr(end + 4, stat.find(' ', end + 4) - end - 4);
}

// Unreadable for another user's process, which is then not proven.
bool has_middleware(const fs::path& process) {
  std::ifstream file(process / "maps");
  for (std::string line; std::getline(file, line);) {
    if (line.find("/librmw_") != std::string::npos) return true;
  }
  return false;
}

// As it was started, and with the program that this really is: "python3" is /usr/bin/python3.11.
bool is_started_as(const fs::path& process, std::vector<std::string> words,
                   const std::vector<std::string>& launch) {
  if (is_launched_as(words, launch)) return true;
  std::error_code error;
  const fs::path program = fs::read_symlink(process / "exe", error);
  if (error || words.empty()) return false;
  words[0] = program.string();
  return is_launched_as(words, launch);
}

// A program may be given with its folder in one of the two, and without in the other.
bool is_path_of(const std::string& path, const std::string& name) {
  return path == name || path.ends_with("/" + name) || name.ends_with("/" + path);
}

bool are_same(Words words, Words launch) {
  return words.size() == launch.size() && !words.empty() && is_path_of(words[0], launch[0]) &&
         std::equal(words.begin() + 1, words.end(), launch.begin() + 1);
}

// The value after "__node:=", also where it is meant for one node of several ("camera:__node:=").
std::string value_of(const std::string& word, const std::string& key) {
  const std::size_t at = word.find(key);
  const bool begins = at == 0 || (at != std::string::npos && word[at - 1] == ':');
  return begins ? word.substr(at + key.size()) : "";
}

}  // namespace

bool names_node(const std::vector<std::string>& words, const std::string& node) {
  const std::size_t slash = node.rfind('/');
  const std::string own = node.substr(slash + 1);
  const std::string its_space = slash == 0 ? "/" : node.substr(0, slash);
  bool is_named = false;
  std::string space = "/";
  for (const std::string& word : words) {
    is_named = is_named || value_of(word, "__node:=") == own || value_of(word, "__name:=") == own;
    if (const std::string given = value_of(word, "__ns:="); !given.empty()) space = given;
  }
  return is_named && space == its_space;
}

bool is_launched_as(const std::vector<std::string>& words, const std::vector<std::string>& launch) {
  if (words.empty() || launch.empty()) return false;
  const Words all(words);
  const auto fits = [&](Words expected) {
    return are_same(all, expected) || are_same(all.subspan(1), expected);
  };
  if (fits(launch)) return true;
  constexpr std::size_t kRosRun = 4;  // "ros2 run package program"
  if (launch.size() < kRosRun || !is_path_of(launch[0], "ros2") || launch[1] != "run") return false;
  std::vector<std::string> run = {"lib/" + launch[2] + "/" + launch[3]};
  run.insert(run.end(), launch.begin() + kRosRun, launch.end());
  return fits(run);
}

bool is_of_launch_file(const std::vector<std::string>& words,
                       const std::vector<std::string>& starter,
                       const std::vector<std::string>& launch, const std::string& node) {
  if (launch.empty() || launch[0].find(".launch.") == std::string::npos) return false;
  const std::string file = launch[0].substr(0, launch[0].find('#'));
  const auto has = [](const std::vector<std::string>& all, const std::string& name) {
    return std::ranges::any_of(all, [&](const std::string& word) {
      return fs::path(word).filename() == fs::path(name).filename();
    });
  };
  return has(starter, file) && has(words, node);
}

NamedProcess::NamedProcess(fs::path proc, unsigned user) : proc_(std::move(proc)), user_(user) {}

ros2::FoundProcess NamedProcess::find(const ros2::ParticipantInfo& participant,
                                      const std::vector<Sought>& nodes) const {
  std::vector<int> found;
  std::error_code error;
  for (fs::directory_iterator i(proc_, error); !error && i != fs::directory_iterator();
       i.increment(error)) {
    const std::string name = i->path().filename().native();
    int pid = 0;
    const auto [rest, trouble] = std::from_chars(name.data(), name.data() + name.size(), pid);
    if (trouble != std::errc() || rest != name.data() + name.size()) continue;
    constexpr int kAnnounced = 0xffff;  // the bits of a process id that Fast DDS announces
    if (participant.pid != 0 && (pid & kAnnounced) != participant.pid) continue;
    if (!is_of(user_, i->path())) continue;
    const std::vector<std::string> words = command_line_of(i->path());
    const bool fits = std::ranges::any_of(nodes, [&](const Sought& each) {
      return names_node(words, each.node) || is_started_as(i->path(), words, each.launch) ||
             (!each.mark.empty() && has_mark(i->path(), each.mark)) ||
             is_of_launch_file(words, command_line_of(proc_ / starter_of(i->path())), each.launch,
                               each.node);
    });
    if (fits && has_middleware(i->path())) found.push_back(pid);
  }
  if (found.size() == 1) return {found.front(), ""};
  const bool is_worth_a_word =
      std::ranges::any_of(nodes, [](const Sought& each) { return !each.mark.empty(); });
  if (!is_worth_a_word) return {};
  return {0, found.empty()
                 ? "no process of culprit's user on this machine has its LAUNCH or its node name "
                   "(__node:=) as its command line"
                 : "the command lines of several processes fit it"};
}

}  // namespace culprit::link
