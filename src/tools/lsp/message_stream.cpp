#include "lsp/message_stream.h"

#include <charconv>
#include <string>

namespace culprit::lsp {
namespace {

constexpr std::size_t kMaxHeader = 1024;

// A line without its end; nothing at the end of the stream.
std::optional<std::string> header_line(std::istream& in) {
  std::string line;
  for (char c = 0; line.size() < kMaxHeader && in.get(c);) {
    if (c == '\n') {
      if (line.ends_with('\r')) line.pop_back();
      return line;
    }
    line += c;
  }
  return std::nullopt;
}

}  // namespace

Expected<std::optional<Json>> read_message(std::istream& in) {
  constexpr std::string_view kLength = "Content-Length: ";
  std::optional<std::size_t> length;
  auto line = header_line(in);
  if (!line) return std::optional<Json>();
  for (; line && !line->empty(); line = header_line(in)) {
    if (!line->starts_with(kLength)) continue;
    std::size_t value = 0;
    const char* end = line->data() + line->size();
    const auto [stop, error] = std::from_chars(line->data() + kLength.size(), end, value);
    if (error == std::errc() && stop == end) length = value;
  }
  if (!line || !length) return Error{"a message without Content-Length"};
  if (*length > kMaxMessage) return Error{"a message of " + std::to_string(*length) + " bytes"};
  std::string body(*length, '\0');
  if (!in.read(body.data(), static_cast<std::streamsize>(body.size())))
    return Error{"a message that ends too early"};
  return std::optional(parse_json(body));
}

void write_message(std::ostream& out, const Json& message) {
  // Texts come from files and may hold anything: what is no UTF-8 is replaced.
  const std::string body = to_line(message);
  out << "Content-Length: " << body.size() << "\r\n\r\n" << body << std::flush;
}

}  // namespace culprit::lsp
