// The turn of one endpoint: anybody may send to it without end, and the other endpoints have a turn, too.
#pragma once

namespace culprit_link {

inline constexpr int kInTurn = 100;  // messages

// Calls `take`, which takes a message, until it gives false: there is none, or kInTurn were taken.
template <class Take>
void take_turn(Take take) {
  for (int i = 0; i < kInTurn && take(); ++i) continue;
}

}  // namespace culprit_link
