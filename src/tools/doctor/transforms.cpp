// tf: one tree of coordinate frames, that all nodes of the robot make together.
#include <algorithm>
#include <map>
#include <set>

#include <fmt/core.h>

#include "base/name_grammar.h"
#include "doctor/examine.h"
#include "doctor/wording.h"

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;

std::string publisher_of(const Transform& edge) {
  return edge.node.empty() ? "an unknown node" : edge.node;
}

std::string edge_of(const Transform& edge) {
  return printable(edge.parent) + " → " + printable(edge.child);
}

using ByChild = std::map<std::string, std::vector<const Transform*>>;

// Whether both say it now: one that took over from the other does not overlap with it.
bool overlap(const Transform& a, const Transform& b) {
  return a.is_static || b.is_static || (a.first < b.last && b.first < a.last);
}

// Two edges to one frame that are said at the same time and for which `is_it`.
template <class Condition>
std::pair<const Transform*, const Transform*> pair_of(const std::vector<const Transform*>& edges,
                                                      Condition is_it) {
  for (const Transform* a : edges) {
    for (const Transform* b : edges) {
      if (a < b && overlap(*a, *b) && is_it(*a, *b)) return {a, b};
    }
  }
  return {nullptr, nullptr};
}

void look_for_rivals(const ByChild& frames, Findings& all) {
  for (const auto& [child, edges] : frames) {
    const auto [a, b] =
        pair_of(edges, [](const Transform& x, const Transform& y) { return x.parent != y.parent; });
    if (a != nullptr) {
      all.push_back({"D052",
                     Gravity::kError,
                     "tf: " + printable(child),
                     fmt::format("it has two parents: {} ({}) and {} ({})", printable(a->parent),
                                 publisher_of(*a), printable(b->parent), publisher_of(*b)),
                     "tf keeps what came last, so the tree falls apart and together all the time",
                     "switch one of them off (publish_tf), or rename a frame",
                     {a->node, b->node},
                     "/tf"});
      continue;
    }
    const auto [c, d] = pair_of(edges, [](const Transform& x, const Transform& y) {
      return x.writer != y.writer && !(x.is_static && y.is_static);
    });
    if (c == nullptr) continue;
    all.push_back({"D053",
                   Gravity::kError,
                   "tf: " + edge_of(*c),
                   "two publish it: " + publisher_of(*c) + " and " + publisher_of(*d),
                   "where they differ the frame jumps between the two",
                   "switch one of them off (publish_tf), or end a duplicate node",
                   {c->node, d->node},
                   "/tf"});
  }
}

void look_at_age(const Picture& picture, const Transform& edge, Findings& all) {
  constexpr Duration kOldAge = 1s;
  constexpr Duration kSilent = 3s;
  constexpr std::size_t kFewest = 5;
  if (edge.is_static || edge.count < kFewest) return;
  const Duration pause = (edge.last - edge.first) / static_cast<int>(edge.count - 1);
  const Duration silent = picture.looked - edge.last;
  const bool has_stopped = silent > std::max(kSilent, 10 * pause);
  const bool is_simulated = picture.clock.has_value();
  const bool is_old = !is_simulated && edge.lag > kOldAge;
  if (!has_stopped && !is_old) return;
  all.push_back({"D051",
                 has_stopped ? Gravity::kError : Gravity::kWarning,
                 "tf: " + edge_of(edge),
                 has_stopped ? fmt::format("it came every {} from {}, and not any more for {}",
                                           duration(pause), publisher_of(edge), duration(silent))
                             : fmt::format("{} publishes it with stamps that are {} old",
                                           publisher_of(edge), duration(edge.lag)),
                 "nodes that look it up now wait or get an error, and nodes that need it stop",
                 has_stopped ? "see the log of " + publisher_of(edge)
                             : "see what delays it, or whose clock is behind",
                 {edge.node},
                 "/tf"});
}

// The frame at which the chain of parents ends.
std::string root_of(const std::string& frame, const ByChild& frames) {
  std::set<std::string> seen;
  std::string at = frame;
  for (auto found = frames.find(at); found != frames.end() && seen.insert(at).second;
       found = frames.find(at))
    at = found->second.front()->parent;
  return at;
}

// "robot1/odom" -> "robot1": several robots may share one /tf.
std::string prefix_of(const std::string& frame) {
  const std::size_t slash = frame.find('/', 1);
  return slash == std::string::npos ? "" : frame.substr(0, slash);
}

void look_for_trees(const Picture& picture, const ByChild& frames, Findings& all) {
  std::map<std::string, std::set<std::string>> roots;  // by prefix
  for (const Transform& edge : picture.transforms) {
    const std::string root = root_of(edge.child, frames);
    roots[prefix_of(root)].insert(root);
  }
  for (const auto& [prefix, some] : roots) {
    if (some.size() < 2) continue;
    std::vector<std::string> names;
    for (const std::string& root : some) names.push_back(printable(root));
    all.push_back(
        {"D054",
         Gravity::kWarning,
         "tf: " + listed(names),
         fmt::format("these are the roots of {} trees, and nothing connects them", some.size()),
         "nothing that is measured in one can be placed in another",
         "which node publishes the transform between them? Localization that has not started (map "
         "→ odom) and a robot_state_publisher without a model leave such gaps",
         {},
         "/tf"});
  }
}

void look_for_missing(const Picture& picture, Findings& all) {
  std::set<std::string> known;
  for (const Transform& edge : picture.transforms) {
    known.insert(edge.parent);
    known.insert(edge.child);
  }
  const auto is_known = [&](const std::string& frame) {
    return known.contains(frame) || known.contains("/" + frame) ||
           (frame.starts_with('/') && known.contains(frame.substr(1)));
  };
  std::map<std::string, std::vector<std::string>> missing;  // with the topics that name it
  for (const auto& [topic, flow] : picture.flows) {
    for (const std::string& frame : flow.frames) {
      if (!frame.empty() && !is_known(frame)) missing[frame].push_back(topic);
    }
  }
  for (const auto& [frame, topics] : missing)
    all.push_back({"D050",
                   Gravity::kWarning,
                   "tf: " + printable(frame),
                   "it is in no transform, and messages are measured in it: " + listed(topics),
                   "they cannot be placed on the robot",
                   "publish its transform (robot_state_publisher, static_transform_publisher), or "
                   "name the frame that is meant",
                   {},
                   topics.front()});
}

}  // namespace

void examine_transforms(const Picture& picture, Findings& all) {
  if (picture.transforms.empty()) return;  // not every robot has them
  ByChild frames;
  for (const Transform& edge : picture.transforms) frames[edge.child].push_back(&edge);
  look_for_rivals(frames, all);
  for (const Transform& edge : picture.transforms) look_at_age(picture, edge, all);
  constexpr Duration kLongEnough = 3s;  // map → odom comes rarely
  if (picture.transforms_listened < kLongEnough) return;
  look_for_trees(picture, frames, all);
  look_for_missing(picture, all);
}

}  // namespace culprit::doctor
