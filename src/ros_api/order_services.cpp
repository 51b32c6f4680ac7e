#include "ros_api/order_services.h"

#include <array>

#include "base/live_clock.h"
#include "base/units.h"

namespace culprit::ros_api {
namespace {

constexpr std::array kServices = {OrderService{"pause", "culprit_msgs/srv/Pause"},
                                  OrderService{"resume", "culprit_msgs/srv/Resume"},
                                  OrderService{"approve", "culprit_msgs/srv/Approve"},
                                  OrderService{"silence", "culprit_msgs/srv/Silence"},
                                  OrderService{"run_strategy", "culprit_msgs/srv/RunStrategy"}};

std::string text_at(const Json& request, const char* name) {
  return http::text_of(request, name).value_or("");
}

bool is_set(const Json& request, const char* name) {
  const auto flag = request.find(name);
  return flag != request.end() && flag->is_boolean() && flag->get<bool>();
}

// A name that is empty was not given.
void add_name(Json& order, const Json& request, const char* name) {
  if (const std::string text = text_at(request, name); !text.empty()) order[name] = text;
}

Expected<void> add_silence(Json& order, const Json& request) {
  order["order"] = is_set(request, "lift") ? "lift" : "silence";
  add_name(order, request, "component");
  add_name(order, request, "rule");
  if (order.contains("component") && order.contains("rule"))
    return Error{"name a component or a rule, not both"};
  const Json& duration = request["duration"];
  const double time = duration["sec"].get<double>() + duration["nanosec"].get<double>() / 1e9;
  if (time != 0 && !is_set(request, "lift")) order["seconds"] = time;
  return {};
}

Json response(bool success, const std::string& message) {
  return {{"success", success}, {"message", message}};
}

}  // namespace

std::span<const OrderService> order_services() { return kServices; }

Expected<Json> to_order(std::string_view service_type, const Json& request) {
  Json order = Json::object();
  if (service_type == "culprit_msgs/srv/Pause") {
    order["order"] = "pause";
  } else if (service_type == "culprit_msgs/srv/Resume") {
    order["order"] = "resume";
  } else if (service_type == "culprit_msgs/srv/Silence") {
    if (const auto added = add_silence(order, request); !added) return Error{added.error()};
  } else {
    const char* answer = is_set(request, "refuse") ? "refuse" : "approve";
    order["order"] = service_type == "culprit_msgs/srv/RunStrategy" ? "run" : answer;
    add_name(order, request, "rule");
    add_name(order, request, "strategy");
  }
  // For the record: the author is not authenticated.
  const std::string author = text_at(request, "author");
  order["author"] = author.empty() ? "" : author + " (over DDS)";
  order["reason"] = text_at(request, "reason");
  return order;
}

OrderServices::OrderServices(const CulpritTypes& types, Give give)
    : types_(types), give_(std::move(give)) {
  for (std::size_t s = 0; s < kServices.size(); ++s)
    workers_.push_back(std::make_unique<ros2::WorkerThread>(kMostWaiting));
}

OrderServices::~OrderServices() { close(); }

std::vector<std::string> OrderServices::open(ros2::NodeEntry& node) {
  close();
  std::vector<std::string> troubles;
  for (std::size_t s = 0; s < kServices.size(); ++s) {
    const ServiceType& type = types_.service(kServices[s].type);
    const auto name = ros2::resolve_name("~/" + std::string(kServices[s].name), node.name());
    auto server = ros2::ServiceServer::create_slow(
        node, {*name, type.name}, rtps::qos::kServices,
        [this, &type, &worker = *workers_[s]](rtps::ByteView request,
                                              const ros2::ServiceServer::Answer& answer) {
          take(type, worker, request, answer);
        },
        {type.request.hash, type.response.hash, type.hash});
    if (server) {
      servers_.push_back(std::move(*server));
    } else {
      troubles.push_back("no orders are taken by " + *name + ": " + server.error());
    }
  }
  return troubles;
}

// Every request gets an answer, whatever its bytes, so that no client waits in vain.
void OrderServices::take(const ServiceType& type, ros2::WorkerThread& worker,
                         rtps::ByteView request, const ros2::ServiceServer::Answer& answer) {
  const auto say = [&type, answer](const Json& said) {
    auto reply = encode(said, type.response);
    if (reply) answer(std::move(*reply));
  };
  auto read = decode(request, type.request);
  if (!read) return say(response(false, read.error()));
  const bool is_taken =
      worker.put([this, &type, say, read = std::move(*read)] { say(obey(type, read)); });
  if (!is_taken) say(response(false, "too many orders wait already; ask again"));
}

Json OrderServices::obey(const ServiceType& type, const Json& request) const {
  auto order = to_order(type.name, request);
  if (!order) return response(false, order.error());
  (*order)["wait_s"] = seconds(kPatience);
  // It is not carried out once its sender received a timeout.
  (*order)["valid_until"] = seconds(live_now().time_since_epoch() + kPatience);
  const http::Answer answer = give_(*order);
  if (answer.status >= 400)
    return response(false, http::text_of(answer.body, "error").value_or("it is refused"));
  if (answer.status != 200)
    return response(false, "culprit has the order, and its manager did not take it within " +
                               to_string(kPatience) + "; ~/status shows what holds");
  const std::string word = http::text_of(answer.body, "order").value_or("");
  const std::string kept = http::text_of(answer.body, "text").value_or("");
  return response(true, kept.empty() ? word : word + "; " + kept);
}

}  // namespace culprit::ros_api
