#include "lsp/wire.h"

#include <charconv>
#include <string_view>

namespace culprit::lsp {
namespace {

std::uint32_t number_at(const Json& value, const JsonPath& path) {
  const Json* found = at(value, path);
  return found != nullptr && found->is_number_unsigned() ? found->get<std::uint32_t>() : 0;
}

Json to_json(TextPosition position) {
  return {{"line", position.line}, {"character", position.character}};
}

}  // namespace

const Json* at(const Json& value, const JsonPath& path) {
  const Json* here = &value;
  for (const char* member : path) {
    const auto found = here->find(member);
    if (!here->is_object() || found == here->end()) return nullptr;
    here = &*found;
  }
  return here;
}

std::string text_at(const Json& value, const JsonPath& path) {
  const Json* found = at(value, path);
  return found != nullptr && found->is_string() ? found->get<std::string>() : "";
}

std::uint32_t place_in(const Document& document, const Json& params, const JsonPath& path) {
  const Json* position = at(params, path);
  if (position == nullptr) return 0;
  return offset_of(document.source(),
                   {number_at(*position, {"line"}), number_at(*position, {"character"})});
}

Json to_json(const Source& source, Span span) {
  return {{"start", to_json(text_position(source, span.begin))},
          {"end", to_json(text_position(source, span.end))}};
}

Json to_json(const Diagnostic& diagnostic, const Source& source) {
  const std::string remedy = diagnostic.remedy.empty() ? "" : "\n" + diagnostic.remedy;
  return {{"range", to_json(source, diagnostic.span)},
          {"severity", diagnostic.severity == Severity::kError ? 1 : 2},
          {"code", to_string(diagnostic.code)},
          {"source", "culprit"},
          {"message", diagnostic.cause + remedy}};
}

std::string path_of(const std::string& uri) {
  constexpr std::string_view kScheme = "file://";
  if (!uri.starts_with(kScheme)) return "";
  std::string path;
  for (std::size_t i = kScheme.size(); i < uri.size(); ++i) {
    unsigned value = 0;
    const char* begin = uri.data() + i + 1;
    const bool is_escape = uri[i] == '%' && i + 2 < uri.size() &&
                           std::from_chars(begin, begin + 2, value, 16).ptr == begin + 2;
    path += is_escape ? static_cast<char>(value) : uri[i];
    if (is_escape) i += 2;
  }
  return path;
}

std::string uri_of(const std::string& path) {
  constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/";
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string uri = "file://";
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    if (kPlain.find(c) != std::string_view::npos) {
      uri += c;
    } else {
      uri += {'%', kDigits[byte / 16], kDigits[byte % 16]};
    }
  }
  return uri;
}

}  // namespace culprit::lsp
