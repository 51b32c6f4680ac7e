// Silence that lost messages explain: the link or a host is at fault, not the publisher.
//
// The sequence numbers of the messages that come show which share of them is lost, and what the link may lose
// at most (SignalStore::Rhythm::loss_at_most). With loss p, a pause of n expected messages is nothing but loss with probability p^n. While that is at
// least kPlausible, the pause says nothing against the publisher. A longer one does, however lossy the link.
#pragma once

#include <optional>
#include <string>

#include "knowledge/knowledge.h"

namespace culprit::diagnose {

// A pause so unlikely would be seen once in some hours at 100 Hz.
inline constexpr double kPlausible = 1e-6;

struct Lost {
  ComponentId publisher;
  TopicId topic;
  double share = 0;  // of its messages
};

// May the present pause of the topic be nothing but loss?
bool may_be_lost(TopicId topic, Time now, const Knowledge& knowledge);

// A topic that the failure's rule watches, with such a pause and a component that publishes it.
std::optional<Lost> lost_behind(RuleId failure, const Knowledge& knowledge);

// After the publisher's name: "answers, and 20 % of what it sends on /scan is lost ...".
std::string in_words(const Lost& lost, const Knowledge& knowledge);

}  // namespace culprit::diagnose
