// Keeps what people order for the next process (journal/standing_orders.h), in the order that
// cannot harm: what restrains culprit is in force first and kept then, whatever the disk does; what
// frees it is kept first, and is in force only then.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "journal/standing_orders.h"
#include "robot/standing.h"
#include "web/order_routes.h"

namespace culprit::cli {

// All members may be called from any thread.
class OrderKeeper {
 public:
  // Until begin() is called nothing is kept; `why` says so to people.
  explicit OrderKeeper(std::string why) : why_not_(std::move(why)) {}

  // From now on orders are kept in `file`. `found` holds according to it; `is_in_file`: and stands
  // there just so. What was ordered of this process before holds as well. Gives what holds now.
  // Errors, if what holds cannot be written, are put into `trouble`.
  journal::StandingOrders begin(std::filesystem::path file, const journal::StandingOrders& found,
                                bool is_in_file, std::string& trouble);
  // From now on nothing is kept; `why` says so to people. What `found` says holds as well.
  journal::StandingOrders begin_without(std::string why, const journal::StandingOrders& found);

  // For web::OrderDesk.
  web::OrderDesk::Keeping keeping();

  // What holds now; also for a successor on another machine, which learns of it with the lease.
  journal::StandingOrders orders() const;
  // Whether the next process on this machine will know.
  bool is_kept() const;

 private:
  web::Kept take(const journal::NamedOrder& order, Standing standing,
                 const std::function<void()>& submit);
  Expected<void> write(const journal::StandingOrders& orders);

  mutable std::mutex mutex_;  // guards what follows; also held while the file is written
  std::optional<std::filesystem::path> file_;
  std::string why_not_;                             // if there is no file
  journal::StandingOrders orders_;                  // what holds
  std::optional<journal::StandingOrders> in_file_;  // nothing: unknown, or unreadable
  std::atomic<std::uint64_t> freed_ = 0;            // how many orders that free were given
};

}  // namespace culprit::cli
