// Culprit is killed at random instants while it heals the live SUNSET, and started again with the
// same journal, over and over; the robot is broken again before it is well. After every few kills,
// and at the end, the robot gets well. At no time is any of its nodes there twice. At the end the
// journal is whole, no outcome is lost or counted twice, and nothing has leaked.
//
// The same with a disk that is full most of the time.
//
// CULPRIT_CHAOS_KILLS says how often (4 unless set; scripts/chaos), CULPRIT_CHAOS_SEED what is
// random.
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <random>
#include <sched.h>
#include <set>
#include <sys/mount.h>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "demo/test_live_sunset.h"
#include "journal/json.h"
#include "journal/reader.h"
#include "journal/session.h"
#include "live/robot_survey.h"
#include "owners/proc.h"
#include "plan/bayes/bayes_planner.h"
#include "replay/replay.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::HasSubstr;

int setting(const char* name, int otherwise) {
  const char* value = std::getenv(name);
  return value == nullptr ? otherwise : std::atoi(value);
}

// The settings of the robot's nodes and the age of their pictures: shows why the robot does not get well.
std::string state_of_the_robot() {
  auto survey = live::open_survey();
  if (!survey) return survey.error();
  LiveInterest interest;
  for (const sunset::Member member : sunset::kManagedMembers)
    interest.nodes.insert("/managed_subsystem/" + std::string(name_of(member)));
  for (const std::string_view topic :
       {sunset::topics::kRgbCamera, sunset::topics::kDepthCamera, sunset::topics::kSensorsFused})
    interest.fields_of_topics[std::string(topic)] = {"header.stamp.sec", "header.stamp.nanosec"};
  (*survey)->ask_for(interest);
  std::this_thread::sleep_for(4s);  // a rate is counted over two
  const LiveInventory robot = (*survey)->inventory();
  std::string text;
  for (const auto& [name, node] : robot.nodes) {
    text += name + " (process " + std::to_string(node.pid) + ") " + node.lifecycle;
    for (const auto& [parameter, value] :
         node.parameters.value_or(decltype(node.parameters)::value_type{}))
      text += " " + parameter + "=" + (value ? to_string(*value) : "?");
    text += "\n";
  }
  for (const auto& [name, topic] : robot.topics) {
    if (!topic.rate) continue;
    text += name + " " + std::to_string(*topic.rate) + " Hz";
    for (const auto& [field, value] : topic.fields) text += " " + field + "=" + to_string(value);
    text += "\n";
  }
  return text;
}

// Each belief of the journal grows by one outcome at a time, each of which was said; what one run
// knew at its end the next knew at its beginning; and what is believed now is the sum of it all.
class OutcomesCount {
 public:
  void follow(const journal::Entry& entry) {
    const Json body = parse_json(entry.body);
    if (entry.kind == journal::kind::kSession) begin(body, entry.id);
    if (entry.kind == journal::kind::kEvent) said(body);
    if (entry.kind == journal::kind::kBelief) learned(body, entry.id);
  }
  void compare(const journal::Learned& now) const {
    EXPECT_EQ(by_name(now), beliefs_) << "the table is not the sum of its rows";
  }
  int outcomes() const { return outcomes_; }

 private:
  using Name = std::pair<std::string, std::string>;
  using Beliefs = std::map<Name, std::pair<double, double>>;

  static Beliefs by_name(const journal::Learned& learned) {
    Beliefs beliefs;
    for (const journal::LearnedBelief& each : learned.beliefs)
      beliefs[{each.rule, each.strategy}] = {each.belief.alpha, each.belief.beta};
    return beliefs;
  }
  void begin(const Json& body, std::int64_t row) {
    said_.clear();
    const auto session = journal::session_from_json(body);
    ASSERT_TRUE(session) << session.error();
    EXPECT_EQ(by_name(session->learned), beliefs_)
        << "the run of row " << row << " begins with other beliefs";
  }
  void said(const Json& body) {
    const std::string type = journal::text_of(body, "type");
    const Name name{journal::text_of(body, "rule"), journal::text_of(body, "strategy")};
    if (type != "outcome_counted") return;
    const std::string as = journal::text_of(body, "as");
    if (as == "success") ++said_[name].first;
    if (as == "failure") ++said_[name].second;
  }
  void learned(const Json& body, std::int64_t row) {
    const Name name{journal::text_of(body, "rule"), journal::text_of(body, "strategy")};
    const std::pair now{journal::number_of(body, "alpha"), journal::number_of(body, "beta")};
    const Json prior = body.value("prior", Json::array({0, 0}));
    const auto before = beliefs_.try_emplace(name, prior[0], prior[1]).first->second;
    const bool helped = now == std::pair{before.first + 1, before.second};
    const bool did_not = now == std::pair{before.first, before.second + 1};
    EXPECT_TRUE(helped || did_not) << "row " << row << " is not one outcome more";
    int& outcomes = helped ? said_[name].first : said_[name].second;
    EXPECT_GT(outcomes--, 0) << "row " << row << " counts an outcome that nobody saw";
    beliefs_[name] = now;
    ++outcomes_;
  }

