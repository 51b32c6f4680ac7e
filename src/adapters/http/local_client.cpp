#include "http/local_client.h"

#include <array>
#include <httplib.h>
#include <optional>

#include "base/live_clock.h"
#include "http/local_exchange.h"

namespace culprit::http {
namespace {

constexpr const char* kJsonType = "application/json";

httplib::Client client_of(const std::filesystem::path& socket, Duration patience) {
  httplib::Client client(socket.string());
  client.set_address_family(AF_UNIX);
  const auto limit = std::chrono::duration_cast<std::chrono::microseconds>(patience);
  client.set_connection_timeout(limit);
  client.set_read_timeout(limit);
  client.set_write_timeout(limit);
  return client;
}

std::string why_no_answer(httplib::Error error, Duration patience) {
  if (error == httplib::Error::Connection) return "no program listens there";
  if (error == httplib::Error::Read || error == httplib::Error::Write)
    return "no answer came within " + culprit::to_string(patience);
  return httplib::to_string(error);
}

std::string request_text(Method method, const std::string& path, const Json& body) {
  const bool gets = method == Method::kGet;
  const std::string content = gets ? "" : to_line(body);
  std::string text = (gets ? "GET " : "POST ") + path + " HTTP/1.1\r\nHost: localhost\r\n" +
                     "Connection: close\r\n";
  if (!gets)
    text += std::string("Content-Type: ") + kJsonType +
            "\r\nContent-Length: " + std::to_string(content.size()) + "\r\n";
  return text + "\r\n" + content;
}

Expected<Answer> answer_of(Expected<LocalAnswer> answer) {
  if (!answer) return Error{answer.error()};
  Json document = parse_json(answer->body);
  if (document.is_discarded()) return Error{"the answer is no JSON"};
  return Answer{answer->status, std::move(document)};
}

std::string refusal_in(const Json& body) {
  return text_of(body, "error").value_or("it refuses without a reason");
}

// Server-sent events, as they come in pieces.
class StreamReader {
 public:
  explicit StreamReader(const LocalClient::Take& take) : take_(take) {}

  // Whether more is wanted.
  bool read(std::string_view piece) {
    rest_ += piece;
    if (rest_.size() + data_.size() > LocalClient::kLargeAnswer) return false;
    std::size_t end = 0;
    while ((end = rest_.find('\n')) != std::string::npos) {
      const std::string line = rest_.substr(0, end);
      rest_.erase(0, end + 1);
      if (!read_line(line)) return false;
    }
    return true;
  }

 private:
  bool read_line(std::string_view line) {
    if (line.starts_with("event: ")) kind_ = line.substr(7);
    if (line.starts_with("data: ")) data_ = line.substr(6);
    if (line.starts_with(':')) return take_("", nullptr);
    if (!line.empty() || data_.empty()) return true;
    Json document = parse_json(std::exchange(data_, ""));
    return document.is_discarded() || take_(kind_, std::move(document));
  }

  const LocalClient::Take& take_;
  std::string rest_;
  std::string kind_;
  std::string data_;
};

}  // namespace

Expected<Answer> LocalClient::ask(Method method, const std::string& path, const Json& body,
                                  std::size_t most_bytes) const {
  const std::array one{LocalRequest{socket_, user_, request_text(method, path, body), most_bytes}};
  return answer_of(std::move(exchange_all(one, patience_).front()));
}

Expected<Json> LocalClient::get(const std::string& path, std::size_t most_bytes) const {
  auto answer = ask(Method::kGet, path, nullptr, most_bytes);
  if (!answer) return Error{answer.error()};
  if (answer->status != 200) return Error{refusal_in(answer->body)};
  return std::move(answer->body);
}

std::vector<Expected<Answer>> LocalClient::ask_all(std::span<const LocalClient> clients,
                                                   Method method, const std::string& path,
                                                   std::span<const Json> bodies,
                                                   Duration patience) {
  std::vector<LocalRequest> requests;
  for (std::size_t i = 0; i < clients.size(); ++i) {
    const Json& body = bodies.empty() ? Json() : bodies[i];
    requests.push_back(
        {clients[i].socket_, clients[i].user_, request_text(method, path, body), kUsualAnswer});
  }
  std::vector<Expected<Answer>> answers;
  for (auto& each : exchange_all(requests, patience)) answers.push_back(answer_of(std::move(each)));
  return answers;
}

Expected<void> LocalClient::follow(const Take& take) const {
  httplib::Client client = client_of(socket_, patience_);
  StreamReader reader(take);
  bool is_enough = false;
  std::optional<Time> latest;
  const auto result = client.Get("/api/stream", [&](const char* bytes, std::size_t size) {
    latest = live_now();
    is_enough = !reader.read({bytes, size});
    return !is_enough;
  });
  // The server ends it by closing the connection, which is no answer to the library either.
  const bool has_ended = latest && live_now() < later(*latest, patience_);
  if (!result && !is_enough && !has_ended) return Error{why_no_answer(result.error(), patience_)};
  return {};
}

}  // namespace culprit::http
