#include "diagnose/reach.h"

#include <algorithm>
#include <array>
#include <utility>

namespace culprit::diagnose {
namespace {

using Scc = Condensation::Scc;

std::vector<ComponentId> each_once(std::vector<ComponentId> components) {
  std::sort(components.begin(), components.end());
  components.erase(std::unique(components.begin(), components.end()), components.end());
  return components;
}

// For each of 64 bits, in how many words it was set: 32 numbers' worth of binary digits, to which
// words are added two at a time. So the number of carries does not depend on the words.
class BitCounts {
 public:
  void add(Word bits, std::uint32_t times) {
    for (std::size_t digit = 0; times != 0; ++digit, times >>= 1) {
      if ((times & 1) != 0) add_at(digit, bits);
    }
  }
  std::size_t of(std::size_t bit) const {
    std::size_t count = 0;
    for (std::size_t d = 0; d < digits_.size(); ++d)
      count += static_cast<std::size_t>((digits_[d] >> bit & 1) + (waiting_[d] >> bit & 1)) << d;
    return count;
  }

 private:
  void add_at(std::size_t digit, Word bits) {
    for (; has_waiting_[digit]; ++digit) {
      const Word sum = digits_[digit];
      const Word other = std::exchange(waiting_[digit], 0);
      has_waiting_[digit] = false;
      digits_[digit] = sum ^ other ^ bits;
      bits = (sum & other) | (sum & bits) | (other & bits);
    }
    waiting_[digit] = bits;
    has_waiting_[digit] = true;
  }

  std::array<Word, 32> digits_{};
  std::array<Word, 32> waiting_{};  // for a second one to add
  std::array<bool, 32> has_waiting_{};
};

Reach::Sccs sccs_of(const Knowledge& knowledge) {
  const Condensation& graph = knowledge.graph.condensation();
  Reach::Sccs sccs(knowledge.rules.components.size());
  for (std::size_t c = 0; c < sccs.size(); ++c) {
    if (const auto vertex = knowledge.graph.vertex_of(ComponentId(c)))
      sccs[c] = graph.scc_of(*vertex);
  }
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
    : Reach(knowledge.graph.condensation(), sccs_of(knowledge), std::move(components)) {}

Reach::Reach(const Condensation& graph, const Sccs& sccs, std::vector<ComponentId> components)
    : components_(each_once(std::move(components))),
      places_(sccs.size(), kAbsent),
      upstream_(components_.size(), components_.size()),
      downstream_(components_.size(), components_.size()),
      dependents_(components_.size(), 0) {
  for (std::size_t p = 0; p < components_.size(); ++p)
    places_[components_[p].index] = static_cast<std::uint32_t>(p);
  const std::vector<std::uint32_t> members = members_of(graph.size(), sccs);
  const auto scc_at = [&](std::size_t place) { return sccs[components_[place].index]; };

  std::vector<Word> own(graph.size(), 0);      // which of the 64 are in the SCC
  std::vector<Word> reached(graph.size(), 0);  // which are in it or upstream of it
  for (std::size_t begin = 0; begin < size(); begin += kWordBits) {
    const std::size_t end = std::min(size(), begin + kWordBits);
    auto first = static_cast<Scc>(graph.size());
    for (std::size_t p = begin; p < end; ++p) {
      if (const auto scc = scc_at(p)) {
        own[*scc] |= Word{1} << (p - begin);
        first = std::min(first, *scc);
      }
    }
    std::fill_n(reached.begin(), first, 0);
    BitCounts counts;
    for (Scc scc = first; scc < graph.size(); ++scc) {
      Word bits = own[scc];
      for (const Scc producer : graph.producers(scc)) bits |= reached[producer];
      reached[scc] = bits;
      if (bits != 0) counts.add(bits, members[scc]);
    }
    for (std::size_t consumer = 0; consumer < size(); ++consumer) {
      const auto scc = scc_at(consumer);
      if (!scc) continue;
      const Word itself = members[*scc] == 1 ? own[*scc] : 0;
      upstream_[consumer][begin / kWordBits] = reached[*scc] & ~itself;
    }
    for (std::size_t p = begin; p < end; ++p) {
      if (const auto scc = scc_at(p)) {
        dependents_[p] = counts.of(p - begin) - 1;
        own[*scc] = 0;
      }
    }
  }
  downstream_ = transposed(upstream_, size());
}

}  // namespace culprit::diagnose
