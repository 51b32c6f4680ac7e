// Tells a black box (recorder/recorder.h) what the manager finds and does, and when a recording is wanted: from the first
// failure until none is there any more. A failure that is given up counts as over: nothing more is done about it.
#pragma once

#include "live/observer.h"
#include "recorder/recorder.h"

namespace culprit::live {

class BlackBox : public Observer {
 public:
  // The recorder must outlive this.
  explicit BlackBox(recorder::Recorder& recorder) : recorder_(recorder) {}

  void begins(const Manager& manager, std::function<Remarks()> remarks, Time start) override;
  void stepped(const Runtime::Step& step) override;
  Time next_look() const override { return kNever; }
  void announced(Time at, const EventWords& words, const std::string& text) override;

 private:
  recorder::Recorder& recorder_;
  const Manager* manager_ = nullptr;  // null: none has begun
};

}  // namespace culprit::live