  Beliefs beliefs_;
  std::map<Name, std::pair<int, int>> said_;  // in this run and not counted yet: helped, did not
  int outcomes_ = 0;
};

// Counts the robot's processes all the time: no node may ever be there twice.
class Census {
 public:
  explicit Census(const lab::LiveSunset& robot)
      : counting_([this, &robot](const std::stop_token& stop) {
          for (; !stop.stop_requested(); std::this_thread::sleep_for(20ms)) count(robot);
        }) {}

  // Ends it. Gives what was seen twice.
  std::vector<std::string> end() {
    counting_.request_stop();
    counting_.join();
    return seen_;
  }
  // How often it counted. Once it is ended.
  int counts() const { return counts_; }

 private:
  void count(const lab::LiveSunset& robot) {
    ++counts_;
    for (const sunset::Member member : sunset::kMembers) {
      const std::vector<int> pids = robot.processes(member);
      if (pids.size() < 2) continue;
      std::string text = std::string(name_of(member)) + " is there more than once:";
      for (const int pid : pids) text += " " + std::to_string(pid);
      if (seen_.empty() || seen_.back() != text) seen_.push_back(text);
    }
  }

  int counts_ = 0;
  std::vector<std::string> seen_;
  std::jthread counting_;  // last: it uses the others
};

// A disk of 2 MiB that this process and its children see.
class SmallDisk {
 public:
  explicit SmallDisk(fs::path folder) : folder_(std::move(folder)) {
    fs::create_directory(folder_);
    is_there_ = unshare(CLONE_NEWNS) == 0 &&
                mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                mount("none", folder_.c_str(), "tmpfs", 0, "size=2m") == 0;
  }
  ~SmallDisk() {
    if (is_there_) umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  bool is_there() const { return is_there_; }
  // Until nothing more fits.
  void fill() {
    std::ofstream file(ballast(), std::ios::app);
    for (const std::string block(4096, 'x'); file << block << std::flush;) {
    }
  }
  void free() { fs::remove(ballast()); }

 private:
  fs::path ballast() const { return folder_ / "ballast"; }

  const fs::path folder_;
  bool is_there_ = false;
};

struct Chaos : testing::Test {
  TestProgram run() {
    return TestProgram(world, {"culprit", "run", rules, "--journal", journal_path(), "--state-dir",
                               (disk / "state").string(), "--settle", "2", "--healthy", "1",
                               "--restarts", "none"});
  }
  // A run that ends in order. Gives what it held.
  Holdings see_the_whole_robot() {
    TestProgram culprit = run();
    for (const char* component : {"camera", "depth", "image_enhancement", "fusion", "segmentation"})
      EXPECT_TRUE(culprit.prints(std::string(component) + " is there")) << culprit.output();
    // A topic that was never published is unknown to a late joiner.
    EXPECT_TRUE(culprit.prints("/managed_subsystem/sensors_fused")) << culprit.output();
    const Holdings holdings = holdings_of(culprit.pid());
    culprit.signal(SIGINT);
    EXPECT_EQ(culprit.wait(), 0) << culprit.output();
    return holdings;
  }
  // Some die while they start, some while they watch, most while they repair.
  void let_live(const TestProgram& culprit) {
    std::uniform_int_distribution<int> any(0, 2500);
    std::uniform_int_distribution<int> repairing(0, 1200);
    if (random() % 3 != 0) culprit.prints("decided", 6s);
    std::this_thread::sleep_for(std::chrono::milliseconds(
        culprit.output().find("decided") != std::string::npos ? repairing(random) : any(random)));
  }
  // Breaks the robot and kills culprit so often. Every few kills the robot gets well first. Gives how many ended well.
  template <class Fault>
  int kill_over_and_over(lab::LiveSunset& robot, int kills, Fault begin_fault) {
    constexpr int kKillsUntilWell = 5;
    int ended_well = 0;
    for (int i = 0; i < kills; ++i) {
      TestProgram culprit = run();
      begin_fault(robot);
      let_live(culprit);
      if (i - ended_well == kKillsUntilWell) {
        if (!robot.is_well_within(180s)) {
          ADD_FAILURE() << robot.complaint() << "\n" << state_of_the_robot() << culprit.output();
          return ended_well;
        }
        ended_well = i;
      }
      culprit.signal(SIGKILL);
      EXPECT_EQ(culprit.wait(), -SIGKILL) << culprit.output();
      std::cout << "." << std::flush;
    }
    return ended_well;
  }
  void expect_whole_journal() const {
    TestProgram audit(world, {"culprit", "audit", "verify", "--journal", journal_path()});
    EXPECT_EQ(audit.wait(), 0) << audit.output();
    EXPECT_THAT(audit.output(), HasSubstr("all as they were written"));
  }
  static void expect_each_node_once(const lab::LiveSunset& robot) {
    for (const sunset::Member member : sunset::kMembers)
      EXPECT_EQ(robot.processes(member).size(), 1u) << name_of(member);
  }
  // Evidence for an investigation: the running processes, the journal and the nodes' logs.
  void keep_evidence(const lab::LiveSunset& robot) const {
    for (const sunset::Member member : sunset::kMembers) {
      for (const int pid : robot.processes(member))
        std::cout << name_of(member) << ": process " << pid << ", "
                  << owners::state_letter(pid).value_or('?') << "\n";
    }
    // The temporary folder of this process goes with it.
    const fs::path kept =
        fs::temp_directory_path().parent_path() / (world.folder().filename().string() + "-chaos");
    fs::copy(world.folder(), kept, fs::copy_options::recursive);
    std::cout << "kept: " << kept << "\n";
  }
  journal::Reader journal() const {
    auto reader = journal::Reader::open(journal_path());
    if (!reader) throw std::runtime_error(reader.error());
    return std::move(*reader);
  }

