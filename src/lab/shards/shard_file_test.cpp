#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "shards/merge.h"
#include "shards/shard_damage.h"
#include "shards/shard_writer.h"
#include "study/csv.h"
#include "study/sealed_line.h"
#include "study/test_findings.h"
#include "suave_study/suave_record.h"
#include "sunset_study/json.h"

namespace culprit::study {
namespace {

constexpr std::uint32_t kRuns = 7;  // of each of the nine rows

std::string fresh_file(const std::string& name) {
  const auto path = std::filesystem::path(testing::TempDir()) / ("culprit-" + name);
  std::filesystem::remove(path);
  return path.string();
}

std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void overwrite(const std::string& path, const std::string& bytes) {
  std::filesystem::remove(path);  // a file system may wait for the disk where a file is emptied
  std::ofstream(path, std::ios::binary) << bytes;
}

ShardHeader<Campaign> header(Shard shard) { return {synthetic_campaign(kRuns), shard}; }

// Works off at most `most` runs.
void work(const std::string& path, Shard shard, std::uint64_t most = 1000) {
  Expected<ShardWriter<Campaign>> writer = ShardWriter<Campaign>::open(path, header(shard));
  ASSERT_TRUE(writer) << writer.error();
  for (std::uint64_t i = 0; i < most && !writer->is_complete(); ++i) {
    const RunId id = writer->next();
    ASSERT_TRUE(writer->append(synthetic_run(synthetic_campaign(kRuns).rows[id.row], id)));
  }
}

std::vector<std::string> worked_shards(std::uint32_t count) {
  std::vector<std::string> paths;
  for (std::uint32_t i = 1; i <= count; ++i) {
    paths.push_back(fresh_file("shard" + std::to_string(i) + "of" + std::to_string(count)));
    work(paths.back(), {i, count});
  }
  return paths;
}

std::string merge_error(const std::vector<std::string>& paths) {
  const auto merged = merge_files(paths);
  return merged ? "merged" : merged.error();
}

// The error for a shard file with this text.
std::string read_error(const std::string& text) {
  std::istringstream in(text);
  const ShardSource source{"x", &in};
  const auto merged = merge(std::span(&source, 1));
  return merged ? "merged" : merged.error();
}

TEST(Shard, IsWrittenAsNumberOfCount) {
  EXPECT_EQ(*parse_shard("2/4"), (Shard{2, 4}));
  for (const char* wrong : {"", "/", "2", "2/", "/4", "0/4", "5/4", "-1/4", "2/4x", "1/100001",
                            "1/99999999999999999999", " 1/2", "1/2/3"})
    EXPECT_FALSE(parse_shard(wrong)) << wrong;
  EXPECT_EQ(parse_shard("5/4").error(),
            "'5/4' is no shard; write i/n with 1 <= i <= n <= 100000, as in 2/4");
}

RC_GTEST_PROP(Shard, SharesTheRunsOut, ()) {
  const auto campaign = synthetic_campaign(*rc::gen::inRange<std::uint32_t>(1, 20));
  const auto count = *rc::gen::inRange<std::uint32_t>(1, 300);
  std::vector<int> taken(campaign.size());
  for (std::uint32_t number = 1; number <= count; ++number) {
    const Shard shard{number, count};
    for (std::uint64_t i = 0; i < size(shard, campaign); ++i) ++taken.at(campaign_index(shard, i));
  }
  RC_ASSERT(taken == std::vector<int>(campaign.size(), 1));
}

// The same to the last bit, however the work was spread.
TEST(Merge, GivesWhatOneProcessFinds) {
  const std::string expected = json({synthetic_result(kRuns), {}, {}});
  for (const std::uint32_t count : {1u, 2u, 5u, 100u}) {
    auto paths = worked_shards(count);
    std::reverse(paths.begin(), paths.end());
    const auto merged = merge_files(paths);
    ASSERT_TRUE(merged) << merged.error();
    const auto& result = std::get<CampaignResult>(*merged);
    EXPECT_EQ(json({result, {}, {}}), expected) << count;
    EXPECT_EQ(result.campaign, synthetic_campaign(kRuns));
    EXPECT_EQ(metrics_csv(result), metrics_csv(synthetic_result(kRuns)));
  }
}

TEST(Merge, WantsEachShardOnce) {
  const auto paths = worked_shards(3);
  EXPECT_EQ(merge_error({}), "there is nothing to merge; name the shard files");
  EXPECT_EQ(merge_error({paths[0], paths[2]}),
            "of the shards of 'SYNTHETIC DATA OF A TEST, NOT MEASURED' these are missing: 2/3; run "
            "them with --shard and merge all");
  EXPECT_EQ(merge_error({paths[0], paths[1], paths[1], paths[2]}),
            paths[1] + " and " + paths[1] + " are both shard 2/3; leave one of them out");
  EXPECT_EQ(
      merge_error({paths[0], worked_shards(2)[1]}),
      fresh_file("shard2of2") +
          ": has shard 2/2, but the first file has 1/3; merge the shards of one campaign only");
  EXPECT_EQ(merge_error({"no/such/file"}),
            "no/such/file: cannot be read: No such file or directory");
}

TEST(Merge, TakesShardsOfOneCampaignOnly) {
  const auto other = [](auto change) {
    ShardHeader<Campaign> changed = header({1, 1});
    change(changed.campaign);
    std::istringstream ours(header_line(header({1, 1})));
    std::istringstream theirs(header_line(changed));
    const std::array sources = {ShardSource{"ours", &ours}, ShardSource{"theirs", &theirs}};
    return merge(sources).error();
  };
  const std::string end = "; merge the shards of one campaign only";
  EXPECT_EQ(other([](Campaign& c) { c.version = "9"; }),
            "theirs: has culprit version 9, but the first file has 0.0-test" + end);
  EXPECT_EQ(other([](Campaign& c) { c.seed = 1; }),
            "theirs: has seed 1, but the first file has 42" + end);
  EXPECT_EQ(other([](Campaign& c) { c.runs = 8; }),
            "theirs: has a number of runs of 8, but the first file has 7" + end);
  EXPECT_EQ(other([](Campaign& c) { c.rows[0].planner = "bayes"; }),
            "theirs: has other configurations than the first file" + end);
  EXPECT_EQ(other([](Campaign& c) { c.command = "x"; }),
            "theirs: was made by 'x', but the first file by 'SYNTHETIC DATA OF A TEST, NOT "
            "MEASURED'" +
                end);
}

SuaveCampaign suave_campaign() {
  SuaveCampaign campaign;
  campaign.plan = *suave::model::find_mission_plan("stress");
  campaign.generation = *suave::model::find_generation("new");
  campaign.managers = {"bt", "culprit"};
  campaign.runs = 1;
  return campaign;
}

TEST(Merge, TakesShardsOfOneStudyOnly) {
  std::istringstream ours(header_line(header({1, 1})));
  std::istringstream theirs(header_line(ShardHeader<SuaveCampaign>{suave_campaign(), {1, 1}}));
  const std::array sources = {ShardSource{"ours", &ours}, ShardSource{"theirs", &theirs}};
  EXPECT_EQ(merge(sources).error(),
            "theirs: is of the study 'suave', not of 'sunset'; shards of one campaign belong "
            "together");
}

TEST(Merge, RefusesAnUnfinishedShard) {
  const std::string path = fresh_file("unfinished");
  work(path, {1, 1}, 37);
  EXPECT_EQ(merge_error({path}),
            path + ": holds 37 of 63 runs; run shard 1/1 again, it goes on where it stopped");
}

TEST(ShardFile, GoesOnWhereItWasInterrupted) {
  const std::string whole = fresh_file("whole");
  work(whole, {2, 3});
  const std::string path = fresh_file("interrupted");
  work(path, {2, 3}, 4);
  work(path, {2, 3}, 3);
  work(path, {2, 3});
  EXPECT_EQ(content(path), content(whole));
  work(path, {2, 3});
  EXPECT_EQ(content(path), content(whole)) << "nothing is left to do";
}

// Wherever the process died.
TEST(ShardFile, DropsHalfALineAndRepeatsThatRun) {
  const std::string path = fresh_file("torn");
  work(path, {2, 9});
  const std::string whole = content(path);
  const std::size_t begin_of_last_run = whole.rfind("{\"row\"");
  const std::size_t header = whole.find('\n');
  // In the header in steps; around its end, and in the last two lines, at each byte.
  for (std::size_t length = 0; length <= whole.size(); length += length < header - 2 ? 97
                                                                 : length == header + 2
                                                                     ? begin_of_last_run - length
                                                                     : 1) {
    overwrite(path, whole.substr(0, length));
    work(path, {2, 9});
    ASSERT_EQ(content(path), whole) << length;
  }
}

TEST(ShardFile, TellsTheRunsThatAreThereAlready) {
  const std::string path = fresh_file("found");
  work(path, {2, 3}, 4);
  std::vector<RunMetrics> found;
  const auto writer = ShardWriter<Campaign>::open(
      path, header({2, 3}), [&](const RunMetrics& run) { found.push_back(run); });
  ASSERT_TRUE(writer);
  EXPECT_EQ(writer->done(), 4u);
  EXPECT_EQ(writer->next(), (RunId{1, 6}));
  ASSERT_EQ(found.size(), 4u);
  const Campaign campaign = synthetic_campaign(kRuns);
  EXPECT_EQ(found[3], synthetic_run(campaign.rows[1], RunId{1, 3}));
}

// No byte may be changed unnoticed: neither when shards are merged nor when one goes on.
TEST(ShardFile, NoticesEveryChangedByte) {
  const std::string path = fresh_file("changed");
  work(path, {1, 9});
  const std::string whole = content(path);
  ASSERT_NE(merge_error({path}), "merged") << "one of nine";
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    std::istringstream in(changed);
    auto reader = ShardReader<Campaign>::open(in, "x");
    bool is_good = reader.has_value();
    while (is_good) {
      const auto run = reader->next();
      is_good = run.has_value();
      if (is_good && !run->has_value()) {
        is_good = reader->is_complete();
        break;
      }
    }
    ASSERT_FALSE(is_good) << "at " << at;
  }
}

TEST(ShardFile, LeavesADamagedFileAsItIs) {
  const std::string path = fresh_file("damaged");
  work(path, {1, 1}, 5);
  std::string damaged = content(path);
  damaged[damaged.find("\"ratio\":") + 8] ^= 1;
  overwrite(path, damaged);
  const auto writer = ShardWriter<Campaign>::open(path, header({1, 1}));
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error(), path +
                                ":2: the line is damaged: its checksum does not fit; remove the "
                                "file and run its shard again");
  EXPECT_EQ(content(path), damaged);
}

