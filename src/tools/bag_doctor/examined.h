// A recording as the parts of the doctor look at it: each topic with its habit, and where the recording itself has holes.
#pragma once

#include <vector>

#include "bag_doctor/habit.h"
#include "bag_doctor/recording_course.h"
#include "bag_doctor/symptom.h"

namespace culprit::bag_doctor {

struct JudgedTopic {
  const TopicCourse* topic;
  Habit habit;  // unknown for what is latched or ROS's own
};

struct Examined {
  const BagCourse& course;
  std::vector<JudgedTopic> topics{};
  // When the robot was shut down, or the recording ended. When a launch ends, its nodes end one after the other, and the
  // recorder last: so it is the time from which fewer than half of the steady topics go on, if that is within the last
  // seconds; and not later than the last of all steady topics.
  Nanoseconds end = 0;
  // No topic at all was recorded although several come all the time: the recorder, its disk or the machine stood still.
  std::vector<Stretch> holes{};
  // By how much the stamps of most topics are behind the recorder's clock: simulated time, or a bag that was played.
  Duration other_clock{};
  bool is_simulated = false;  // that is simulated time

  bool is_hole(const Stretch& gap, const Habit& habit) const;
};

Examined examined(const BagCourse& course);

// Its driver publishes it all the time: sensors, joint states, odometry.
bool is_continuous(const TopicCourse& topic);

using Symptoms = std::vector<Symptom>;
void look_at_rhythm(const Examined& bag, Symptoms& all);  // D201 to D204, D210, D215
void look_at_values(const Examined& bag, Symptoms& all);  // D205, D206, D216
void look_at_stamps(const Examined& bag, Symptoms& all);  // D042 to D045, D208
void look_at_frames(const Examined& bag, Symptoms& all);  // D051, D052
void look_at_states(const Examined& bag, Symptoms& all);  // D020, D021, D211 to D213

// Whether a stamp counts from the start of a simulation or of a device: its clock was never set.
bool counts_from_zero(Nanoseconds stamp, Nanoseconds recorded);

inline Time time_of(Nanoseconds at) { return Time(Duration(at)); }

}  // namespace culprit::bag_doctor
