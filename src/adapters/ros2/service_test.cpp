#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros2/live_test.h"
#include "ros2/service_client.h"
#include "ros2/service_server.h"
#include "ros2/services.h"

namespace culprit::ros2 {
namespace {

using namespace std::chrono_literals;

const ServiceName kEcho{"/a/echo", std::string(srv::ChangeMode::kType)};
const ServiceName kProbe{"/a/probe", std::string(srv::Trigger::kType)};

// Padded as it comes over the wire.
rtps::Bytes request(const std::string& text) {
  rtps::Bytes bytes = rtps::encode(srv::ChangeMode::Request{text});
  bytes.resize((bytes.size() + 3) / 4 * 4);
  return bytes;
}
rtps::Bytes probe_request() { return rtps::encode(srv::Trigger::Request{}); }

struct Answer {
  CallOutcome outcome;
  rtps::Bytes reply;
};

// Counts what it is asked, and answers with a reply of ChangeMode, or not at all.
class Echo {
 public:
  explicit Echo(NodeEntry& node, const ServiceName& service = kEcho, bool answers = true)
      : server_(std::move(*ServiceServer::create(
            node, service, rtps::qos::kServices, [this, answers](rtps::ByteView payload) {
              asked_.add({payload.begin(), payload.end()});
              return answers ? rtps::Bytes(payload.begin(), payload.end()) : rtps::Bytes();
            }))) {}

  rtps::EventLog<rtps::Bytes>& asked() { return asked_; }