TEST(ShardDamage, IsKeptAsideAndTheShardGoesOnBeforeIt) {
  const std::string path = fresh_file("mended");
  for (const auto& each : std::filesystem::directory_iterator(testing::TempDir())) {
    if (each.path().string().starts_with(path + ".damaged")) std::filesystem::remove(each.path());
  }
  work(path, {1, 1});
  const std::string whole = content(path);
  std::size_t third = 0;  // the line of the second run
  for (int lines = 0; lines < 2; ++lines) third = whole.find('\n', third) + 1;
  std::string damaged = whole;
  damaged[third + 9] ^= 1;
  overwrite(path, damaged);
  const auto aside = set_damage_aside<Campaign>(path, header({1, 1}));
  ASSERT_TRUE(aside) << aside.error();
  EXPECT_EQ(content(*aside), damaged);
  EXPECT_EQ(content(path), whole.substr(0, third));
  work(path, {1, 1});
  EXPECT_EQ(content(path), whole);
  // Also where nothing can be saved.
  damaged = whole;
  damaged[40] ^= 1;
  overwrite(path, damaged);
  ASSERT_TRUE(set_damage_aside<Campaign>(path, header({1, 1})));
  work(path, {1, 1});
  EXPECT_EQ(content(path), whole);
}

TEST(ShardDamage, NothingElseIsSetAside) {
  const std::string path = fresh_file("undamaged");
  work(path, {1, 2}, 3);
  const std::string before = content(path);
  EXPECT_FALSE(set_damage_aside<Campaign>(path, header({1, 2}))) << "it is not damaged";
  EXPECT_FALSE(set_damage_aside<Campaign>(path, header({2, 2}))) << "of another shard";
  EXPECT_EQ(content(path), before);
  overwrite(path, "a text that somebody named by mistake\n");
  EXPECT_FALSE(set_damage_aside<Campaign>(path, header({1, 2})));
}

