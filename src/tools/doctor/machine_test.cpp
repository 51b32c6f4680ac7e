// Tests readings of this machine on our own process, for others may be in any state.
#include "doctor/machine.h"

#include <fstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "doctor/process_watch.h"
#include "doctor/start_parameters.h"
#include "ros2/live_test.h"

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

TEST(ProcessWatch, SeesMemoryAndProcessorTimeOfAProcess) {
  ProcessWatch watch;
  EXPECT_EQ(watch.sample({{"/me", getpid()}, {"/remote", 0}, {"/gone", 4'000'000}}, 0s),
            std::set<int>{4'000'000});
  volatile double work = 1;
  const auto until = std::chrono::steady_clock::now() + 200ms;
  while (std::chrono::steady_clock::now() < until) work = work * 1.0001;
  watch.sample({{"/me", getpid()}}, 1s);
  ASSERT_EQ(watch.processes().size(), 1u);
  const Process& me = watch.processes().at(getpid());
  ASSERT_EQ(me.samples.size(), 2u);
  EXPECT_GT(me.samples[0].bytes, 1'000'000);
  EXPECT_GT(me.samples[1].processor, me.samples[0].processor);
  EXPECT_FALSE(me.is_left_over);
  EXPECT_NE(me.shared_memory, 0u);
  EXPECT_LT(me.started, std::chrono::system_clock::now());
  watch.begin_anew();
  EXPECT_THAT(watch.processes().at(getpid()).samples, IsEmpty());
  watch.sample({}, 2s);
  EXPECT_THAT(watch.processes(), IsEmpty()) << "its node has left";
}

TEST(ProcessWatch, KnowsWhetherAnybodyReadsWhatAProcessPrints) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const int child = fork();
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    close(ends[0]);
    close(ends[1]);
    for (;;) pause();
  }
  close(ends[1]);
  // Until it has its output there.
  const std::string output = "/proc/" + std::to_string(child) + "/fd/1";
  while (!std::filesystem::read_symlink(output).native().starts_with("pipe:"))
    std::this_thread::yield();
  EXPECT_FALSE(has_unread_output(child));
  while (std::filesystem::exists("/proc/" + std::to_string(child) + "/fd/" +
                                 std::to_string(ends[0])) &&
         ends[0] > STDERR_FILENO)
    std::this_thread::yield();
  close(ends[0]);
  EXPECT_TRUE(has_unread_output(child));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_FALSE(has_unread_output(child)) << "it is gone";
}

TEST(StartParameters, AreReadFromACommandLine) {
  const test::TestFolder folder;
  std::ofstream(folder.path() / "robot.yaml")
      << "/**:\n  ros__parameters: {rate: 10, map: office}\n"
         "slam:\n  ros__parameters: {rate: 20}\n";
  const auto all = start_parameters(
      {"slam", "-p", "no:=1", "--ros-args", "--params-file", "robot.yaml", "-p", "map:=attic", "-p",
       "lidar:gain:=1.0", "-r", "a:=b", "-p", "broken", "--", "-p", "neither:=1"},
      folder.path(), {"/slam", "/lidar"});
  EXPECT_EQ(all.at("/slam"),
            (std::map<std::string, std::string>{{"rate", "20"}, {"map", "attic"}}));
  EXPECT_EQ(all.at("/lidar"),
            (std::map<std::string, std::string>{{"rate", "10"}, {"map", "attic"}, {"gain", "1"}}));
  EXPECT_THAT(start_parameters({"slam", "--ros-args", "-p"}, "/", {"/slam"}), IsEmpty());
}

TEST(Disks, AreThoseThatAProcessWorksOn) {
  const std::vector<Disk> disks = disks_of({{"/me", getpid()}});
  ASSERT_FALSE(disks.empty());
  for (const Disk& disk : disks) {
    EXPECT_GT(disk.size, 0);
    EXPECT_LE(disk.free, disk.size);
    EXPECT_THAT(disk.used_for, HasSubstr("/me"));
  }
}

TEST(OtherDomains, AreThoseThatProcessesOfThisMachineWaitOn) {
  const ros2::TestDomain domain;
  const ros2::LiveContext context(domain.options());
  const auto others = other_domains(domain.number() + 1, {});
  const auto found = std::ranges::find(others, domain.number(),
                                       [](const OtherDomain& each) { return each.domain; });
  ASSERT_NE(found, others.end());
  EXPECT_THAT(found->programs, Contains(HasSubstr("process " + std::to_string(getpid()))));
  EXPECT_THAT(found->siblings, IsEmpty()) << "no launch has started it";
  for (const OtherDomain& each : other_domains(domain.number(), {}))
    EXPECT_NE(each.domain, domain.number());
}

}  // namespace
}  // namespace culprit::doctor
