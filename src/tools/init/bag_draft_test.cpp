// Rules drafted from three recordings of a robot that was well: they pass the check, a fourth recording raises no alarm, and
// a silence planted in it does.
#include "init/bag_draft.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag/bag_file.h"
#include "bag/bag_reading.h"
#include "bag_doctor/test_recording.h"
#include "base/test_expected.h"
#include "base/test_folder.h"
#include "language/checker.h"
#include "language/formatter.h"
#include "manager/manager.h"
#include "plan/paper_planner.h"

namespace culprit::init {
namespace {

namespace recorded = bag_doctor::test;
using culprit::test::value_of;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

enum class Planted { kNothing, kSilence, kNaN, kFrozen, kError };

// Its sensors come in another rhythm in each recording, a little, and end one after the other.
recorded::Recording recording_of(std::uint64_t seed, Planted planted = Planted::kNothing) {
  recorded::Recording recording;
  const double length = 40;
  double last = 0;
  for (double time = 0.3; time < length; time += 0.1 * (1 + 0.4 * recorded::noise(++seed))) {
    if (planted == Planted::kSilence && time > 20) break;
    recording.add("/scan", "sensor_msgs/msg/LaserScan", time,
                  recorded::scan(time, recorded::noise(++seed)));
  }
  for (double time = 0.1; time < length + 0.2; time += 0.02 * (1 + 0.3 * recorded::noise(++seed))) {
    double value = recorded::noise(++seed);
    if (planted == Planted::kNaN && time > 20) value = std::nan("");
    if (planted == Planted::kFrozen && time > 20) value = last;
    last = value;
    recording.add("/imu", "sensor_msgs/msg/Imu", time, recorded::imu(time, value));
  }
  for (double time = 1; time < length; time += 1) {
    const bool is_bad = planted == Planted::kError && time > 20;
    recording.add(
        "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", time,
        recorded::diagnostic(time, is_bad ? 2 : 0, "imu: temperature", is_bad ? "too hot" : "ok"));
  }
  recording.add("/rosout", "rcl_interfaces/msg/Log", 1, recorded::log(1, 20, "imu", "ready"));
  return recording;
}

class BagDraftTest : public testing::Test {
 protected:
  std::string draft() {
    std::vector<bag_doctor::BagCourse> courses;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      ros2::MessageLibrary library;
      const auto path =
          recording_of(1000 * seed).write(folder_.path() / (std::to_string(seed) + ".mcap"));
      courses.push_back(value_of(bag_doctor::read_course(path, library)));
    }
    return draft_of_bags(courses);
  }

  // The rules that fire.
  std::vector<std::string> alarms(const std::string& text, Planted planted) {
    const Source source("draft.rules", text);
    const Checked checked = check(source);
    for (const Diagnostic& each : checked.diagnostics) {
      if (each.severity == Severity::kError) ADD_FAILURE() << render(each, source);
    }
    if (!checked.rules) return {"the draft has errors:\n" + text};
    const RuleSet& rules = *checked.rules;
    auto bag = value_of(
        bag::BagFile::open(recording_of(9000, planted).write(folder_.path() / "fourth.mcap")));
    ros2::MessageLibrary library;
    bag::BagReading reading(rules, bag.contents(), library);
    Manager::Options options;
    options.autonomy = Autonomy::kAdvise;
    options.start = Time(Duration(recorded::kBegin));
    options.discovery = std::chrono::hours(24);
    Manager manager(rules, std::make_unique<PaperPlanner>(), options);
    std::set<std::string> fired;
    const auto step = [&](Time now, std::span<const Observation> observations) {
      manager.step(now, observations);
      for (const Event& event : manager.events()) {
        if (const auto* detected = std::get_if<FailureDetected>(&event.what))
          fired.insert(rules[detected->rule].name);
      }
    };
    std::vector<Observation> observations;
    for (bag::BagMessage message; bag.next(message); observations.clear()) {
      const Time now{Duration(message.at)};
      while (manager.next_deadline() < now) step(manager.next_deadline(), {});
      reading.read(message, observations);
      step(now, observations);
    }
    return {fired.begin(), fired.end()};
  }

  const culprit::test::TestFolder folder_;
};

TEST_F(BagDraftTest, RaisesNoAlarmOnAFourthRecording) {
  EXPECT_THAT(alarms(draft(), Planted::kNothing), IsEmpty());
}

TEST_F(BagDraftTest, FindsWhatIsPlantedInIt) {
  const std::string text = draft();
  EXPECT_THAT(alarms(text, Planted::kSilence), Contains("scan_silent"));
  EXPECT_THAT(alarms(text, Planted::kNaN), Contains("imu_nan"));
  EXPECT_THAT(alarms(text, Planted::kFrozen), Contains("imu_frozen"));
  EXPECT_THAT(alarms(text, Planted::kError), Contains("imu_temperature_error"));
}

TEST_F(BagDraftTest, ProposesComponentsAndSaysHowSureItIs) {
  const std::string text = draft();
  EXPECT_THAT(text, HasSubstr("#   COMPONENT imu NODE /imu\n"));
  EXPECT_THAT(text, HasSubstr("(95 % certain)"));
  EXPECT_THAT(text, HasSubstr("from 3 recordings of 120 s"));
}

TEST_F(BagDraftTest, IsLaidOutAsTheFormatterDoes) { EXPECT_TRUE(format({"draft", draft()})); }

}  // namespace
}  // namespace culprit::init
