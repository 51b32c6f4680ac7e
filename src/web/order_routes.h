// The call for people's orders to the manager (robot/order.h).
#pragma once

#include <functional>

#include "base/mutex.h"
#include "http/hub.h"
#include "http/routes.h"
#include "language/rule_set.h"
#include "live/order_keeper.h"
#include "robot/order.h"

namespace culprit::web {

// Takes orders, by names of a rule set, for the current manager. Both may be replaced while the
// server runs. All members may be called from any thread.
class OrderDesk : public live::OrderTaker {
 public:
  // `keeping` is called under a lock.
  explicit OrderDesk(live::KeepOrders keeping) : keeping_(std::move(keeping)) {}

  void open(const RuleSet& rules, std::function<void(Order)> submit) override;
  // Until then only a pause is taken, and given to the next manager.
  void close() override;

  // 202: the manager has it, and an event of its number will say what becomes of it. An order with
  // `valid_until` is refused after that time, unless it restrains culprit.
  http::Answer take(const Json& body);

 private:
  http::Answer keep(const live::KeepOrder& keep, const Json& body, std::uint64_t number);
  void submit(Order order) CULPRIT_REQUIRES(mutex_);

  const live::KeepOrders keeping_;
  Mutex mutex_;
  const RuleSet* rules_ CULPRIT_GUARDED_BY(mutex_) = nullptr;  // null: nobody manages now
  std::function<void(Order)> submit_ CULPRIT_GUARDED_BY(mutex_);
  std::optional<Order> waiting_ CULPRIT_GUARDED_BY(mutex_);  // a pause, for whoever manages next
  std::uint64_t last_ CULPRIT_GUARDED_BY(mutex_) = 0;        // number of the last order
};

// Gives an order as /api/orders does: if the call has `wait_s`, it returns the manager's own answer from `hub`, 200 or, if it refuses the order, 409. Blocks
// for at most that time.
http::Answer give_order(OrderDesk& desk, http::Hub& hub, const Json& body);

// Both must outlive the routes.
std::vector<http::Route> order_routes(OrderDesk& desk, http::Hub& hub);

}  // namespace culprit::web
