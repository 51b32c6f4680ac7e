// For tests: a PostgreSQL server of the distribution, in a folder of its own, on a unix socket there,
// as a user that may do nothing else. It ends with the test, however that ends.
#pragma once

#include <filesystem>
#include <string>
#include <sys/types.h>
#include <vector>

#include "base/test_folder.h"
#include "fleet/postgres.h"

namespace culprit::fleet {

// A program of the distribution, as a user that may do nothing else; it ends with us. Its output
// goes to `log`. give_away() lets that user write into the folder.
pid_t start_as_nobody(std::vector<std::string> arguments, const std::filesystem::path& log);
void give_away(const std::filesystem::path& folder);

class TestPostgres {
 public:
  // Why there is none; empty: there is.
  static std::string why_not();

  // Throws if it does not start.
  TestPostgres();
  ~TestPostgres();
  TestPostgres(const TestPostgres&) = delete;

  void start();
  // As a power failure would.
  void stop();

  // The server's process, whose children are its other processes.
  pid_t pid() const { return pid_; }

  // The folder of its socket.
  const std::filesystem::path& folder() const { return folder_.path(); }
  // As this login, which needs no password.
  Address address(const std::string& login = "postgres") const;
  // Throws if that is impossible.
  Postgres connect(const std::string& login = "postgres") const;
  // Runs a query as the owner of the database; throws if it fails.
  Rows query(const std::string& sql) const;
  void run(const std::string& sql) const;
  // Set up for a fleet, with this login as a robot's.
  void set_up_fleet(const std::string& login = "rover") const;

 private:
  test::TestFolder folder_;
  pid_t pid_ = 0;
  static inline const std::atomic<bool> kGoesOn = false;
};

}  // namespace culprit::fleet
