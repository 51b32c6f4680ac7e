// Orders over DDS: services of culprit_msgs. They pass each request to the same call as HTTP and
// the unix socket (web/order_routes.h), and return its answer.
//
// Each service has a thread of its own: an order may wait for the disk or for the manager, and a
// pause must not wait behind another order. While kMostWaiting wait, further orders are refused at
// once.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "http/routes.h"
#include "ros2/service_server.h"
#include "ros2/worker_thread.h"
#include "ros_api/message_codec.h"

namespace culprit::ros_api {

// "pause" -> "culprit_msgs/srv/Pause": below culprit's own node.
struct OrderService {
  std::string_view name;
  std::string_view type;
};
std::span<const OrderService> order_services();

// The document that web::OrderDesk takes, of a request of that type. Error: it names too much.
Expected<Json> to_order(std::string_view service_type, const Json& request);

class OrderServices {
 public:
  static constexpr std::size_t kMostWaiting = 8;                  // of each service
  static constexpr Duration kPatience = std::chrono::seconds(3);  // with the manager

  // Called on threads of this, and may block as long as an order does.
  using Give = std::function<http::Answer(const Json& order)>;

  // `types` outlive it.
  OrderServices(const CulpritTypes& types, Give give);
  ~OrderServices();

  // Offers them at this node, which outlives that, until close() is called. Gives what could not be offered,
  // and why, a line each.
  std::vector<std::string> open(ros2::NodeEntry& node);
  void close() { servers_.clear(); }

 private:
  void take(const ServiceType& type, ros2::WorkerThread& worker, rtps::ByteView request,
            const ros2::ServiceServer::Answer& answer);
  Json obey(const ServiceType& type, const Json& request) const;

  const CulpritTypes& types_;
  const Give give_;
  std::vector<std::unique_ptr<ros2::WorkerThread>> workers_;  // by service
  std::vector<std::unique_ptr<ros2::ServiceServer>> servers_;
};

}  // namespace culprit::ros_api
