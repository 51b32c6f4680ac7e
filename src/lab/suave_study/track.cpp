#include "suave_study/track.h"

#include <fmt/core.h>

#include "exemplars/suave/model/pipeline.h"
#include "json/json.h"

namespace culprit::study {

using namespace suave::model;

namespace {

Json place(const suave::model::Position& position) { return {position.x, position.y}; }

Json places(const auto& positions) {
  Json json = Json::array();
  for (const auto& position : positions) json.push_back(place(position));
  return json;
}

}  // namespace

std::string tracks_json(const std::string& mission, const std::vector<Track>& tracks) {
  Json document = {
      {"mission", mission}, {"pipeline", places(pipeline())}, {"tracks", Json::array()}};
  for (const Track& track : tracks) {
    Json marks = Json::array();
    for (const TrackMark& mark : track.marks)
      marks.push_back({{"time", mark.time_s}, {"at", place(mark.at)}, {"text", mark.what}});
    document["tracks"].push_back({{"manager", track.manager},
                                  {"points", places(track.points)},
                                  {"marks", std::move(marks)}});
  }
  return to_line(document) + "\n";
}

TrackRecorder::TrackRecorder(SuaveModel& model, Track& track) : model_(model), track_(track) {
  model_.world().watch(*this);
  model_.world().at(model_.guided(), [this] { sample(); });
}

TrackRecorder::~TrackRecorder() { model_.world().unwatch(*this); }

void TrackRecorder::sample() {
  if (model_.mission().ended()) return;
  track_.points.push_back(model_.vehicle().position());
  model_.world().after(std::chrono::seconds(1), [this] { sample(); });
}

void TrackRecorder::mark(Happening kind, std::string what) {
  const Time now = model_.world().now();
  if (now < model_.guided()) return;
  track_.marks.push_back(
      {seconds(now - model_.guided()), model_.vehicle().position(), kind, std::move(what)});
}

void TrackRecorder::on_field(const simulation::TopicBase& topic, const std::string&,
                             const Value& value) {
  if (topic.name() == "/pipeline/detected" && value == Value(true))
    mark(Happening::kNote, "the pipeline is found");
  if (topic.name() == "/pipeline/inspected") mark(Happening::kNote, "all of it is inspected");
}

void TrackRecorder::on_diagnostic(std::string_view, std::string_view key, const Value& value) {
  if (!key.starts_with(diagnostics::kThrusterKey)) return;
  const std::string thruster(key.substr(diagnostics::kThrusterKey.size()));
  if (value == Value(std::string(diagnostics::kError))) {
    has_failed_[thruster] = true;
    mark(Happening::kFault, "thruster " + thruster + " fails");
  } else if (value == Value(std::string(diagnostics::kRecovered)) && has_failed_[thruster]) {
    has_failed_[thruster] = false;
    mark(Happening::kNote, "thruster " + thruster + " is recovered");
  }
}

void TrackRecorder::on_parameter(const simulation::Node&, const std::string& name,
                                 const Value& value) {
  if (name != kAltitude || value == altitude_) return;
  altitude_ = value;
  mark(Happening::kNote, fmt::format("it searches at {:.0f} m", std::get<double>(value)));
}

void TrackRecorder::on_lifecycle(const simulation::Node& node) {
  if (!node.is_active()) return;
  if (node.name() == nodes::kFollow) mark(Happening::kNote, "it inspects");
  if (node.name() == nodes::kRecharge) mark(Happening::kNote, "it leaves for the charging station");
}

}  // namespace culprit::study