TEST(ShardFile, IsNotWrittenOverAnotherCampaign) {
  const std::string path = fresh_file("other");
  work(path, {1, 1}, 1);
  const std::string before = content(path);
  ShardHeader<Campaign> other = header({1, 1});
  other.campaign.seed = 43;
  const auto writer = ShardWriter<Campaign>::open(path, other);
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error(),
            path +
                ": belongs to another campaign or shard (SYNTHETIC DATA OF A TEST, NOT MEASURED, "
                "shard 1/1, culprit 0.0-test); choose another file");
  overwrite(path, "my thesis");
  EXPECT_FALSE(ShardWriter<Campaign>::open(path, other));
  EXPECT_EQ(content(path), "my thesis");
  EXPECT_NE(before, "");
}

TEST(ShardFile, IsWrittenByOneProcessAtATime) {
  const std::string path = fresh_file("locked");
  const auto first = ShardWriter<Campaign>::open(path, header({1, 1}));
  ASSERT_TRUE(first);
  const auto second = ShardWriter<Campaign>::open(path, header({1, 1}));
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error(),
            path + ": another process writes it; wait for that, or choose another file");
}

TEST(ShardFile, RefusesWhatWouldNotComeBack) {
  auto writer = ShardWriter<Campaign>::open(fresh_file("infinite"), header({1, 1}));
  RunMetrics run;
  run.reactions_s = {1, std::numeric_limits<double>::infinity()};
  EXPECT_FALSE(writer->append(run));
  EXPECT_EQ(writer->done(), 0u);
  EXPECT_FALSE(ShardWriter<Campaign>::open("no/such/folder/file", header({1, 1})));
}

