// With real nodes: what was planted among them is found, and nothing else.
#include "doctor/look.h"

#include <future>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "doctor/examine.h"
#include "ros2/live_test.h"
#include "ros2/node.h"
#include "ros2/timer.h"

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

// A node of a process of its own, as far as DDS can tell.
struct Member {
  Member(const ros2::TestDomain& domain, const std::string& name) : context(domain.options()) {
    context.run([&] { node = std::move(*ros2::Node::create(*context, {"/", name})); });
  }
  ros2::LiveContext context;
  std::unique_ptr<ros2::Node> node;
};

// Looks until so many findings are there, or for long enough that there would be.
std::vector<std::string> found(const ros2::TestDomain& domain, std::size_t wanted) {
  std::vector<std::string> codes;
  for (int tries = 0; tries < 10; ++tries) {
    const auto picture = look(domain.options(), 1500ms);
    EXPECT_TRUE(picture) << picture.error();
    codes.clear();
    for (const Finding& finding : examine(*picture))
      codes.push_back(finding.code + " " + finding.who);
    if (codes.size() == wanted) break;
  }
  return codes;
}

TEST(Look, FindsWhatNobodyHears) {
  const ros2::TestDomain domain;
  Member lidar(domain, "lidar");
  Member slam(domain, "slam");
  constexpr ros2::Qos kOffered{.reliability = ros2::Reliability::kBestEffort};
  std::optional<ros2::Publisher<ros2::msg::Float64>> range;
  lidar.context.run([&] {
    range.emplace(std::move(*lidar.node->create_publisher<ros2::msg::Float64>("/range", kOffered)));
  });
  std::unique_ptr<ros2::Subscription> subscription;
  slam.context.run([&] {
    subscription = std::move(*slam.node->create_subscription<ros2::msg::Float64>(
        "/range", ros2::qos::kDefault, [](const ros2::msg::Float64&) {}));
  });
  EXPECT_THAT(found(domain, 1), ElementsAre("D001 /range: /lidar → /slam"));
  slam.context.run([&] { subscription.reset(); });
}

TEST(Look, FindsNothingAmongHealthyNodesAndSaysWhenNobodyIsThere) {
  const ros2::TestDomain domain;
  EXPECT_THAT(found(domain, 1), ElementsAre("D030 domain " + std::to_string(domain.number())));
  Member lidar(domain, "lidar");
  Member slam(domain, "slam");
  EXPECT_THAT(found(domain, 0), IsEmpty());
}

TEST(Look, FindsTwoNodesOfOneName) {
  const ros2::TestDomain domain;
  Member first(domain, "lidar");
  Member second(domain, "lidar");
  EXPECT_THAT(found(domain, 1), ElementsAre("D010 /lidar"));
}

TEST(Look, FindsANodeThatHangs) {
  const ros2::TestDomain domain;
  Member lidar(domain, "lidar");
  Member slam(domain, "slam");
  std::promise<void> let_go;
  ros2::TaskGroup tasks(slam.context->executor());
  tasks.post([waits = let_go.get_future().share()] { waits.wait(); });
  EXPECT_THAT(found(domain, 1), ElementsAre("D012 /slam"));
  let_go.set_value();
  EXPECT_THAT(found(domain, 0), IsEmpty());
}

}  // namespace
}  // namespace culprit::doctor
