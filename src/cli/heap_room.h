// Room on the heap for the rules of a large file.
//
// The heap grows by 128 KiB at a time, in pages of 4 KiB, each of which the kernel gives when it is
// touched first: of a check of 10,000 rules that is a quarter of the time. Got in one piece, the
// same room can have pages of 2 MiB.
#pragma once

#include <cstddef>

namespace culprit::cli {

// Takes addresses, and memory only where they are used. To be called before what needs the room is
// there, and only by commands that end soon after: what was got once is not given back.
void make_heap_room(std::size_t bytes);

}  // namespace culprit::cli
