// Several who look on, as one.
#pragma once

#include <algorithm>
#include <vector>

#include "live/observer.h"

namespace culprit::live {

class Observers : public Observer {
 public:
  // All must outlive this.
  explicit Observers(std::vector<Observer*> all) : all_(std::move(all)) {}

  void joined(ros2::NodeEntry& node) override {
    for (Observer* each : all_) each->joined(node);
  }
  void leaves() override {
    for (Observer* each : all_) each->leaves();
  }
  void begins(const Manager& manager, std::function<Remarks()> remarks, Time start) override {
    for (Observer* each : all_) each->begins(manager, remarks, start);
  }
  void stepped(const Runtime::Step& step) override {
    for (Observer* each : all_) each->stepped(step);
  }
  Time next_look() const override {
    Time next = kNever;
    for (const Observer* each : all_) next = std::min(next, each->next_look());
    return next;
  }
  void announced(Time at, const EventWords& words, const std::string& text) override {
    for (Observer* each : all_) each->announced(at, words, text);
  }

 private:
  const std::vector<Observer*> all_;
};

}  // namespace culprit::live
