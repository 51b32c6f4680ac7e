#include "cli/drill_injector.h"

#include <algorithm>
#include <csignal>
#include <future>
#include <poll.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "owners/piped_program.h"
#include "owners/proc.h"
#include "owners/process_tree.h"
#include "ros2/lifecycle.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using drill::FaultKind;
using drill::Injected;

constexpr Duration kAnswerWithin = 3s;
constexpr auto kActivate = static_cast<std::uint8_t>(ros2::TransitionId::kActivate);
constexpr auto kDeactivate = static_cast<std::uint8_t>(ros2::TransitionId::kDeactivate);

// The slow rhythm: a tenth of the time is left to the process.
constexpr int kStoppedMs = 450;
constexpr int kRunningMs = 50;

int send_signal(int process, int signal) {
  return static_cast<int>(syscall(SYS_pidfd_send_signal, process, signal, nullptr, 0));
}

owners::FileDescriptor hold(const drill::ProcessId& process) {
  return owners::hold(process.pid, process.ticks);
}

// The guard, between fork and _exit: calls only what may be called there.
[[noreturn]] void guard(int process, int alive, int lasts_ms, bool in_rhythm) {
  setsid();
  const int kept = dup2(process, 0);
  const int drill = dup2(alive, 1);
  close_range(2, ~0U, 0);
  int left = lasts_ms;
  bool goes_on = kept == 0 && drill == 1;
  while (goes_on && left > 0) {
    const int stopped = in_rhythm && left > kStoppedMs ? kStoppedMs : left;
    if (send_signal(kept, SIGSTOP) != 0) break;
    pollfd end{drill, POLLIN, 0};
    goes_on = poll(&end, 1, stopped) == 0;
    send_signal(kept, SIGCONT);
    left -= stopped;
    if (goes_on && left > 0) {
      goes_on = poll(&end, 1, kRunningMs) == 0;
      left -= kRunningMs;
    }
  }
  _exit(0);
}

std::string no_answer(const std::string& node, const std::string& what) {
  return node + " does not answer: " + what;
}

// The answer of a client, waited for.
template <class Service>
std::optional<typename Service::Response> answer_of(ros2::Client<Service>& client,
                                                    const typename Service::Request& request) {
  const auto promise = std::make_shared<std::promise<std::optional<typename Service::Response>>>();
  auto future = promise->get_future();
  client.call(request, ros2::Repeat::kUntilAnswered, kAnswerWithin,
              [promise](const auto& answer) { promise->set_value(answer.response); });
  return future.get();
}

template <class Service, class Clients>
Expected<ros2::Client<Service>*> client_in(Clients& clients, ros2::Node& self,
                                           const std::string& node, const char* service) {
  auto& client = clients[node];
  if (client == nullptr) {
    auto made = self.create_client<Service>(node + service, rtps::qos::kParameterServices);
    if (!made) return Error{made.error()};
    client = std::move(*made);
  }
  return client.get();
}

}  // namespace

Expected<std::unique_ptr<DrillNode>> DrillNode::join() {
  const auto options = ros2::options_from_environment();
  if (!options) return Error{options.error()};
  std::unique_ptr<DrillNode> self(new DrillNode);
  auto context = ros2::Context::create(self->executor_, *options);
  if (!context) return Error{context.error()};
  self->context_ = std::move(*context);
  auto node =
      ros2::Node::create(*self->context_, {"/", "_culprit_drill"}, ros2::Node::Extent::kMinimal);
  if (!node) return Error{node.error()};
  self->node_ = std::move(*node);
  self->thread_ = std::thread([raw = self.get()] { raw->executor_.run(); });
  return self;
}

DrillNode::~DrillNode() {
  executor_.stop();
  if (thread_.joinable()) thread_.join();
}

Expected<Value> DrillNode::parameter(const std::string& node, const std::string& name) {
  const auto client =
      client_in<ros2::srv::GetParameters>(getters_, *node_, node, "/get_parameters");
  if (!client) return Error{client.error()};
  const auto answer = answer_of(**client, {{name}});
  if (!answer) return Error{no_answer(node, "get_parameters")};
  const auto value =
      answer->values.size() == 1 ? ros2::to_value(answer->values.front()) : std::nullopt;
  if (!value) return Error{node + " has no parameter '" + name + "' of one value"};
  return *value;
}

Expected<void> DrillNode::set_parameter(const std::string& node, const std::string& name,
                                        const Value& value) {
  const auto client =
      client_in<ros2::srv::SetParameters>(setters_, *node_, node, "/set_parameters");
  if (!client) return Error{client.error()};
  const auto answer = answer_of(**client, {{{name, ros2::to_parameter_value(value)}}});
  if (!answer || answer->results.size() != 1) return Error{no_answer(node, "set_parameters")};
  if (!answer->results.front().successful)
    return Error{node + " refuses " + name + " = " + to_string(value) + ": " +
                 answer->results.front().reason};
  return {};
}

