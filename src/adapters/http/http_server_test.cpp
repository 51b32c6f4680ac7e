// The server as browsers, scripts and attackers meet it: real sockets on loopback.
#include "http/http_server.h"

#include <algorithm>
#include <arpa/inet.h>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <httplib.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "http/local_client.h"

namespace culprit::http {
namespace {

using testing::HasSubstr;

constexpr const char* kToken = "0123456789abcdef";

Route echo(Method method) {
  return {method, "/api/echo", [](const Json& body) { return Answer{200, {{"sent", body}}}; }};
}

constexpr std::string_view kPage = "<!doctype html><title>culprit</title></html>";

// A page as the program has it.
std::span<const Asset> test_app() {
  static const std::string kGzip = [] {
    std::string gzip;
    httplib::detail::gzip_compressor().compress(kPage.data(), kPage.size(), true,
                                                [&](const char* bytes, std::size_t size) {
                                                  gzip.append(bytes, size);
                                                  return true;
                                                });
    return gzip;
  }();
  static const Asset kAssets[] = {{"/", "text/html; charset=utf-8", kGzip}};
  return kAssets;
}

std::unique_ptr<HttpServer> start(Hub* hub = nullptr, bool is_local = true) {
  HttpServer::Options options;
  options.access = {kToken, {}, is_local};
  options.app = test_app();
  options.openapi = "{}";
  auto server = HttpServer::start(options, {echo(Method::kGet), echo(Method::kPost)}, hub);
  EXPECT_TRUE(server) << server.error();
  return std::move(*server);
}

struct WebServer : testing::Test {
  httplib::Client client() const {
    httplib::Client patient("127.0.0.1", server->port());
    patient.set_read_timeout(60);
    return patient;
  }
  const httplib::Headers with_token = {{"Authorization", std::string("Bearer ") + kToken}};
  httplib::Headers with(const std::string& name, const std::string& value) const {
    httplib::Headers headers = with_token;
    headers.emplace(name, value);
    return headers;
  }
  int post(const httplib::Headers& headers, const std::string& body = "{}",
           const char* type = "application/json") const {
    const auto answer = client().Post("/api/echo", headers, body, type);
    return answer ? answer->status : -1;
  }

