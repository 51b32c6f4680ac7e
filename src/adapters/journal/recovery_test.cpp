// What a run takes from the one before, when rows are not what was written.
#include "journal/recovery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_expected.h"
#include "base/test_folder.h"
#include "journal/event_json.h"
#include "journal/writer.h"
#include "language/checker.h"

namespace culprit::journal {
namespace {

using culprit::test::value_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kRecoveredAt = 1'800'000'000'000'000'000;

struct JournalRecovery : testing::Test {
  JournalRecovery() {
    Session session;
    session.boot = boot_id();
    Batch all;
    all.entries.push_back(
        {0, kRecoveredAt, std::string(kind::kSession), to_text(to_json(session))});
    all.entries.push_back({0, kRecoveredAt, std::string(kind::kSteps), "anything"});
    all.entries.push_back({0, kRecoveredAt, std::string(kind::kEvent), found(4242)});
    Writer writer = value_of(Writer::open(path, {}));
    EXPECT_TRUE(writer.append(all, kRecoveredAt, Durability::kProcessEnd));
  }

  std::string found(int pid) const {
    Json row = to_json(Event{Time(), ComponentFound{ComponentId(0), pid}}, rules);
    return to_text(row);
  }
  void change(const std::string& sql) {
    auto database = value_of(Database::open(path, Database::Mode::kWrite));
    ASSERT_TRUE(database.run(sql));
  }
  Recovery recovered() {
    const Reader reader = value_of(Reader::open(path));
    return value_of(recover(reader, {}, rules, {Time(), kRecoveredAt}));
  }
  static std::vector<int> processes(const History& past) {
    std::vector<int> pids;
    for (const Event& event : past) {
      if (const auto* seen = std::get_if<ComponentFound>(&event.what)) pids.push_back(seen->pid);
    }
    return pids;
  }

  const RuleSet rules = *check(Source("my.rules", "COMPONENT camera NODE /camera\n")).rules;
  culprit::test::TestFolder folder;
  const std::filesystem::path path = folder / "a.journal";
};

TEST_F(JournalRecovery, KnowsTheProcessesOfRowsThatAreAsTheyWereWritten) {
  const Recovery recovery = recovered();
  EXPECT_THAT(processes(recovery.past), ElementsAre(4242));
  EXPECT_THAT(recovery.given_up, IsEmpty());
}

TEST_F(JournalRecovery, TakesNoProcessFromARowWithAWrongHash) {
  change("UPDATE entry SET body = '" + found(1) + "' WHERE id = 3");
  const Recovery recovery = recovered();
  EXPECT_THAT(processes(recovery.past), IsEmpty());
  EXPECT_THAT(recovery.given_up, ElementsAre(HasSubstr("row 3 (event) is not what was written")));
}

TEST_F(JournalRecovery, NorFromOneThatWasAdded) {
  change("INSERT INTO entry SELECT 4, at, kind, '" + found(1) + "', hash FROM entry WHERE id = 3");
  EXPECT_THAT(processes(recovered().past), ElementsAre(4242));
}

TEST_F(JournalRecovery, NorFromTheBeginningOfARun) {
  change("UPDATE entry SET body = json_set(body, '$.past', json('[" + found(1) +
         "]')) WHERE id = 1");
  const Recovery recovery = recovered();
  EXPECT_TRUE(recovery.had_run);
  EXPECT_TRUE(recovery.orders_kept) << "whether it was paused, it does not tell";
  EXPECT_THAT(processes(recovery.past), IsEmpty());
  EXPECT_THAT(recovery.given_up, ElementsAre(HasSubstr("row 1 (session)")));
}

}  // namespace
}  // namespace culprit::journal
