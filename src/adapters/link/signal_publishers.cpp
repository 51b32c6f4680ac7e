#include "link/signal_publishers.h"

#include "base/name_grammar.h"

namespace culprit::ros2 {
namespace {

std::string in_words(const std::string& node) {
  return node.empty() ? "a participant without a node" : printable(node);
}

}  // namespace

void SignalPublishers::remember(const std::string& status, const std::string& node) {
  bound_.try_emplace(status, Bound{node, false, std::nullopt});
}

SignalPublishers::Answer SignalPublishers::judge(const std::string& status, const Publisher& by,
                                                 Time now, const IsThere& is_there) {
  const auto found = bound_.find(status);
  if (found == bound_.end()) {
    const Time first = first_.try_emplace(status, now).first->second;
    const bool is_proven = by.is_proven && !by.node.empty();
    if (!by.counts || (!is_proven && now < later(first, kClaimed))) return {};
    return learn(status, by);
  }
  Bound& bound = found->second;
  if (by.node == bound.node) {
    if (!by.counts || (bound.is_proven && !by.is_proven)) return refuse(status, by, bound.node);
    bound.is_proven = by.is_proven;
    bound.missed.reset();
    return {.is_used = true};
  }
  if (is_there(bound.node)) {
    bound.missed.reset();
  } else if (!bound.missed) {
    bound.missed = now;
  }
  const bool is_gone = bound.missed && now >= later(*bound.missed, kForgets);
  const bool is_besides = by.is_component && by.is_proven && by.counts;
  if (is_besides && bound.is_proven && !is_gone) return {.is_used = true};
  if (!by.is_proven || !by.counts || (bound.is_proven && !is_gone) || (!is_gone && by.node.empty()))
    return refuse(status, by, bound.node);
  const std::string before = bound.node;
  Answer answer = learn(status, by);
  if (!is_gone)
    answer.conflict = "the diagnostic status " + printable(status) + " is published by " +
                      in_words(by.node) + " of this computer, and by " + in_words(before) +
                      ", which is not proven to be here: only the former is used";
  return answer;
}

SignalPublishers::Answer SignalPublishers::learn(const std::string& status, const Publisher& by) {
  bound_.insert_or_assign(status, Bound{by.node, by.is_proven, std::nullopt});
  first_.erase(status);
  conflicts_.erase(status);
  return {.is_used = true, .is_learned = true};
}

SignalPublishers::Answer SignalPublishers::refuse(const std::string& status, const Publisher& by,
                                                  const std::string& bound) {
  if (told_.size() >= kMostConflicts || !told_.emplace(status, by.node).second) return {};
  const std::string other =
      by.node == bound ? "another participant that claims this name" : in_words(by.node);
  Answer answer;
  answer.conflict = "the diagnostic status " + printable(status) + " is published by " +
                    in_words(bound) + ", and by " + other + ", too: only the former is used";
  conflicts_[status] = answer.conflict;
  return answer;
}

}  // namespace culprit::ros2
