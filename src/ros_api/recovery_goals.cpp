#include "ros_api/recovery_goals.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "base/closest.h"

namespace culprit::ros_api {
namespace {

// culprit_msgs/msg/Component: PROCESS_STOPPED and worse.
constexpr int kFirstBadProcess = 2;

// The facts of a status about the subject of a goal.
struct Outlook {
  bool is_known = false;  // the robot's messages arrive
  bool is_there = false;  // and has such a component
  std::vector<std::string> ill;
  std::string doing;
  bool needs_person = false;

  Json feedback() const { return {{"ill", ill}, {"doing", doing}, {"needs_person", needs_person}}; }
};

bool is_ill(const Json& component) {
  return component["health"] != 0 || component["is_present"] == false ||
         component["process"].get<int>() >= kFirstBadProcess || component["adapting"] != "";
}

bool is_about(const Json& incident, const std::string& component) {
  const Json& all = incident["components"];
  return component.empty() || std::find(all.begin(), all.end(), component) != all.end();
}

std::string no_such(const std::string& component, const Json& components) {
  std::vector<std::string_view> names;
  for (const Json& each : components) names.push_back(each["name"].get_ref<const std::string&>());
  const std::string near = closest(component, names);
  return "there is no component '" + component + "'" +
         (near.empty() ? "" : "; did you mean '" + near + "'?");
}

Outlook outlook_of(const Json& status, const std::string& component) {
  Outlook outlook;
  if (status["hears"] == false) {
    outlook.doing = "culprit receives nothing from the robot";
    return outlook;
  }
  outlook.is_known = true;
  outlook.is_there = component.empty();
  for (const Json& each : status["components"]) {
    if (!component.empty() && each["name"] != component) continue;
    outlook.is_there = true;
    if (is_ill(each)) outlook.ill.push_back(each["name"]);
  }
  for (const Json& incident : status["incidents"]) {
    if (!is_about(incident, component)) continue;
    outlook.needs_person = outlook.needs_person || incident["needs_person"] == true;
    if (!outlook.doing.empty()) continue;  // the worst stands first
    outlook.doing =
        incident["headline"].get<std::string>() + ": " + incident["doing"].get<std::string>();
  }
  return outlook;
}

}  // namespace

// The oldest results.
void RecoveryGoals::forget_some() {
  auto ended = static_cast<std::size_t>(std::ranges::count_if(
      goals_, [](const auto& each) { return each.second.state != State::kExecuting; }));
  std::erase_if(order_, [&](const Id& id) {
    const auto goal = goals_.find(id);
    if (goal->second.state == State::kExecuting || ended <= kMostEnded) return false;
    --ended;
    goals_.erase(goal);
    return true;
  });
}

// The client that has waited longest is the most likely to have left.
void RecoveryGoals::make_room() {
  std::vector<Goal*> open;
  for (const Id& id : order_) {
    if (Goal& goal = goals_.at(id); goal.state == State::kExecuting) open.push_back(&goal);
  }
  if (open.size() >= kMostOpen) end(*open.front(), State::kAborted, "too many others wait");
}

bool RecoveryGoals::begin(const Request& request, Time now, WallTime wall) {
  if (goals_.contains(request.id)) return false;
  make_room();
  forget_some();
  Goal goal{.request = request, .accepted = wall, .feedback = nullptr, .result = nullptr};
  if (request.timeout > Duration::zero()) goal.ends = later(now, request.timeout);
  goals_.emplace(request.id, std::move(goal));
  order_.push_back(request.id);
  return true;
}

void RecoveryGoals::look(Json status) {
  status_ = std::move(status);
  look_again();
}

void RecoveryGoals::look_again() {
  for (auto& [id, goal] : goals_) {
    if (goal.state == State::kExecuting) consider(goal);
  }
}

void RecoveryGoals::consider(Goal& goal) {
  const std::string& component = goal.request.component;
  if (goal.request.timeout < Duration::zero())
    return end(goal, State::kAborted, "the timeout is negative");
  if (status_.is_null()) return;
  const Outlook outlook = outlook_of(status_, component);
  if (outlook.is_known && !outlook.is_there)
    return end(goal, State::kAborted, no_such(component, status_["components"]));
  const bool is_well =
      outlook.is_known && outlook.ill.empty() && (!component.empty() || status_["health"] == 0);
  if (is_well)
    return end(
        goal, State::kSucceeded,
        component.empty() ? status_.value("summary", "all is well") : component + " is well");
  if (goal.feedback == outlook.feedback()) return;
  goal.feedback = outlook.feedback();
  news_.push_back(goal.request.id);
}

void RecoveryGoals::end(Goal& goal, State state, std::string message) {
  goal.state = state;
  goal.ends = kNever;
  goal.result = {{"recovered", state == State::kSucceeded}, {"message", std::move(message)}};
  ended_.push_back(goal.request.id);
}

void RecoveryGoals::expire(Time now) {
  for (auto& [id, goal] : goals_) {
    if (goal.state != State::kExecuting || goal.ends > now) continue;
    const std::string doing =
        goal.feedback.is_null() ? "" : goal.feedback["doing"].get<std::string>();
    end(goal, State::kAborted, "it took too long" + (doing.empty() ? "" : "; " + doing));
  }
}

Time RecoveryGoals::due() const {
  Time first = kNever;
  for (const auto& [id, goal] : goals_) first = std::min(first, goal.ends);
  return first;
}

std::vector<RecoveryGoals::Id> RecoveryGoals::cancel(const Id& id, WallTime until) {
  const bool is_any = id == Id{} && until == WallTime{};
  std::vector<Id> canceled;
  for (const Id& each : order_) {
    const Goal& goal = goals_.at(each);
    const bool is_meant = is_any || each == id || (until != WallTime{} && goal.accepted <= until);
    if (is_meant && goal.state == State::kExecuting) canceled.push_back(each);
  }
  for (const Id& each : canceled)
    end(goals_.at(each), State::kCanceled, "no client waits any more");
  return canceled;
}

const RecoveryGoals::Goal* RecoveryGoals::find(const Id& id) const {
  const auto found = goals_.find(id);
  return found == goals_.end() ? nullptr : &found->second;
}

std::vector<RecoveryGoals::Id> RecoveryGoals::take_ended() { return std::exchange(ended_, {}); }
std::vector<RecoveryGoals::Id> RecoveryGoals::take_news() { return std::exchange(news_, {}); }

std::vector<const RecoveryGoals::Goal*> RecoveryGoals::all() const {
  std::vector<const Goal*> all;
  for (const Id& each : order_) all.push_back(&goals_.at(each));
  return all;
}

}  // namespace culprit::ros_api
