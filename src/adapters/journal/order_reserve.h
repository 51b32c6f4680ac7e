// Room on the disk for what people have ordered, taken while there is some: "a.journal-orders-reserve".
//
// A pause must be kept also when the disk is full. The file of the orders is replaced as a whole,
// which needs room for the new one. So these 32 KiB are reserved beforehand and written in place.
// Two records of 16 KiB take turns: while one is written the other one holds; each is sealed
// (sealed_file.h), and begins with its number on a line.
//
// A file system that never writes in place (btrfs, ZFS) may refuse this, too; then the order is in force and not kept.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/expected.h"

namespace culprit::journal {

// Beside which file of orders: "a.journal-orders" -> "a.journal-orders-reserve"
std::filesystem::path reserve_beside(const std::filesystem::path& orders);

// The room is there when it returns. A record in it stays. Errors name the file.
Expected<void> make_reserve(const std::filesystem::path& reserve);
// Removes the records; the room stays.
Expected<void> clear_reserve(const std::filesystem::path& reserve);

// On the disk when it returns, beside the record that was written before. Errors: make_reserve() did not succeed, the
// text is too long, or the disk refuses.
Expected<void> write_reserve(const std::filesystem::path& reserve, const std::string& text);

// The text of the newest record that is whole. Nothing: there is none.
std::optional<std::string> read_reserve(const std::filesystem::path& reserve);

}  // namespace culprit::journal
