#include "http/hub.h"

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "http/event_stream.h"

namespace culprit::http {
namespace {

using namespace std::chrono_literals;

std::vector<std::string> told(const Hub::Batch& batch) {
  std::vector<std::string> data;
  for (const Message& message : batch.messages) data.push_back(*message.data);
  return data;
}

TEST(Hub, GivesEveryEventAndOnlyTheNewestState) {
  Hub hub;
  hub.publish(Kind::kState, "state 1");
  hub.publish(Kind::kEvent, "event 1");
  hub.publish(Kind::kState, "state 2");
  hub.publish(Kind::kEvent, "event 2");
  EXPECT_THAT(told(hub.wait(0, 0ms)), testing::ElementsAre("event 1", "state 2", "event 2"));
}

TEST(Hub, GoesOnBehindWhatAReaderHad) {
  Hub hub;
  for (const char* event : {"a", "b", "c"}) hub.publish(Kind::kEvent, event);
  const auto first = hub.wait(0, 0ms).messages.front().number;
  EXPECT_THAT(told(hub.wait(first, 0ms)), testing::ElementsAre("b", "c"));
}

TEST(Hub, ForgetsTheOldestEventsAndSaysSo) {
  Hub hub;
  for (std::size_t i = 0; i < Hub::kMostEvents + 10; ++i) hub.publish(Kind::kEvent, "x");
  EXPECT_TRUE(hub.wait(1, 0ms).is_gap);
  EXPECT_FALSE(hub.wait(hub.last() - 1, 0ms).is_gap);
  std::size_t kept = 0;
  for (std::uint64_t seen = 0;;) {
    const Hub::Batch batch = hub.wait(seen, 0ms);
    if (batch.messages.empty()) break;
    EXPECT_LE(batch.messages.size(), Hub::kBatch);
    kept += batch.messages.size();
    seen = batch.messages.back().number;
  }
  EXPECT_EQ(kept, Hub::kMostEvents);
}

TEST(Hub, IsBoundedInBytesToo) {
  Hub hub;
  const std::string large(Hub::kMostBytes / 4, 'x');
  for (int i = 0; i < 10; ++i) hub.publish(Kind::kEvent, large);
  EXPECT_LE(hub.wait(0, 0ms).messages.size(), 4u);
}

TEST(Hub, WakesThePublisherForTheFirstReader) {
  int woken = 0;
  Hub hub([&] { ++woken; });
  {
    const Hub::Reader first(hub);
    const Hub::Reader second(hub);
    EXPECT_TRUE(hub.has_readers());
  }
  EXPECT_FALSE(hub.has_readers());
  EXPECT_EQ(woken, 1);
}

TEST(Hub, LetsAWaitingReaderGoWhenItIsClosed) {
  Hub hub;
  std::thread reader([&] { EXPECT_TRUE(hub.wait(0, 1h).messages.empty()); });
  hub.close();
  reader.join();
}

TEST(EventStream, ResumesBehindTheLastEvent) {
  Hub hub;
  hub.publish(Kind::kEvent, "{\"first\": 1}");
  EventStream begins(hub, "");
  const std::string all = begins.next().value();
  EXPECT_THAT(all, testing::HasSubstr("{\"resumed\": false}"));
  EXPECT_THAT(
      all, testing::HasSubstr("id: " + hub.name() + "-1\nevent: event\ndata: {\"first\": 1}\n\n"));

  hub.publish(Kind::kEvent, "{\"second\": 2}");
  EventStream goes_on(hub, hub.name() + "-1");
  const std::string rest = goes_on.next().value();
  EXPECT_THAT(rest, testing::HasSubstr("{\"resumed\": true}"));
  EXPECT_THAT(rest, testing::HasSubstr("second"));
  EXPECT_THAT(rest, testing::Not(testing::HasSubstr("first")));
}

TEST(EventStream, BeginsAnewForIdsThatAreNotOurs) {
  Hub hub;
  hub.publish(Kind::kEvent, "{}");
  const std::vector<std::string> others{"another-1",        hub.name() + "-",
                                        hub.name() + "-99", hub.name() + "--1",
                                        hub.name() + "-1x", std::string(5000, '9')};
  for (const std::string& id : others) {
    EXPECT_THAT(EventStream(hub, id).next().value(), testing::HasSubstr("\"resumed\": false"))
        << id;
  }
}

}  // namespace
}  // namespace culprit::http
