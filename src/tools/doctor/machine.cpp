#include "doctor/machine.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sys/stat.h>
#include <sys/statvfs.h>

#include "doctor/wording.h"
#include "owners/proc.h"
#include "owners/start_of.h"
#include "rtps/udp_sockets.h"

namespace culprit::doctor {
namespace {

namespace fs = std::filesystem;

std::string variable_in(const owners::Started& started, const std::string& name) {
  for (const std::string& each : started.environment) {
    if (each.starts_with(name + "=")) return each.substr(name.size() + 1);
  }
  return "";
}

// Where launch and rcl write (ROS_LOG_DIR, ROS_HOME, ~/.ros).
std::string logs_of(const owners::Started& started) {
  if (const std::string logs = variable_in(started, "ROS_LOG_DIR"); !logs.empty()) return logs;
  if (const std::string home = variable_in(started, "ROS_HOME"); !home.empty())
    return home + "/log";
  const std::string home = variable_in(started, "HOME");
  return home.empty() ? "" : home + "/.ros/log";
}

// The folder, or the nearest one above it that is there.
fs::path existing(fs::path folder) {
  std::error_code error;
  while (!folder.empty() && folder != "/" && !fs::exists(folder, error))
    folder = folder.parent_path();
  return folder;
}

class Disks {
 public:
  void add(const std::string& folder, const std::string& used_for) {
    if (!folder.starts_with('/')) return;
    const fs::path there = existing(folder);
    struct stat status {};
    struct statvfs space {};
    if (stat(there.c_str(), &status) != 0 || statvfs(there.c_str(), &space) != 0) return;
    const auto block = static_cast<std::int64_t>(space.f_frsize);
    const std::int64_t size = static_cast<std::int64_t>(space.f_blocks) * block;
    if (size == 0 || (space.f_flag & ST_RDONLY) != 0) return;
    disks_.try_emplace(status.st_dev, Disk{there, used_for, size,
                                           static_cast<std::int64_t>(space.f_bavail) * block});
  }
  std::vector<Disk> all() const {
    std::vector<Disk> disks;
    for (const auto& [device, disk] : disks_) disks.push_back(disk);
    return disks;
  }

 private:
  std::map<dev_t, Disk> disks_;
};

// ---- domains

constexpr int kFirstPort = 7400;
constexpr int kPortsOfDomain = 250;
constexpr int kMostDomains = 233;

// The domains that sockets wait on, with the sockets.
std::map<std::uint32_t, std::set<std::string>> sockets_by_domain() {
  std::map<std::uint32_t, std::set<std::string>> found;
  for (const rtps::UdpSocket& socket : rtps::udp_sockets()) {
    const int above = socket.address.port - kFirstPort;
    if (above < 0 || above % kPortsOfDomain != 0 || above / kPortsOfDomain >= kMostDomains)
      continue;
    found[static_cast<std::uint32_t>(above / kPortsOfDomain)].insert(socket.link);
  }
  return found;
}

std::vector<int> processes() {
  std::vector<int> pids;
  std::error_code error;
  for (fs::directory_iterator i("/proc", error); !error && i != fs::directory_iterator();
       i.increment(error)) {
    if (const int pid = std::atoi(i->path().filename().c_str()); pid > 0) pids.push_back(pid);
  }
  return pids;
}

std::set<std::string> sockets_of(int pid) {
  std::set<std::string> links;
  std::error_code error;
  for (fs::directory_iterator i("/proc/" + std::to_string(pid) + "/fd", error);
       !error && i != fs::directory_iterator(); i.increment(error)) {
    std::error_code unreadable;
    std::string link = fs::read_symlink(i->path(), unreadable);
    if (link.starts_with("socket:")) links.insert(std::move(link));
  }
  return links;
}

bool have_one_in_common(const std::set<std::string>& a, const std::set<std::string>& b) {
  return std::ranges::any_of(a, [&](const std::string& each) { return b.contains(each); });
}

// `ros2 launch robot robot.launch.py`, or what a program of its own makes of it.
bool is_launcher(int pid) {
  const auto started = owners::start_of(pid);
  if (!started) return false;
  return std::ranges::any_of(started->command, [](const std::string& word) {
    return word == "launch" || word.ends_with(".launch.py") || word.ends_with("_launch.py") ||
           word.ends_with(".launch.xml") || word.ends_with(".launch.yaml");
  });
}

std::string program_of(int pid) {
  const auto identity = owners::identity_of(pid);
  const std::string name =
      identity ? fs::path(identity->script.empty() ? identity->program : identity->script)
                     .filename()
                     .native()
               : "a program";
  return name + " (process " + std::to_string(pid) + ")";
}

}  // namespace

std::vector<Disk> disks_of(const std::map<std::string, int>& nodes) {
  Disks disks;
  std::set<int> seen;
  for (const auto& [node, pid] : nodes) {
    if (pid == 0 || !seen.insert(pid).second) continue;
    const auto started = owners::start_of(pid);
    if (!started) continue;
    disks.add(logs_of(*started), "the logs of " + node);
    disks.add(started->folder, "the folder of " + node);
  }
  return disks.all();
}

std::vector<OtherDomain> other_domains(std::uint32_t own, const std::map<std::string, int>& nodes) {
  auto domains = sockets_by_domain();
  domains.erase(own);
  std::vector<OtherDomain> others;
  if (domains.empty()) return others;
  std::map<int, std::string> launched;  // by launcher, a node of ours
  std::set<int> here;
  for (const auto& [node, pid] : nodes) {
    if (pid == 0) continue;
    here.insert(pid);
    const int parent = owners::parent_of(pid).value_or(0);
    if (parent > 1 && is_launcher(parent)) launched.emplace(parent, node);
  }
  std::map<int, std::set<std::string>> sockets;  // by process
  for (const int pid : processes()) sockets[pid] = sockets_of(pid);
  for (const auto& [domain, waiting] : domains) {
    OtherDomain& other = others.emplace_back(OtherDomain{domain});
    for (const auto& [pid, its] : sockets) {
      if (!have_one_in_common(waiting, its)) continue;
      other.programs.push_back(program_of(pid));
      // A process on both domains is a bridge.
      const auto sibling = launched.find(owners::parent_of(pid).value_or(0));
      if (sibling != launched.end() && !here.contains(pid))
        other.siblings.emplace(other.programs.back(), sibling->second);
    }
  }
  return others;
}

std::string domains_with_programs(const std::vector<OtherDomain>& others) {
  std::vector<std::string> all;
  for (const OtherDomain& each : others)
    all.push_back("domain " + std::to_string(each.domain) +
                  (each.programs.empty() ? "" : " (" + listed(each.programs) + ")"));
  return listed(all);
}

}  // namespace culprit::doctor
