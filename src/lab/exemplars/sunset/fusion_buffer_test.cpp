#include "exemplars/sunset/fusion_buffer.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "exemplars/sunset/truth_buffer.h"

namespace culprit::sunset {
namespace {

using namespace std::chrono_literals;

constexpr Duration kTolerance = 10ms;

ros2::msg::Image stamped(Duration stamp) {
  ros2::msg::Image picture;
  picture.header.stamp = {static_cast<std::int32_t>(stamp / 1s),
                          static_cast<std::uint32_t>((stamp % Duration(1s)).count())};
  return picture;
}

int frame_of(const ros2::msg::Image& picture) {
  return static_cast<int>(stamp_of(picture) / 100ms);
}

struct Sent {
  int frame;   // that was sent
  int during;  // the frame period in which it was sent
};

// The output of a fusion while a bag plays: in each period comes a picture, if there is one, then
// its depth.
std::vector<Sent> play(int frames, int pictures_until) {
  FusionBuffer buffer;
  std::vector<Sent> sent;
  const auto send = [&](int now) {
    const auto pair = buffer.take_pair(kTolerance);
    if (pair) sent.push_back({frame_of(pair->rgb), now});
  };
  for (int frame = 0; frame < frames; ++frame) {
    if (frame < pictures_until) {
      buffer.add_rgb(stamped(frame * 100ms));
      send(frame);
    }
    buffer.add_depth(stamped(frame * 100ms));
    send(frame);
  }
  return sent;
}

TEST(FusionBuffer, SendsEachFrameTwiceAndLate) {
  std::map<int, int> times;
  for (const auto& [frame, during] : play(100, 100)) {
    ++times[frame];
    if (during < 6) continue;
    EXPECT_GE(during - frame, 4);
    EXPECT_LE(during - frame, 5);
  }
  for (int frame = 6; frame < 90; ++frame) EXPECT_EQ(times[frame], 2) << frame;
}

TEST(FusionBuffer, AlternatesBetweenTheTwoOldestPairs) {
  std::vector<int> frames;
  for (const auto& [frame, during] : play(14, 14)) {
    if (during >= 10) frames.push_back(frame);
  }
  EXPECT_EQ(frames, (std::vector<int>{6, 5, 6, 7, 8, 7, 8, 9}));
}

TEST(FusionBuffer, SendsAFewOldPairsMoreAfterTheCameraWentSilent) {
  for (const int last : {50, 51}) {
    const std::vector<Sent> sent = play(100, last + 1);
    const auto blind = std::ranges::count_if(sent, [&](const Sent& s) { return s.during > last; });
    EXPECT_EQ(blind, last % 2 == 0 ? 5 : 4);
    EXPECT_EQ(sent.back().during, last + blind);
    EXPECT_EQ(sent.back().frame, last) << "the last picture comes out at the very end";
  }
}

TEST(FusionBuffer, DoesNotPairWhatIsTooFarApart) {
  FusionBuffer buffer;
  buffer.add_rgb(stamped(100ms));
  buffer.add_depth(stamped(111ms));
  EXPECT_FALSE(buffer.take_pair(kTolerance));
  buffer.add_depth(stamped(110ms));
  EXPECT_TRUE(buffer.take_pair(kTolerance));
}

// Against the definition, by brute force, whatever arrives in whatever order.
RC_GTEST_PROP(ClosestPair, IsTheClosestAllowedOne, (std::vector<int> a, std::vector<int> b)) {
  Pictures<ros2::msg::Image> first;
  Pictures<ros2::msg::Image> second;
  for (const int ms : a) first.push_back(stamped((ms % 100 + 100) * 1ms));
  for (const int ms : b) second.push_back(stamped((ms % 100 + 100) * 1ms));
  const Duration forbidden = first.empty() ? 0ms : stamp_of(first.front());
  const auto allowed = [&](const auto& one, const auto&) { return stamp_of(one) != forbidden; };

  std::multiset<Duration> distances;
  for (const auto& one : first) {
    for (const auto& other : second) {
      const Duration apart = std::chrono::abs(stamp_of(one) - stamp_of(other));
      if (apart <= kTolerance && allowed(one, other)) distances.insert(apart);
    }
  }
  const auto found = closest_pair(first, second, kTolerance, allowed);
  RC_ASSERT(found.has_value() == !distances.empty());
  if (!found) return;
  const auto& one = first[found->first];
  RC_ASSERT(allowed(one, second[found->second]));
  RC_ASSERT(std::chrono::abs(stamp_of(one) - stamp_of(second[found->second])) ==
            *distances.begin());
}

RC_GTEST_PROP(FusionBuffer, NeverSendsThePairThatItSentLast, (const std::vector<bool>& arrivals)) {
  FusionBuffer buffer;
  int rgb = 0;
  int depth = 0;
  int last = -1;
  for (const bool is_rgb : arrivals) {
    if (is_rgb) {
      buffer.add_rgb(stamped(rgb++ * 100ms));
    } else {
      buffer.add_depth(stamped(depth++ * 100ms));
    }
    const auto pair = buffer.take_pair(kTolerance);
    if (!pair) continue;
    RC_ASSERT(stamp_of(pair->rgb) == stamp_of(pair->depth));
    RC_ASSERT(frame_of(pair->rgb) != last);
    last = frame_of(pair->rgb);
    RC_ASSERT(last >= std::max(rgb, depth) - static_cast<int>(FusionBuffer::kKeep));
  }
}

TEST(TruthBuffer, JudgesEachFrameOnceWhateverTheOrder) {
  TruthBuffer buffer;
  std::vector<int> judged;
  const auto judge = [&] {
    if (const auto pair = buffer.take_pair()) judged.push_back(frame_of(pair->prediction));
  };
  for (int frame = 0; frame < 6; ++frame) {
    buffer.add_truth(stamped(frame * 100ms));
    judge();
  }
  for (const int frame : {1, 0, 1, 2, 3, 2, 0, 4}) {
    buffer.add_prediction(stamped(frame * 100ms));
    judge();
  }
  EXPECT_EQ(judged, (std::vector<int>{1, 0, 2, 3, 4}));
}

TEST(TruthBuffer, ForgetsTheTruthThatIsTooOld) {
  TruthBuffer buffer;
  for (int frame = 0; frame <= static_cast<int>(TruthBuffer::kKeep); ++frame) {
    buffer.add_truth(stamped(frame * 100ms));
  }
  buffer.add_prediction(stamped(0ms));
  EXPECT_FALSE(buffer.take_pair());
  buffer.add_prediction(stamped(100ms));
  EXPECT_TRUE(buffer.take_pair());
}

}  // namespace
}  // namespace culprit::sunset
