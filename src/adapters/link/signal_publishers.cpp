#include "link/signal_publishers.h"

#include "base/name_grammar.h"

namespace culprit::link {
namespace {

std::string in_words(const std::string& node) {
  return node.empty() ? "a participant without a node" : printable(node);
}

}  // namespace

void SignalPublishers::declare(const std::string& status, ComponentId component,
                               const std::string& name) {
  Declared& declared = declared_[status];
  if (!declared.components.insert(component).second) return;
  declared.names += (declared.names.empty() ? "" : " and ") + name;
}

void SignalPublishers::remember(const std::string& status, const std::string& node) {
  bound_.try_emplace(Claim(status, ""), Bound{node, false, std::nullopt});
}

SignalPublishers::Answer SignalPublishers::judge(const std::string& status, const Publisher& by,
                                                 Time now, const IsThere& is_there) {
  const auto declared = declared_.find(status);
  if (declared == declared_.end()) return judge(Claim(status, ""), by, now, is_there);
  if (!by.component || !declared->second.components.contains(*by.component)) {
    // Another component may have a status of the same name, which no rule reads.
    if (by.component && by.is_proven && by.counts) return {};
    return report(status, by,
                  "by " + in_words(by.node) + ", but the rules read it FROM " +
                      declared->second.names + ": culprit ignores " + in_words(by.node));
  }
  Answer answer = judge(Claim(status, by.node), by, now, is_there);
  answer.is_learned = false;
  return answer;
}

SignalPublishers::Answer SignalPublishers::judge(const Claim& claim, const Publisher& by, Time now,
                                                 const IsThere& is_there) {
  const std::string& status = claim.first;
  const auto found = bound_.find(claim);
  if (found == bound_.end()) {
    const Time first = first_.try_emplace(claim, now).first->second;
    const bool is_proven = by.is_proven && !by.node.empty();
    if (!by.counts || (!is_proven && now < later(first, kClaimed))) return {};
    return learn(claim, by);
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
  const bool is_besides = by.component && by.is_proven && by.counts;
  if (is_besides && bound.is_proven && !is_gone) return {.is_used = true};
  if (!by.is_proven || !by.counts || (bound.is_proven && !is_gone) || (!is_gone && by.node.empty()))
    return refuse(status, by, bound.node);
  const std::string before = bound.node;
  Answer answer = learn(claim, by);
  if (!is_gone)
    answer.conflict = "the diagnostic status " + printable(status) + " is published by " +
                      in_words(by.node) + " of this computer, and by " + in_words(before) +
                      ", which is not proven to be here: culprit ignores " + in_words(before);
  return answer;
}

SignalPublishers::Answer SignalPublishers::learn(const Claim& claim, const Publisher& by) {
  bound_.insert_or_assign(claim, Bound{by.node, by.is_proven, std::nullopt});
  first_.erase(claim);
  conflicts_.erase(claim.first);
  return {.is_used = true, .is_learned = true};
}

SignalPublishers::Answer SignalPublishers::refuse(const std::string& status, const Publisher& by,
                                                  const std::string& bound) {
  const std::string other =
      by.node == bound ? "another participant that claims this name" : in_words(by.node);
  return report(status, by,
                "by " + in_words(bound) + ", and by " + other + ", too: culprit ignores " + other);
}

// Once for each publisher.
SignalPublishers::Answer SignalPublishers::report(const std::string& status, const Publisher& by,
                                                  const std::string& publishers) {
  if (by.is_new || told_.size() >= kMostConflicts || !told_.emplace(status, by.node).second)
    return {};
  Answer answer;
  answer.conflict = "the diagnostic status " + printable(status) + " is published " + publishers;
  conflicts_[status] = answer.conflict;
  return answer;
}

}  // namespace culprit::link
