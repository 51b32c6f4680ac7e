#include "ros2/domain_lock.h"

#include <netinet/in.h>
#include <optional>
#include <string>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

namespace culprit::ros2 {
namespace {

TEST(DomainLock, GivesADomainOfItsOwn) {
  const auto one = DomainLock::reserve();
  const auto other = DomainLock::reserve();
  ASSERT_TRUE(one) << one.error();
  ASSERT_TRUE(other) << other.error();
  EXPECT_NE(one->domain(), other->domain());
  for (const auto* lock : {&*one, &*other}) {
    EXPECT_GE(lock->domain(), DomainLock::kFirst);
    EXPECT_LE(lock->domain(), DomainLock::kLast);
  }
}

TEST(DomainLock, SaysWhenAllAreTakenAndFreesThemAtTheEnd) {
  // No DDS domains, and no other process's: other tests must not find theirs taken.
  const auto first = 1000 + static_cast<std::uint32_t>(getpid()) * 2;
  std::optional<Expected<DomainLock>> one = DomainLock::reserve(first, first + 1);
  const auto other = DomainLock::reserve(first, first + 1);
  ASSERT_TRUE(*one);
  ASSERT_TRUE(other);
  EXPECT_FALSE(DomainLock::reserve(first, first + 1));
  one.reset();
  EXPECT_TRUE(DomainLock::reserve(first, first + 1));
}

// Such a listener may be a demonstration that was killed, or a robot.
TEST(DomainLock, TakesNoDomainThatSomebodyListensIn) {
  std::optional<Expected<DomainLock>> lock = DomainLock::reserve();
  ASSERT_TRUE(*lock);
  const std::uint32_t domain = (*lock)->domain();
  const int listener = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * domain + 10));
  ASSERT_EQ(bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  lock.reset();
  const auto taken = DomainLock::reserve(domain, domain);
  close(listener);
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error(), "nodes run on the DDS domain " + std::to_string(domain) +
                               " of this machine already; end them, or take another domain");
}

}  // namespace
}  // namespace culprit::ros2
