#include "study/campaign.h"

namespace culprit::study {

std::string label(const PaperSwitches& switches) {
  std::string text;
  text += switches.dependencies ? "D " : "- ";
  text += switches.criticality ? "C " : "- ";
  text += switches.impact ? "S" : "-";
  return text;
}

std::string label(const Configuration& configuration) {
  std::string text = label(configuration.switches);
  if (configuration.planner != "paper") text += ", " + configuration.planner;
  if (configuration.profile != "paper") text += ", profile " + configuration.profile;
  if (configuration.probabilities == Probabilities::kMisspecified) text += ", misspecified P";
  return text;
}

}  // namespace culprit::study
