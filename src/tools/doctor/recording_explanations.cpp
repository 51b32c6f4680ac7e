#include "doctor/recording_explanations.h"

namespace culprit::doctor {

std::vector<Explanation> recording_explanations() {
  return {
      {"D200", "the most likely cause of an incident in a recording",
       "Several findings belong together: the failure of one component explains the others. Repair "
       "it first.",
       "From the onset of each finding and the graph of the robot (--graph, --rules, or what was "
       "recorded), by the "
       "diagnosis that a running culprit uses. A component is named although nothing of it was "
       "recorded if several "
       "components that depend on it failed at once. Without a graph it is not reported.",
       "Read the log of the component around the onset, and see whether its process was still "
       "there."},
      {"D201", "a topic paused in a recording",
       "Its readers had no data meanwhile, or worked with old data.",
       "A pause of five usual pauses and 300 ms that is 2.5 times as long as all but the three "
       "longest. It is an error "
       "for a sensor that comes steadily, after 20 usual pauses and two seconds, if it is the only "
       "such pause. Three pauses of "
       "one length are the rhythm of bursts. Transient local topics and those of ROS itself are "
       "not examined.",
       "Read the log of its publisher at that time."},
      {"D202", "a topic ended before the recording did",
       "Its publisher, or a component that it needs, failed or was ended.",
       "A topic that came steadily and not any more for five usual pauses, twice its longest one "
       "and a second. It is an "
       "error for sensors only: a command or a plan may have done its work. The end of the "
       "recording is the time from "
       "which half of the steady topics are over, if that is in its last five seconds.",
       "Read the log of its publisher at that time."},
      {"D203", "a sensor was announced and has no message",
       "Its publisher was there; its device, its input or its configuration failed before the "
       "recording began.",
       "Of types that drivers publish all the time. Topics on demand and plugins of "
       "image_transport are not reported.",
       "Read the log of its publisher, and see whether the topics that it reads have messages."},
      {"D204", "the rate of a topic fell", "Its readers have less data than usual, and older data.",
       "Of a steady topic: 20 pauses or more in a row whose mean is 1.5 times as long as its "
       "habit, for three seconds. "
       "A topic whose rate varies more often is not reported.",
       "See whether its publisher or the computer was busy then, or an exposure became longer."},
      {"D205", "numbers are NaN or infinite",
       "Filters that take it in become NaN, too, and stay so; comparisons with it are false.",
       "Of numbers that were finite before; it is an error in IMU data, odometry, poses, "
       "velocities and positions of "
       "joints. Covariances and ranges are not reported, nor numbers that were never measured.",
       "See what its publisher divides by, or what its device reports then."},
      {"D206", "values froze while others changed", "Its readers take old data for new data.",
       "Of a number, or the content of a scan, cloud or image, that changes with nine of ten "
       "messages. It stayed the same "
       "for two seconds, 15 messages and five times its next longest row. It is an error for "
       "sensors if the robot or "
       "another sensor changed meanwhile. Odometry and joints of a robot that stands still are not "
       "reported.",
       "See whether its publisher repeats its last reading when its device does not answer."},
      {"D208", "messages in a row have one time stamp",
       "tf and message filters take them for one message, or drop them.",
       "More than five in a row, of a topic whose stamps differ otherwise.",
       "See whether its publisher repeats its last message, or its clock stands still."},
      {"D209", "the clock was set while the robot was recorded",
       "All ages, rates and transforms around that time are wrong by as much.",
       "The times of messages jump, back or by more than any topic pauses, for all topics at once.",
       "Set the clock before the robot starts, and let chrony or PTP slew it afterwards."},
      {"D210", "nothing was recorded for some time",
       "The recorder, its disk or the whole computer stood still; nothing is known of the robot "
       "meanwhile.",
       "No topic has a message for three usual pauses of each of three steady topics or more.",
       "Read the recorder's log for dropped messages, and the computer's for a sleep or a full "
       "disk."},
      {"D211", "a lifecycle node left its active state, or a transition failed",
       "A node that is not active publishes nothing, and its consumers wait.",
       "From recorded transition events. A node that was deactivated in the last five seconds is "
       "not reported.",
       "Read its log around that time, or see which manager deactivated it."},
      {"D212", "a node logged errors", "The node says itself that something does not work.",
       "From /rosout: an error if it logged at FATAL, else a warning.",
       "Read its log around that time."},
      {"D213", "publishers of one topic offer different quality of service",
       "A subscription that requests more gets the messages of some publishers only.",
       "From the offers that the recorder wrote down. /tf_static has to be transient local.",
       "Let all publishers of the topic offer the same."},
      {"D214", "the recording does not keep its policy",
       "A pipeline that relies on it will fail or be wrong.",
       "From --policy: topics that have to be there, their rates, gaps and coverage, and pairs of "
       "sensors.",
       "Record again, or change the policy."},
      {"D215", "a sensor began long after the recording",
       "Its readers had nothing until then, unless it was started late by design.",
       "The first message of a steady sensor came more than five seconds late.",
       "See when its publisher was started, and what it waited for."},
      {"D216", "messages do not fit their type",
       "Their values are unknown, and a reader may refuse them.",
       "A message is too short for the definition that the recording has of its type.",
       "See whether all publishers were built with one version of the message package."},
  };
}

}  // namespace culprit::doctor
