// A drill's faults as tests of the rules (docs/rule-tests.md): what held on the robot each time is expected in virtual
// time, too.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/expected.h"
#include "drill/robot_view.h"

namespace culprit::drill {

// A text of the rule language: paths may have blanks and quotes.
std::string in_quotes(const std::string& text);

// The test of one fault, all of whose trials are given; empty: a test cannot inject it (slow, restart, set_parameter).
// `rules`: their path.
std::string test_of(const std::vector<const Trial*>& trials, const std::string& rules,
                    const std::string& date, const HealthyRobot& robot,
                    const std::vector<Trial>& all);

// Writes "kill-camera.test" and so on. Gives how many. Errors: a file cannot be written.
Expected<std::size_t> export_tests(const std::filesystem::path& folder, const std::string& rules,
                                   const std::string& date, const std::vector<Trial>& trials,
                                   const HealthyRobot& robot);

}  // namespace culprit::drill
