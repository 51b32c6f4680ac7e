#include "owners/launch_difference.h"

#include <csignal>
#include <fstream>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"

namespace culprit::owners {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using Words = std::vector<std::string>;

RunningProcess running(Words command) {
  RunningProcess process;
  process.program = command.front();
  process.started = {std::move(command), {}, "/"};
  process.started_at = INT64_MAX / 2;
  return process;
}

std::vector<std::string> differences(const Words& launch, const RunningProcess& process) {
  return launch_differences(launch, "", "/camera", process);
}

struct LaunchDifference : testing::Test {
  std::string file(const std::string& name, const std::string& rate) {
    const std::filesystem::path path = folder.path() / name;
    std::ofstream(path) << "/**:\n  ros__parameters:\n    rate: " << rate << "\n";
    return path.native();
  }
  test::TestFolder folder;
};

TEST_F(LaunchDifference, IsNoneWhereBothAreTheSame) {
  EXPECT_THAT(differences({"/ws/lib/cam/driver", "--fps", "30"},
                          running(Words{"/ws/lib/cam/driver", "--fps", "30"})),
              IsEmpty());
}

TEST_F(LaunchDifference, Ros2RunIsTheProgramThatItRuns) {
  const Words launch{"ros2", "run", "cam", "driver", "--ros-args", "-r", "__node:=cam"};
  EXPECT_THAT(
      differences(launch, running(Words{"/ws/lib/cam/driver", "--ros-args", "-r", "__node:=cam"})),
      IsEmpty());
  EXPECT_THAT(differences(launch, running(Words{"/usr/bin/python3", "/ws/lib/cam/driver",
                                                "--ros-args", "-r", "__node:=cam"})),
              IsEmpty());
}

TEST_F(LaunchDifference, IsNoneIfLaunchAddsRosArgsWithoutAny) {
  EXPECT_THAT(differences({"ros2", "run", "cam", "driver"},
                          running(Words{"/ws/lib/cam/driver", "--ros-args"})),
              IsEmpty());
}

TEST_F(LaunchDifference, NamesTheArgumentsThatAreOthers) {
  EXPECT_THAT(differences({"driver", "--fps", "15", "--wide"},
                          running(Words{"driver", "--fps", "30", "--wide"})),
              ElementsAre("runs with '--fps 30', and its LAUNCH has '--fps 15'"));
  EXPECT_THAT(differences({"driver"}, running(Words{"driver", "--wide"})),
              ElementsAre("runs with '--wide', which its LAUNCH has not"));
  EXPECT_THAT(differences({"driver", "--wide"}, running(Words{"driver"})),
              ElementsAre("runs without '--wide', which its LAUNCH has"));
}

TEST_F(LaunchDifference, SaysThatTheProgramWasReplaced) {
  RunningProcess process = running(Words{"/bin/sh"});
  process.program_is_gone = true;
  EXPECT_THAT(differences({"/bin/sh"}, process),
              ElementsAre(HasSubstr("was replaced since it was started")));
}

TEST_F(LaunchDifference, SaysThatAParameterFileIsGone) {
  const std::string gone = (folder.path() / "launch_params_x").native();
  EXPECT_THAT(differences({"driver", "--ros-args", "--params-file", gone},
                          running(Words{"driver", "--ros-args", "--params-file", gone})),
              ElementsAre("cannot be started again: there is no parameter file '" + gone + "'"));
}

TEST_F(LaunchDifference, SaysThatAParameterFileWasChangedSince) {
  const std::string path = file("camera.yaml", "10");
  RunningProcess process = running(Words{"driver", "--params-file", path});
  process.started_at = 1000;
  EXPECT_THAT(differences({"driver", "--params-file", path}, process),
              ElementsAre("was started before its parameter file '" + path + "' was changed"));
}

// The launch file was edited since the draft was made.
TEST_F(LaunchDifference, ComparesTheParametersOfTwoFiles) {
  const std::string now = file("launch_params_y", "20");
  const std::string draft = file("my.camera.params.yaml", "10");
  const Words command{"driver", "--params-file", draft};
  EXPECT_THAT(differences(command, running(Words{"driver", "--params-file", now})),
              ElementsAre("was started with rate: 20, and its LAUNCH gives it 10"));
  EXPECT_THAT(differences(command, running(Words{"driver", "--params-file", file("same", "10")})),
              IsEmpty());
}

TEST_F(LaunchDifference, IsFoundOfAProgramThatWasReplacedWhileItRan) {
  const std::filesystem::path program = folder.path() / "driver";
  std::filesystem::copy_file("/bin/sleep", program);
  const pid_t pid = fork();
  if (pid == 0) {
    execl(program.c_str(), "driver", "1000", nullptr);
    _exit(127);
  }
  for (const Time end = live_now() + std::chrono::seconds(10); live_now() < end;) {
    const auto runs = running_process(pid);
    if (runs && runs->program == program) break;
  }
  std::filesystem::remove(program);
  std::filesystem::copy_file("/bin/sleep", program);
  const auto process = running_process(pid);
  kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
  ASSERT_TRUE(process);
  EXPECT_THAT(differences({program.native(), "1000"}, *process),
              ElementsAre(HasSubstr("was replaced since it was started")));
}

TEST_F(LaunchDifference, IsFoundOfAProcessThatRuns) {
  const auto process = running_process(getpid());
  ASSERT_TRUE(process);
  EXPECT_THAT(differences(process->started.command, *process), IsEmpty());
}

}  // namespace
}  // namespace culprit::owners
