// The journal of a live run: what the last run left behind, and the recording of this one.
#pragma once

#include "journal/recorder.h"
#include "journal/recovery.h"
#include "journal/session.h"
#include "journal/standing_orders.h"

namespace culprit::live {

// Where the journal of a robot is unless it is said otherwise.
std::filesystem::path default_journal(const std::filesystem::path& state_folder,
                                      const std::string& robot);

// All that is known when a run begins.
struct RunBeginning {
  std::optional<journal::Writer> writer;  // nothing: it cannot be written now
  // Rows that the last run could not write; they are written before this one begins.
  std::vector<journal::Entry> unwritten;
  journal::Learned learned;
  Json interrupted = Json::array();
  History past;            // without silences
  KnownRobot known_robot;  // is_whole: as far as the journal tells
  std::string last_rules;  // the text of the last run's rules
  journal::StandingOrders orders;
  bool are_orders_kept = false;       // they stand in their file just so
  bool is_of_another = false;         // another culprit writes the journal, and the orders
  bool ended_unexpectedly = false;    // the last run, in this boot of the machine
  std::vector<std::string> findings;  // for the user, one line each
};

// Opens the journal, or reads it if it cannot be written, and finds out what the last run left
// behind. A faulty journal never keeps culprit from watching the robot. If it is unknown whether a
// person has paused culprit, it is paused. `manager_before`: as recover()'s.
RunBeginning begin_journal(const std::filesystem::path& path, const RuleSet& rules,
                           const journal::Moment& now, std::optional<int> manager_before = {});

// People's orders according to the file beside the journal, if the journal is not to be written.
RunBeginning begin_without_journal(const std::filesystem::path& path, Time now);

}  // namespace culprit::live
