// The manager runs on a thread of its own, which blocks in its requests; its node answers meanwhile.
#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "base/live_clock.h"
#include "base/mutex.h"
#include "exemplars/rover/bond_manager.h"
#include "exemplars/rover/nodes.h"
#include "ros2/lifecycle.h"
#include "ros2/node.h"
#include "ros2/services.h"

namespace culprit::rover {
namespace {

using namespace std::chrono_literals;
using ros2::TransitionId;

constexpr Duration kForEver = std::chrono::hours(24);

class Server {
 public:
  Expected<void> open(ros2::Node& manager, std::string_view name) {
    name_ = name;
    auto client = ros2::ServiceClient::create(
        manager.entry(), {name_ + "/change_state", std::string(ros2::srv::ChangeState::kType)},
        rtps::qos::kServices,
        {{name_ + "/get_state", std::string(ros2::srv::GetState::kType)},
         rtps::encode(ros2::srv::GetState::Request{})});
    if (!client) return Error{client.error()};
    change_ = std::move(*client);
    return {};
  }

  const std::string& name() const { return name_; }
  bool is_there() const { return change_->is_ready(); }
  Time heard() const { return heard_; }
  void on_bond(const msg::BondStatus& bond) {
    if ("/" + bond.id == name_ && bond.active) heard_ = live_now();
  }

  // Blocks until the server has answered, in whichever way.
  bool change(TransitionId transition) {
    auto answered = std::make_shared<std::promise<bool>>();
    auto answer = answered->get_future();
    ros2::srv::ChangeState::Request request;
    request.transition.id = static_cast<std::uint8_t>(transition);
    change_->call(rtps::encode(request), ros2::Repeat::kNever, kForEver,
                  [answered](const ros2::CallResult& result) {
                    const auto response =
                        result.outcome == ros2::CallOutcome::kAnswered
                            ? rtps::decode<ros2::srv::ChangeState::Response>(result.reply)
                            : std::nullopt;
                    answered->set_value(response && response->success);
                  });
    return answer.get();
  }

 private:
  std::string name_;
  std::unique_ptr<ros2::ServiceClient> change_;
  std::atomic<Time> heard_ = kLongAgo;
};

class LifecycleManager {
 public:
  Expected<void> open(ros2::Context& context, const std::string& name,
                      std::span<const std::string_view> servers) {
    auto node = ros2::Node::create(context, {"/", name});
    if (!node) return Error{node.error()};
    node_ = std::move(*node);
    ros2::msg::Parameter names{"node_names", {}};
    names.value.type = static_cast<std::uint8_t>(ros2::msg::ParameterType::kStringArray);
    for (const std::string_view each : servers) {
      names.value.string_array_value.emplace_back(each.substr(1));
      servers_.push_back(std::make_unique<Server>());
      if (auto opened = servers_.back()->open(*node_, each); !opened) return opened;
    }
    if (auto done = node_->parameters().declare(names.name, names.value); !done) return done;
    auto bonds = node_->create_subscription<msg::BondStatus>("/bond", rtps::qos::kDefault,
                                                             [this](const msg::BondStatus& bond) {
                                                               for (const auto& server : servers_)
                                                                 server->on_bond(bond);
                                                             });
    if (!bonds) return Error{bonds.error()};
    bonds_ = std::move(*bonds);
    auto manage = ros2::ServiceServer::create_slow(
        node_->entry(),
        {node_->name().full() + "/manage_nodes", std::string(srv::ManageLifecycleNodes::kType)},
        rtps::qos::kServices,
        [this](rtps::ByteView request, const ros2::ServiceServer::Answer& answer) {
          const auto asked = rtps::decode<srv::ManageLifecycleNodes::Request>(request);
          const MutexLock lock(mutex_);
          if (asked) requests_.push_back({asked->command, answer});
        });
    if (!manage) return Error{manage.error()};
    manage_ = std::move(*manage);
    return {};
  }

  // For ever.
  void run() {
    BondManager manager(
        {.count = servers_.size(),
         .reach =
             [this](std::size_t s) {
               using enum BondManager::Reach;
               return servers_[s]->is_there() ? kAnswers : kNobody;
             },
         .pid = [](std::size_t) { return 0; },
         .change = [this](std::size_t s, Transition t) { return change(*servers_[s], t); },
         .answer_time = [] { return Duration::zero(); }},
        true);
    manager.begin(live_now());
    for (;; std::this_thread::sleep_for(manager.is_changing() ? 10ms : 100ms)) {
      for (std::size_t s = 0; s < servers_.size(); ++s) manager.on_bond(s, servers_[s]->heard());
      for (const Request& request : take_requests()) {
        manager.ask(request.command, [answer = request.answer](bool is_done) {
          answer(rtps::encode(srv::ManageLifecycleNodes::Response{is_done}));
        });
      }
      const bool was_resetting = manager.is_resetting();
      manager.step(live_now());
      if (manager.is_resetting() && !was_resetting)
        node_->log(ros2::Severity::kError, "a bond is broken; resetting all nodes");
    }
  }

 private:
  struct Request {
    std::uint8_t command;
    ros2::ServiceServer::Answer answer;
  };

  std::vector<Request> take_requests() {
    const MutexLock lock(mutex_);
    return std::exchange(requests_, {});
  }

  bool change(Server& server, Transition transition) {
    constexpr TransitionId kIds[] = {TransitionId::kConfigure, TransitionId::kCleanup,
                                     TransitionId::kActivate, TransitionId::kDeactivate};
    const bool agrees = server.change(kIds[static_cast<std::size_t>(transition)]);
    const bool starts = transition == Transition::kConfigure || transition == Transition::kActivate;
    if (!agrees && starts)
      node_->log(ros2::Severity::kError,
                 "failed to bring up all requested nodes; " + server.name() + " refuses");
    return agrees;
  }

  std::unique_ptr<ros2::Node> node_;
  std::vector<std::unique_ptr<Server>> servers_;
  std::unique_ptr<ros2::Subscription> bonds_;
  std::unique_ptr<ros2::ServiceServer> manage_;
  Mutex mutex_;
  std::vector<Request> requests_ CULPRIT_GUARDED_BY(mutex_);
};

}  // namespace

Expected<void> run_lifecycle_manager(ros2::Context& context, const std::string& name,
                                     std::span<const std::string_view> servers) {
  auto manager = std::make_shared<LifecycleManager>();
  if (auto opened = manager->open(context, name, servers); !opened) return opened;
  std::thread([manager] { manager->run(); }).detach();
  return {};
}

}  // namespace culprit::rover
