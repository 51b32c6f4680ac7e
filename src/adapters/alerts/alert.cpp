#include "alerts/alert.h"

#include <algorithm>

#include <fmt/core.h>

namespace culprit::alerts {
namespace {

std::string some_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 10;
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, names.size()); ++i)
    text += (i == 0 ? "" : ", ") + names[i];
  return names.size() > kMost ? text + fmt::format(" and {} more", names.size() - kMost) : text;
}

}  // namespace

std::string text_of(const Alert& alert) {
  std::string text = alert.robot.empty() ? alert.host : alert.robot;
  const bool is_over = alert.state == Alert::State::kResolved;
  text += fmt::format(": {}{} ({})",
                      is_over              ? "RESOLVED: "
                      : alert.needs_person ? "A PERSON IS NEEDED: "
                                           : "",
                      alert.headline, alert.health);
  if (!alert.consequences.empty())
    text += fmt::format(", so that {} {}", some_of(alert.consequences),
                        alert.consequences.size() == 1 ? "fails" : "fail");
  if (is_over) text += fmt::format(", after {:.1f} s", std::max(0.0, alert.ended - alert.began));
  for (const std::string& more : {alert.doing, alert.next}) {
    if (!more.empty()) text += "; " + more;
  }
  if (alert.untold > 0) text += fmt::format("; {} earlier alerts could not be sent", alert.untold);
  return text;
}

}  // namespace culprit::alerts
