#include "ros2/domain_lock.h"

#include <optional>
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
  // No DDS domains, and nobody else's: other tests must not find theirs taken.
  const auto first = 1000 + static_cast<std::uint32_t>(getpid()) * 2;
  std::optional<Expected<DomainLock>> one = DomainLock::reserve(first, first + 1);
  const auto other = DomainLock::reserve(first, first + 1);
  ASSERT_TRUE(*one);
  ASSERT_TRUE(other);
  EXPECT_FALSE(DomainLock::reserve(first, first + 1));
  one.reset();
  EXPECT_TRUE(DomainLock::reserve(first, first + 1));
}

}  // namespace
}  // namespace culprit::ros2
