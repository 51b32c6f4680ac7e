#include "exemplars/sunset/parameter_file.h"

#include <iterator>
#include <sstream>
#include <system_error>
#include <utility>

namespace culprit::sunset {
namespace {

Error trouble(const std::filesystem::path& path, const std::string& what) {
  return {"the parameters in " + path.string() + " cannot be " + what +
          "; is the folder writable, and is there space?"};
}

std::string text_of(const Value& value) {
  const auto* text = std::get_if<std::string>(&value);
  return text != nullptr ? *text : to_string(value);  // without the rule language's quotes
}

}  // namespace

Expected<ParameterFile> ParameterFile::open(const std::filesystem::path& path) {
  std::error_code error;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), error);
  std::ifstream present(path, std::ios::binary);
  std::string content(std::istreambuf_iterator<char>(present), {});
  const std::size_t whole = content.rfind('\n') + 1;  // 0 if there is none
  if (whole < content.size()) {
    std::filesystem::resize_file(path, whole, error);
    if (error) return trouble(path, "repaired");
    content.resize(whole);
  }

  std::map<std::string, std::string, std::less<>> texts;
  std::istringstream lines(content);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t blank = line.find(' ');
    if (blank != std::string::npos) texts[line.substr(0, blank)] = line.substr(blank + 1);
  }

  std::ofstream file(path, std::ios::binary | std::ios::app);
  if (!file) return trouble(path, "opened");
  return ParameterFile(std::move(texts), std::move(file));
}

std::optional<Value> ParameterFile::last(std::string_view name, const Value& pattern) const {
  const auto found = texts_.find(name);
  if (found == texts_.end()) return std::nullopt;
  if (std::holds_alternative<std::string>(pattern)) return found->second;
  Value value = value_from_text(found->second);
  if (value.index() != pattern.index()) return std::nullopt;
  return value;
}

Expected<void> ParameterFile::append(std::string_view name, const Value& value) {
  const std::string text = text_of(value);
  if (text.find('\n') != std::string::npos) {
    return Error{"parameter '" + std::string(name) + "' cannot be a text of several lines"};
  }
  // One line, smaller than the stream's buffer, is one write.
  file_ << name << ' ' << text << '\n' << std::flush;
  if (!file_)
    return Error{"parameter '" + std::string(name) + "' cannot be kept; is the disk full?"};
  return {};
}

}  // namespace culprit::sunset
