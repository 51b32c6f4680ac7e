#include "http/access.h"

#include <filesystem>
#include <fstream>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "http/rate_limit.h"

namespace culprit::http {
namespace {

TEST(Access, TakesAddressesAndLocalhostForItself) {
  const Access access{"t", {"rover.lan"}};
  for (const char* host : {"127.0.0.1:8642", "127.0.0.1", "localhost:1", "[::1]:80", "10.0.0.7:80",
                           "rover.lan:8642"}) {
    EXPECT_TRUE(access.allows_host(host)) << host;
  }
}

TEST(Access, RefusesNamesThatAPageCanHaveResolvedToIt) {
  const Access access{"t", {"rover.lan"}};
  for (const char* host : {"evil.example", "127.0.0.1.evil.example", "localhost.evil.example:80",
                           "", "[evil]", "[::1", "rover.lan.evil.example", "0x7f.1"}) {
    EXPECT_FALSE(access.allows_host(host)) << host;
  }
}

TEST(Access, TakesOnlyItsOwnOrigin) {
  const Access access{"t", {}};
  EXPECT_TRUE(access.allows_origin("", "localhost:1"));
  EXPECT_TRUE(access.allows_origin("http://localhost:1", "localhost:1"));
  for (const char* origin : {"http://localhost:2", "https://localhost:1", "null",
                             "http://evil.example", "http://localhost:1.evil.example"}) {
    EXPECT_FALSE(access.allows_origin(origin, "localhost:1")) << origin;
  }
}

TEST(Access, OverTlsItsOriginIsEncrypted) {
  Access access{"t", {}};
  access.is_encrypted = true;
  EXPECT_TRUE(access.allows_origin("https://localhost:1", "localhost:1"));
  EXPECT_FALSE(access.allows_origin("http://localhost:1", "localhost:1"));
}

TEST(Access, ATokenAllowsWhatItsRoleDoes) {
  Access access{"secret", {}};
  access.operate_token = "operate";
  access.look_token = "look";
  EXPECT_EQ(access.role_of("Bearer secret"), Role::kAdminister);
  EXPECT_EQ(access.role_of("Bearer operate"), Role::kOperate);
  EXPECT_EQ(access.role_of("Bearer look"), Role::kLook);
  EXPECT_LT(Role::kLook, Role::kOperate);
  EXPECT_LT(Role::kOperate, Role::kAdminister);
}

TEST(Access, TakesOnlyTheToken) {
  const Access access{"secret", {}};
  EXPECT_EQ(access.role_of("Bearer secret"), Role::kAdminister);
  for (const char* header : {"", "secret", "Bearer ", "Bearer secreu", "Bearer secrets",
                             "bearer secret", "Basic secret"}) {
    EXPECT_EQ(access.role_of(header), std::nullopt) << header;
  }
}

TEST(Access, MakesADifferentTokenEachTime) { EXPECT_NE(make_token(), make_token()); }

struct TokenFile : testing::Test {
  TokenFile() : path(testing::TempDir() + "token-" + std::to_string(getpid())) {}
  ~TokenFile() override { std::filesystem::remove(path); }
  Expected<std::string> read(const std::string& text, std::filesystem::perms mode) {
    std::ofstream(path) << text;
    std::filesystem::permissions(path, mode);
    return read_secret(path);
  }
  const std::string path;
  static constexpr auto kOnlyMine =
      std::filesystem::perms::owner_read | std::filesystem::perms::owner_write;
};

TEST_F(TokenFile, IsReadIfNobodyElseCan) {
  EXPECT_EQ(*read("0123456789abcdef\n", kOnlyMine), "0123456789abcdef");
}

TEST_F(TokenFile, IsRefusedIfOthersCanReadIt) {
  const auto token = read("0123456789abcdef\n", kOnlyMine | std::filesystem::perms::group_read);
  ASSERT_FALSE(token);
  EXPECT_THAT(token.error(), testing::HasSubstr("chmod 600"));
}

TEST_F(TokenFile, IsRefusedIfTheTokenCanBeGuessed) {
  EXPECT_FALSE(read("short\n", kOnlyMine));
  EXPECT_FALSE(read("two words that are long enough\n", kOnlyMine));
  EXPECT_FALSE(read_secret("/does/not/exist"));
}

TEST(RateLimit, AllowsABurstAndThenASteadyRate) {
  RateLimit limit(10, 3);
  const RateLimit::Clock::time_point start{};
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(limit.allows("a", start));
  EXPECT_FALSE(limit.allows("a", start));
  EXPECT_TRUE(limit.allows("b", start));
  EXPECT_TRUE(limit.allows("a", start + std::chrono::milliseconds(100)));
  EXPECT_FALSE(limit.allows("a", start + std::chrono::milliseconds(100)));
}

}  // namespace
}  // namespace culprit::http
