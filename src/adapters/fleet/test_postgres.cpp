#include "fleet/test_postgres.h"

#include <csignal>
#include <stdexcept>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "fleet/schema.h"

namespace culprit::fleet {
namespace {

namespace fs = std::filesystem;

// Debian keeps it out of PATH, by version.
fs::path programs() {
  std::error_code error;
  fs::path newest;
  for (const auto& each : fs::directory_iterator("/usr/lib/postgresql", error)) {
    const fs::path folder = each.path() / "bin";
    if (fs::exists(folder / "initdb") && folder > newest) newest = folder;
  }
  return newest;
}

void run_as_nobody(std::vector<std::string> arguments, const fs::path& log) {
  const std::string program = arguments[0];
  int status = 0;
  waitpid(start_as_nobody(std::move(arguments), log), &status, 0);
  if (status != 0) throw std::runtime_error(program + " failed");
}

// An empty one, made once in a process: a copy takes a tenth of the time.
const fs::path& empty_database() {
  static const test::TestFolder folder;
  static const fs::path data = [] {
    give_away(folder.path());
    run_as_nobody({programs() / "initdb", "-D", folder / "data", "--no-sync", "-A", "trust", "-U",
                   "postgres", "-E", "UTF8", "--locale=C", "--wal-segsize=1", "--no-instructions"},
                  folder / "log");
    return fs::path(folder / "data");
  }();
  return data;
}

}  // namespace

pid_t start_as_nobody(std::vector<std::string> arguments, const fs::path& log) {
  std::vector<std::string> all = {"setpriv", "--pdeathsig", "QUIT"};
  if (geteuid() == 0)
    all.insert(all.end(), {"--reuid", "65534", "--regid", "65534", "--clear-groups"});
  all.insert(all.end(), arguments.begin(), arguments.end());
  std::vector<char*> words;
  for (std::string& each : all) words.push_back(each.data());
  words.push_back(nullptr);
  const pid_t pid = fork();
  if (pid == 0) {
    if (std::freopen(log.c_str(), "a", stdout) == nullptr ||
        std::freopen(log.c_str(), "a", stderr) == nullptr || chdir("/") != 0)
      _exit(126);
    execvp(words[0], words.data());
    _exit(127);
  }
  return pid;
}

void give_away(const fs::path& folder) {
  if (geteuid() == 0 && chown(folder.c_str(), 65534, 65534) != 0)
    throw std::runtime_error("the folder cannot be given away");
}

std::string TestPostgres::why_not() {
  return programs().empty() ? "there is no PostgreSQL here (Debian: postgresql)" : "";
}

TestPostgres::TestPostgres() {
  give_away(folder_.path());
  run_as_nobody({"cp", "-a", empty_database(), folder_ / "data"}, folder_ / "log");
  start();
}

TestPostgres::~TestPostgres() { stop(); }

void TestPostgres::start() {
  pid_ = start_as_nobody({programs() / "postgres", "-D", folder_ / "data", "-k", folder_.path(),
                          "-c", "listen_addresses=", "-c", "fsync=off", "-c", "shared_buffers=32MB",
                          "-c", "max_connections=40", "-c", "autovacuum=off"},
                         folder_ / "log");
  for (int i = 0; i < 1500; ++i) {
    if (Postgres::connect(address(), kGoesOn)) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  throw std::runtime_error("PostgreSQL does not start");
}

void TestPostgres::stop() {
  if (pid_ == 0) return;
  kill(pid_, SIGQUIT);
  waitpid(pid_, nullptr, 0);
  pid_ = 0;
}

Address TestPostgres::address(const std::string& login) const {
  return {"postgresql:///postgres?host=" + folder_.path().string() + "&user=" + login};
}

Postgres TestPostgres::connect(const std::string& login) const {
  auto server = Postgres::connect(address(login), kGoesOn);
  if (!server) throw std::runtime_error(server.error());
  return std::move(*server);
}

Rows TestPostgres::query(const std::string& sql) const {
  Postgres server = connect();
  auto rows = server.query(sql);
  if (!rows) throw std::runtime_error(sql + ": " + rows.error());
  return *rows;
}

void TestPostgres::run(const std::string& sql) const {
  Postgres server = connect();
  if (const auto done = server.run(sql); !done) throw std::runtime_error(sql + ": " + done.error());
}

void TestPostgres::set_up_fleet(const std::string& login) const {
  Postgres server = connect();
  if (const auto done = set_up(server, {}); !done) throw std::runtime_error(done.error());
  run("CREATE ROLE " + login + " LOGIN IN ROLE culprit_robot");
}

}  // namespace culprit::fleet
