#include <memory>

#include "base/mutex.h"
#include "base/units.h"
#include "doctor/doctor_report.h"
#include "doctor/look.h"
#include "ros2/options.h"
#include "web/calls.h"

namespace culprit::web {
namespace {

constexpr double kLeastSeconds = 0.5;
constexpr double kMostSeconds = 60;

http::Answer answer(const Json& body, const Doctor& doctor, Mutex& looking) {
  const auto seconds = body.is_object() ? body.find("seconds") : body.end();
  const bool is_given = body.is_object() && seconds != body.end() && seconds->is_number();
  const double time = is_given ? seconds->get<double>() : 0;
  if (!(time >= kLeastSeconds && time <= kMostSeconds))
    return http::refuse(400, "say how long to look, from 0.5 to 60: {\"seconds\": 8}");
  if (!looking.try_lock())
    return http::refuse(409, "the robot is being examined already; ask again in a moment");
  const MutexLock lock(looking, std::adopt_lock);
  auto report = doctor(from_seconds(time));
  if (!report) return http::refuse(503, report.error());
  return {200, std::move(*report)};
}

}  // namespace

std::vector<http::Route> doctor_routes(Doctor doctor) {
  return {{http::Method::kPost, "/api/doctor",
           [doctor = std::move(doctor), looking = std::make_shared<Mutex>()](const Json& body) {
             return answer(body, doctor, *looking);
           },
           http::Role::kOperate}};
}

Expected<Json> examine_robot(Duration time) {
  const auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  const auto picture = doctor::look({.participant = *participant, .time = time});
  if (!picture) return Error{picture.error()};
  return doctor::to_json(doctor::report_of(*picture));
}

}  // namespace culprit::web
