// People's orders that hold until they are revoked: pause, dry run, mutes. They are in a small file
// of their own beside the journal. So neither damage, nor retention, nor a jump of the clock can
// make culprit forget that it must not act.
//
// A culprit that finds that file unreadable, or missing although a run had one, is paused.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "journal/clocks.h"
#include "knowledge/history.h"
#include "language/rule_set.h"

namespace culprit::journal {

struct StandingOrders {
  struct Said {
    std::string author;
    std::string reason;
    bool operator==(const Said&) const = default;
  };
  enum class About : std::uint8_t { kComponent, kRule };
  struct Quiet {
    About about = About::kComponent;
    std::string name;
    Said said;
    Time until = kNever;  // on the robot's clock
    bool operator==(const Quiet&) const = default;
  };
  std::optional<Said> pause;
  std::optional<Said> dry_run;
  std::vector<Quiet> silences;
  std::uint64_t revision = 0;  // how many orders led to this; more is later
  bool operator==(const StandingOrders&) const = default;
};

// A standing order by names, which outlive the rules. @pre standing_of(order) is not kNot
struct NamedOrder {
  decltype(Order::what) what;
  StandingOrders::Said said;
  StandingOrders::About about = StandingOrders::About::kComponent;  // of silences
  std::string name;
};
NamedOrder by_name(const Order& order, const RuleSet& rules);

// `orders` after `order` at `now`. Silences that are over are left out.
StandingOrders after(StandingOrders orders, const NamedOrder& order, Time now);

// Whether they are the same for the manager, however many orders led there.
bool restrain_alike(const StandingOrders& a, const StandingOrders& b);

// All restraints of both.
StandingOrders both(StandingOrders a, const StandingOrders& b);

// The restrictions of `theirs` that `ours` has not, as orders; no mutes of what `rules` does not
// have.
std::vector<Order> restraints_beyond(const StandingOrders& ours, const StandingOrders& theirs,
                                     const RuleSet& rules, Time now);

// Silences as the manager remembers them (knowledge/history.h); those about what `rules` does not have
// are left out. And back.
History to_past(const StandingOrders& orders, const RuleSet& rules, Time now);
std::vector<StandingOrders::Quiet> silences_of(const History& past, const RuleSet& rules);
bool is_about_silence(const Event& event);

// As text, also for a successor on another machine. A silence goes on for what is left of it; if
// the clocks do not show how much that is, for longer rather than shorter.
std::string to_text(const StandingOrders& orders, const Clocks& now);
Expected<StandingOrders> orders_from_text(const std::string& text, const Clocks& now);

// Beside which journal: "a.journal" -> "a.journal-orders"
std::filesystem::path orders_beside(const std::filesystem::path& journal);

// On the disk when it returns: in the file, or, where the disk is full, in the room that was taken beforehand
// (order_reserve.h). Errors give the reason why it is not in the file.
Expected<void> write_orders(const std::filesystem::path& path, const StandingOrders& orders,
                            const Clocks& now);
// The orders that were written last, by their revision. Nothing: there is no such file. Errors: it cannot be read, or is damaged.
Expected<std::optional<StandingOrders>> read_orders(const std::filesystem::path& path,
                                                    const Clocks& now);

}  // namespace culprit::journal
