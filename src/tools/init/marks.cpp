#include "init/marks.h"

#include <charconv>
#include <utility>

#include <fmt/format.h>

namespace culprit::init {
namespace {

constexpr std::string_view kIntroduction =
    "# What `culprit init` wrote itself: by these marks --update leaves alone what you change.";
constexpr std::string_view kMarks = "# marks";
constexpr std::string_view kFileIntroduction =
    "# What `culprit init --launch` wrote: by this mark --update leaves it alone once you change "
    "it.\n"
    "# mark ";
constexpr std::size_t kMarksInALine = 6;
constexpr std::size_t kDigits = 8;  // of each of the two numbers
constexpr std::string_view kBlanks = " \t\r\n";

std::string_view trimmed(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return "";
  return line.substr(begin, line.find_last_not_of(kBlanks) + 1 - begin);
}

// FNV-1a.
constexpr std::uint32_t kFirstPrint = 2166136261u;
std::uint32_t with(std::uint32_t print, char c) {
  return (print ^ static_cast<unsigned char>(c)) * 16777619u;
}

std::optional<std::uint32_t> number_in(std::string_view digits) {
  std::uint32_t number = 0;
  const char* end = digits.data() + digits.size();
  const auto read = std::from_chars(digits.data(), end, number, 16);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return number;
}

}  // namespace

std::uint32_t print_of(std::string_view text) {
  std::uint32_t print = kFirstPrint;
  const auto add = [&](char c) { print = with(print, c); };
  bool is_between = false;
  for (const char c : trimmed(text)) {
    if (kBlanks.find(c) != std::string_view::npos) {
      is_between = true;
      continue;
    }
    if (std::exchange(is_between, false)) add(' ');
    add(c);
  }
  return print;
}

std::optional<Mark> mark_of(const Part& part) {
  if (part.subject.empty()) return std::nullopt;
  const std::string about = std::to_string(static_cast<int>(part.kind)) + part.subject;
  return Mark{print_of(about), print_of(part.text)};
}

std::string text_of(const std::vector<Mark>& marks) {
  if (marks.empty()) return "";
  std::string text = std::string(kIntroduction) + "\n";
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (i % kMarksInALine == 0) text += kMarks;
    text += fmt::format(" {:08x}{:08x}", marks[i].about, marks[i].text);
    if (i % kMarksInALine == kMarksInALine - 1 || i + 1 == marks.size()) text += "\n";
  }
  return text;
}

std::string with_mark(std::string_view text) {
  std::uint32_t print = kFirstPrint;
  for (const char c : text) print = with(print, c);
  return fmt::format("{}{:08x}\n{}", kFileIntroduction, print, text);
}

bool is_as_written(std::string_view text) {
  const std::size_t head = kFileIntroduction.size() + kDigits + 1;
  return text.size() >= head && with_mark(text.substr(head)) == text;
}

bool is_of_marks(std::string_view line) {
  line = trimmed(line);
  return line == kIntroduction || line.starts_with(std::string(kMarks) + " ");
}

std::vector<Mark> marks_in(std::string_view line) {
  std::vector<Mark> marks;
  line = trimmed(line);
  if (!line.starts_with(kMarks)) return marks;
  line.remove_prefix(kMarks.size());
  while (!(line = trimmed(line)).empty()) {
    const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
    line.remove_prefix(word.size());
    if (word.size() != 2 * kDigits) continue;
    const auto about = number_in(word.substr(0, kDigits));
    const auto text = number_in(word.substr(kDigits));
    if (about && text) marks.push_back({*about, *text});
  }
  return marks;
}

}  // namespace culprit::init
