#include "link/name_contests.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <unistd.h>

#include "base/name_grammar.h"

namespace culprit::link {
namespace {

std::string read_whole(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// "process 99 (ros2 launch robot.launch.py)". A command line is the process's own claim.
std::string process_in_words(int pid) {
  constexpr std::size_t kLongest = 120;
  std::string command = read_whole("/proc/" + std::to_string(pid) + "/cmdline");
  while (!command.empty() && command.back() == '\0') command.pop_back();
  std::replace(command.begin(), command.end(), '\0', ' ');
  if (command.size() > kLongest) command = command.substr(0, kLongest) + "...";
  return "process " + std::to_string(pid) +
         (command.empty() ? "" : " (" + printable(command) + ")");
}

// 0: it is gone.
int parent_of(int pid) {
  const std::string stat = read_whole("/proc/" + std::to_string(pid) + "/stat");
  const std::size_t end = stat.rfind(')');  // of the name, which may hold anything
  return end + 4 < stat.size() ? std::atoi(stat.c_str() + end + 4) : 0;
}

std::string holders_in_words(const std::vector<ros2::GraphNode>& nodes) {
  if (nodes.size() < 2) return "";
  std::string text;
  std::string others;
  for (const ros2::GraphNode& node : nodes) {
    text += text.empty() ? "" : "; ";
    if (node.pid == 0) {
      text += node.host.empty() ? "one on another machine" : "one on " + printable(node.host);
      continue;
    }
    const int parent = parent_of(node.pid);
    text += process_in_words(node.pid);
    if (parent == getpid()) {
      text += ", started by this culprit";
    } else {
      if (parent > 1) text += ", started by " + process_in_words(parent);
      others += " " + std::to_string(node.pid);
    }
  }
  text += ". culprit does not act on it until one is left: end the extra one";
  if (!others.empty()) text += " (kill" + others + (others.rfind(' ') > 0 ? ": one of them)" : ")");
  return text + ", and if a launch file starts it again, set respawn to False there";
}

}  // namespace

void NameContests::seen(const ros2::NodeNamesakes& seen, bool is_ours, Time now) {
  std::vector<int> processes;
  for (const ros2::GraphNode& node : seen.all) processes.push_back(node.pid);
  const std::string text =
      "several nodes have the name " + seen.node + ": " + holders_in_words(seen.all);
  const MutexLock lock(mutex_);
  contests_.erase(seen.node);
  processes_.erase(seen.node);
  if (seen.others == 0) return;
  processes_[seen.node] = std::move(processes);
  if (is_ours) contests_[seen.node] = {text, later(now, kSettles)};
}

std::map<std::string, std::string> NameContests::texts() const {
  const MutexLock lock(mutex_);
  std::map<std::string, std::string> all;
  for (const auto& [node, contest] : contests_) all[node] = contest.text;
  return all;
}

std::vector<std::string> NameContests::due(Time now) {
  std::vector<std::string> texts;
  const MutexLock lock(mutex_);
  for (auto& [node, contest] : contests_) {
    if (now < contest.due) continue;
    contest.due = later(now, kReminder);
    texts.push_back(contest.text);
  }
  return texts;
}

std::map<std::string, std::vector<int>> NameContests::processes() const {
  const MutexLock lock(mutex_);
  return processes_;
}

}  // namespace culprit::link
