#include "link/leaving_announcements.h"

#include <utility>

#include "base/live_clock.h"

namespace culprit::link {
namespace {

// A node that was announced to leave, and answered.
constexpr auto kLeavingAskedAgain = std::chrono::seconds(2);

}  // namespace

LeavingAnnouncements::LeavingAnnouncements(ros2::Executor& executor, Inbox& inbox, Ask ask,
                                           Left left)
    : inbox_(inbox), ask_(std::move(ask)), left_(std::move(left)), tasks_(executor) {}

void LeavingAnnouncements::is_back(const std::string& node) {
  leaving_.erase(node);
  unproven_.erase(node);
}

void LeavingAnnouncements::joined(const ros2::GraphNode& node) {
  if (node.pid == 0) unproven_[node.name] = {node.vendor, node.participant};
}

void LeavingAnnouncements::left(const std::string& node, bool was_lost) {
  const auto unproven = unproven_.extract(node);
  if (unproven) return doubt(node, {unproven.mapped(), was_lost});
  left_(node, was_lost);
}

void LeavingAnnouncements::doubt(const std::string& node, Leaving leaving) {
  constexpr auto kOfFastDds = std::chrono::seconds(4);
  constexpr auto kOfOthers = std::chrono::seconds(9);
  const auto patience = leaving.node.vendor == ros2::Vendor::kFastDds ? kOfFastDds : kOfOthers;
  leaving.doubt = ++doubts_;
  leaving_[node] = leaving;
  tasks_.post_at(ros2::Executor::Clock::now() + patience,
                 [this, node, doubt = leaving.doubt] { ask_leaving(node, doubt); });
}

// The middleware may know its services still, if a message in its name announced only that it holds
// no node.
void LeavingAnnouncements::ask_leaving(const std::string& node, std::uint64_t doubt) {
  const auto found = leaving_.find(node);
  if (found == leaving_.end() || found->second.doubt != doubt) return;
  ask_(node, [this, node, doubt](std::optional<rtps::GuidPrefix> answered) {
    tasks_.post([this, node, doubt, answered] { believe(node, answered, doubt); });
  });
}

void LeavingAnnouncements::believe(const std::string& node,
                                   std::optional<rtps::GuidPrefix> answered,
                                   std::uint64_t doubt_asked) {
  const auto found = leaving_.find(node);
  if (found == leaving_.end() || found->second.doubt != doubt_asked) return;
  Leaving leaving = found->second;
  if (answered != leaving.node.participant) {
    leaving_.erase(found);
    return left_(node, leaving.was_lost);
  }
  if (!std::exchange(leaving.is_told, true))
    inbox_.put(LinkTrouble{node +
                           " was announced to have left, but answers: another program may speak "
                           "in its name. It counts as present"});
  doubt(node, leaving);
}

// The node announces it, or another program does in its name.
void LeavingAnnouncements::said_to_leave(const std::string& node) {
  if (asked_whether_left_.insert(node).second) tasks_.post([this, node] { ask_again(node); });
}

void LeavingAnnouncements::ask_again(const std::string& node) {
  constexpr int kQuestions = 2;
  if (context_->graph().is_said_to_leave(node)) return ask_whether_left(node, kQuestions);
  asked_whether_left_.erase(node);
}

void LeavingAnnouncements::ask_whether_left(const std::string& node, int questions) {
  ask_(node, [this, node, questions](std::optional<rtps::GuidPrefix> answered) {
    tasks_.post([this, node, questions, answers = answered.has_value()] {
      on_whether_left(node, questions, answers);
    });
  });
}

void LeavingAnnouncements::on_whether_left(const std::string& node, int questions, bool answers) {
  constexpr std::size_t kMost = 100;
  if (!answers && questions > 1) return ask_whether_left(node, questions - 1);
  if (!answers) {
    asked_whether_left_.erase(node);
    return context_->believe_left(node);
  }
  tasks_.post_at(ros2::Executor::Clock::now() + kLeavingAskedAgain,
                 [this, node] { ask_again(node); });
  if (told_of_false_leaving_.size() >= kMost || !told_of_false_leaving_.insert(node).second) return;
  inbox_.put(LinkTrouble{"a message in the name of " + node +
                         " announced that it left the graph, but it answers and counts as "
                         "present. Does another program on this network speak in its name?"});
}

void LeavingAnnouncements::expect(ComponentId component, Time until) {
  const MutexLock lock(mutex_);
  expected_[component] = until;
}

// One whose process is not proven is doubted when it left.
bool LeavingAnnouncements::is_doubted(ComponentId component, const std::string& node) const {
  if (unproven_.contains(node)) return false;
  const MutexLock lock(mutex_);
  const auto expected = expected_.find(component);
  return expected == expected_.end() || expected->second < live_now();
}

}  // namespace culprit::link
