// The robot's computer loses its power after each step of culprit that matters. Unsynced writes are dropped, torn or there out of order; the processes of this
// computer have exited, and nodes on others live on. Rows that had to be on the disk first are there, no attempt is continued, and the robot ends healthy.
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "journal/verify.h"
#include "replay/test_disk.h"
#include "replay/test_life.h"

namespace culprit::replay {
namespace {

namespace fs = std::filesystem;
using culprit::test::TestFolder;
using culprit::test::TestRobot;
using test::Life;
using test::PowerCutDisk;
using test::value_of;
using namespace std::chrono_literals;

// The camera is a process of this computer. The gimbal is on another one: no process is known of it.
constexpr const char* kTwoComputers = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT gimbal NODE /gimbal
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 2
RULE Still
  POLICIES ERROR
  TRIGGER age(/pose) > 300ms
    STRATEGY faster 90 10
      ADAPTATION gimbal increase_parameter speed 0.5 2
)";

// All that such a disk may have of a file that is never synced: each of its sectors as it was after
// any of its writes.
std::string torn(const std::vector<std::string>& moments, std::mt19937& random) {
  std::size_t size = 0;
  for (const std::string& moment : moments) size = std::max(size, moment.size());
  std::string content = moments[random() % moments.size()];
  content.resize(random() % 2 == 0 ? size : content.size());
  for (std::size_t at = 0; at < content.size(); at += PowerCutDisk::kSector) {
    const std::string& moment = moments[random() % moments.size()];
    for (std::size_t i = at; i < std::min(at + PowerCutDisk::kSector, content.size()); ++i)
      content[i] = i < moment.size() ? moment[i] : '\0';
  }
  return content;
}

std::string content_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

int intents_about(const std::string& component, const fs::path& path) {
  const journal::Reader reader = value_of(journal::Reader::open(path));
  auto rows = value_of(reader.entries(journal::Which::kReadable));
  journal::Entry entry;
  int count = 0;
  while (value_of(rows.next(entry))) {
    const bool is_one = entry.kind == journal::kind::kIntent &&
                        journal::text_of(parse_json(entry.body), "component") == component;
    count += is_one ? 1 : 0;
  }
  return count;
}

// Gives false if all was over before the power was cut.
bool live_lose_power_and_begin_anew(int steps, unsigned seed) {
  const std::string what =
      "power cut after " + std::to_string(steps) + " steps, seed " + std::to_string(seed);
  std::mt19937 random(seed);
  const TestFolder folder;
  PowerCutDisk disk;
  TestRobot robot(kTwoComputers);
  robot.add("camera", {}, "/rgb");
  robot.add("gimbal", {}, "/pose").parameters["speed"] = 1.0;
  robot["gimbal"].pid = 0;
  robot["gimbal"].has_lifecycle = false;
  const fs::path path = folder / "first.journal";
  Life first(path, robot, kTwoComputers, {}, "the start of the machine before");
  std::vector<std::string> intents{content_of(journal::intents_beside(path))};
  int asked_elsewhere = 0;
  const auto step = robot.before_commands;
  robot.before_commands = [&](auto& observations, auto commands) {
    const bool was_dead = first.is_dead();
    const bool lives = step(observations, commands);
    if (was_dead) return lives;
    intents.push_back(content_of(journal::intents_beside(path)));
    for (const Command& command : commands)
      asked_elsewhere += !is_read(command) && robot.rules()[command.component].name == "gimbal";
    if (!first.is_dead()) return lives;
    disk.cut(path, first.remains(), random);
    std::ofstream(journal::intents_beside(first.remains()), std::ios::binary)
        << torn(intents, random);
    test::copy_parts(path, first.remains(), {"-learned"});
    return lives;
  };
  robot.discover(6s);
  robot["camera"].fault = "redeploy";
  robot["gimbal"].fault = "speed=1.5";
  first.die_after(steps, true);
  for (int i = 0; i < 3000 && !first.is_dead(); ++i) robot.run_for(10ms);
  if (!first.is_dead()) return false;

  EXPECT_GE(intents_about("gimbal", first.remains()), asked_elsewhere) << what;
  const auto verified =
      value_of(journal::verify(value_of(journal::Reader::open(first.remains())), {}));
  EXPECT_TRUE(verified.findings.empty()) << what << ": " << verified.findings.front();
  // The processes that started with the machine, and those that went on elsewhere.
  robot["camera"].end();
  robot["camera"].fault = "";
  robot.run_for(5s);
  robot.start_by_hand("camera", 5s);
  const std::size_t asked = robot.asked.size();
  Life second(first.remains(), robot, kTwoComputers);
  EXPECT_TRUE(second.recovery.was_other_boot) << what;
  // As after any such start the robot has its time to show itself.
  robot.run_for(1s);
  EXPECT_EQ(robot.asked.size(), asked) << what << ": nothing is gone on with";
  robot.fail("camera", "redeploy", 90s);
  EXPECT_TRUE(robot.works("camera")) << what;
  EXPECT_LE(robot.count_asked("camera: start process"),
            robot.count_asked("camera: stop process") + 1)
      << what;
  return true;
}

TEST(PowerCut, AfterAnyStepLeavesARecordOfWhatItMustAndNothingHalfDone) {
  int cuts = 0;
  for (int steps = 0;
       live_lose_power_and_begin_anew(steps, static_cast<unsigned>(steps)) && steps < 40; ++steps) {
    for (unsigned seed = 100; seed < 103; ++seed) live_lose_power_and_begin_anew(steps, seed);
    ++cuts;
  }
  EXPECT_GE(cuts, 5) << "chosen, asked for, done, resolved";
}

}  // namespace
}  // namespace culprit::replay
