// The call by which people tell the manager something (robot/order.h).
#pragma once

#include <functional>
#include <mutex>

#include "language/rule_set.h"
#include "robot/order.h"
#include "web/routes.h"

namespace culprit::web {

// Whether the next process will know of an order.
struct Kept {
  bool is_kept = false;
  bool is_given = true;  // false: it is not in force, for it could not be kept
  std::string why_not{};
};

// Where orders are taken: by names of a rule set, for whoever manages with it. Both may be replaced
// while the server runs. All members may be called from any thread.
class OrderDesk {
 public:
  // Gives an order that stands to the manager, by calling `submit`, and keeps it for the next
  // process. It may take as long as the disk.
  using Keep = std::function<Kept(const std::function<void()>& submit)>;
  // What does that for an order; called under a lock, does not block.
  using Keeping = std::function<Keep(const Order& order, const RuleSet& rules)>;

  explicit OrderDesk(Keeping keeping) : keeping_(std::move(keeping)) {}

  // `rules` must live until the desk is closed, or opened with others. `submit` must not block.
  void open(const RuleSet& rules, std::function<void(Order)> submit);
  // Nobody manages for a while. Only a pause is taken meanwhile, and given to whoever is next.
  void close();

  Answer take(const Json& body);

 private:
  Answer keep(const Keep& keep, const Json& body, std::uint64_t number);
  void submit(Order order);

  const Keeping keeping_;
  std::mutex mutex_;
  const RuleSet* rules_ = nullptr;  // null: nobody manages now
  std::function<void(Order)> submit_;
  std::optional<Order> waiting_;  // a pause, for whoever manages next
  std::uint64_t last_ = 0;        // number of the last order
};

// For who keeps nothing: each order is given at once.
OrderDesk::Keeping keeps_nothing(std::string why);

// `desk` must outlive the routes.
std::vector<Route> order_routes(OrderDesk& desk);

}  // namespace culprit::web
