// Keeps people's orders for the next process (journal/standing_orders.h), in the order that cannot
// harm. A restraint of culprit is in force first and is kept then, whatever the disk does. An order
// that lifts one is kept first, and is in force only then. Orders in force that are not kept are
// written as soon as the disk accepts them.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "journal/standing_orders.h"
#include "language/rule_set.h"
#include "robot/standing.h"

namespace culprit::live {

// Whether the next process will know of an order.
struct Kept {
  bool is_kept = false;
  bool is_given = true;  // false: it is not in force, for it could not be kept
  std::string why_not{};
};
// Gives an order that stands to the manager, by calling `submit`, and keeps it for the next
// process. It may take as long as the disk.
using KeepOrder = std::function<Kept(const std::function<void()>& submit)>;
// Keeps an order in this way; does not block.
using KeepOrders = std::function<KeepOrder(const Order& order, const RuleSet& rules)>;

// Takes people's orders, by names of a rule set, for the current manager.
class OrderTaker {
 public:
  virtual ~OrderTaker() = default;

  // `rules` must live until it is closed, or opened with others. `submit` must not block.
  virtual void open(const RuleSet& rules, std::function<void(Order)> submit) = 0;
  // Called when managing is suspended.
  virtual void close() = 0;
};

// All members may be called from any thread.
class OrderKeeper {
 public:
  // Until begin() is called nothing is kept; `why` says so to people.
  explicit OrderKeeper(std::string why);

  ~OrderKeeper();

  // From now on orders are kept in `file`. `found` holds according to it; `is_in_file`: and stands
  // there just so. Earlier orders of this process hold as well. Returns all orders that hold. If
  // they cannot be written, the error is put into `trouble`.
  journal::StandingOrders begin(std::filesystem::path file, const journal::StandingOrders& found,
                                bool is_in_file, std::string& trouble);
  // From now on orders are not kept; `why` is the reason for people. The orders in `found` hold as
  // well.
  journal::StandingOrders begin_without(std::string why, const journal::StandingOrders& found);
  // The same for a culprit that must not act: its dry run cannot be ended.
  journal::StandingOrders begin_advising(std::string why);

  // For the classes that take orders from people.
  KeepOrders keeping();

  // What holds now.
  journal::StandingOrders orders() const;
  // Orders that a successor on another machine must learn with the lease: those that hold now, and
  // those in force that are being written. Does not wait for the disk.
  journal::StandingOrders told() const;
  // Takes orders that people gave to another culprit that managed this robot for a while. Returns
  // its restraints that are new here, to be submitted; they are kept like any other. Does not wait:
  // while the disk is busy it returns none; ask again.
  std::vector<Order> heed(const journal::StandingOrders& theirs, const RuleSet& rules, Time now);
  // Whether what was in force and not kept is kept since it was asked last.
  bool is_kept_again() { return is_kept_again_.exchange(false); }
  // Whether the next process on this machine will know.
  bool is_kept() const;

 private:
  Kept take(const journal::NamedOrder& order, Standing standing,
            const std::function<void()>& submit);
  Expected<void> write(const journal::StandingOrders& orders) CULPRIT_REQUIRES(mutex_);
  void begin_with(const journal::StandingOrders& orders) CULPRIT_REQUIRES(mutex_);
  void tell(const journal::StandingOrders& orders);
  bool is_unwritten() const CULPRIT_REQUIRES(mutex_);
  void write_later();

  mutable Mutex mutex_;  // also held while the file is written
  std::optional<std::filesystem::path> file_ CULPRIT_GUARDED_BY(mutex_);
  std::string why_not_ CULPRIT_GUARDED_BY(mutex_);  // if there is no file
  bool only_advises_ CULPRIT_GUARDED_BY(mutex_) = false;
  journal::StandingOrders orders_ CULPRIT_GUARDED_BY(mutex_);  // what holds
  std::uint64_t known_ CULPRIT_GUARDED_BY(mutex_) =
      0;  // the latest revision of another culprit's orders that is in ours
  std::optional<journal::StandingOrders> in_file_
      CULPRIT_GUARDED_BY(mutex_);         // nothing: unknown, or unreadable
  std::atomic<std::uint64_t> freed_ = 0;  // how many orders that free were given

  mutable Mutex told_mutex_;
  journal::StandingOrders told_ CULPRIT_GUARDED_BY(told_mutex_);

  std::atomic<bool> is_kept_again_ = false;
  ConditionVariable wakes_;
  bool is_over_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::thread later_;
};

}  // namespace culprit::live
