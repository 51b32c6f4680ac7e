// Passes the manager's findings and actions to a black box (recorder/recorder.h), and starts a recording: from the first failure until there is none any more.
// A failure that is given up counts as over: nothing more is done about it.
#pragma once

#include "live/observer.h"
#include "recorder/incident_recorder.h"

namespace culprit::live {

class BlackBox : public Observer {
 public:
  // The recorder must outlive this.
  explicit BlackBox(recorder::IncidentRecorder& recorder) : recorder_(recorder) {}

  void begins(const Manager& manager, std::function<Remarks()> remarks, Time start) override;
  void stepped(const Runtime::Step& step) override;
  Time next_look() const override { return kNever; }
  void announced(Time at, const EventWords& words, const std::string& text) override;

 private:
  recorder::IncidentRecorder& recorder_;
  const Manager* manager_ = nullptr;  // null: none has begun
};

}  // namespace culprit::live
