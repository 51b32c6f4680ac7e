// examples/cluster as it stands, with a small campaign, on the engines that can be had here.
#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "terminal/test_program.h"

namespace culprit::lab {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

std::string contents_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Runs `command` in the folder of `world` to its end, like a user who begins the small campaign. Returns its output.
std::string begin_campaign(const TestWorld& world, const std::string& command) {
  TestProgram program(world, {"sh", "-c",
                              "cd '" + world.folder().string() + "' && exec env HOME=. CULPRIT='" +
                                  (own_folder() / "culprit-lab").string() +
                                  "' CULPRIT_STUDY='sunset --ablation --runs 8' " + command});
  EXPECT_EQ(program.wait(2min), 0) << program.output();
  return program.output();
}

fs::path shard_of(const TestWorld& world, int number) {
  return world.folder() / "shards" / ("sunset-" + std::to_string(number) + ".shard");
}

// What `campaign` makes: eight shards, which can be put together. One that is damaged is named, kept aside and made anew,
// the same bytes. `campaign` gives what was said, of the third shard or of all.
void expect_to_go_on(const TestWorld& world, const std::function<std::string()>& campaign) {
  const fs::path third = shard_of(world, 3);
  campaign();
  const std::string whole = contents_of(third);
  ASSERT_GT(whole.size(), 200u);
  std::string damaged = whole;
  damaged[damaged.size() / 2] ^= 1;
  std::ofstream(third, std::ios::binary) << damaged;
  EXPECT_THAT(campaign(), testing::HasSubstr("sunset-3.shard was damaged; it is kept as"));
  EXPECT_EQ(contents_of(third), whole);
  std::vector<std::string> merge = {"culprit-lab", "study", "merge"};
  for (int shard = 8; shard >= 1; --shard) merge.push_back(shard_of(world, shard).string());
  TestProgram merged(world, merge);
  EXPECT_EQ(merged.wait(), 0) << merged.output();
}

TEST(ClusterCampaign, OfGnuParallelGoesOnAndMendsAShardThatIsDamaged) {
  if (!fs::exists("/usr/bin/parallel")) GTEST_SKIP() << "there is no GNU parallel here";
  const TestWorld world;
  const std::string line = "'" + fs::absolute("examples/cluster/campaign.sh").string() + "'";
  expect_to_go_on(world, [&] { return begin_campaign(world, line); });
}

// A cluster of this computer alone: Slurm's controller, its daemon, and MUNGE, by which they know one another. They look up
// addresses of none but families that an interface has, and a loopback's own does not count. So it has another one, in a
// network of their own.
class OneNodeSlurm {
 public:
  explicit OneNodeSlurm(const TestWorld& world) : world_(world), folder_(world.folder() / "slurm") {
    fs::create_directories(folder_ / "munge");
    fs::permissions(folder_ / "munge", fs::perms::owner_all);
    std::ofstream(key()) << std::string(128, 'k');
    fs::permissions(key(), fs::perms::owner_read);
    std::ofstream(configuration()) << settings();
    setenv("SLURM_CONF", configuration().c_str(), 1);
    network_.emplace(world_,
                     std::vector<std::string>{
                         "unshare", "--net", "sh", "-c",
                         "ip link set lo up && ip address add 192.0.2.1/32 dev lo && echo up; "
                         "exec sleep infinity"});
    EXPECT_TRUE(network_->prints("up")) << network_->output();
    const std::string munge = (folder_ / "munge" / "munged").string();
    start("munged --foreground --force --key-file=" + key().string() + " --socket=" + socket() +
          " --pid-file=" + munge + ".pid --seed-file=" + munge + ".seed --log-file=" + munge +
          ".log");
    start("slurmctld -D -i");
    start("slurmd -D");
  }
  ~OneNodeSlurm() {
    while (!daemons_.empty()) daemons_.pop_back();  // who works for another first
    unsetenv("SLURM_CONF");
  }
  OneNodeSlurm(const OneNodeSlurm&) = delete;
  OneNodeSlurm& operator=(const OneNodeSlurm&) = delete;

  // Waits until it would take jobs. False if it does not.
  bool is_ready() const {
    const auto end = std::chrono::steady_clock::now() + 1min;
    while (std::chrono::steady_clock::now() < end) {
      TestProgram sinfo(world_, {"sh", "-c", here("sinfo --noheader --format=%t")});
      if (sinfo.wait() == 0 && sinfo.output().find("idle") != std::string::npos) return true;
      std::this_thread::sleep_for(100ms);
    }
    return false;
  }
  // A command of a shell that runs `command` in that network.
  std::string here(const std::string& command) const {
    return "nsenter --net=/proc/" + std::to_string(network_->pid()) + "/ns/net " + command;
  }
  std::string said() const {
    std::string all;
    for (const auto& each : daemons_) all += each->output();
    return all;
  }

 private:
  fs::path key() const { return folder_ / "munge" / "key"; }
  fs::path configuration() const { return folder_ / "slurm.conf"; }
  std::string socket() const { return (folder_ / "socket").string(); }

  std::string settings() const {
    std::array<char, 256> host{};
    gethostname(host.data(), host.size() - 1);
    const std::string whole = host.data();
    const std::string name = whole.substr(0, whole.find('.'));
    const std::string user = std::to_string(geteuid());
    return "ClusterName=test\nSlurmctldHost=" + name + "(127.0.0.1)\nSlurmUser=" + user +
           "\nSlurmdUser=" + user + "\nAuthType=auth/munge\nAuthInfo=socket=" + socket() +
           "\nCredType=cred/munge\nStateSaveLocation=" + (folder_ / "state").string() +
           "\nSlurmdSpoolDir=" + (folder_ / "spool").string() +
           "\nSlurmctldPidFile=" + (folder_ / "slurmctld.pid").string() +
           "\nSlurmdPidFile=" + (folder_ / "slurmd.pid").string() +
           "\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nSwitchType=switch/none\n"
           "MpiDefault=none\nJobAcctGatherType=jobacct_gather/none\n"
           "AccountingStorageType=accounting_storage/none\nReturnToService=2\n"
           "SchedulerParameters=sched_interval=1,batch_sched_delay=0\nNodeName=" +
           name + " NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN\nPartitionName=all Nodes=" + name +
           " Default=YES State=UP\n";
  }

  void start(const std::string& command) {
    daemons_.push_back(std::make_unique<TestProgram>(
        world_, std::vector<std::string>{"sh", "-c", "exec " + here("/usr/sbin/" + command)}));
  }

  const TestWorld& world_;
  const fs::path folder_;
  std::optional<TestProgram> network_;
  std::vector<std::unique_ptr<TestProgram>> daemons_;
};

TEST(ClusterCampaign, OfSlurmGoesOnAndMendsAShardThatIsDamaged) {
  for (const char* program : {"munged", "slurmctld", "slurmd"}) {
    if (!fs::exists(fs::path("/usr/sbin") / program))
      GTEST_SKIP() << "there is no " << program << " here";
  }
  const TestWorld world;
  const OneNodeSlurm slurm(world);
  ASSERT_TRUE(slurm.is_ready()) << slurm.said();
  const std::string line = slurm.here(
      "sbatch --wait '" + fs::absolute("examples/cluster/campaign.slurm").string() + "'");
  expect_to_go_on(world, [&] {
    begin_campaign(world, line);
    std::string said;
    for (const auto& entry : fs::directory_iterator(world.folder())) {
      if (entry.path().extension() == ".out") said += contents_of(entry.path());
    }
    return said;
  });
}

}  // namespace
}  // namespace culprit::lab