Expected<ros2::ServiceClient*> DrillNode::lifecycle_client(const std::string& node) {
  auto& client = lifecycle_clients_[node];
  if (client == nullptr) {
    auto made = ros2::ServiceClient::create(
        node_->entry(), {node + "/change_state", std::string(ros2::srv::ChangeState::kType)},
        rtps::qos::kServices,
        {{node + "/get_state", std::string(ros2::srv::GetState::kType)},
         rtps::encode(ros2::srv::GetState::Request{})});
    if (!made) return Error{made.error()};
    client = std::move(*made);
  }
  return client.get();
}

Expected<std::string> DrillNode::lifecycle(const std::string& node) {
  const auto client = lifecycle_client(node);
  if (!client) return Error{client.error()};
  const auto promise = std::make_shared<std::promise<std::string>>();
  auto future = promise->get_future();
  (*client)->probe()->call(
      rtps::encode(ros2::srv::GetState::Request{}), ros2::Repeat::kUntilAnswered, kAnswerWithin,
      [promise](const ros2::CallResult& result) {
        const auto response = result.outcome == ros2::CallOutcome::kAnswered
                                  ? rtps::decode<ros2::srv::GetState::Response>(result.reply)
                                  : std::nullopt;
        promise->set_value(response ? response->current_state.label : "");
      });
  const std::string label = future.get();
  if (label.empty()) return Error{no_answer(node, "get_state")};
  return label;
}

Expected<void> DrillNode::change(const std::string& node, std::uint8_t transition) {
  const auto client = lifecycle_client(node);
  if (!client) return Error{client.error()};
  const auto promise = std::make_shared<std::promise<std::optional<bool>>>();
  auto future = promise->get_future();
  (*client)->call(rtps::encode(ros2::srv::ChangeState::Request{{transition, ""}}),
                  ros2::Repeat::kNever, kAnswerWithin, [promise](const ros2::CallResult& result) {
                    const auto response =
                        result.outcome == ros2::CallOutcome::kAnswered
                            ? rtps::decode<ros2::srv::ChangeState::Response>(result.reply)
                            : std::nullopt;
                    promise->set_value(response ? std::optional(response->success) : std::nullopt);
                  });
  const auto success = future.get();
  if (!success) return Error{no_answer(node, "change_state")};
  if (!*success) return Error{node + " refuses the transition"};
  return {};
}

std::map<std::string, std::string> DrillNode::publishers_of(
    const std::vector<std::string>& topics) {
  std::promise<std::map<std::string, std::string>> promise;
  auto future = promise.get_future();
  ros2::TaskGroup tasks(executor_);
  tasks.post([&] {
    std::map<std::string, std::string> found;
    for (const std::string& topic : topics) {
      for (const auto& [endpoint, node] : context_->graph().publishers_of(topic))
        if (!node.empty()) found.emplace(topic, node);
    }
    promise.set_value(std::move(found));
  });
  return future.get();
}

Expected<Injected> DrillInjector::prepare(const drill::Fault& fault, const std::string& node,
                                          int pid) {
  Injected out{fault, node, {}, {}};
  if (drill::acts_on_process(fault.kind)) {
    const auto ticks = pid == 0 ? std::nullopt : owners::start_ticks_of(pid);
    if (!ticks) return Error{"the process of " + fault.component + " is not known"};
    if (kill(pid, 0) != 0) return Error{"no right to signal process " + std::to_string(pid)};
    if (fault.kind == FaultKind::kLoss) {
      if (auto may = may_lose_datagrams(pid); !may) return Error{may.error()};
    }
    out.process = {pid, *ticks};
    return out;
  }
  if (node.empty()) return Error{"the node of " + fault.component + " is not known"};
  if (fault.kind == FaultKind::kSetParameter) {
    const auto before = node_.parameter(node, fault.parameter);
    if (!before) return Error{before.error()};
    // Files write 0 where the node has 0.0.
    if (const auto* whole = std::get_if<std::int64_t>(&fault.value);
        whole != nullptr && std::holds_alternative<double>(*before))
      out.fault.value = static_cast<double>(*whole);
    if (*before == out.fault.value)
      return Error{fault.parameter + " is " + to_string(fault.value) + " already"};
    out.before = *before;
    return out;
  }
  const auto state = node_.lifecycle(node);
  if (!state) return Error{state.error()};
  if (*state != "active") return Error{node + " is " + *state + ", not active"};
  return out;
}

Expected<void> DrillInjector::inject(const Injected& fault, Duration lasts) {
  auto done = inject_now(fault, lasts);
  if (!done && !drill::acts_on_process(fault.fault.kind)) in_doubt_.push_back(fault);
  return done;
}

