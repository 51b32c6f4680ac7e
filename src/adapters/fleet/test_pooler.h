// For tests: pgbouncer of the distribution before a PostgreSQL server, on a unix socket in a folder of its own. A session
// is a client's as long as it is connected, and has been reset when the next one gets it. It ends with the test.
#pragma once

#include <string>
#include <sys/types.h>
#include <vector>

#include "base/test_folder.h"
#include "fleet/postgres.h"
#include "fleet/test_postgres.h"

namespace culprit::fleet {

class TestPooler {
 public:
  // Why there is none; empty: there is.
  static std::string why_not();

  // For these logins, each of which gets one session at most. Throws if it does not start.
  TestPooler(const TestPostgres& postgres, const std::vector<std::string>& logins);
  ~TestPooler();
  TestPooler(const TestPooler&) = delete;

  pid_t pid() const { return pid_; }
  Address address(const std::string& login) const;

 private:
  test::TestFolder folder_;
  pid_t pid_ = 0;
  static inline const std::atomic<bool> kGoesOn = false;
};

}  // namespace culprit::fleet