RC_GTEST_PROP(ShardFile, BringsNumbersBackToTheLastBit, (double value)) {
  RC_PRE(std::isfinite(value));
  Campaign campaign;
  campaign.rows.resize(1);
  campaign.runs = 1;
  RunMetrics run;
  run.ratio = value;
  run.reactions_s = {value, value / 3};
  run.honest.recovery_s = value * 0x1p-1040;
  std::istringstream in(header_line(ShardHeader<Campaign>{campaign, {1, 1}}) +
                        run_line({0, 0}, run) + end_line(1));
  auto reader = ShardReader<Campaign>::open(in, "x");
  RC_ASSERT(**reader->next() == run);
  RC_ASSERT(!reader->next()->has_value());
  RC_ASSERT(reader->is_complete());
}

RC_GTEST_PROP(ShardFile, BringsRunsOfSuaveBackToTheLastBit, (double value)) {
  RC_PRE(std::isfinite(value));
  SuaveRun run;
  run.search_s = value;
  run.distance_m = value / 3;
  run.visibility.answered_s = {value, value / 7};
  run.thruster.unanswered_s = {-value};
  run.battery.answered_s = {value * 0x1p-1040};
  run.is_found = run.is_success = value > 0;
  run.found_s = value / 9;
  run.whole_distance_m = value / 11;
  std::istringstream in(header_line(ShardHeader<SuaveCampaign>{suave_campaign(), {1, 1}}) +
                        run_line({0, 0}, run) + run_line({1, 0}, SuaveRun()) + end_line(2));
  auto reader = ShardReader<SuaveCampaign>::open(in, "x");
  RC_ASSERT(reader->header().campaign == suave_campaign());
  RC_ASSERT(**reader->next() == run);
  RC_ASSERT(**reader->next() == SuaveRun());
  RC_ASSERT(!reader->next()->has_value());
  RC_ASSERT(reader->is_complete());
}

TEST(ShardFile, SaysWhatIsWrongWithACampaignOfSuave) {
  const auto complaint = [](const char* field, const Json& value) {
    std::string line = header_line(ShardHeader<SuaveCampaign>{suave_campaign(), {1, 1}});
    line.pop_back();
    Json json = *unsealed(line);
    json["campaign"][field] = value;
    return read_error(sealed_line(json));
  };
  const std::string begin = "x: has a wrong header: campaign is wrong: ";
  EXPECT_EQ(complaint("managers", Json::array()), begin + "managers is wrong: there is no manager");
  EXPECT_EQ(complaint("managers", {"bt", 3}), begin + "managers holds something that is no text");
  EXPECT_EQ(complaint("managers", {"bt", "bt"}),
            begin + "managers is wrong: manager 'bt' is there twice");
  EXPECT_EQ(complaint("managers", {"me"}),
            begin +
                "managers is wrong: there is no manager 'me'; there are none, random, bt, "
                "metacontrol, rosa, rebet, rebet-ucb, rebet-greedy, rebet-random, bandit, "
                "ac-ros, vogel, ghahremani, culprit");
  EXPECT_EQ(complaint("mission", "moon").find(begin + "mission is wrong: "), 0u);
  EXPECT_EQ(complaint("generation", "next").find(begin + "generation is wrong: "), 0u);
  EXPECT_EQ(complaint("runs", 0), begin + "runs is 0");
  EXPECT_EQ(complaint("more", 1), begin + "there are more fields than known");
}

