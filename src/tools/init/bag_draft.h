// A first rule file from recordings of a robot that was well (`culprit init --bag BAG…`): silences, rates, frozen and NaN
// values, diagnostics. All of its rules only report, since a recording does not say how a node is started.
//
//     const std::string text = init::draft_of_bags(courses);      // passes culprit check
//
// A rule is drafted only about what all recordings have. Limits, over all of them:
//
//   silence      three times the longest pause, from the first message to the end of the recording; 300 ms at least
//   rate         0.7 of the slowest 5 s, of topics of 2 Hz or more
//   frozen       five times the longest row of equal values, 2 s at least, of numbers that change by habit
//   NaN          of numbers that were always finite and changed
//   diagnostics  ERROR, of statuses that never were
#pragma once

#include <span>
#include <string>

#include "bag_doctor/recording_course.h"

namespace culprit::init {

// @pre bags is not empty
std::string draft_of_bags(std::span<const bag_doctor::BagCourse> bags);

}  // namespace culprit::init
