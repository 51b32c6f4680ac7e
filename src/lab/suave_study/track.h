// Where the vehicle went in one run of the SUAVE study, and where what happened.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "exemplars/suave/model/suave_model.h"
#include "study/timeline.h"

namespace culprit::study {

struct TrackMark {
  double time_s = 0;  // since the mission began
  suave::model::Position at;
  Happening kind = Happening::kNote;  // or kFault
  std::string what;
};

struct Track {
  std::string manager;
  std::vector<suave::model::Position> points;  // one each second since the mission began
  std::vector<TrackMark> marks;
};

// {"mission": "...", "pipeline": [[x, y], ...], "tracks": [{"manager": "bt", "points": [[x, y], ...],
//  "marks": [{"time": seconds, "at": [x, y], "text": "it inspects"}]}]}; places in metres
std::string tracks_json(const std::string& mission, const std::vector<Track>& tracks);

// Writes down a mission that is about to be played. It watches, and changes nothing.
class TrackRecorder : private simulation::Watcher {
 public:
  // Both must outlive the recorder, and the recorder the mission.
  TrackRecorder(suave::model::SuaveModel& model, Track& track);
  ~TrackRecorder() override;

 private:
  void on_field(const simulation::TopicBase& topic, const std::string& field,
                const Value& value) override;
  void on_diagnostic(std::string_view status, std::string_view key, const Value& value) override;
  void on_parameter(const simulation::Node& node, const std::string& name,
                    const Value& value) override;
  void on_lifecycle(const simulation::Node& node) override;
  void sample();
  void mark(Happening kind, std::string what);

  suave::model::SuaveModel& model_;
  Track& track_;
  std::map<std::string, bool> has_failed_;  // by thruster
  Value altitude_;
};

}  // namespace culprit::study