  std::mt19937 random{static_cast<std::mt19937::result_type>(setting("CULPRIT_CHAOS_SEED", 1))};
  TestWorld world;
  const std::string rules = fs::absolute("rules/sunset.rules").string();
  fs::path disk = world.folder();  // where the journal and the state are kept
  std::string journal_path() const { return (disk / "sunset.journal").string(); }
};

// Gives how many runs there were.
int expect_runs_to_replay(const journal::Reader& journal) {
  Governor::Options governor = Governor::Options::recommended();
  // As it was run.
  governor.limits.backoff.healthy = std::chrono::seconds(1);
  governor.limits.restarts = {};
  int runs = 0;
  std::int64_t before = 0;
  while (true) {
    const auto session = journal.newest(journal::kind::kSession, before);
    if (!session || !*session) return runs;
    before = (*session)->id;
    ++runs;
    auto recording = replay::Recording::open(journal, before);
    EXPECT_TRUE(recording) << recording.error();
    if (!recording) continue;
    const auto repetition =
        replay::repeat(*recording, journal, std::make_unique<BayesPlanner>(), governor);
    EXPECT_TRUE(repetition) << repetition.error();
    if (repetition && repetition->difference)
      ADD_FAILURE() << "the run of row " << before << " decides otherwise, first in row "
                    << repetition->difference->row;
  }
}

TEST_F(Chaos, CulpritMayBeKilledAtAnyInstant) {
  const int kills = setting("CULPRIT_CHAOS_KILLS", 4);
  const std::set<std::string> memory_before = names_in("/dev/shm", "");
  const std::set<std::string> temporary_before = names_in(fs::temp_directory_path(), "culprit");
  lab::LiveSunset robot(world);
  ASSERT_TRUE(robot.is_well_within(30s)) << robot.complaint();
  const int witness = robot.processes(sunset::Member::kWorld).at(0);
  const Holdings witness_before = holdings_of(witness);
  // A process that is stopped before any culprit has seen it cannot be known to be there.
  const Holdings first = see_the_whole_robot();
  Census census(robot);
  int ended_well = kill_over_and_over(robot, kills,
                                      [&](lab::LiveSunset& each) { each.break_something(random); });

  TestProgram last = run();
  if (robot.is_well_within(180s)) {
    ended_well = HasFailure() ? ended_well : kills;
  } else {
    ADD_FAILURE() << robot.complaint() << "\n" << last.output();
  }
  EXPECT_THAT(census.end(), testing::IsEmpty());
  const Holdings at_last = holdings_of(last.pid());
  last.signal(SIGINT);
  EXPECT_EQ(last.wait(), 0) << last.output();

  expect_whole_journal();
  const journal::Reader reader = journal();
  OutcomesCount count;
  auto rows = reader.entries(journal::Which::kReadable);
  ASSERT_TRUE(rows) << rows.error();
  journal::Entry entry;
  for (auto more = rows->next(entry); more && *more; more = rows->next(entry)) count.follow(entry);
  count.compare(*reader.learned());
  const int runs = expect_runs_to_replay(reader);

  expect_each_node_once(robot);
  EXPECT_EQ(names_in("/dev/shm", ""), memory_before);
  std::set<std::string> temporary = names_in(fs::temp_directory_path(), "culprit");
  temporary.erase(world.folder().filename().string());
  for (const std::string& each : temporary_before) temporary.erase(each);
  EXPECT_THAT(temporary, testing::IsEmpty());
  const Holdings witness_after = holdings_of(witness);
  EXPECT_LE(witness_after.descriptors, witness_before.descriptors);
  EXPECT_LE(at_last.descriptors, first.descriptors + 20);

  if (HasFailure()) keep_evidence(robot);
  std::cout << "\n"
            << ended_well << " of " << kills << " kills ended well, processes were counted "
            << census.counts() << " times, " << runs << " runs on record, " << count.outcomes()
            << " outcomes counted; first culprit: " << first.descriptors << " descriptors, "
            << first.kilobytes << " KiB; last: " << at_last.descriptors << ", " << at_last.kilobytes
            << " KiB; a node that lived through it: " << witness_before.descriptors << ", "
            << witness_before.kilobytes << " KiB before, " << witness_after.descriptors << ", "
            << witness_after.kilobytes << " KiB after\n";
}

// Where nothing can be kept, culprit heals all the same, and knows its processes from themselves. The settings that it has
// changed it cannot know.
TEST_F(Chaos, CulpritMayBeKilledWhileTheDiskIsFull) {
  SmallDisk small(world.folder() / "disk");
  if (!small.is_there()) GTEST_SKIP() << "no disk can be mounted here";
  disk = world.folder() / "disk";
  const int kills = setting("CULPRIT_CHAOS_KILLS", 4);
  lab::LiveSunset robot(world);
  ASSERT_TRUE(robot.is_well_within(30s)) << robot.complaint();
  see_the_whole_robot();
  Census census(robot);
  kill_over_and_over(robot, kills, [&](lab::LiveSunset& each) {
    each.break_something(random, lab::LiveSunset::faults_of_processes());
    if (random() % 3 == 0) small.free();
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 1000));
    if (random() % 4 != 0) small.fill();
  });
  small.fill();
  TestProgram last = run();
  EXPECT_TRUE(robot.is_well_within(180s)) << robot.complaint() << "\n" << last.output();
  EXPECT_THAT(census.end(), testing::IsEmpty());
  small.free();
  last.signal(SIGINT);
  EXPECT_EQ(last.wait(), 0) << last.output();
  expect_whole_journal();
  expect_each_node_once(robot);
  if (HasFailure()) keep_evidence(robot);
}

// A node that is inactive when it starts, was activated by a culprit that is gone, and died before
// the next one came.
TEST_F(Chaos, WhatDiedWhileNobodyWatchedComesBackAsItWas) {
  lab::LiveSunset robot(world);
  ASSERT_TRUE(robot.is_well_within(30s)) << robot.complaint();
  {
    TestProgram culprit = run();
    ASSERT_TRUE(culprit.prints("fusion is there")) << culprit.output();
    ASSERT_TRUE(robot.inject("image_degradation"));
    ASSERT_TRUE(culprit.prints("resolved by enhancement_activate")) << culprit.output();
    culprit.signal(SIGKILL);
    culprit.wait();
  }
  ASSERT_TRUE(robot.inject("kill:image_enhancement"));
  TestProgram culprit = run();
  EXPECT_TRUE(culprit.prints("redeploy image_enhancement: done")) << culprit.output();
  EXPECT_TRUE(robot.is_well_within(30s)) << robot.complaint() << "\n" << culprit.output();
}

}  // namespace
}  // namespace culprit::cli
