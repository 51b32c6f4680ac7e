// For tests of what outlives a process of culprit: managers that die, one after the other, on one
// robot.
#pragma once

#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "base/test_expected.h"
#include "journal/recorder.h"
#include "journal/recovery.h"
#include "journal/requests.h"
#include "manager/test_robot.h"
#include "replay/replay.h"

namespace culprit::replay::test {

namespace fs = std::filesystem;
using culprit::test::TestRobot;
using culprit::test::value_of;
using namespace std::chrono_literals;

inline constexpr int kProcess = 4711;  // of each culprit here
inline constexpr std::int64_t kWall = 1'800'000'000'000'000'000;

// As the file system has it at this moment: what is not written yet dies with the process.
inline void copy_parts(const fs::path& from, const fs::path& to,
                       std::initializer_list<const char*> parts) {
  for (const char* part : parts) {
    fs::remove(to.string() + part);
    if (fs::exists(from.string() + part)) fs::copy_file(from.string() + part, to.string() + part);
  }
}
inline void copy_database(const fs::path& from, const fs::path& to) {
  copy_parts(from, to, {"", "-wal"});
}
inline void copy_journal(const fs::path& from, const fs::path& to) {
  // In this order: the rows of a part that is missing from the second are in the first.
  copy_parts(from, to, {"-intents"});
  copy_database(from, to);
}

inline journal::Moment moment(const TestRobot& robot) {
  return {robot.now, kWall + robot.now.time_since_epoch().count()};
}

inline journal::Recovery recovered(const fs::path& path, const TestRobot& robot) {
  const journal::Reader reader = value_of(journal::Reader::open(path));
  const auto unwritten = journal::unwritten_rows(journal::intents_beside(path), reader);
  return value_of(journal::recover(reader, unwritten, robot.rules(), moment(robot)));
}

// A manager on a robot, with its journal.
class Life {
 public:
  // `boot`: since which start of the machine it lives.
  Life(const fs::path& path, TestRobot& robot, const std::string& rules_text,
       const Governor::Options& governor = {}, const std::string& boot = journal::boot_id())
      : robot_(robot), path_(path) {
    auto writer = value_of(journal::Writer::open(path, {}));
    const journal::Reader reader = value_of(journal::Reader::open(path));
    auto unwritten = journal::unwritten_rows(journal::intents_beside(path), reader);
    recovery = value_of(journal::recover(reader, unwritten, robot.rules(), moment(robot)));
    journal::Session session;
    session.rules_path = "test.rules";
    session.rules_text = rules_text;
    session.planner = {{"name", "bayes"}};
    session.process = kProcess;
    session.boot = boot;
    session.start = robot.now;
    session.discovery = 2s;
    session.learned = value_of(reader.learned());
    session.is_paused = recovery.is_paused;
    session.is_dry_run = recovery.is_dry_run;
    session.past = journal::to_json(recovery.past, robot.rules());
    session.known_robot = journal::to_json(recovery.known_robot);
    for (const Interrupted& each : recovery.interrupted) {
      if (recovery.is_other_robot()) break;
      session.interrupted.push_back(journal::to_json(each, robot.rules()));
    }
    robot.replace_manager(manager_for(session, robot.rules(), std::make_unique<BayesPlanner>(),
                                      {Autonomy::kAct, governor}));
    journal::Recorder::Options options;
    options.path = path;
    options.unwritten = std::move(unwritten.rows);
    options.wall_clock = [&robot] { return kWall + robot.now.time_since_epoch().count(); };
    recorder_ = std::make_unique<journal::Recorder>(std::move(writer), options, session,
                                                    robot.manager().knowledge());
    robot.before_commands = [this](auto& observations, auto commands) {
      return step(observations, commands);
    };
  }

  // Whether its journal has its last step although it need not, or only the files beside the
  // journal do.
  enum class Journal : std::uint8_t { kHasIt, kBehind };
  // After so many steps that ask or say anything; whether its last requests still go out.
  void die_after(int steps, bool sends, Journal journal = Journal::kHasIt) {
    steps_left_ = steps;
    sends_ = sends;
    journal_ = journal;
  }
  // Its last word to the journal.
  void end(journal::Ending ending) {
    if (const auto written = recorder_->end(ending); !written)
      throw std::runtime_error(written.error());
  }
  // The robot's clock runs faster than the recorder's thread: waits until the robot's topics are on
  // record.
  void wait_until_known() const {
    for (int i = 0; i < 1000; ++i) {
      const auto found = recovered(path_, robot_);
      if (!found.known_robot.topics.empty()) return;
      std::this_thread::sleep_for(10ms);
    }
    throw std::runtime_error("what was seen of the robot is not on record");
  }
  bool is_dead() const { return is_dead_; }
  // Whether what it asked for last stands beside the journal that it left, and not in it.
  bool is_behind() const { return is_behind_; }
  fs::path remains() const { return path_.string() + ".remains"; }

  journal::Recovery recovery;  // what it found

 private:
  bool step(std::vector<Observation>& observations, std::span<const Command> commands) {
    if (is_dead_) return false;
    const bool matters = !commands.empty() || !robot_.manager().events().empty();
    const bool dies = steps_left_ >= 0 && matters && --steps_left_ < 0;
    if (dies) copy_database(path_, remains());
    recorder_->stepped(robot_.now, observations, commands, robot_.manager().events());
    if (!dies) return true;
    is_dead_ = true;
    copy_parts(path_, remains(), {"-intents"});
    const bool stays_behind = journal_ == Journal::kBehind && are_beside(commands);
    if (!stays_behind) copy_journal(path_, remains());
    is_behind_ = stays_behind && !std::all_of(commands.begin(), commands.end(), is_read);
    return sends_;
  }

  // Whether the next run would find the changes among these beside the rows that it finds.
  bool are_beside(std::span<const Command> commands) const {
    const journal::Reader reader = value_of(journal::Reader::open(remains()));
    const auto found = journal::unwritten_rows(journal::intents_beside(remains()), reader);
    return std::all_of(commands.begin(), commands.end(), [&](const Command& command) {
      return is_read(command) ||
             std::any_of(found.rows.begin(), found.rows.end(), [&](const journal::Entry& row) {
               return row.kind == journal::kind::kIntent &&
                      journal::integer_of(parse_json(row.body), "command") ==
                          static_cast<std::int64_t>(command.id.number);
             });
    });
  }

  TestRobot& robot_;
  fs::path path_;
  std::unique_ptr<journal::Recorder> recorder_;
  int steps_left_ = -1;
  bool sends_ = true;
  Journal journal_ = Journal::kHasIt;
  bool is_dead_ = false;
  bool is_behind_ = false;
};

}  // namespace culprit::replay::test