  Hub hub;
  std::unique_ptr<HttpServer> server = start(&hub);
};

// A connection whose bytes are ours.
class Raw {
 public:
  // SOCK_NONBLOCK among `flags`: it does not wait for the server.
  explicit Raw(int port, int flags = 0) : socket_(socket(AF_INET, SOCK_STREAM | flags, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address);
    const timeval patience{20, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  ~Raw() { close(socket_); }
  Raw(const Raw&) = delete;

  // Whether the server takes it.
  bool send(const std::string& bytes) const {
    return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) >= 0;
  }
  // All that comes until the server closes, or `text` has come.
  std::string receive(const std::string& text = "") const {
    std::string all;
    char block[4096];
    while (text.empty() || all.find(text) == std::string::npos) {
      const ssize_t n = recv(socket_, block, sizeof block, 0);
      if (n <= 0) break;
      all.append(block, static_cast<std::size_t>(n));
    }
    return all;
  }

 private:
  const int socket_;
};

TEST_F(WebServer, AnswersCalls) {
  const auto answer = client().Post("/api/echo", with_token, "{\"a\": 1}", "application/json");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->body, "{\"sent\":{\"a\":1}}");
}

// httplib itself would take seconds for a large one (budgeted_server.h).
TEST_F(WebServer, PacksLargeAnswersFast) {
  const std::string large = "{\"a\": \"" + std::string(100'000, 'x') + "\"}";
  const auto ask = [&](const std::string& body, const char* takes) {
    httplib::Headers headers = with_token;
    headers.emplace("Accept-Encoding", takes);
    return client().Post("/api/echo", headers, body, "application/json");
  };
  const auto packed = ask(large, "gzip, deflate, br");
  ASSERT_TRUE(packed);
  EXPECT_EQ(packed->get_header_value("Content-Encoding"), "gzip");
  EXPECT_LT(std::stoi(packed->get_header_value("Content-Length")), 10'000);
  EXPECT_EQ(parse_json(packed->body)["sent"], parse_json(large));
  const auto plain = ask(large, "identity");
  ASSERT_TRUE(plain);
  EXPECT_FALSE(plain->has_header("Content-Encoding"));
  EXPECT_EQ(plain->body, packed->body);
  EXPECT_FALSE(ask("{}", "gzip, deflate, br")->has_header("Content-Encoding"));
}

TEST_F(WebServer, GivesCallsWhatStandsBehindTheQuestionMark) {
  const auto answer = client().Get("/api/echo?name=a%20b&since=7");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->body, R"({"sent":{"name":"a b","since":"7"}})");
  EXPECT_EQ(client().Get("/api/echo")->body, R"({"sent":null})");
}

TEST_F(WebServer, ServesTheAppUnderAStrictPolicy) {
  const auto page = client().Get("/", {{"Accept-Encoding", "gzip"}});
  ASSERT_TRUE(page);
  EXPECT_EQ(page->body, kPage);
  const std::string policy = page->get_header_value("Content-Security-Policy");
  EXPECT_THAT(policy, HasSubstr("default-src 'none'"));
  EXPECT_THAT(policy, testing::Not(HasSubstr("unsafe-inline")));
  EXPECT_THAT(policy, testing::Not(HasSubstr("unsafe-eval")));
  EXPECT_EQ(page->get_header_value("X-Frame-Options"), "DENY");
  EXPECT_FALSE(page->has_header("Access-Control-Allow-Origin"));
}

TEST_F(WebServer, ServesTheAppAlsoToClientsThatCannotUnpackIt) {
  const auto page = client().Get("/", {{"Accept-Encoding", "identity"}});
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_FALSE(page->has_header("Content-Encoding"));
  EXPECT_EQ(page->body, kPage);
}

TEST_F(WebServer, DescribesItsCalls) { EXPECT_EQ(client().Get("/api/openapi.json")->body, "{}"); }

TEST_F(WebServer, NeedsTheTokenForWhatChangesAnything) {
  EXPECT_EQ(post({}), 401);
  EXPECT_EQ(post({{"Authorization", "Bearer 0123456789abcdee"}}), 401);
  EXPECT_EQ(post(with_token), 200);
  EXPECT_EQ(client().Get("/api/echo")->status, 200);
}

TEST_F(WebServer, NeedsTheTokenForEverythingWhereOthersCanReachIt) {
  server = start(nullptr, false);
  EXPECT_EQ(client().Get("/api/echo")->status, 401);
  EXPECT_EQ(client().Get("/metrics")->status, 401);
  EXPECT_EQ(client().Get("/api/echo", with_token)->status, 200);
}

TEST_F(WebServer, LetsRoutesKnowWhetherTheirClientHasAToken) {
  HttpServer::Options options;
  options.access = {kToken, {}, true};
  const auto tell = [](const Json&) { return Answer{200, {{"token", client_has_token()}}}; };
  auto started = HttpServer::start(options, {{Method::kGet, "/api/token", tell}}, nullptr);
  ASSERT_TRUE(started) << started.error();
  server = std::move(*started);
  httplib::Client one = client();  // on one connection, and so on one thread
  one.set_keep_alive(true);
  EXPECT_EQ(one.Get("/api/token", with_token)->body, R"({"token":true})");
  EXPECT_EQ(one.Get("/api/token")->body, R"({"token":false})");
}

TEST_F(WebServer, LetsEachTokenDoWhatItsRoleAllows) {
  HttpServer::Options options;
  options.access = {kToken, {}, false};
  options.access.operate_token = "operate-0123456789";
  options.access.look_token = "look-0123456789abc";
  const auto ok = [](const Json&) { return Answer{}; };
  auto started = HttpServer::start(options,
                                   {{Method::kGet, "/api/state", ok},
                                    {Method::kPost, "/api/ask", ok, Role::kLook},
                                    {Method::kPost, "/api/orders", ok, Role::kOperate},
                                    {Method::kPut, "/api/rules", ok}},
                                   nullptr);
  ASSERT_TRUE(started) << started.error();
  server = std::move(*started);
  const auto status = [&](const std::string& token, const char* method, const char* path) {
    httplib::Request request;
    request.method = method;
    request.path = path;
    if (!token.empty()) request.headers.emplace("Authorization", "Bearer " + token);
    const auto answer = client().send(request);
    return answer ? answer->status : -1;
  };
  struct Expectation {
    std::string token;
    int look, ask, operate, administer;
  };
  for (const auto& [token, look, ask, operate, administer] :
       {Expectation{"", 401, 401, 401, 401},
        Expectation{options.access.look_token, 200, 200, 403, 403},
        Expectation{options.access.operate_token, 200, 200, 200, 403},
        Expectation{kToken, 200, 200, 200, 200}}) {
    EXPECT_EQ(status(token, "GET", "/api/state"), look) << token;
    EXPECT_EQ(status(token, "POST", "/api/ask"), ask) << token;
    EXPECT_EQ(status(token, "POST", "/api/orders"), operate) << token;
    EXPECT_EQ(status(token, "PUT", "/api/rules"), administer) << token;
    EXPECT_EQ(status(token, "PUT", "/api//rules"), token == kToken ? 404
                                                   : token.empty() ? 401
                                                                   : 403);
  }
  httplib::Headers look{{"Authorization", "Bearer " + options.access.look_token}};
  const auto refused = client().Post("/api/orders", look, "{}", "application/json");
  EXPECT_THAT(refused->body,
              HasSubstr("this token allows to look; this needs one that allows to operate"));
}

// Readers do not agree which of the two counts.
TEST_F(WebServer, RefusesAMemberThatIsThereTwice) {
  EXPECT_EQ(post(with_token, R"({"order": "pause", "order": "resume"})"), 400);
  EXPECT_EQ(post(with_token, R"({"a": [{"b": 1, "\u0062": 2}]})"), 400);
  EXPECT_EQ(post(with_token, R"({"a": {"b": 1}, "b": [{"b": 1}, {"b": 2}]})"), 200);
  EXPECT_EQ(client().Get("/api/echo?a=1&a=2")->status, 400);
}

// Made for this test; the certificate is its own authority.
struct TlsServer : testing::Test {
  TlsServer() {
    const std::string make =
        "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 "
        "-nodes -days 2 -subj /CN=localhost -addext subjectAltName=IP:127.0.0.1 "
        "-keyout " +
        key + " -out " + certificate + " 2> /dev/null";
    EXPECT_EQ(std::system(make.c_str()), 0);
    auto tls = TlsContext::load(certificate, key);
    EXPECT_TRUE(tls) << tls.error();
    HttpServer::Options options;
    options.access = {kToken, {}, false};
    options.access.is_encrypted = true;
    options.tls = *tls;
    auto started = HttpServer::start(options, {echo(Method::kGet), echo(Method::kPost)}, &hub);
    EXPECT_TRUE(started) << started.error();
    server = std::move(*started);
  }

  const test::TestFolder folder;
  const std::string key = folder / "robot.key";
  const std::string certificate = folder / "robot.crt";
  Hub hub;
  std::unique_ptr<HttpServer> server;
};

TEST_F(TlsServer, AnswersClientsThatSpeakTls) {
  EXPECT_THAT(server->address(), HasSubstr("https://127.0.0.1:"));
  httplib::SSLClient client("127.0.0.1", server->port());
  client.set_ca_cert_path(certificate.c_str());
  client.enable_server_certificate_verification(true);
  client.set_bearer_token_auth(kToken);
  client.set_keep_alive(true);
  const std::string large = "\"" + std::string(900'000, 'x') + "\"";
  for (const std::string& body : {std::string("1"), large, std::string("2")}) {
    const auto answer = client.Post("/api/echo", body, "application/json");
    ASSERT_TRUE(answer) << httplib::to_string(answer.error());
    EXPECT_EQ(answer->body, R"({"sent":)" + body + "}");
  }
  httplib::Headers page{{"Origin", "https://127.0.0.1:" + std::to_string(server->port())}};
  EXPECT_EQ(client.Get("/api/echo", page)->status, 200);
}

TEST_F(TlsServer, StreamsOverTls) {
  httplib::SSLClient client("127.0.0.1", server->port());
  client.enable_server_certificate_verification(false);
  client.set_bearer_token_auth(kToken);
  hub.publish(Kind::kState, R"({"t": 1})");
  std::string all;
  client.Get("/api/stream", [&](const char* bytes, std::size_t size) {
    all.append(bytes, size);
    return all.find("event: state") == std::string::npos;
  });
  EXPECT_THAT(all, HasSubstr(R"({"t": 1})"));
}

TEST_F(TlsServer, TellsNothingToClientsThatDoNot) {
  const Raw plain(server->port());
  plain.send("GET /api/echo HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer " +
             std::string(kToken) + "\r\n\r\n");
  EXPECT_THAT(plain.receive(), testing::Not(HasSubstr("HTTP/1.1")));
  const Raw hangs_up(server->port());
  hangs_up.send("\x16\x03\x01");
  httplib::SSLClient client("127.0.0.1", server->port());
  client.enable_server_certificate_verification(false);
  client.set_bearer_token_auth(kToken);
  EXPECT_TRUE(client.Get("/api/echo")) << "one that dawdles delays no other";
}

TEST_F(TlsServer, TakesOnlyAKeyThatIsPrivateAndFits) {
  chmod(key.c_str(), 0640);
  EXPECT_THAT(TlsContext::load(certificate, key).error(), HasSubstr("chmod 600"));
  chmod(key.c_str(), 0600);
  EXPECT_THAT(TlsContext::load(key, key).error(), HasSubstr("cannot use the certificate"));
  chmod(certificate.c_str(), 0600);
  EXPECT_THAT(TlsContext::load(certificate, certificate).error(), HasSubstr("cannot use the key"));
  EXPECT_THAT(TlsContext::load(folder / "none", key).error(),
              HasSubstr("cannot read the certificate"));
}

TEST_F(WebServer, RefusesPagesOfOtherSites) {
  EXPECT_EQ(post(with("Origin", "http://evil.example")), 403);
  EXPECT_EQ(post(with("Origin", "null")), 403);
  EXPECT_EQ(post(with("Sec-Fetch-Site", "cross-site")), 403);
  EXPECT_EQ(client().Get("/api/echo", {{"Sec-Fetch-Site", "cross-site"}})->status, 403);
  // A content type that a form can send without a preflight request.
  EXPECT_EQ(post(with_token, "{}", "text/plain"), 415);
  EXPECT_EQ(client().Options("/api/echo")->status, 401);
}

// A browser sends such a body for any page, and the headers in it would be that page's own.
TEST_F(WebServer, TakesNoBodyForARequest) {
  const std::string inner = "GET /api/about HTTP/1.1\r\nHost: localhost\r\n\r\n";
  const std::string length = "Content-Length: " + std::to_string(inner.size()) + "\r\n";
  const std::string host = "Host: 127.0.0.1\r\n";
  const std::string foreign = host + "Origin: http://evil\r\nContent-Type: text/plain\r\n";
  for (const std::string& head :
       {"POST /api/echo HTTP/1.1\r\n" + foreign + length,
        "GET /api/about HTTP/1.1\r\n" + host + "Content-Type: application/json\r\n" + length,
        "POST /api/echo HTTP/1.1\r\n" + host + "Transfer-Encoding: chunked\r\n",
        "GET /api/about HTTP/1.1\r\n" + host + "Content-Length: 0\r\n" + length}) {
    Raw raw(server->port());
    raw.send(head + "\r\n" + inner);
    const std::string answer = raw.receive();
    const std::size_t first = answer.find("HTTP/1.1 ");
    EXPECT_EQ(first, 0u) << answer;
    EXPECT_EQ(answer.find("HTTP/1.1 ", first + 1), std::string::npos) << answer;
  }
}

// Each range would be a copy of it in memory.
TEST_F(WebServer, GivesTheWholeWhereSeveralPartsAreAskedFor) {
  const auto whole = client().Get("/", {{"Range", "bytes=0-,0-"}, {"Accept-Encoding", "identity"}});
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->status, 200);
  EXPECT_EQ(whole->body, kPage);
  const auto part = client().Get("/", {{"Range", "bytes=0-3"}, {"Accept-Encoding", "identity"}});
  ASSERT_TRUE(part);
  EXPECT_EQ(part->body, kPage.substr(0, 4));
}

TEST_F(WebServer, RefusesNamesThatWereReboundToIt) {
  EXPECT_EQ(client().Get("/api/echo", {{"Host", "evil.example"}})->status, 403);
  EXPECT_EQ(client().Get("/", {{"Host", "evil.example:80"}})->status, 403);
}

TEST_F(WebServer, HasNoFilesToReach) {
  for (const char* path : {"/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/app.js/../../x",
                           "//etc/passwd", "/etc/passwd%00.js", "/app\\js", "/appXjs"}) {
    const Raw raw(server->port());
    raw.send(std::string("GET ") + path +
             " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    EXPECT_THAT(raw.receive(), testing::StartsWith("HTTP/1.1 404")) << path;
  }
}

TEST_F(WebServer, RefusesBodiesThatAreTooLarge) {
  EXPECT_EQ(post(with_token, std::string(HttpServer::kMostBytes + 1, ' ')), 413);
}

TEST_F(WebServer, RefusesBodiesOfUnknownSize) {
  const Raw raw(server->port());
  raw.send(std::string("POST /api/echo HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer ") +
           kToken + "\r\nTransfer-Encoding: chunked\r\nConnection: close\r\n\r\n");
  EXPECT_THAT(raw.receive("\r\n\r\n"), testing::StartsWith("HTTP/1.1 411"));
  EXPECT_EQ(post(with("Content-Encoding", "gzip")), 415);  // it may unpack to anything
}

TEST_F(WebServer, RefusesWhatIsNoJson) {
  for (const char* body : {"{", "\xff\xfe", "nul"}) EXPECT_EQ(post(with_token, body), 400);
}

TEST_F(WebServer, SurvivesDeepJson) { EXPECT_EQ(post(with_token, std::string(100000, '[')), 400); }

TEST_F(WebServer, SlowsDownAClientThatAsksTooOften) {
  int refused = 0;
  // A slow machine asks hardly more often than is allowed in the long run.
  for (int i = 0; i < 100 * static_cast<int>(HttpServer::kBurst) && refused == 0; ++i)
    refused += client().Get("/api/echo")->status == 429 ? 1 : 0;
  EXPECT_EQ(refused, 1);
}

// On one machine all users have one address: requests without the token do not keep the owner's
// pause out.
TEST_F(WebServer, TakesOrdersWithTheTokenWhileSomebodyElseAsksTooOften) {
  const auto ask_too_often = [&] {
    int refused = 0;
    for (int i = 0; i < 100 * static_cast<int>(HttpServer::kBurst) && refused == 0; ++i)
      refused += client().Get("/api/echo")->status == 429 ? 1 : 0;
    return refused;
  };
  for (int i = 0; i < 40; ++i) {
    ASSERT_EQ(ask_too_often(), 1);
    EXPECT_EQ(post(with_token), 200);
    EXPECT_EQ(client().Get("/api/echo", with_token)->status, 200) << "nor its page";
    EXPECT_THAT(post({{"Authorization", "Bearer wrong"}}), testing::AnyOf(401, 429));
  }
}

TEST_F(WebServer, SlowsDownOrdersWithTheTokenByThemselves) {
  int refused = 0;
  for (int i = 0; i < 100 * static_cast<int>(HttpServer::kBurst) && refused == 0; ++i)
    refused += post(with_token) == 429 ? 1 : 0;
  EXPECT_EQ(refused, 1);
  EXPECT_EQ(client().Get("/api/echo")->status, 200);
}

TEST_F(WebServer, StreamsWhatIsPublished) {
  const Raw raw(server->port());
  raw.send("GET /api/stream HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_THAT(raw.receive("hello"), HasSubstr("text/event-stream"));
  hub.publish(Kind::kEvent, "{\"label\": \"detected\"}");
  EXPECT_THAT(raw.receive("detected"), HasSubstr("event: event"));
}

TEST_F(WebServer, BoundsTheNumberOfStreams) {
  std::vector<std::unique_ptr<Raw>> readers;
  const auto read = [&](const std::string& more) {
    readers.push_back(std::make_unique<Raw>(server->port()));
    readers.back()->send("GET /api/stream HTTP/1.1\r\nHost: localhost\r\n" + more + "\r\n");
    return readers.back()->receive("hello");
  };
  for (std::size_t i = 0; i < HttpServer::kMostStreamsWithoutToken; ++i)
    ASSERT_THAT(read(""), HasSubstr("hello"));
  EXPECT_EQ(client().Get("/api/stream")->status, 503);
  while (readers.size() < HttpServer::kMostStreams)
    ASSERT_THAT(read(std::string("Authorization: Bearer ") + kToken + "\r\n"), HasSubstr("hello"))
        << "readers without a token cannot take all";
  EXPECT_EQ(client().Get("/api/stream", with_token)->status, 503);
  readers.clear();  // and the publisher does not notice that
  for (int i = 0; i < 10; ++i) hub.publish(Kind::kEvent, "{}");
}

// Readers that never read and connections that never ask: publishing costs the same.
TEST_F(WebServer, DoesNotLetPublishersWaitForSlowReaders) {
  std::vector<std::unique_ptr<Raw>> idle;
  for (int i = 0; i < 20; ++i) {
    idle.push_back(std::make_unique<Raw>(server->port()));
    idle.back()->send("GET /api/stream HTTP/1.1\r\nHost: localhost\r\n\r\n");
    ASSERT_THAT(idle.back()->receive("hello"), HasSubstr("hello"));
  }
  const std::string large(100'000, 'x');
  for (int i = 0; i < 2000; ++i) hub.publish(Kind::kEvent, large);  // more than sockets hold
  EXPECT_EQ(hub.last(), 2000u);
  EXPECT_EQ(client().Get("/api/echo")->status, 200);
}

TEST_F(WebServer, GoesOnAfterAThousandConnections) {
  for (int round = 0; round < 2; ++round) {
    std::vector<std::unique_ptr<Raw>> flood;
    for (int i = 0; i < 500; ++i) {
      flood.push_back(std::make_unique<Raw>(server->port(), SOCK_NONBLOCK));
      flood.back()->send("GET /api/");  // and nothing more
    }
  }
  httplib::Client patient = client();
  patient.set_connection_timeout(60);
  patient.set_read_timeout(60);
  const auto answer = patient.Get("/api/echo");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
}

// Until then it keeps a thread.
TEST_F(WebServer, EndsARequestThatIsOnlyBegun) {
  const Raw raw(server->port());
  const auto began = std::chrono::steady_clock::now();
  raw.send("GET /api/");
  raw.receive();
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(8));
}

// Headers without end, and a line without end: cut off before they are kept.
TEST_F(WebServer, CutsOffHeadersThatDoNotEnd) {
  for (const std::string& endless : {std::string("a: b\r\n"), std::string("aaaaaaaa")}) {
    const Raw raw(server->port());
    raw.send("GET /api/echo HTTP/1.1\r\n");
    std::string block;
    while (block.size() < 64 * 1024) block += endless;
    std::size_t sent = 0;
    while (sent < (64u << 20) && raw.send(block)) sent += block.size();
    EXPECT_LT(sent, 64u << 20) << endless;
  }
  EXPECT_EQ(client().Get("/api/echo")->status, 200);
}

TEST_F(WebServer, TakesHeadersOfAnOrdinarySize) {
  EXPECT_EQ(client().Get("/api/echo", {{"Cookie", std::string(6000, 'c')}})->status, 200);
}

int open_descriptors() {
  const std::filesystem::directory_iterator all("/proc/self/fd");
  return static_cast<int>(std::distance(begin(all), end(all)));
}

// Under a low limit of descriptors, a hundred connections leave the manager enough of them.
TEST(WebServerStart, LeavesDescriptorsToTheManager) {
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  rlimit low = before;
  low.rlim_cur = static_cast<rlim_t>(open_descriptors()) + 48;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &low), 0);
  auto server = start();
  const pid_t flood = fork();
  if (flood == 0) {  // with descriptors of its own
    setrlimit(RLIMIT_NOFILE, &before);
    std::vector<std::unique_ptr<Raw>> connections;
    for (int i = 0; i < 100; ++i) {
      connections.push_back(std::make_unique<Raw>(server->port(), SOCK_NONBLOCK));
      connections.back()->send("GET /api/");
    }
    pause();
    _exit(0);
  }
  // Others are served while the flood comes.
  int served = 0;
  for (int i = 0; i < 20; ++i) {
    served += httplib::Client("127.0.0.1", server->port()).Get("/api/echo") ? 1 : 0;
    usleep(20'000);
  }
  EXPECT_GE(served, 15);
  std::vector<int> opened;
  for (int i = 0; i < 24; ++i) opened.push_back(dup(0));
  EXPECT_TRUE(std::none_of(opened.begin(), opened.end(), [](int each) { return each < 0; }));
  for (const int each : opened) close(each);
  kill(flood, SIGKILL);
  waitpid(flood, nullptr, 0);
  setrlimit(RLIMIT_NOFILE, &before);
}

TEST(WebServerStart, SaysWhenThePortIsTaken) {
  const auto first = start();
  HttpServer::Options options;
  options.port = first->port();
  options.access.token = kToken;
  const auto second = HttpServer::start(options, {}, nullptr);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error(), HasSubstr("--port"));
}

// A server that is asked from this machine only.
struct LocalServer : testing::Test {
  LocalServer() {
    HttpServer::Options options;
    options.socket = path;
    options.access.token = kToken;
    options.about = {{"robot", "rover"}};
    auto started = HttpServer::start(options, {echo(Method::kGet), echo(Method::kPost)}, &hub);
    EXPECT_TRUE(started) << started.error();
    server = std::move(*started);
  }

  const test::TestFolder folder;
  const std::string path = folder / "7-1.sock";
  Hub hub;
  std::unique_ptr<HttpServer> server;
  const LocalClient client{path, std::chrono::seconds(20), geteuid()};
};

// No stack of this size is available, so no thread can be made while this exists.
class NoThreads {
 public:
  NoThreads() {
    pthread_getattr_default_np(&before_);
    pthread_attr_t huge;
    pthread_attr_init(&huge);
    pthread_attr_setstacksize(&huge, std::size_t{1} << 46);
    EXPECT_EQ(pthread_setattr_default_np(&huge), 0);
    pthread_attr_destroy(&huge);
  }
  ~NoThreads() { pthread_setattr_default_np(&before_); }
  NoThreads(const NoThreads&) = delete;

 private:
  pthread_attr_t before_;
};

// As with a limit of processes (pids.max). It used to end the whole program.
TEST_F(LocalServer, RefusesConnectionsThatItHasNoThreadFor) {
  std::vector<int> open;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  const auto connect_here = [&] {
    const int made = socket(AF_UNIX, SOCK_STREAM, 0);
    EXPECT_EQ(connect(made, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    return made;
  };
  ASSERT_TRUE(client.get("/api/about"));
  {
    const NoThreads none;
    // Some were there before, once they are through with the request before.
    int tries = 1000;
    while (!client.get("/api/about") && --tries > 0) usleep(10'000);
    EXPECT_GT(tries, 0);
    // They follow the stream for as long as they like.
    const std::string request = "GET /api/stream HTTP/1.1\r\nHost: localhost\r\n\r\n";
    int refused = 0;
    for (int i = 0; i < 20; ++i) {
      open.push_back(connect_here());
      send(open.back(), request.data(), request.size(), MSG_NOSIGNAL);
      char byte = 0;
      refused += recv(open.back(), &byte, 1, 0) <= 0 ? 1 : 0;
    }
    EXPECT_GE(refused, 10);
    EXPECT_LT(refused, 20);
    EXPECT_THAT(client.get("/api/about").error(), HasSubstr("hung up without an answer"));
  }
  EXPECT_TRUE(client.get("/api/about")) << "and goes on";
  for (const int each : open) close(each);
}

TEST(Servers, SayThatTheyHaveNoThread) {
  const test::TestFolder folder;
  HttpServer::Options options;
  options.socket = folder / "7-1.sock";
  const NoThreads none;
  EXPECT_THAT(HttpServer::start(options, {}, nullptr).error(), HasSubstr("gives no thread"));
}

TEST_F(LocalServer, ServesItsOwnUserWithoutAToken) {
  const auto answer = client.ask(Method::kPost, "/api/echo", {{"a", 1}});
  ASSERT_TRUE(answer) << answer.error();
  EXPECT_EQ(to_line(answer->body), R"({"sent":{"a":1}})");
  const auto about = client.get("/api/about");
  ASSERT_TRUE(about) << about.error();
  EXPECT_EQ((*about)["robot"], "rover");
  EXPECT_FALSE(client.get("/api/nothing"));
}

TEST_F(LocalServer, OpensItsSocketForItsUserOnlyAndTakesItAway) {
  struct stat status {};
  ASSERT_EQ(stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
  server.reset();
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_THAT(client.get("/api/about").error(), HasSubstr("no program listens"));
}

TEST_F(LocalServer, TakesThePlaceOfWhatAKilledOneLeft) {
  server.reset();
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  const int left = socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(bind(left, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  close(left);
  HttpServer::Options options;
  options.socket = path;
  EXPECT_TRUE(HttpServer::start(options, {}, nullptr));
}

// The kernel shows which user asks: also where the file's permissions were opened by mistake.
TEST_F(LocalServer, ServesNobodyElse) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  chmod(path.c_str(), 0666);
  const pid_t stranger = fork();
  if (stranger == 0) {
    constexpr uid_t kNobody = 65534;
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    const int socket_of_stranger = socket(AF_UNIX, SOCK_STREAM, 0);
    if (setresuid(kNobody, kNobody, kNobody) != 0 ||
        connect(socket_of_stranger, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
      _exit(2);
    const std::string request = "GET /api/echo HTTP/1.1\r\nHost: localhost\r\n\r\n";
    send(socket_of_stranger, request.data(), request.size(), MSG_NOSIGNAL);
    char byte = 0;
    _exit(recv(socket_of_stranger, &byte, 1, 0) > 0 ? 1 : 0);
  }
  int ended = 0;
  ASSERT_EQ(waitpid(stranger, &ended, 0), stranger);
  EXPECT_EQ(WEXITSTATUS(ended), 0) << "1: it was answered";
  EXPECT_TRUE(client.get("/api/about")) << "and its own user still is";
}

TEST_F(LocalServer, GoesOnAfterHostileBytes) {
  for (const std::string& bytes :
       {std::string(100'000, '\0'),
        std::string("POST /api/echo HTTP/1.1\r\nContent-Length: 9999999999\r\n\r\n"),
        std::string("\xff\xfe{}[]"), std::string("GET\r\n\r\n"), std::string()}) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    const int hostile = socket(AF_UNIX, SOCK_STREAM, 0);
    ASSERT_EQ(connect(hostile, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    send(hostile, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    close(hostile);
    EXPECT_TRUE(client.get("/api/about"));
  }
}

TEST_F(LocalServer, IsFollowedUntilItEnds) {
  hub.publish(Kind::kState, R"({"t": 1})");
  std::vector<std::string> kinds;
  const auto ended = client.follow([&](std::string_view kind, const Json& document) {
    kinds.emplace_back(kind);
    if (kind == "state") {
      EXPECT_EQ(document["t"], 1);
      hub.close();
    }
    return true;
  });
  EXPECT_TRUE(ended) << ended.error();
  EXPECT_THAT(kinds, testing::IsSupersetOf({"hello", "state"}));
}

// A stopped process accepts connections all the same: its kernel does.
TEST(LocalClients, DoNotWaitForEverForAServerThatDoesNotAnswer) {
  const test::TestFolder folder;
  const std::string path = folder / "s";
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  const int silent = socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(bind(silent, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(listen(silent, 1), 0);
  const LocalClient client(path, std::chrono::milliseconds(50), geteuid());
  EXPECT_THAT(client.get("/api/about").error(), HasSubstr("no answer came within 50ms"));
  EXPECT_FALSE(client.follow([](std::string_view, const Json&) { return true; }));
  close(silent);
}

}  // namespace
}  // namespace culprit::http
