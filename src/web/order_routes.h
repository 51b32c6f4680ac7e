// The call by which people tell the manager something (robot/order.h).
#pragma once

#include <functional>
#include <mutex>

#include "language/rule_set.h"
#include "robot/order.h"
#include "web/routes.h"

namespace culprit::web {

// Where orders are taken: by names of a rule set, for whoever manages with it. Both may be replaced
// while the server runs. All members may be called from any thread.
class OrderDesk {
 public:
  // `rules` must live until the desk is closed, or opened with others. `submit` must not block.
  void open(const RuleSet& rules, std::function<void(Order)> submit);
  void close();

  Answer take(const Json& body);

 private:
  std::mutex mutex_;
  const RuleSet* rules_ = nullptr;  // null: nobody manages now
  std::function<void(Order)> submit_;
  std::uint64_t last_ = 0;  // number of the last order
};

// `desk` must outlive the routes.
std::vector<Route> order_routes(OrderDesk& desk);

}  // namespace culprit::web
