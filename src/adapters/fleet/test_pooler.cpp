#include "fleet/test_pooler.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <sys/wait.h>
#include <thread>

namespace culprit::fleet {
namespace {

constexpr const char* kProgram = "/usr/sbin/pgbouncer";

}  // namespace

std::string TestPooler::why_not() {
  return std::filesystem::exists(kProgram) ? "" : "there is no pgbouncer here (Debian: pgbouncer)";
}

TestPooler::TestPooler(const TestPostgres& postgres, const std::vector<std::string>& logins) {
  give_away(folder_.path());
  std::ofstream(folder_ / "pgbouncer.ini")
      << "[databases]\npostgres = host=" << postgres.folder().string()
      << "\n[pgbouncer]\npool_mode = session\nauth_type = trust\nauth_file = "
      << (folder_ / "users").string() << "\nunix_socket_dir = " << folder_.path().string()
      << "\ndefault_pool_size = 1\nlog_connections = 0\nlog_disconnections = 0\n";
  std::ofstream users(folder_ / "users");
  for (const std::string& login : logins) users << '"' << login << "\" \"\"\n";
  users.close();
  pid_ = start_as_nobody({kProgram, folder_ / "pgbouncer.ini"}, folder_ / "log");
  for (int i = 0; i < 1500; ++i) {
    if (Postgres::connect(address(logins.front()), kGoesOn)) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  throw std::runtime_error("pgbouncer does not start");
}

TestPooler::~TestPooler() {
  kill(pid_, SIGTERM);
  waitpid(pid_, nullptr, 0);
}

Address TestPooler::address(const std::string& login) const {
  return {"postgresql:///postgres?port=6432&host=" + folder_.path().string() + "&user=" + login};
}

}  // namespace culprit::fleet