 private:
  rtps::EventLog<rtps::Bytes> asked_;
  std::unique_ptr<ServiceServer> server_;
};

// One side of a service: a context, and a node on it.
struct Side {
  explicit Side(const TestDomain& domain, const std::string& name)
      : context(domain.options()), node(*context, {"/", name}) {}
  LiveContext context;
  NodeEntry node;
};

std::unique_ptr<ServiceClient> client_of(Side& side, const ServiceName& service = kEcho) {
  return std::move(*ServiceClient::create(side.node, service));
}

std::unique_ptr<ServiceClient> guarded_client_of(Side& side) {
  return std::move(
      *ServiceClient::create(side.node, kEcho, rtps::qos::kServices, {kProbe, probe_request()}));
}

// Calls, and gives the log that the answer comes to.
std::unique_ptr<rtps::EventLog<Answer>> call(ServiceClient& client, const std::string& text,
                                             Repeat repeat, Duration timeout = rtps::kPatience) {
  auto answers = std::make_unique<rtps::EventLog<Answer>>();
  client.call(request(text), repeat, timeout, [log = answers.get()](const CallResult& result) {
    log->add({result.outcome, {result.reply.begin(), result.reply.end()}});
  });
  return answers;
}

TEST(Service, AnswersACall) {
  const TestDomain domain;
  Side robot(domain, "robot"), manager(domain, "manager");
  Echo echo(robot.node);
  const auto client = client_of(manager);
  const auto answers = call(*client, "hello", Repeat::kUntilAnswered);
  ASSERT_TRUE(answers->wait_for_count(1));
  EXPECT_EQ(answers->all()[0].outcome, CallOutcome::kAnswered);
  EXPECT_EQ(answers->all()[0].reply, request("hello"));
}

// Anybody may offer a service of that name. A stranger's reply is no answer, and does not block the
// true one.
TEST(Service, TakesAnswersOnlyOfTheParticipantThatIsMeant) {
  const TestDomain domain;
  Side stranger(domain, "stranger"), robot(domain, "robot"), manager(domain, "manager");
  const rtps::GuidPrefix meant = robot.context->participant().guid().prefix();
  Echo forged(stranger.node);
  const auto client = client_of(manager);
  client->ask_only(meant);
  const auto alone = call(*client, "hello", Repeat::kUntilAnswered, 500ms);
  ASSERT_TRUE(alone->wait_for_count(1));
  EXPECT_EQ(alone->all()[0].outcome, CallOutcome::kUnreachable);
  const auto early = call(*client, "hello", Repeat::kUntilAnswered);
  Echo echo(robot.node);
  ASSERT_TRUE(early->wait_for_count(1));
  EXPECT_EQ(early->all()[0].outcome, CallOutcome::kAnswered);
  const auto later = call(*client, "again", Repeat::kNever);
  ASSERT_TRUE(later->wait_for_count(1));
  EXPECT_EQ(later->all()[0].outcome, CallOutcome::kAnswered);
}

TEST(Service, ACallWaitsForItsServer) {
  const TestDomain domain;
  Side robot(domain, "robot"), manager(domain, "manager");
  const auto client = client_of(manager);
  const auto answers = call(*client, "hello", Repeat::kUntilAnswered);
  Echo echo(robot.node);
  ASSERT_TRUE(answers->wait_for_count(1));
  EXPECT_EQ(answers->all()[0].outcome, CallOutcome::kAnswered);
}

TEST(Service, WithoutAServerACallIsUnreachable) {
  const TestDomain domain;
  Side manager(domain, "manager");
  const auto client = client_of(manager);
  const auto answers = call(*client, "hello", Repeat::kUntilAnswered, 50ms);
  ASSERT_TRUE(answers->wait_for_count(1));
  EXPECT_EQ(answers->all()[0].outcome, CallOutcome::kUnreachable);
}

TEST(Service, WithoutAnAnswerACallIsTimedOut) {
  const TestDomain domain;
  Side robot(domain, "robot"), manager(domain, "manager");
  Echo silent(robot.node, kEcho, false);
  const auto client = client_of(manager);
  const auto first = call(*client, "first", Repeat::kUntilAnswered);
  ASSERT_TRUE(silent.asked().wait_for_count(1));  // it is there
  const auto second = call(*client, "second", Repeat::kNever, 50ms);
  ASSERT_TRUE(second->wait_for_count(1));
  EXPECT_EQ(second->all()[0].outcome, CallOutcome::kTimedOut);
}

TEST(Service, ARequestThatMayRunTwiceIsRepeatedUntilItIsAnswered) {
  const TestDomain domain;
  Side robot(domain, "robot"), manager(domain, "manager");
  int asked = 0;
  const auto server =
      ServiceServer::create(robot.node, kEcho, rtps::qos::kServices, [&](rtps::ByteView payload) {
        return ++asked < 3 ? rtps::Bytes() : rtps::Bytes(payload.begin(), payload.end());
      });
  const auto client = client_of(manager);
  const auto answers = call(*client, "hello", Repeat::kUntilAnswered);
  ASSERT_TRUE(answers->wait_for_count(1));
  EXPECT_EQ(answers->all()[0].outcome, CallOutcome::kAnswered);
}

TEST(Service, ASlowServerIsNotAskedAgainBeforeItCanHaveAnswered) {
  const TestDomain domain;
  Side robot(domain, "robot"), manager(domain, "manager");
  rtps::EventLog<ServiceServer::Answer> asked_first;
  rtps::EventLog<rtps::Bytes> asked_second;
  const auto server = std::move(
      *ServiceServer::create_slow(robot.node, kEcho, rtps::qos::kServices,
                                  [&](rtps::ByteView payload, const ServiceServer::Answer& answer) {
                                    const rtps::Bytes bytes(payload.begin(), payload.end());
                                    if (bytes == request("first")) return asked_first.add(answer);
                                    asked_second.add(bytes);
                                  }));
  const auto client = client_of(manager);
  const auto first = call(*client, "first", Repeat::kUntilAnswered);
  ASSERT_TRUE(asked_first.wait_for_count(5));  // 200 ms apart
  asked_first.all()[0](request("after 0.8 s"));
  ASSERT_TRUE(first->wait_for_count(1));
  const auto begin = std::chrono::steady_clock::now();
  const auto second = call(*client, "second", Repeat::kUntilAnswered);
  ASSERT_TRUE(asked_second.wait_for_count(1));
  std::this_thread::sleep_for(1s);
  // Once each 1.6 s, however long the test stood still.
  const std::size_t asked = asked_second.all().size();
  const auto passed = std::chrono::steady_clock::now() - begin;
  EXPECT_LE(asked, 1u + static_cast<std::size_t>(passed / 1600ms));
}

TEST(Service, EveryClientGetsItsOwnAnswers) {
  const TestDomain domain;
  Side robot(domain, "robot"), one(domain, "one"), other(domain, "other");
  Echo echo(robot.node);
  const auto first = client_of(one), second = client_of(other), third = client_of(other);
  std::vector<std::pair<std::string, std::unique_ptr<rtps::EventLog<Answer>>>> calls;
  for (int i = 0; i < 20; ++i) {
    for (ServiceClient* client : {first.get(), second.get(), third.get()}) {
      const std::string text = std::to_string(calls.size());
      calls.emplace_back(text, call(*client, text, Repeat::kUntilAnswered));
    }
  }
  for (const auto& [text, answers] : calls) {
    ASSERT_TRUE(answers->wait_for_count(1));
    EXPECT_EQ(answers->all().size(), 1u);
    EXPECT_EQ(answers->all()[0].reply, request(text));
  }
}

TEST(Service, AnAnswerMayTakeItsTimeAndHoldsNobodyUp) {
  const TestDomain domain;
  Side robot(domain, "robot"), manager(domain, "manager");
  rtps::EventLog<ServiceServer::Answer> asked;
  const auto server = std::move(*ServiceServer::create_slow(
      robot.node, kEcho, rtps::qos::kServices,
      [&](rtps::ByteView, const ServiceServer::Answer& answer) { asked.add(answer); }));
  Echo echo(robot.node, kProbe);
  const auto slow = client_of(manager);
  const auto quick = client_of(manager, kProbe);
  const auto late = call(*slow, "hello", Repeat::kUntilAnswered);
  ASSERT_TRUE(asked.wait_for_count(1));
  const auto soon = call(*quick, "", Repeat::kUntilAnswered);
  ASSERT_TRUE(soon->wait_for_count(1)) << "while the other one waits";
  EXPECT_TRUE(late->all().empty());
  std::thread([&] { asked.all()[0](request("at last")); }).join();
  ASSERT_TRUE(late->wait_for_count(1));
  EXPECT_EQ(late->all()[0].reply, request("at last"));
}

TEST(Service, AnAnswerThatComesWhenItsServerIsGoneGoesNowhere) {
  const TestDomain domain;
  Side robot(domain, "robot"), manager(domain, "manager");
  rtps::EventLog<ServiceServer::Answer> asked;
  auto server = std::move(*ServiceServer::create_slow(
      robot.node, kEcho, rtps::qos::kServices,
      [&](rtps::ByteView, const ServiceServer::Answer& answer) { asked.add(answer); }));
  const auto client = client_of(manager);
  const auto answers = call(*client, "hello", Repeat::kUntilAnswered);
  ASSERT_TRUE(asked.wait_for_count(1));
  server.reset();
  asked.all()[0](request("too late"));
  Echo next(robot.node);
  ASSERT_TRUE(answers->wait_for_count(1)) << "the successor answers";
  EXPECT_EQ(answers->all()[0].reply, request("hello"));
}

TEST(Service, ItsTypesAreAnnouncedByTheirHashes) {
  const TestDomain domain;
  Side robot(domain, "robot"), manager(domain, "manager");
  const auto server = std::move(*ServiceServer::create_slow(
      robot.node, kEcho, rtps::qos::kServices, [](rtps::ByteView, const ServiceServer::Answer&) {},
      {"RIHS01_aa", "RIHS01_bb", "RIHS01_cc"}));
  EXPECT_TRUE(manager.context.changes().wait_for_one([](const GraphChange& change) {
    const auto* joined = std::get_if<EndpointJoined>(&change);
    return joined != nullptr && joined->endpoint.kind == EndpointKind::kServer &&
           joined->endpoint.type_hash == "RIHS01_aa" &&
           joined->endpoint.service_hash == "RIHS01_cc";
  }));
}

TEST(Service, MayBeCalledFromAnyThread) {
  const TestDomain domain;
  Side robot(domain, "robot"), manager(domain, "manager");
  Echo echo(robot.node);
  const auto client = client_of(manager);
  std::vector<std::thread> threads;
  std::atomic<int> right = 0;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 50; ++i) {
        const std::string text = std::to_string(t) + "/" + std::to_string(i);
        const auto answers = call(*client, text, Repeat::kUntilAnswered);
        if (answers->wait_for_count(1) && answers->all()[0].reply == request(text)) ++right;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(right, 200);
}

TEST(Service, AnUnguardedRequestGoesOutOnceWhenAServerIsReady) {
  const TestDomain domain;
  Side robot(domain, "robot"), manager(domain, "manager");
  Echo echo(robot.node);
  const auto client = client_of(manager);
  ASSERT_TRUE(call(*client, "first", Repeat::kUntilAnswered)->wait_for_count(1));
  EXPECT_TRUE(client->is_ready());
}

TEST(Service, FiftyFreshGuardedCallsAreNeitherLostNorDoubled) {
  const TestDomain domain;
  Side robot(domain, "robot");
  Echo echo(robot.node), probe(robot.node, kProbe);
  for (int i = 0; i < 50; ++i) {
    Side manager(domain, "manager");
    const auto client = guarded_client_of(manager);
    const auto answers = call(*client, std::to_string(i), Repeat::kNever);
    ASSERT_TRUE(answers->wait_for_count(1));
    EXPECT_EQ(answers->all()[0].outcome, CallOutcome::kAnswered) << i;
  }
  const auto asked = echo.asked().all();
  ASSERT_EQ(asked.size(), 50u);
  for (int i = 0; i < 50; ++i)
    EXPECT_EQ(asked[static_cast<std::size_t>(i)], request(std::to_string(i)));
}

TEST(Service, AGuardedRequestIsNotSentBeforeTheProof) {
  const TestDomain domain;
  Side robot(domain, "robot"), manager(domain, "manager");
  Echo echo(robot.node);
  Echo silent_probe(robot.node, kProbe, false);
  const auto client = guarded_client_of(manager);
  ASSERT_TRUE(silent_probe.asked().wait_for_count(2));
  const auto answers = call(*client, "never", Repeat::kNever, 50ms);
  ASSERT_TRUE(answers->wait_for_count(1));
  EXPECT_EQ(answers->all()[0].outcome, CallOutcome::kUnreachable);
  EXPECT_FALSE(client->is_ready());
  EXPECT_TRUE(echo.asked().all().empty());
}

TEST(Service, AGuardedClientFollowsARestartedServer) {
  const TestDomain domain;
  Side manager(domain, "manager");
  const auto client = guarded_client_of(manager);
  for (int i = 0; i < 3; ++i) {
    Side robot(domain, "robot");
    Echo echo(robot.node), probe(robot.node, kProbe);
    const auto answers = call(*client, std::to_string(i), Repeat::kNever);
    ASSERT_TRUE(answers->wait_for_count(1));
    EXPECT_EQ(answers->all()[0].outcome, CallOutcome::kAnswered);
    EXPECT_EQ(echo.asked().all().size(), 1u);
  }
}

TEST(Service, ADestroyedClientNeverCallsBack) {
  const TestDomain domain;
  Side robot(domain, "robot"), manager(domain, "manager");
  Echo echo(robot.node), probe(robot.node, kProbe);
  std::atomic<int> late = 0;
  for (int i = 0; i < 30; ++i) {
    std::atomic<bool> is_gone = false;
    auto client = guarded_client_of(manager);
    const auto callback = [&](const CallResult&) {
      if (is_gone) ++late;
    };
    client->call(request("x"), Repeat::kUntilAnswered, 10ms, callback);
    client->call(request("x"), Repeat::kNever, 10ms, callback);
    std::this_thread::sleep_for(std::chrono::milliseconds(i % 7));  // wherever that hits
    client.reset();
    is_gone = true;
  }
  EXPECT_EQ(late, 0);
}

TEST(Service, ServersMayGoWhileRequestsCome) {
  const TestDomain domain;
  Side robot(domain, "robot"), manager(domain, "manager");
  const auto client = client_of(manager);
  std::atomic<bool> stop = false;
  std::thread asking([&] {
    while (!stop) {
      client->call(request("x"), Repeat::kUntilAnswered, 5ms, [](const CallResult&) {});
      // Far more than any client sends, and discovery still gets its share of a busy computer.
      std::this_thread::sleep_for(1ms);
    }
  });
  for (int i = 0; i < 10; ++i) {
    Echo echo(robot.node);
    EXPECT_TRUE(echo.asked().wait_for_count(1));
  }
  stop = true;
  asking.join();
}

TEST(Service, BadNamesAreErrors) {
  const TestDomain domain;
  Side manager(domain, "manager");
  EXPECT_FALSE(ServiceClient::create(manager.node, {"relative", kEcho.type}));
  EXPECT_FALSE(ServiceClient::create(manager.node, {"/a", "no type"}));
  EXPECT_FALSE(ServiceServer::create(manager.node, {"/a b", kEcho.type}, {},
                                     [](rtps::ByteView) { return rtps::Bytes(); }));
}

}  // namespace
}  // namespace culprit::ros2
