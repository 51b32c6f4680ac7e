#include "language/test_edits.h"

#include <algorithm>
#include <rapidcheck.h>
#include <string_view>
#include <vector>

#include "language/test_rules.h"

namespace culprit {
namespace {

// Lines that make sense together, or nearly: names that are declared and that are not, mistakes
// that depend on what other lines say, warnings that only come where there is no mistake.
const std::vector<std::string> kLines = {
    "ROBOT rover",
    "CYCLE 200ms",
    "CYCLE 2h",
    "CONST limit = 0.5",
    "CONST limit = other * 2",
    "COMPONENT camera NODE /camera LAUNCH \"run camera\"",
    "COMPONENT lidar NODE /lidar",
    "COMPONENT lidar NODE /camera REQUIRED",
    "COMPONENT lidar NODE /camera LAUNCH \"lidar\" READY 20s",
    "COMPONENT nav LAUNCH \"run camera\" # größer",
    "COMPONENT",
    "DEPENDENCY camera ON lidar",
    "DEPENDENCY lidar ON camera",
    "IGNORE TOPIC /rosout",
    "INTERLOCK battery > 10",
    "ABORT battery < 5",
    "DRILL camera set_parameter gain limit",
    "DRILL lidar without kill",
    "SIGNAL entropy DIAGNOSTIC camera KEY entropy RANGE 0..1",
    "SIGNAL entropy TOPIC /entropy FIELD data",
    "RULE Blind",
    "RULE Blind  # the same name",
    "RULE Late",
    "RULE Lost",
    "RULE",
    "RULE <name>",
    "  POLICIES ERROR FOR 500ms",
    "  POLICIES WARNING HOLD 3/5 COOLDOWN 2s",
    "  POLICIES REPORT",
    "  TRIGGER entropy > limit",
    "  TRIGGER entropy > 2",
    "  TRIGGER entrop > 0.25 && age(/image) > 1s",
    "  TRIGGER age(/image) > 1s",
    "  TRIGGER rate(/image, 1s) < 0.5 || mode == \"dock\"",
    "  TRIGGER mode == speed",
    "  TRIGGER speed > 1 ? mode : alive(lidr)",
    "    STRATEGY restart 50 10",
    "    STRATEGY restart 0.5 10 WHEN mode == \"dock\"",
    "    STRATEGY last 90 10 LASTRESORT",
    "      ADAPTATION camera restart 3",
    "      ADAPTATION camera activate 3",
    "      ADAPTATION camera deactivate 3",
    "      ADAPTATION lidar redeploy 10",
    "      THEN ADAPTATION camera activate 3",
    "      ADAPTATION lidr redeploy 1",
    "      ADAPTATION camera set_parameter gain entropy * 2 3",
    "      ADAPTATION camera set_parameter gain \"high\" 3",
    "      ADAPTATION lidar stop 3",
    "INCLUDE \"other.rules\"",
    "INCLUDE \"missing.rules\"",
    "TEMPLATE watched(name, topic = /scan)",
    "  TRIGGER age({topic}) > 1s && {name} > 1",
    "      ADAPTATION {name} redeploy 20",
    "      ADAPTATION {nam} redeploy 20",
    "END",
    "USE watched(camera)",
    "USE watched(lidar, /image) IN /robot1",
    "USE watchd",
    "# only said",
    "",
};

const std::vector<std::string> kPieces = {"a",
                                          "1",
                                          "0",
                                          " ",
                                          "\t",
                                          "\"",
                                          "\\",
                                          "#",
                                          "//",
                                          ".",
                                          ",",
                                          ")",
                                          "(",
                                          ":",
                                          "<",
                                          "{x}",
                                          "&& ",
                                          "!",
                                          "\n",
                                          "\r\n",
                                          "\r",
                                          "\n\n",
                                          "ä",
                                          "🌳",
                                          "\xC3",
                                          "\xEF\xBB\xBF",
                                          std::string("\0", 1),
                                          "\x7f",
                                          "RULE ",
                                          "END\n"};

int below(std::size_t n) {
  return *rc::gen::inRange(0, static_cast<int>(std::max<std::size_t>(n, 1)));
}

std::size_t place_in(const std::string& text) {
  return static_cast<std::size_t>(below(text.size() + 1));
}

std::string line_end() { return *rc::gen::weightedElement<std::string>({{5, "\n"}, {1, "\r\n"}}); }

std::string line() { return *rc::gen::elementOf(kLines) + line_end(); }

// The line around `place`, with its end.
struct Line {
  std::size_t begin = 0;
  std::size_t size = 0;
};
Line line_at(const std::string& text, std::size_t place) {
  const std::size_t before = place == 0 ? std::string::npos : text.rfind('\n', place - 1);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  const std::size_t end = text.find('\n', place);
  return {begin, (end == std::string::npos ? text.size() : end + 1) - begin};
}

std::string rules_without_mistake() {
  const auto pick = [](std::initializer_list<std::string> from) {
    return *rc::gen::elementOf(std::vector<std::string>(from));
  };
  const std::string end = line_end();
  std::string text = pick({"", "ROBOT rover" + end, "CYCLE 100ms" + end});
  text += "CONST limit = 0.5" + end + "COMPONENT camera NODE /camera LAUNCH \"run camera\"" + end +
          "COMPONENT lidar NODE /lidar LAUNCH \"run lidar\"" + end +
          "SIGNAL entropy DIAGNOSTIC camera KEY entropy RANGE 0..1" + end;
  text += pick({"", "INTERLOCK battery > 10" + end, "DEPENDENCY camera ON lidar" + end,
                "TEMPLATE watched(name)" + end + "RULE Silent_{name}" + end + "  POLICIES ERROR" +
                    end + "  TRIGGER age(/{name}/out) > 1s" + end + "    STRATEGY redeploy 50 10" +
                    end + "      ADAPTATION {name} redeploy 20" + end + "END" + end +
                    "USE watched(camera)" + end + "USE watched(lidar)" + end});
  for (int rules = below(8); rules > 0; --rules) {
    const std::string component = pick({"camera", "lidar", "other"});
    text += "RULE R" + std::to_string(rules) + end + "  POLICIES " +
            pick({"ERROR", "WARNING FOR 500ms", "ERROR ON_CHANGE"}) + end + "  TRIGGER " +
            pick({"entropy > limit", "entropy > 2 || age(/image) > 1s", "entropy < 0.1",
                  "age(/camera/image) > 1s && alive(lidar)", "mode == \"dock\"", "speed > 3",
                  "lifecycle(lidar) != \"active\"", "speed > 5", "mode == place && place == \"x\"",
                  "rate(/scan, 1s) < 0.25"}) +
            end;
    for (int strategies = below(3); strategies >= 0; --strategies) {
      text += "    STRATEGY s" + std::to_string(strategies) + " 50 10" +
              pick({"", "", " LASTRESORT", " LASTRESORT WITHIN 1s", " WHEN entropy < 0.7"}) + end +
              "      ADAPTATION " + component + " " +
              pick({"restart 3", "redeploy 20", "set_parameter gain 1 3", "set_parameter gain 2 3",
                    "activate 3", "deactivate 3", "redeploy 1"}) +
              end;
    }
  }
  return text;
}

}  // namespace

std::string random_start() {
  switch (below(4)) {
    case 0:
      return random_rule_text().text;
    case 1: {
      std::string text;
      for (int lines = below(40); lines > 0; --lines) text += line();
      return text;
    }
    default:
      return rules_without_mistake();
  }
}

std::string edited(std::string text) {
  const std::size_t place = place_in(text);
  const Line here = line_at(text, place);
  switch (below(9)) {
    case 0:
    case 1:
      return text.insert(place, *rc::gen::elementOf(kPieces));
    case 2:
      return text.erase(place, 1);
    case 3:
      return text.insert(here.begin, line());
    case 4:
      return text.erase(here.begin, here.size);
    case 5:  // copies a line
      return text.insert(place_in(text), text.substr(here.begin, here.size));
    case 6:  // writes a line anew
      return text.replace(here.begin, here.size, line());
    case 7:  // cuts up to some other place
      return text.erase(place,
                        static_cast<std::size_t>(below(std::min<std::size_t>(text.size(), 200))));
    default: {  // pastes several lines
      std::string pasted;
      for (int lines = below(8); lines > 0; --lines) pasted += line();
      return text.insert(here.begin, pasted);
    }
  }
}

}  // namespace culprit
