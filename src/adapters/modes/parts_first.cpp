#include "modes/parts_first.h"

#include <algorithm>
#include <map>

namespace culprit::modes {
namespace {

// Depth-first, with a stack of its own: how deep a model is, is up to its author.
class Walk {
 public:
  explicit Walk(const Model& model) : model_(model), marks_(model.entities.size()) {
    for (std::size_t i = 0; i < model.entities.size(); ++i) index_[model.entities[i].name] = i;
  }

  PartsFirst run() {
    for (std::size_t i = 0; i < marks_.size() && order_.circle.empty(); ++i)
      if (marks_[i] == Mark::kNew) visit(i);
    return std::move(order_);
  }

 private:
  enum class Mark : std::uint8_t { kNew, kOpen, kDone };
  struct Step {
    std::size_t entity;
    std::size_t next_part = 0;
  };

  void visit(std::size_t root) {
    std::vector<Step> path{{root}};
    marks_[root] = Mark::kOpen;
    while (!path.empty()) {
      Step& step = path.back();
      const auto& parts = model_.entities[step.entity].parts;
      if (step.next_part == parts.size()) {
        marks_[step.entity] = Mark::kDone;
        order_.entities.push_back(step.entity);
        path.pop_back();
        continue;
      }
      const std::size_t part = index_.at(parts[step.next_part++]);
      if (marks_[part] == Mark::kOpen) return close_circle(path, part);
      if (marks_[part] == Mark::kDone) continue;
      marks_[part] = Mark::kOpen;
      path.push_back({part});
    }
  }

  void close_circle(const std::vector<Step>& path, std::size_t first) {
    const auto begin = std::find_if(path.begin(), path.end(),
                                    [&](const Step& step) { return step.entity == first; });
    for (auto step = begin; step != path.end(); ++step) order_.circle.push_back(step->entity);
  }

  const Model& model_;
  std::vector<Mark> marks_;
  std::map<std::string, std::size_t, std::less<>> index_;
  PartsFirst order_;
};

}  // namespace

PartsFirst parts_first(const Model& model) { return Walk(model).run(); }

std::string describe_circle(const Model& model, const std::vector<std::size_t>& circle) {
  const std::string& first = model.entities[circle.front()].name;
  std::string text = first + " is a part of itself: ";
  for (const std::size_t i : circle) text += model.entities[i].name + " -> ";
  return text + first;
}

}  // namespace culprit::modes
