#include "alerts/test_webhook.h"

#include <arpa/inet.h>
#include <csignal>
#include <cstdlib>
#include <httplib.h>
#include <stdexcept>
#include <sys/socket.h>
#include <unistd.h>

namespace culprit::test {

class TestWebhook::Http {
 public:
  explicit Http(std::unique_ptr<httplib::Server> server) : server_(std::move(server)) {}

  httplib::Server& server() { return *server_; }
  int port = 0;
  bool is_secure = false;

 private:
  std::unique_ptr<httplib::Server> server_;
};

TestWebhook::TestWebhook(std::function<int()> status)
    : status_(std::move(status)),
      http_(std::make_unique<Http>(std::make_unique<httplib::Server>())) {
  listen();
}

TestWebhook::TestWebhook(const std::filesystem::path& folder, std::function<int()> status)
    : status_(std::move(status)), certificate_(folder / "certificate.pem") {
  const std::string key = folder / "key.pem";
  const std::string make =
      "openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=127.0.0.1 -addext "
      "subjectAltName=IP:127.0.0.1 -keyout " +
      key + " -out " + certificate_ + " 2>/dev/null";
  if (std::system(make.c_str()) != 0) throw std::runtime_error("openssl makes no certificate");
  http_ = std::make_unique<Http>(
      std::make_unique<httplib::SSLServer>(certificate_.c_str(), key.c_str()));
  http_->is_secure = true;
  listen();
}

void TestWebhook::listen() {
  http_->server().Post(".*", [this](const httplib::Request& q, httplib::Response& r) {
    r.status = status_();
    r.set_content("taken", "text/plain");
    const MutexLock lock(mutex_);
    requests_.push_back({q.path, q.body});
    something_came_.notify_all();
  });
  http_->port = http_->server().bind_to_any_port("127.0.0.1");
  thread_ = std::thread([this] { http_->server().listen_after_bind(); });
  while (!http_->server().is_running()) std::this_thread::yield();
}

TestWebhook::~TestWebhook() {
  http_->server().stop();
  thread_.join();
}

std::string TestWebhook::address() const {
  return (http_->is_secure ? "https://127.0.0.1:" : "http://127.0.0.1:") +
         std::to_string(http_->port);
}

std::vector<TestWebhook::Request> TestWebhook::requests() const {
  const MutexLock lock(mutex_);
  return requests_;
}

bool TestWebhook::waits_for(std::size_t count) const {
  MutexLock lock(mutex_);
  return something_came_.wait_for(lock, std::chrono::seconds(30), [&]() CULPRIT_REQUIRES(mutex_) {
    return requests_.size() >= count;
  });
}

TestListener::TestListener(std::function<void(int)> talk)
    : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
  signal(SIGPIPE, SIG_IGN);  // as the programs do
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  auto* const raw = reinterpret_cast<sockaddr*>(&address);
  if (bind(socket_, raw, length) != 0 || listen(socket_, 8) != 0 ||
      getsockname(socket_, raw, &length) != 0)
    throw std::runtime_error("cannot listen");
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this, talk = std::move(talk)] {
    for (int connection = 0; (connection = accept(socket_, nullptr, nullptr)) >= 0;) {
      // A client that closes without having read everything leaves it full.
      const timeval patience{1, 0};
      setsockopt(connection, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
      talk(connection);
      close(connection);
    }
  });
}

TestListener::~TestListener() {
  shutdown(socket_, SHUT_RDWR);
  thread_.join();
  close(socket_);
}

std::string TestListener::address() const { return "http://127.0.0.1:" + std::to_string(port_); }

}  // namespace culprit::test
