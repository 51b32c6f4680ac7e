#include "cli/give_order.h"

#include <pwd.h>
#include <unistd.h>

#include "base/environment.h"
#include "base/live_clock.h"

namespace culprit::cli {
namespace {

// The user at the terminal, for the record.
std::string author_of_order() {
  const std::string behind_sudo = geteuid() == 0 ? environment("SUDO_USER") : "";
  if (!behind_sudo.empty()) return behind_sudo;
  const passwd* user = getpwuid(geteuid());
  return user != nullptr ? user->pw_name : "user " + std::to_string(geteuid());
}

OutcomeOfOrder outcome_of(const http::Answer& answer) {
  const std::string error = http::text_of(answer.body, "error").value_or("");
  if (answer.status >= 400) return {false, "refused: " + error, answer.body};
  const std::string text = http::text_of(answer.body, "order").value_or("");
  if (answer.status != 200)
    return {false,
            "NOT CONFIRMED: culprit has the order, but its decision loop did not take it within " +
                to_string(kPatienceWithCulprit) + "; culprit status shows what holds",
            answer.body};
  const auto kept = answer.body.find("kept");
  if (kept == answer.body.end()) return {true, text, answer.body};
  if (kept->is_boolean() && kept->get<bool>())
    return {true, text + "; it also holds after a restart of culprit", answer.body};
  return {false,
          text + "; " + http::text_of(answer.body, "text").value_or("not kept") +
              ". A restart of culprit would forget it",
          answer.body};
}

}  // namespace

OutcomeOfOrder give(const RunningCulprit& culprit, Json order, const std::string& reason) {
  return std::move(give_all({culprit}, {std::move(order)}, reason).front());
}

std::vector<OutcomeOfOrder> give_all(const std::vector<RunningCulprit>& culprits,
                                     std::vector<Json> orders, const std::string& reason) {
  // It waits less than we do, and is not followed once we have given up.
  constexpr Duration kMargin = std::chrono::milliseconds(500);
  for (Json& order : orders) {
    order["author"] = author_of_order();
    order["reason"] = reason;
    order["wait_s"] = seconds(kPatienceWithCulprit - kMargin);
    order["valid_until"] = seconds(live_now().time_since_epoch() + kPatienceWithCulprit);
  }
  std::vector<http::LocalClient> clients;
  for (const RunningCulprit& each : culprits) clients.push_back(each.client);
  std::vector<OutcomeOfOrder> outcomes;
  for (const auto& answer : http::LocalClient::ask_all(clients, http::Method::kPost, "/api/orders",
                                                       orders, kPatienceWithCulprit)) {
    outcomes.push_back(answer ? outcome_of(*answer)
                              : OutcomeOfOrder{false, "NOT CONFIRMED: " + answer.error() +
                                                          "; culprit status shows what holds"});
  }
  return outcomes;
}

}  // namespace culprit::cli
