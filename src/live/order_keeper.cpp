#include "live/order_keeper.h"

#include <system_error>

#include "inbox/inbox.h"
#include "journal/order_reserve.h"
#include "journal/sealed_file.h"

namespace culprit::live {

using journal::NamedOrder;
using journal::StandingOrders;

OrderKeeper::OrderKeeper(std::string why)
    : why_not_(std::move(why)), later_([this] { write_later(); }) {}

OrderKeeper::~OrderKeeper() {
  {
    const MutexLock lock(mutex_);
    is_over_ = true;
  }
  wakes_.notify_all();
  later_.join();
}

StandingOrders OrderKeeper::begin(std::filesystem::path file, const StandingOrders& found,
                                  bool is_in_file, std::string& trouble) {
  const MutexLock lock(mutex_);
  file_ = std::move(file);
  only_advises_ = false;
  in_file_ = is_in_file ? std::optional(found) : std::nullopt;
  begin_with(both(found, orders_));
  // A record there belongs to a file that is gone or damaged.
  if (!is_in_file) (void)journal::clear_reserve(journal::reserve_beside(*file_));
  if (const auto written = write(orders_); !written) trouble = written.error();
  (void)journal::make_reserve(journal::reserve_beside(*file_));
  wakes_.notify_all();
  return orders_;
}

StandingOrders OrderKeeper::begin_without(std::string why, const StandingOrders& found) {
  const MutexLock lock(mutex_);
  file_.reset();
  in_file_.reset();
  only_advises_ = false;
  why_not_ = std::move(why);
  begin_with(both(found, orders_));
  return orders_;
}

StandingOrders OrderKeeper::begin_advising(std::string why) {
  const MutexLock lock(mutex_);
  file_.reset();
  in_file_.reset();
  only_advises_ = true;
  why_not_ = std::move(why);
  begin_with(orders_);
  return orders_;
}

void OrderKeeper::begin_with(const StandingOrders& orders) {
  orders_ = orders;
  known_ = std::max(known_, orders.revision);
  tell(orders);
}

void OrderKeeper::tell(const StandingOrders& orders) {
  const MutexLock lock(told_mutex_);
  told_ = orders;
}

StandingOrders OrderKeeper::told() const {
  const MutexLock lock(told_mutex_);
  return told_;
}

// Orders that they announced before, and orders that they had from us, are not new: a person may
// have lifted them here since.
std::vector<Order> OrderKeeper::heed(const StandingOrders& theirs, const RuleSet& rules, Time now) {
  if (!mutex_.try_lock()) return {};
  const MutexLock lock(mutex_, std::adopt_lock);
  if (theirs.revision <= known_) return {};
  known_ = theirs.revision;
  orders_.revision = std::max(orders_.revision, theirs.revision);
  std::vector<Order> orders = restraints_beyond(orders_, theirs, rules, now);
  for (const Order& order : orders)
    orders_ = after(std::move(orders_), journal::by_name(order, rules), now);
  tell(orders_);
  wakes_.notify_all();
  return orders;
}

void OrderKeeper::write_later() {
  constexpr auto kAgain = std::chrono::seconds(1);
  MutexLock lock(mutex_);
  while (!is_over_) {
    // A person, or a program that cleans up, may remove it.
    std::error_code error;
    if (in_file_ && !std::filesystem::exists(*file_, error) && !error) in_file_.reset();
    if (is_unwritten() && write(orders_)) is_kept_again_ = true;
    wakes_.wait_for(lock, kAgain);
  }
}

KeepOrders OrderKeeper::keeping() {
  return [this](const Order& order, const RuleSet& rules) -> KeepOrder {
    return [this, named = journal::by_name(order, rules), standing = standing_of(order)](
               const std::function<void()>& submit) { return take(named, standing, submit); };
  };
}

// Two people may order at once. Under the mutex the last one wins, on the disk and in force.
Kept OrderKeeper::take(const NamedOrder& order, Standing standing,
                       const std::function<void()>& submit) {
  const bool frees = standing == Standing::kFrees;
  const std::uint64_t freed = freed_;
  if (!frees) submit();
  const MutexLock lock(mutex_);
  const auto* dry_run = std::get_if<SetDryRun>(&order.what);
  if (only_advises_ && dry_run != nullptr && !dry_run->is_on) return {false, false, why_not_};
  StandingOrders next = after(orders_, order, live_now());
  if (!frees) tell(next);
  const auto written = write(next);
  // Without a file there is none that says otherwise.
  if (frees && file_ && !written) return {false, false, written.error()};
  orders_ = std::move(next);
  tell(orders_);
  if (frees) ++freed_;
  if (frees || freed != freed_) submit();
  if (!written) wakes_.notify_all();
  return {written.has_value(), true, written ? "" : written.error()};
}

Expected<void> OrderKeeper::write(const StandingOrders& orders) {
  if (!file_) return Error{why_not_};
  if (in_file_ && restrain_alike(*in_file_, orders)) return {};
  const auto content = [&]() CULPRIT_REQUIRES(mutex_) {
    const auto text = journal::read_sealed(*file_);
    return text ? *text : std::nullopt;
  };
  const auto before = content();
  const auto written = write_orders(*file_, orders, journal::clocks_now(live_now()));
  if (written) in_file_ = orders;
  // Where there was no room at the beginning.
  if (written) (void)journal::make_reserve(journal::reserve_beside(*file_));
  // A failure may come after the name was changed already.
  if (!written && content() != before) in_file_.reset();
  return written;
}

StandingOrders OrderKeeper::orders() const {
  const MutexLock lock(mutex_);
  return orders_;
}

bool OrderKeeper::is_kept() const {
  const MutexLock lock(mutex_);
  return file_ && !is_unwritten();
}

bool OrderKeeper::is_unwritten() const {
  return file_ && (!in_file_ || !restrain_alike(*in_file_, orders_));
}

}  // namespace culprit::live
