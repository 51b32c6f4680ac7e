// Which topics are recorded: those that somebody named, or all that are not hidden.
//
//     TopicChoice({})                             all; what is large only as far as it fits
//     TopicChoice({"/scan", "/camera/*"})         these; '*' stands for anything, slashes too
//     TopicChoice({"!/camera/*"})                 all but these
//
// The robot's word on itself (/diagnostics, /rosout, /parameter_events) is always among them, unless it is named with '!'.
#pragma once

#include <string>
#include <vector>

namespace culprit::recorder {

class TopicChoice {
 public:
  explicit TopicChoice(std::vector<std::string> patterns);

  bool includes(const std::string& topic) const;
  // Somebody wants it by its name, however large it is.
  bool names(const std::string& topic) const;

 private:
  std::vector<std::string> wanted_;
  std::vector<std::string> unwanted_;
};

}  // namespace culprit::recorder