Expected<void> DrillInjector::inject_now(const Injected& fault, Duration lasts) {
  switch (fault.fault.kind) {
    case FaultKind::kKill:
      if (const auto process = hold(fault.process);
          !process || send_signal(process.get(), SIGKILL) != 0)
        return Error{"process " + std::to_string(fault.process.pid) + " cannot be killed"};
      return {};
    case FaultKind::kLoss: {
      if (!hold(fault.process))
        return Error{"process " + std::to_string(fault.process.pid) + " has ended"};
      auto loss = lose_datagrams(fault.process.pid, lasts);
      if (!loss) return Error{loss.error()};
      guards_.push_back(std::move(*loss));
      return {};
    }
    case FaultKind::kHang:
      return stop_for(fault.process, lasts, false);
    case FaultKind::kSlow:
      return stop_for(fault.process, lasts, true);
    case FaultKind::kDeactivate:
      return node_.change(fault.node, kDeactivate);
    case FaultKind::kRestart:
      if (auto down = node_.change(fault.node, kDeactivate); !down) return down;
      return node_.change(fault.node, kActivate);
    case FaultKind::kSetParameter: {
      const std::string& name = fault.fault.parameter;
      if (auto set = node_.set_parameter(fault.node, name, fault.fault.value); !set) return set;
      // It is undone only while it has this value.
      const auto now = node_.parameter(fault.node, name);
      if (!now) return Error{now.error()};
      if (*now == fault.fault.value) return {};
      return Error{fault.node + " sets " + name + " to " + to_string(*now) + ", not to " +
                   to_string(fault.fault.value)};
    }
  }
  return {};
}

Expected<void> DrillInjector::stop_for(const drill::ProcessId& id, Duration lasts, bool in_rhythm) {
  const owners::FileDescriptor process = hold(id);
  auto pipe = owners::make_pipe();
  if (!process || !pipe) return Error{"process " + std::to_string(id.pid) + " cannot be stopped"};
  const auto lasts_ms =
      static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(lasts).count());
  const int child = fork();
  if (child == 0) guard(process.get(), pipe->read_end.get(), lasts_ms, in_rhythm);
  if (child < 0) return Error{"the system gives no process"};
  guards_.push_back({child, std::move(pipe->write_end)});
  return {};
}

void DrillInjector::release() {
  for (FaultGuard& each : guards_) {
    each.alive = owners::FileDescriptor();
    waitpid(each.pid, nullptr, 0);
  }
  guards_.clear();
}

Expected<bool> DrillInjector::undo(const Injected& fault) {
  release();
  switch (fault.fault.kind) {
    case FaultKind::kKill:
      return false;  // its owner starts it
    case FaultKind::kLoss:
    case FaultKind::kHang:
    case FaultKind::kSlow: {
      const auto process = hold(fault.process);
      if (process && owners::state_letter(fault.process.pid) == 'T')
        send_signal(process.get(), SIGCONT);
      return static_cast<bool>(process);
    }
    case FaultKind::kDeactivate:
    case FaultKind::kRestart:
      return undo_lifecycle(fault);
    case FaultKind::kSetParameter:
      return undo_parameter(fault);
  }
  return false;
}

// A request in doubt is answered before the one that follows it here, which takes it back.
Expected<bool> DrillInjector::undo_lifecycle(const Injected& fault) {
  const bool is_in_doubt = std::ranges::find(in_doubt_, fault) != in_doubt_.end();
  if (is_in_doubt) (void)node_.change(fault.node, kActivate);
  const auto state = node_.lifecycle(fault.node);
  if (!state) return Error{state.error()};
  if (*state == "deactivating") return Error{fault.node + " is still deactivating"};
  if (*state == "inactive") {
    if (auto up = node_.change(fault.node, kActivate); !up) return Error{up.error()};
  }
  std::erase(in_doubt_, fault);
  return *state == "inactive";
}

Expected<bool> DrillInjector::undo_parameter(const Injected& fault) {
  const std::string& name = fault.fault.parameter;
  if (!fault.before) return false;
  const bool is_in_doubt = std::ranges::find(in_doubt_, fault) != in_doubt_.end();
  if (is_in_doubt) (void)node_.set_parameter(fault.node, name, *fault.before);
  const auto value = node_.parameter(fault.node, name);
  if (!value) return Error{value.error()};
  const bool is_there = is_in_doubt ? *value != *fault.before : *value == fault.fault.value;
  if (is_there) {
    if (auto set = node_.set_parameter(fault.node, name, *fault.before); !set)
      return Error{set.error()};
  }
  std::erase(in_doubt_, fault);
  return is_there;
}

}  // namespace culprit::cli
