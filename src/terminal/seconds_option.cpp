#include "terminal/seconds_option.h"

#include <cmath>

#include <fmt/core.h>

#include "base/units.h"

namespace culprit {
namespace {

bool is_number(const std::string& text) {
  return text.find_first_not_of("+-.0123456789eE") == std::string::npos;
}

// A number of seconds stays unchanged, and so does invalid text: CLI11 reports its error then.
std::string in_seconds(std::string& text) {
  if (is_number(text)) return "";
  const auto time = typed_duration(text);
  if (!time) return time.error();
  text = fmt::format("{}", seconds(*time));
  return "";
}

}  // namespace

Expected<Duration> typed_duration(const std::string& text) {
  if (is_number(text)) return parse_duration(text + "s");
  const std::string number = text.substr(0, text.size() - 1);
  if (number.empty() || !is_number(number)) return parse_duration(text);
  if (text.ends_with('m')) return parse_duration(number + "min");
  if (!text.ends_with('d')) return parse_duration(text);
  constexpr double kHours = 24;
  const auto hours = parse_duration(number + "h");
  return hours ? from_seconds(kHours * seconds(*hours)) : hours;
}

Expected<Duration> duration_of_option(const std::string& name, const std::string& text) {
  auto duration = typed_duration(text);
  if (!duration) return Error{name + ": " + duration.error()};
  if (*duration < Duration::zero())
    return Error{name + ": '" + text + "' is negative; write how long ago, as in 1h"};
  return duration;
}

CLI::Option* add_seconds(CLI::App& command, const std::string& name, double& value,
                         const std::string& what, double least, double most) {
  const auto in_range = [=](const std::string& text) {
    double number = 0;
    const bool is_number = CLI::detail::lexical_cast(text, number);
    if (is_number && number >= least && number <= most) return std::string();
    const bool is_time = is_number && std::isfinite(number);
    return fmt::format("{} is not from {} to {}", is_time ? to_string(from_seconds(number)) : text,
                       to_string(from_seconds(least)), to_string(from_seconds(most)));
  };
  return command.add_option(name, value, what)
      ->check(CLI::Validator(in_range, ""))
      ->transform(CLI::Validator(in_seconds, ""))
      ->type_name("DURATION")
      ->default_str(to_string(from_seconds(value)));
}

}  // namespace culprit
