#include "plan/bayes/reach.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace culprit::plan {
namespace {

using Scc = Condensation::Scc;

std::vector<ComponentId> each_once(std::vector<ComponentId> components) {
  std::sort(components.begin(), components.end());
  components.erase(std::unique(components.begin(), components.end()), components.end());
  return components;
}

// For each of 64 bits, in how many words it was set: 32 numbers' worth of binary digits, added a
// word at a time.
class BitCounts {
 public:
  void add(Word bits) {
    for (std::size_t digit = 0; bits != 0; ++digit) {
      const Word carry = digits_[digit] & bits;
      digits_[digit] ^= bits;
      bits = carry;
    }
  }
  std::size_t of(std::size_t bit) const {
    std::size_t count = 0;
    for (std::size_t digit = 0; digit < digits_.size(); ++digit)
      count |= static_cast<std::size_t>(digits_[digit] >> bit & 1) << digit;
    return count;
  }

 private:
  std::array<Word, 32> digits_{};
};

Reach::Sccs sccs_of(const Knowledge& knowledge) {
  Reach::Sccs sccs(knowledge.rules.components.size());
  for (std::size_t c = 0; c < sccs.size(); ++c) sccs[c] = knowledge.graph.scc_of(ComponentId(c));
  return sccs;
}

// Components, by SCC.
std::vector<std::uint32_t> members_of(std::size_t size, const Reach::Sccs& sccs) {
  std::vector<std::uint32_t> members(size, 0);
  for (const auto scc : sccs) {
    if (scc) ++members[*scc];
  }
  return members;
}

}  // namespace

Reach::Reach(const Knowledge& knowledge, std::vector<ComponentId> components)
    : Reach(std::move(components)) {
  find(knowledge.graph.condensation(), sccs_of(knowledge));
}

Reach::Reach(const Condensation& graph, const Sccs& sccs, std::vector<ComponentId> components)
    : Reach(std::move(components)) {
  find(graph, sccs);
}

Reach::Reach(std::vector<ComponentId> components)
    : components_(each_once(std::move(components))),
      upstream_(components_.size(), components_.size()),
      downstream_(components_.size(), components_.size()),
      dependents_(components_.size(), 0) {}

void Reach::find(const Condensation& graph, const Sccs& sccs) {
  const std::vector<std::uint32_t> members = members_of(graph.size(), sccs);
  // By the order of their SCCs, so that a pass can begin at its first.
  std::vector<std::size_t> order;
  for (std::size_t p = 0; p < components_.size(); ++p) {
    if (sccs[components_[p].index]) order.push_back(p);
  }
  const auto scc_at = [&](std::size_t place) { return *sccs[components_[place].index]; };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(scc_at(a), a) < std::pair(scc_at(b), b);
  });

  std::vector<Word> own(graph.size(), 0);      // which of the 64 are in the SCC
  std::vector<Word> reached(graph.size(), 0);  // which are in it or upstream of it
  for (std::size_t begin = 0; begin < order.size(); begin += kWordBits) {
    const std::size_t end = std::min(order.size(), begin + kWordBits);
    for (std::size_t i = begin; i < end; ++i) own[scc_at(order[i])] |= Word{1} << (i - begin);
    std::fill(reached.begin(), reached.end(), 0);
    BitCounts counts;
    for (Scc scc = scc_at(order[begin]); scc < graph.size(); ++scc) {
      Word bits = own[scc];
      for (const Scc producer : graph.producers(scc)) bits |= reached[producer];
      reached[scc] = bits;
      for (std::uint32_t m = 0; m < members[scc]; ++m) counts.add(bits);
    }
    for (std::size_t i = begin; i < end; ++i) dependents_[order[i]] = counts.of(i - begin) - 1;
    for (const std::size_t consumer : order) {
      const Scc scc = scc_at(consumer);
      Word bits = reached[scc];
      if (members[scc] == 1) bits &= ~own[scc];
      for (; bits != 0; bits &= bits - 1) {
        const std::size_t producer =
            order[begin + static_cast<std::size_t>(std::countr_zero(bits))];
        set(upstream_[consumer], producer);
        set(downstream_[producer], consumer);
      }
    }
    for (std::size_t i = begin; i < end; ++i) own[scc_at(order[i])] = 0;
  }
}

std::size_t Reach::place_of(ComponentId component) const {
  const auto found = std::lower_bound(components_.begin(), components_.end(), component);
  assert(found != components_.end() && *found == component);
  return static_cast<std::size_t>(found - components_.begin());
}

}  // namespace culprit::plan