TEST(ShardFile, SaysWhatIsWrongWithItsLines) {
  Campaign campaign;
  campaign.rows.resize(1);
  campaign.runs = 2;
  const std::string head = header_line(ShardHeader<Campaign>{campaign, {1, 1}});
  const std::string run = run_line({0, 0}, RunMetrics());
  const std::string end = "; remove the file and run its shard again";
  EXPECT_EQ(read_error(""), "x: is no shard file of culprit, or its first line is damaged" + end);
  EXPECT_EQ(read_error(sealed_line({{"format", "other"}})), "x: is no shard file of culprit");
  EXPECT_EQ(read_error(sealed_line({{"format", "culprit-shard"}, {"format_version", 1}})),
            "x: has format version 1, but this culprit reads 2; use the culprit that wrote it");
  EXPECT_EQ(read_error(beginning_line({"moon", {1, 1}, {}})),
            "x: has a wrong header: campaign is no JSON object");
  EXPECT_EQ(read_error(beginning_line({"moon", {1, 1}, Json::object()})),
            "x: is of a study 'moon' that this culprit does not know; use the culprit that wrote "
            "it");
  EXPECT_EQ(read_error(head + run + run), "x:3: here should be run 1 of row 0" + end);
  EXPECT_EQ(read_error(head + run + end_line(2)),
            "x:3: the last line says 2 runs, but there are 1 before it" + end);
  EXPECT_EQ(read_error(head + run + end_line(1)),
            "x:3: the last line says 1 runs, but there are 1 before it" + end);
  EXPECT_EQ(read_error(head + run + run_line({0, 1}, RunMetrics()) + end_line(2) + "\n"),
            "x:5: there is something after the last line" + end);
  EXPECT_EQ(read_error(head + std::string(2 << 20, 'x')), "x:2: the line is too long" + end);
  EXPECT_EQ(read_error(head + sealed_line({{"row", 0}, {"run", 0}, {"metrics", 3}})),
            "x:2: metrics is no JSON object" + end);
}

TEST(ShardFile, SaysWhichFieldIsWrong) {
  const auto complaint = [](const char* field, const Json& value) {
    Campaign campaign;
    campaign.rows.resize(1);
    campaign.runs = 1;
    std::string line = run_line({0, 0}, RunMetrics());
    line.pop_back();
    Json json = *unsealed(line);
    json["metrics"].at(Json::json_pointer(field)) = value;
    const std::string error =
        read_error(header_line(ShardHeader<Campaign>{campaign, {1, 1}}) + sealed_line(json));
    return error.substr(0, error.find(';'));
  };
  EXPECT_EQ(complaint("/ratio", "x"), "x:2: metrics is wrong: ratio is no finite number");
  EXPECT_EQ(complaint("/ratio", nullptr), "x:2: metrics is wrong: ratio is no finite number");
  EXPECT_EQ(complaint("/reactions_s", {1, "x"}),
            "x:2: metrics is wrong: reactions_s holds something that is no finite number");
  EXPECT_EQ(complaint("/honest/faults", -1),
            "x:2: metrics is wrong: honest is wrong: faults is no whole number of at least 0");
  EXPECT_EQ(complaint("/honest/root_causes/top", 1),
            "x:2: metrics is wrong: honest is wrong: root_causes is wrong: asked is less than what "
            "was right");
  EXPECT_EQ(complaint("/unnecessary_redeployments", std::uint64_t{1} << 63U),
            "x:2: metrics is wrong: unnecessary_redeployments is no whole number of at least "
            "-2147483648");
}

}  // namespace
}  // namespace culprit::study
