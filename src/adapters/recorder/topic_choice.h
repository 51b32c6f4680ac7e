// Selects the topics to record: named ones, or all that are not hidden.
//
//     TopicChoice({})                             all; large ones only as far as they fit
//     TopicChoice({"/scan", "/camera/*"})         these; '*' stands for anything, slashes too
//     TopicChoice({"!/camera/*"})                 all but these
//
// The robot's own reports (/diagnostics, /rosout, /parameter_events) are always recorded, unless
// they are named with '!'.
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
