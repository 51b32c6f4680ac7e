#include "journal/learned.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/test_expected.h"
#include "journal/session.h"
#include "json/json.h"

namespace culprit::journal {
namespace {

using culprit::test::value_of;

TEST(Learned, OfAFleetIsAddedUp) {
  Learned ours;
  ours.beliefs = {{"R", "s", {6, 5}, {5, 5}}};  // helped once
  Learned theirs;
  theirs.beliefs = {{"R", "s", {10, 7}, {8, 4}}, {"R", "t", {3, 2}, {2, 2}}};  // other priors
  theirs.couplings = {{"R", "S", {2, 1, 0.5}}};
  merge(ours, theirs);
  merge(ours, theirs);
  EXPECT_EQ(ours.beliefs[0].belief, (Belief{10, 11})) << "twice two successes, three failures";
  EXPECT_EQ(ours.beliefs[1].belief, (Belief{4, 2}));
  EXPECT_EQ(ours.couplings[0].coupling, (Coupling{4, 2, 1}));
}

TEST(Learned, LatenciesOfAFleetAreTheShortestAndTheLongest) {
  Learned ours{.latencies = {{"R", 2, 0.5, 1.5}, {"Forgotten", 0, 0, 0}}};
  merge(ours, {.latencies = {
                   {"R", 3, 1, 2}, {"Forgotten", 1, 3, 4}, {"S", 1, 0.1, 0.1}, {"T", 0, 0, 0}}});
  EXPECT_EQ(ours.latencies, (std::vector<LearnedLatency>{
                                {"R", 5, 0.5, 2}, {"Forgotten", 1, 3, 4}, {"S", 1, 0.1, 0.1}}));
  merge(ours, {.latencies = {{"R", Latencies::Learned::kMost, 1, 1}}});
  EXPECT_EQ(ours.latencies[0].count, Latencies::Learned::kMost);
}

TEST(Learned, FailuresThatClearByThemselvesAreKeptBesideLatencies) {
  const Transients::Seen seen{3, 1, std::chrono::milliseconds(2500)};
  Transients::Seen read;
  for (const LearnedLatency& each : named("R", seen)) {
    const auto part = transients_from(each);
    ASSERT_TRUE(part);
    EXPECT_EQ(part->first, "R");
    read.cleared += part->second.cleared;
    read.stayed += part->second.stayed;
    read.longest = std::max(read.longest, part->second.longest);
  }
  EXPECT_EQ(read, seen);
  EXPECT_FALSE(transients_from({"R", 1, 2, 2}));
}

TEST(Learned, LatenciesAreKeptToTheNanosecond) {
  const Latencies::Learned learned{
      7, {Duration(1'234'567'891), Duration(86'400'000'000'001), Duration(1'234'567'891)}};
  EXPECT_EQ(latency_from(named("R", learned)), learned);
  const Learned read = value_of(
      learned_from_json(parse_json(to_line(to_json({.latencies = {named("R", learned)}})))));
  EXPECT_EQ(latency_from(read.latencies.at(0)), learned);
}

TEST(Learned, ExposureIsKeptToTheLastBitAndOlderCouplingsHaveNone) {
  Learned all{.couplings = {{"R", "S", {2, 1, 31.0 / 7}}}};
  const auto read = [](const std::string& text) {
    return value_of(learned_from_json(parse_json(text))).couplings;
  };
  EXPECT_EQ(read(to_line(to_json(all))), all.couplings);
  EXPECT_EQ(read(R"({"beliefs":[],"couplings":[
                     {"cause":"R","effect":"S","cleared":2,"stayed":1}]})"),
            (std::vector<LearnedCoupling>{{"R", "S", {2, 1, 0}}}));
  EXPECT_FALSE(learned_from_json(parse_json(R"({"beliefs":[],"couplings":[
      {"cause":"R","effect":"S","cleared":2,"stayed":1,"spared":-1}]})")));
}

TEST(Learned, LatenciesThatCannotBeAreRefused) {
  for (const char* wrong :
       {R"({})", R"([{"rule":"R"}])", R"([{"rule":"R","count":-1,"least_s":1,"most_s":2}])",
        R"([{"rule":"R","count":1,"least_s":3,"most_s":2}])",
        R"([{"rule":"R","count":1,"least_s":-1,"most_s":2}])",
        R"([{"rule":"R","count":1,"least_s":1,"most_s":1e300}])",
        R"([{"rule":"R","count":9000000000,"least_s":1,"most_s":2}])"}) {
    EXPECT_FALSE(learned_from_json(
        parse_json(R"({"beliefs":[],"couplings":[],"latencies":)" + std::string(wrong) + "}")))
        << wrong;
  }
  EXPECT_TRUE(learned_from_json(parse_json(R"({"beliefs":[],"couplings":[]})"))) << "of version 1";
}

TEST(Learned, FailuresThatBeganTogetherAreAddedUpInWhateverOrderTheyAreNamed) {
  Learned ours = value_of(learned_from_json(parse_json(
      R"({"beliefs":[],"couplings":[],"coincidences":[{"rule":"S","other":"R","count":2}]})")));
  EXPECT_EQ(ours.coincidences, (std::vector<LearnedCoincidence>{{"R", "S", 2}}));
  EXPECT_EQ(value_of(learned_from_json(parse_json(to_line(to_json(ours))))).coincidences,
            ours.coincidences);
  Learned theirs;
  theirs.coincidences = {{"R", "R", Coincidences::kMost}, {"R", "S", 3}};
  merge(ours, theirs);
  merge(ours, theirs);
  EXPECT_EQ(ours.coincidences,
            (std::vector<LearnedCoincidence>{{"R", "S", 8}, {"R", "R", Coincidences::kMost}}));
}

TEST(Learned, CountsOfFailuresThatCannotBeAreRefused) {
  for (const char* wrong :
       {R"({})", R"([{"rule":"R","other":"S"}])", R"([{"rule":"R","other":"S","count":-1}])",
        R"([{"rule":"R","other":"S","count":9000000000}])"}) {
    EXPECT_FALSE(learned_from_json(
        parse_json(R"({"beliefs":[],"couplings":[],"coincidences":)" + std::string(wrong) + "}")))
        << wrong;
  }
}

TEST(Learned, FailuresThatBeganTogetherAreNamedOnceTheyChange) {
  RuleSet rules;
  rules.rules.resize(2);
  rules.rules[0].name = "S";
  rules.rules[1].name = "R";
  Coincidences before(rules);
  before.began(RuleId(0), {});
  Coincidences now = before;
  EXPECT_TRUE(named(now, before, rules).empty());
  now.began(RuleId(1), std::vector{RuleId(0)});
  EXPECT_EQ(named(now, before, rules),
            (std::vector<LearnedCoincidence>{{"R", "R", 1}, {"R", "S", 1}}));
}

TEST(Learned, GrowsFromANewPriorByWhatWasCounted) {
  EXPECT_EQ(grown_from({9, 1}, {"R", "s", {6, 7}, {5, 5}}), (Belief{10, 3}));
}

}  // namespace
}  // namespace culprit::journal
