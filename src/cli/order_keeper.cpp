#include "cli/order_keeper.h"

#include "journal/sealed_file.h"
#include "robot/inbox.h"

namespace culprit::cli {

using journal::NamedOrder;
using journal::StandingOrders;

StandingOrders OrderKeeper::begin(std::filesystem::path file, const StandingOrders& found,
                                  bool is_in_file, std::string& trouble) {
  const std::lock_guard lock(mutex_);
  file_ = std::move(file);
  in_file_ = is_in_file ? std::optional(found) : std::nullopt;
  orders_ = both(found, orders_);
  if (const auto written = write(orders_); !written) trouble = written.error();
  return orders_;
}

StandingOrders OrderKeeper::begin_without(std::string why, const StandingOrders& found) {
  const std::lock_guard lock(mutex_);
  file_.reset();
  in_file_.reset();
  why_not_ = std::move(why);
  orders_ = both(found, orders_);
  return orders_;
}

web::OrderDesk::Keeping OrderKeeper::keeping() {
  return [this](const Order& order, const RuleSet& rules) -> web::OrderDesk::Keep {
    return [this, named = journal::by_name(order, rules), standing = standing_of(order)](
               const std::function<void()>& submit) { return take(named, standing, submit); };
  };
}

// Two people may order at once. Under the mutex the last one wins, on the disk and in force.
web::Kept OrderKeeper::take(const NamedOrder& order, Standing standing,
                            const std::function<void()>& submit) {
  const bool frees = standing == Standing::kFrees;
  const std::uint64_t freed = freed_;
  if (!frees) submit();
  const std::lock_guard lock(mutex_);
  StandingOrders next = after(orders_, order, live_now());
  const auto written = write(next);
  // Without a file there is none that says otherwise.
  if (frees && file_ && !written) return {false, false, written.error()};
  orders_ = std::move(next);
  if (frees) ++freed_;
  if (frees || freed != freed_) submit();
  return {written.has_value(), true, written ? "" : written.error()};
}

Expected<void> OrderKeeper::write(const StandingOrders& orders) {
  if (!file_) return Error{why_not_};
  if (in_file_ == orders) return {};
  const auto content = [&] {
    const auto text = journal::read_sealed(*file_);
    return text ? *text : std::nullopt;
  };
  const auto before = content();
  const auto written = write_orders(*file_, orders, journal::clocks_now(live_now()));
  if (written) in_file_ = orders;
  // A failure may come after the name was changed already.
  if (!written && content() != before) in_file_.reset();
  return written;
}

StandingOrders OrderKeeper::orders() const {
  const std::lock_guard lock(mutex_);
  return orders_;
}

bool OrderKeeper::is_kept() const {
  const std::lock_guard lock(mutex_);
  return file_ && in_file_ == orders_;
}

}  // namespace culprit::cli
