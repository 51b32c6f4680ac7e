#include "language/explanations.h"

#include <algorithm>
#include <charconv>

namespace culprit {
namespace {

// The rule around the line that an example is about.
std::string rule_with(std::string_view trigger, std::string_view policies = "ERROR",
                      std::string_view strategy = "STRATEGY restart 50 10",
                      std::string_view adaptation = "ADAPTATION camera restart 5") {
  std::string out = "RULE CameraFails\n";
  out += "  POLICIES " + std::string(policies) + "\n";
  out += "  TRIGGER " + std::string(trigger) + "\n";
  out += "    " + std::string(strategy) + "\n";
  out += "      " + std::string(adaptation) + "\n";
  return out;
}

constexpr const char* kExampleRobot =
    "the managed node /robot/camera with a parameter `exposure` and a routine `recalibrate`, which "
    "publishes /robot/image and the diagnostic status `camera` with the key `entropy`.";

std::vector<Explanation> syntax_explanations() {
  return {
      {Code::kUnknownStatement, "a line begins with a word that is no statement",
       "Every line is one statement, and its first word says which: ROBOT, CYCLE, CONST, "
       "COMPONENT, DEPENDENCY, GROUP, IGNORE, INTERLOCK, ABORT, DRILL, SIGNAL, RULE, POLICIES, "
       "TRIGGER, "
       "STRATEGY, "
       "ADAPTATION, INCLUDE, TEMPLATE, END or USE, in upper case. The line counts for nothing "
       "until the word is right.",
       "robot sunset\n", "ROBOT sunset\n"},
      {Code::kSyntax, "something else is expected at this place",
       "The statement is known, but its line is not built as this statement is. The message says "
       "what belongs to the place under the carets; docs/rule-language.md shows each statement "
       "whole.",
       "CYCLE 200\n", "CYCLE 200ms\n"},
      {Code::kBadToken, "unrecognized token",
       "A text without its closing quote, a number with letters behind it, or a character that the "
       "language does not use. culprit does not read the rest of the line.",
       "COMPONENT camera LAUNCH \"camera_driver --fps 30\n",
       "COMPONENT camera LAUNCH \"camera_driver --fps 30\"\n"},
      {Code::kExtraText, "the line goes on after its statement has ended",
       "culprit would ignore the rest of the line, which may have been meant to do something: an "
       "operator is missing, or a comment lacks its #.",
       rule_with("entropy > 0.5 exposure < 3"), rule_with("entropy > 0.5 && exposure < 3")},
      {Code::kOutOfPlace, "this line is not inside what it belongs to",
       "POLICIES, TRIGGER and STRATEGY belong to the RULE line before them, one POLICIES and one "
       "TRIGGER each; an ADAPTATION belongs to the STRATEGY line before it. INCLUDE, TEMPLATE, END "
       "and USE end the rule above them; no TEMPLATE and no INCLUDE stands in a TEMPLATE.",
       "RULE CameraFails\n  POLICIES ERROR\n  TRIGGER rate(/robot/image) < 1\n"
       "  TRIGGER age(/robot/image) > 1s\n    STRATEGY restart 50 10\n"
       "      ADAPTATION camera restart 5\n",
       rule_with("rate(/robot/image) < 1 || age(/robot/image) > 1s")},
      {Code::kIncomplete, "a part of the rule or strategy is missing",
       "A rule needs POLICIES (how critical the failure is), a TRIGGER (when it is there) and at "
       "least one STRATEGY (what may help), or REPORT among its policies; a strategy needs at "
       "least "
       "one ADAPTATION.",
       "RULE CameraFails\n  POLICIES ERROR\n    STRATEGY restart 50 10\n"
       "      ADAPTATION camera restart 5\n",
       rule_with("rate(/robot/image) < 1")},
      {Code::kTooDeep, "an expression is nested too deeply",
       "Expressions may nest 256 levels deep, so that checking and evaluating them takes a bounded "
       "amount of memory. An expression that a person wrote never comes near: split it into "
       "several rules, or name parts of it with CONST.",
       rule_with(std::string(257, '!') + "docked"), rule_with("!docked")},
      {Code::kPlaceholder, "a form was copied and not filled in",
       "Documentation writes <name> where a name of yours belongs. The angle brackets are no part "
       "of the language.",
       rule_with("<expression>"), rule_with("rate(/robot/image) < 1")},
  };
}

std::vector<Explanation> name_explanations() {
  return {
      {Code::kDuplicateName, "a name is given twice",
       "Constants, components and signals share one set of names, rules have theirs, and each "
       "rule's strategies have theirs. With two things of one name, neither a reader nor a message "
       "could distinguish them.",
       "CONST limit = 0.5\nCONST limit = 0.7\n", "CONST limit = 0.5\nCONST high_limit = 0.7\n"},
      {Code::kUnknownName, "an undeclared name is nearly a declared one",
       "Names that a file does not declare are looked up on the robot, so a slip of the fingers is "
       "not an error by itself: it is a rule that waits for ever for something that does not "
       "exist. Correct the name, or declare it if it is meant to be another one.",
       "COMPONENT camera NODE /robot/camera\n" + rule_with("rate(/robot/image) < 1", "ERROR",
                                                           "STRATEGY restart 50 10",
                                                           "ADAPTATION camrea restart 5"),
       "COMPONENT camera NODE /robot/camera\n" + rule_with("rate(/robot/image) < 1")},
      {Code::kUndeclared, "a name is not declared (--strict)",
       "culprit check --strict accepts only components and signals that the file declares, so that "
       "it stands for itself and no rule depends on what the robot happens to call its nodes.",
       rule_with("rate(/robot/image) < 1"),
       "COMPONENT camera NODE /robot/camera\n" + rule_with("rate(/robot/image) < 1"),
       Strictness::kStrict},
      {Code::kUnknownFunction, "there is no function of this name",
       "Expressions call rate, age, phi, loss, alive, lifecycle, parameter, level, mean, min, max, "
       "stddev, changed, isnan, frozen, cpu, memory, goals, goal_age, abs, pow and sqrt. Functions "
       "of your own do "
       "not exist; CONST names "
       "values.",
       rule_with("frequency(/robot/image) < 1"), rule_with("rate(/robot/image) < 1")},
      {Code::kUnknownAdaptation, "there is no adaptation of this name",
       "An adaptation is one of the things that culprit can do to a component: set_parameter, "
       "increase_parameter, decrease_parameter, change_communication, activate, deactivate, "
       "restart, redeploy, start, stop, change_mode and call, or start_group for a GROUP. For a "
       "routine of the component's own, use call.",
       rule_with("rate(/robot/image) < 1", "ERROR", "STRATEGY reboot 50 10",
                 "ADAPTATION camera reboot 5"),
       rule_with("rate(/robot/image) < 1")},
      {Code::kUnknownPolicy, "there is no policy of this name, or it is given twice",
       "After the criticality come FOR, HOLD, COOLDOWN, ATTEMPTS and ON_CHANGE, each at most once "
       "and in any order.",
       rule_with("rate(/robot/image) < 1", "ERROR AFTER 2s"),
       rule_with("rate(/robot/image) < 1", "ERROR FOR 2s")},
      {Code::kReservedWord, "a word of the language is used as a name",
       "Keywords and true and false cannot be names, or a line could be read in two ways. Names "
       "are usually lower case; keywords are upper case.",
       "CONST RANGE = 30\n", "CONST range = 30\n"},
      {Code::kBadRosName, "this is no full ROS name",
       "Topics and nodes are named with their namespace, from the leading slash: letters, digits "
       "and underscores between slashes. There is no namespace that a relative name could be "
       "relative to.",
       rule_with("rate(image) < 1"), rule_with("rate(/robot/image) < 1")},
      {Code::kUnused, "no rule uses this component",
       "It is declared, but no trigger, strategy, signal or dependency uses it: if it fails, "
       "culprit "
       "does nothing and reports nothing. In a file that others include this is no mistake, and is "
       "not reported.",
       "COMPONENT lidar NODE /lidar\n" + rule_with("rate(/robot/image) < 1"),
       "COMPONENT lidar NODE /lidar REQUIRED\n" + rule_with("rate(/robot/image) < 1")},
  };
}

std::vector<Explanation> value_explanations() {
  return {
      {Code::kTypeMismatch, "a value is of the wrong kind",
       "Expressions know true/false, whole numbers, numbers, texts and durations, and mix none but "
       "the two kinds of numbers. A duration has a unit, a text has quotes, a trigger is true or "
       "false.",
       rule_with("age(/robot/image) > 0.5"), rule_with("age(/robot/image) > 500ms")},
      {Code::kUnknownType, "cannot infer the type of this value",
       "Signals and parameters get their kind from their use: compared with 0.5 it is a number, "
       "with \"docked\" a text, alone it is true or false. Two unknown ones give no "
       "information on each other. Often a text merely lacks its quotes.",
       rule_with("mode == docked"), rule_with("mode == \"docked\"")},
      {Code::kArguments, "a function is called with the wrong arguments",
       "Each function takes what its usage line says; the message repeats it.",
       rule_with("rate() < 1"), rule_with("rate(/robot/image) < 1")},
      {Code::kNotConstant, "a constant is made of something that changes",
       "A constant is computed once, when the file is read: of numbers, texts, durations and of "
       "constants that were defined before it. Use a signal for a value that changes at run time.",
       "CONST limit = battery / 2\n", "CONST full = 12.6\nCONST limit = full / 2\n"},
      {Code::kNoValue, "a constant has no value",
       "The expression divides by zero, overflows, or takes the root of a negative number. At run "
       "time such a value would be unknown, and no trigger that uses it could ever fire.",
       "CONST limit = 1 / 0\n", "CONST limit = 1 / 2\n"},
      {Code::kProbabilityRange, "a success probability is out of range",
       "The first number of a STRATEGY is the probability, in percent, that it resolves the "
       "failure: above 0 and at most 100. It is where learning begins, so an estimate will do.",
       rule_with("rate(/robot/image) < 1", "ERROR", "STRATEGY restart 150 10"),
       rule_with("rate(/robot/image) < 1", "ERROR", "STRATEGY restart 90 10")},
      {Code::kConfidenceRange, "a confidence is out of range",
       "The second number of a STRATEGY says how many past attempts the probability is worth: "
       "above 0 and at most 100. A high one makes culprit slow to learn otherwise.",
       rule_with("rate(/robot/image) < 1", "ERROR", "STRATEGY restart 50 0"),
       rule_with("rate(/robot/image) < 1", "ERROR", "STRATEGY restart 50 1")},
      {Code::kImpactRange, "an impact is out of range",
       "The last number of an ADAPTATION counts the cycles until the failure is gone, once the "
       "adaptation took effect: a whole number, at least 1. The verdict on the strategy waits that "
       "long, so too small a number condemns strategies that would have helped.",
       rule_with("rate(/robot/image) < 1", "ERROR", "STRATEGY restart 50 10",
                 "ADAPTATION camera restart 2.5"),
       rule_with("rate(/robot/image) < 1", "ERROR", "STRATEGY restart 50 10",
                 "ADAPTATION camera restart 3")},
      {Code::kPolicyRange, "a time or count is out of range",
       "Durations of policies, windows and cycles are longer than zero and bounded; HOLD n/k asks "
       "for n of the last k cycles, so n is at most k; ATTEMPTS is at least 1.",
       rule_with("rate(/robot/image) < 1", "ERROR HOLD 5/3"),
       rule_with("rate(/robot/image) < 1", "ERROR HOLD 3/5")},
      {Code::kEmptyRange, "a RANGE holds no values",
       "RANGE low..high says which values a signal can have; the smaller number comes first.",
       "SIGNAL battery TOPIC /battery FIELD percentage RANGE 1..0\n",
       "SIGNAL battery TOPIC /battery FIELD percentage RANGE 0..1\n"},
      {Code::kShortImpact, "an impact is shorter than any process takes to start",
       "The impact is how many cycles pass from when an adaptation took effect (a redeploy: the "
       "node "
       "is there) until the failure is gone. A new process needs a while until its topics flow. "
       "With "
       "less than two cycles of 200 ms the strategy is judged before it can have helped, counts as "
       "failed, and is believed in less and less.",
       "COMPONENT camera NODE /robot/camera LAUNCH \"camera_driver\"\n" +
           rule_with("rate(/robot/image) < 1", "ERROR", "STRATEGY redeploy 80 10",
                     "ADAPTATION camera redeploy 1"),
       "COMPONENT camera NODE /robot/camera LAUNCH \"camera_driver\"\n" +
           rule_with("rate(/robot/image) < 1", "ERROR", "STRATEGY redeploy 80 10",
                     "ADAPTATION camera redeploy 10")},
      {Code::kShortWindow, "a window is shorter than the period that it is to measure",
       "rate(topic, window) counts the messages within the window. At the rate that it is compared "
       "with, less than one message falls into this window: the rate is 0 between two messages, "
       "and "
       "the failure seems to come and go.",
       rule_with("rate(/robot/image, 100ms) < 5"), rule_with("rate(/robot/image, 1s) < 5")},
      {Code::kLongWindow, "a window is longer than a day",
       "rate, mean, min, max and stddev keep the samples of their window, so that they are exact. "
       "A "
       "window is at most 24h long. It holds at most 4,194,304 samples (64 MB), which are 24 h of "
       "48 Hz or 1 h of 1,165 Hz. If more come, the function is unknown, and culprit reports it. "
       "age(topic) keeps no samples and has no such limit.",
       rule_with("rate(/robot/image, 36h) < 0.001"), rule_with("age(/robot/image) > 36h")},
  };
}

std::vector<Explanation> rule_explanations() {
  return {
      {Code::kContradiction, "a strategy contradicts itself",
       "All adaptations of one step are applied together. An adaptation that undoes or repeats "
       "another, or that reconfigures a process which the same step ends, is a mistake: the robot "
       "would be left in whichever state came last. A restart beside a redeploy of the same "
       "component is in vain. A component may be started again after it was stopped. THEN begins a "
       "step: a later step may take back what an earlier one did, as in deactivate THEN redeploy "
       "another component THEN activate. Without THEN culprit takes such a strategy for steps, and "
       "warns. Alternatives are strategies of their own.",
       "RULE CameraFails\n  POLICIES ERROR\n  TRIGGER rate(/robot/image) < 1\n"
       "    STRATEGY again 50 10\n      ADAPTATION camera deactivate 5\n"
       "      ADAPTATION camera activate 5\n",
       rule_with("rate(/robot/image) < 1")},
      {Code::kNoLaunch, "a strategy needs a LAUNCH command that is missing",
       "redeploy and start run the LAUNCH command of the component, or ask the systemd that runs "
       "its UNIT. Without either culprit cannot start it, and the strategy is never chosen.",
       "COMPONENT camera NODE /robot/camera\n"
       "RULE CameraFails\n  POLICIES ERROR\n  TRIGGER rate(/robot/image) < 1\n"
       "    STRATEGY restart 50 10\n      ADAPTATION camera restart 5\n"
       "    STRATEGY redeploy 90 10\n      ADAPTATION camera redeploy 10\n",
       "COMPONENT camera NODE /robot/camera LAUNCH \"ros2 run my_cameras driver\"\n"
       "RULE CameraFails\n  POLICIES ERROR\n  TRIGGER rate(/robot/image) < 1\n"
       "    STRATEGY restart 50 10\n      ADAPTATION camera restart 5\n"
       "    STRATEGY redeploy 90 10\n      ADAPTATION camera redeploy 10\n"},
      {Code::kNeverValid, "no strategy of a rule can ever run",
       "Every strategy of the rule starts a component that has no LAUNCH command. The failure "
       "would be detected, and nothing could be done about it.",
       "COMPONENT camera NODE /robot/camera\n" + rule_with("rate(/robot/image) < 1", "ERROR",
                                                           "STRATEGY redeploy 90 10",
                                                           "ADAPTATION camera redeploy 10"),
       "COMPONENT camera NODE /robot/camera LAUNCH \"ros2 run my_cameras driver\"\n" +
           rule_with("rate(/robot/image) < 1", "ERROR", "STRATEGY redeploy 90 10",
                     "ADAPTATION camera redeploy 10")},
      {Code::kStopsRequired, "a strategy stops a REQUIRED component",
       "With REQUIRED, culprit notifies a person when the component is not there. A strategy that "
       "stops it, and does not start it again, causes just that. A last resort may: it is a safe "
       "stop, and culprit notifies a person of it anyway.",
       "COMPONENT camera NODE /robot/camera REQUIRED\n" + rule_with("rate(/robot/image) < 1",
                                                                    "ERROR", "STRATEGY quiet 50 10",
                                                                    "ADAPTATION camera stop 5"),
       "COMPONENT camera NODE /robot/camera REQUIRED\n" + rule_with("rate(/robot/image) < 1")},
      {Code::kTwoOwners, "it is not clear who starts and ends a component",
       "The owner that starts a component also ends it: culprit itself (LAUNCH), systemd (UNIT), "
       "a container engine (CONTAINER), a component container (IN) or a launcher that respawns it "
       "(RESPAWNED). Two of them would start it twice; and a unit that runs two components cannot "
       "be restarted for one of them.",
       "COMPONENT camera NODE /robot/camera UNIT camera.service LAUNCH \"camera_driver\"\n",
       "COMPONENT camera NODE /robot/camera UNIT camera.service\n"},
      {Code::kTrueWhenWell, "a trigger is true while all is well",
       "A trigger describes a failure. This one is true while every component is alive and every "
       "topic is received: the rule would adapt a healthy robot, and do nothing about a failed "
       "one. Most often a comparison is the wrong way round. A rule that waits for something to "
       "come, and acts once, has ON_CHANGE among its policies.",
       rule_with("age(/robot/image) < 500ms"), rule_with("age(/robot/image) > 500ms")},
      {Code::kNoShell, "a LAUNCH command is written for a shell",
       "A launch command is an argument vector: no shell reads it. Clauses do what a shell would "
       "do: SETUP is sourced first, ENV sets variables, CWD is the folder. Where it has to be a "
       "shell, say so: LAUNCH \"bash -c 'one | another'\".",
       "COMPONENT camera NODE /robot/camera LAUNCH \"source /opt/ros/humble/setup.bash && ros2 run "
       "cameras driver\"\n",
       "COMPONENT camera NODE /robot/camera LAUNCH \"ros2 run cameras driver\" SETUP "
       "/opt/ros/humble/setup.bash\n"},
      {Code::kBadGroup, "a group cannot be what its line says",
       "GROUP names components that one lifecycle manager starts, in the order in which it starts "
       "them, and that manager. Each is declared by a COMPONENT line and named once, and the "
       "manager "
       "is none of them. start_group takes the name of such a group.",
       "COMPONENT planner NODE /planner_server\nCOMPONENT manager NODE /lifecycle_manager\n"
       "GROUP navigation { planner, controler } MANAGER manager\n"
       "COMPONENT controller NODE /controller_server\n",
       "COMPONENT planner NODE /planner_server\nCOMPONENT manager NODE /lifecycle_manager\n"
       "GROUP navigation { planner, controller } MANAGER manager\n"
       "COMPONENT controller NODE /controller_server\n"},
      {Code::kMovesInterlock, "a last resort changes what an INTERLOCK reads",
       "A last resort does not wait for an interlock, and often opens it: the robot stands, and "
       "the repair can begin. That is safe only if the interlock reads the state of the robot. If "
       "it reads the parameter that the last resort sets, it opens before the robot has stopped.",
       "INTERLOCK parameter(base, max_speed) < 0.1\nCOMPONENT base NODE /robot/base\n" +
           rule_with("rate(/robot/image) < 1", "ERROR",
                     "STRATEGY restart 50 10\n      ADAPTATION camera restart 5\n"
                     "    STRATEGY stand_still 90 10 LASTRESORT",
                     "ADAPTATION base set_parameter max_speed 0.0 1"),
       "INTERLOCK speed < 0.1\nSIGNAL speed TOPIC /robot/odom FIELD twist.twist.linear.x\n"
       "COMPONENT base NODE /robot/base\n" +
           rule_with("rate(/robot/image) < 1", "ERROR",
                     "STRATEGY restart 50 10\n      ADAPTATION camera restart 5\n"
                     "    STRATEGY stand_still 90 10 LASTRESORT",
                     "ADAPTATION base set_parameter max_speed 0.0 1")},
      {Code::kAlwaysTrue, "a trigger reads nothing and is always true",
       "A trigger that reads no signal, topic or component says the same whatever the robot does: "
       "this failure would be there from the start and could never be resolved.",
       rule_with("1 < 2"), rule_with("rate(/robot/image) < 2")},
      {Code::kNeverTrue, "a trigger reads nothing and is never true",
       "A trigger that reads no signal, topic or component says the same whatever the robot does: "
       "this failure would never be detected.",
       rule_with("1 > 2"), rule_with("1 > rate(/robot/image)")},
      {Code::kCircularDependency, "declared dependencies form a loop",
       "DEPENDENCY a ON b says that failures of b show at a. In a loop every component could be "
       "blamed on every other, and the search for the culprit could not begin anywhere.",
       "COMPONENT camera\nCOMPONENT fusion\nDEPENDENCY fusion ON camera\n"
       "DEPENDENCY camera ON fusion\n",
       "COMPONENT camera\nCOMPONENT fusion\nDEPENDENCY fusion ON camera\n"},
  };
}

std::string lights(std::string_view off_above) {
  return "RULE TooDark\n  POLICIES WARNING\n  TRIGGER brightness < 0.3\n    STRATEGY light 90 10\n"
         "      ADAPTATION lamp activate 5\nRULE TooBright\n  POLICIES WARNING\n"
         "  TRIGGER brightness > " +
         std::string(off_above) + "\n    STRATEGY dark 90 10\n      ADAPTATION lamp deactivate 5\n";
}

std::string escalation(std::string_view first, std::string_view second) {
  return rule_with("age(/robot/image) > 500ms", first) + "RULE CameraFailsForLong\n  POLICIES " +
         std::string(second) +
         "\n  TRIGGER age(/robot/image) > 2s\n    STRATEGY activate 50 10\n"
         "      ADAPTATION camera activate 5\n";
}

std::vector<Explanation> meaning_explanations() {
  const std::string battery = "SIGNAL battery TOPIC /battery FIELD percentage RANGE 0..1\n";
  const std::string camera = "COMPONENT camera NODE /robot/camera LAUNCH \"camera_driver\"\n";
  return {
      {Code::kOscillation, "strategies of two rules undo one another",
       "One rule's strategy sets what the other's resets, and they can take turns: both triggers "
       "can be true together, one of them always is, or the parameter that each sets makes the "
       "other's true. The robot could flip between the two for ever. Leave a band between the "
       "triggers, as a thermostat does, or make both strategies alternatives of one rule, which "
       "remembers what it tried.",
       lights("0.2"), lights("0.7")},
      {Code::kAlwaysTrueInRange, "a condition is always true",
       "For every value that its inputs can have, by their RANGE or by what they are, this "
       "condition holds. A trigger made of it would report a failure from the first value on and "
       "never resolve it; in an && it has no say.",
       battery + rule_with("battery < 20"), battery + rule_with("battery < 0.2")},
      {Code::kNeverTrueInRange, "a condition is never true",
       "The condition does not hold for any value that its inputs can have, by their RANGE or "
       "their kind, or its parts exclude one another. A trigger made of it would never detect "
       "the failure.",
       rule_with("entropy > 0.8 && entropy < 0.2"), rule_with("entropy > 0.8 || entropy < 0.2")},
      {Code::kCovered, "a rule is covered by another one",
       "Whenever this rule's trigger is true, the other one's is too; it adapts the same "
       "components, is at least as critical, and detects no later. This rule can only get in its "
       "way. Where it was meant as an escalation it has to be more critical.",
       escalation("ERROR", "WARNING"), escalation("WARNING", "ERROR")},
      {Code::kWhenNeverTrue, "a strategy's WHEN is never true",
       "The condition does not hold for any value that its inputs can have, so the strategy is "
       "never chosen. Often a state or a limit is misspelt.",
       rule_with("rate(/robot/image) < 1", "ERROR",
                 "STRATEGY restart 50 10 WHEN lifecycle(camera) == \"Active\""),
       rule_with("rate(/robot/image) < 1", "ERROR",
                 "STRATEGY restart 50 10 WHEN lifecycle(camera) == \"active\"")},
      {Code::kWhenContradictsTrigger, "a strategy's WHEN contradicts the rule's trigger",
       "The strategies of a rule are chosen while its trigger is true, and then this WHEN is "
       "false. The strategy waits for a situation in which it is not needed.",
       rule_with("rate(/robot/image) < 1", "ERROR",
                 "STRATEGY restart 50 10 WHEN rate(/robot/image) > 5"),
       rule_with("rate(/robot/image) < 1", "ERROR",
                 "STRATEGY restart 50 10 WHEN rate(/robot/image) > 0.1")},
      {Code::kNoLastResort, "no strategy helps if the process hangs",
       "The rule fires when a topic falls silent, and a hung process is silent. It answers no "
       "lifecycle request and no parameter call, so all of the rule's strategies would fail, "
       "though a LAUNCH command is there. A strategy that redeploys is the last resort; it costs "
       "nothing while cheaper ones help.",
       camera + rule_with("age(/robot/image) > 500ms"),
       camera + rule_with("age(/robot/image) > 500ms") +
           "    STRATEGY redeploy 90 10\n      ADAPTATION camera redeploy 10\n"},
  };
}

std::vector<Explanation> robot_explanations() {
  const auto against_robot = [](Code code, std::string title, std::string why, std::string wrong,
                                std::string right) {
    return Explanation{code,
                       std::move(title),
                       std::move(why) +
                           " Found by `culprit check --robot`. The robot of the "
                           "example: " +
                           kExampleRobot,
                       std::move(wrong),
                       std::move(right),
                       Strictness::kLenient,
                       true};
  };
  const std::string camera = "COMPONENT camera NODE /robot/camera\n";
  return {
      against_robot(Code::kNoSuchNode, "no node of the robot is this component",
                    "The graph of the robot was read, and it holds no node of this name: it is not "
                    "started, it exited, or its name or namespace is another one. culprit can "
                    "neither observe the component nor send it requests.",
                    "COMPONENT camera NODE /camera\n", camera),
      against_robot(Code::kNoSuchTopic, "no node publishes this topic",
                    "Its rate would be 0, its age and its fields unknown for ever; a node that is "
                    "switched to it would receive no message.",
                    rule_with("rate(/robot/imag) < 1"), rule_with("rate(/robot/image) < 1")),
      against_robot(
          Code::kNoSuchParameter, "the node has no such parameter",
          "The node listed its parameters. Reading another one stays unknown, and setting it is "
          "refused, unless the node allows undeclared parameters.",
          camera + rule_with("parameter(camera, exposre) > 1"),
          camera + rule_with("parameter(camera, exposure) > 1")),
      against_robot(
          Code::kNoSuchDiagnostic, "no such diagnostic was received",
          "No message on /diagnostics carried this status or key while culprit listened, so "
          "the signal would stay unknown and its rule quiet. Status messages that come seldom "
          "need a longer --wait.",
          "SIGNAL entropy DIAGNOSTIC camera KEY entropi\n",
          "SIGNAL entropy DIAGNOSTIC camera KEY entropy\n"),
      against_robot(Code::kNoSuchService, "no node offers the service that this needs",
                    "A call needs its service, a lifecycle adaptation the node's change_state, a "
                    "mode its change_mode, a parameter its set_parameters. Without it the "
                    "adaptation is unreachable whenever it is tried.",
                    rule_with("rate(/robot/image) < 1", "ERROR", "STRATEGY mode 50 10",
                              "ADAPTATION camera change_mode night 5"),
                    rule_with("rate(/robot/image) < 1", "ERROR", "STRATEGY calibrate 50 10",
                              "ADAPTATION camera call ~/recalibrate 5")),
      against_robot(Code::kNoSuchUnit, "culprit could not start and end this unit",
                    "culprit has to ask the owner of the component. systemd or the container "
                    "engine cannot be reached, does not know it, or does not let culprit's "
                    "user manage it (docs/security.md). The rule could neither end nor start "
                    "anything.",
                    "COMPONENT camera NODE /robot/camera UNIT camra.service\n",
                    "COMPONENT camera NODE /robot/camera UNIT camera.service\n"),
      against_robot(Code::kCannotLaunch, "culprit could not start this LAUNCH",
                    "There is no such program, its SETUP is not there or could be changed by "
                    "others than culprit's user and root, or its CWD is no folder. When the rule "
                    "fires, culprit would not end the component, because it could not start it "
                    "again.",
                    "COMPONENT camera NODE /robot/camera LAUNCH \"camera_driver\" "
                    "SETUP /opt/ros/humbel/setup.bash\n",
                    "COMPONENT camera NODE /robot/camera LAUNCH \"camera_driver\" "
                    "SETUP /opt/ros/humble/setup.bash\n"),
      against_robot(
          Code::kRunsOtherwise, "the component runs otherwise than its LAUNCH says",
          "The robot's node runs with other arguments or parameters than its LAUNCH says, or its "
          "program or a parameter file was changed or removed since it was started. A redeploy "
          "would start another program than the one that works now.",
          "COMPONENT lidar NODE /robot/camera LAUNCH \"scan_driver --fps 15\"\n",
          "COMPONENT lidar NODE /robot/camera LAUNCH \"/opt/lidar/driver --fps 30\"\n"),
      against_robot(Code::kNoSuchField, "the messages of this topic have no such field",
                    "Their type has none of this name, or it is not known what the type looks "
                    "like: no .msg file of it was found, and the publisher's node did not describe "
                    "it. So the signal would stay unknown and its rule quiet.",
                    "SIGNAL lines TOPIC /robot/image FIELD heigt\n",
                    "SIGNAL lines TOPIC /robot/image FIELD height\n"),
      against_robot(Code::kSeveralNodes, "several nodes of the robot have this component's name",
                    "A component without NODE is the node whose own name it has. Here more than "
                    "one has it, in different namespaces, and culprit does not choose: it does "
                    "nothing to either until NODE says which is meant.",
                    "COMPONENT wheel LAUNCH \"wheel_driver\"\n",
                    "COMPONENT wheel NODE /left/wheel LAUNCH \"wheel_driver\"\n"),
      against_robot(
          Code::kNoSuchHost, "culprit cannot ask this computer over ssh",
          "The owner of the component is on another computer (HOST). culprit asks it over "
          "ssh without a password: there is no such computer, it does not "
          "answer, its key is not known, or it does not take the key of culprit's user "
          "(docs/security.md). The rule could neither end nor start "
          "anything.",
          "COMPONENT camera NODE /robot/camera UNIT camera.service HOST robot@rovr2\n",
          "COMPONENT camera NODE /robot/camera UNIT camera.service HOST robot@rover2\n"),
      against_robot(
          Code::kBadRequest, "the service would not understand this call",
          "The fields of a call have to fit the type of the service that the robot offers: every "
          "field that is written has to be one of the request's, and of its type. A field that is "
          "left out is 0, false or empty. Found by asking the robot for the type. A service whose "
          ".srv file is not found cannot be called either.",
          rule_with("rate(/robot/image) < 1", "ERROR", "STRATEGY light 50 10",
                    "ADAPTATION camera call ~/light \"on: true\" 5"),
          rule_with("rate(/robot/image) < 1", "ERROR", "STRATEGY light 50 10",
                    "ADAPTATION camera call ~/light \"data: true\" 5")),
  };
}

// A template of one rule, and a USE of it.
std::string template_with(std::string_view use, std::string_view trigger = "age({topic}) > 1s",
                          std::string_view head = "silent(topic)") {
  return "TEMPLATE " + std::string(head) + "\n" + rule_with(trigger) + "END\n" + std::string(use) +
         "\n";
}

std::vector<Explanation> reuse_explanations() {
  return {
      {Code::kCannotInclude, "a file cannot be included",
       "INCLUDE reads the rules of another file: one whose name ends in .rules, in the folder of "
       "the file that includes it or, as \"packs/nav2.rules\", among those that were installed "
       "with culprit (share/culprit/rules). Files that include one another in a circle cannot be "
       "put together either.",
       "INCLUDE \"packs/nav3.rules\"\n", "INCLUDE \"packs/nav2.rules\"\n"},
      {Code::kUnknownTemplate, "there is no template of this name",
       "USE writes down the statements of a TEMPLATE, which stands in this file or in one that it "
       "includes, above or below.",
       template_with("USE silence(/robot/image)"), template_with("USE silent(/robot/image)")},
      {Code::kTemplateArguments, "a template gets too few or too many arguments",
       "A USE gives one argument for each parameter of its template, in their order. Those that "
       "have a usual value, as in TEMPLATE driver(name, topic, hz = 10), may be left out at the "
       "end.",
       template_with("USE silent(/robot/image, 10)"), template_with("USE silent(/robot/image)")},
      {Code::kUnknownParameter, "a template has no such parameter",
       "In a template, {name} stands for what a USE gives for the parameter 'name'. A parameter "
       "that is not in the first line of the template has no value.",
       template_with("USE silent(/robot/image)", "age({topik}) > 1s"),
       template_with("USE silent(/robot/image)")},
      {Code::kEndlessTemplate, "templates would go on without end",
       "A template that uses itself, also by way of others, would become endless rules; so would "
       "very many that use one another.",
       "TEMPLATE left\n  USE right\nEND\nTEMPLATE right\n  USE left\nEND\nUSE left\n",
       "TEMPLATE left\n  USE right\nEND\nTEMPLATE right\nEND\nUSE left\n"},
  };
}

std::string indented(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    out += "    " + std::string(text.substr(0, end)) + "\n";
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::string wrapped(std::string_view text, std::size_t width) {
  std::string out;
  std::size_t column = 0;
  while (!text.empty()) {
    const auto end = std::min(text.find(' '), text.size());
    if (column > 0) out += column + 1 + end > width ? '\n' : ' ';
    column = column > 0 && column + 1 + end <= width ? column + 1 + end : end;
    out += text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

}  // namespace

const std::vector<Explanation>& explanations() {
  static const std::vector<Explanation> kAll = [] {
    std::vector<Explanation> all;
    for (const auto& part :
         {syntax_explanations(), name_explanations(), value_explanations(), rule_explanations(),
          meaning_explanations(), robot_explanations(), reuse_explanations()}) {
      all.insert(all.end(), part.begin(), part.end());
    }
    std::sort(all.begin(), all.end(),
              [](const Explanation& a, const Explanation& b) { return a.code < b.code; });
    return all;
  }();
  return kAll;
}

const LiveInventory& example_robot() {
  static const LiveInventory kRobot = [] {
    LiveInventory robot;
    LiveInventory::Node& camera = robot.nodes["/robot/camera"];
    camera.parameters = {{"exposure", Value(0.5)}};
    camera.lifecycle = "active";
    robot.nodes["/left/wheel"].pid = 41;
    robot.nodes["/right/wheel"];
    robot.nodes["/left/arm"];
    robot.nodes["/right/arm"];
    robot.topics["/robot/image"] = {
        .type = "sensor_msgs/msg/Image",
        .publishers = {"/robot/camera"},
        .rate = {},
        .fields = {},
        .unreadable = {{"heigt",
                        "sensor_msgs/msg/Image has no field 'heigt'; its fields are header, "
                        "height, width, encoding, is_bigendian, step, data"}}};
    robot.topics["/diagnostics"] = {.type = "diagnostic_msgs/msg/DiagnosticArray",
                                    .publishers = {"/robot/camera"},
                                    .rate = {},
                                    .fields = {},
                                    .unreadable = {}};
    robot.services = {{"/robot/camera/change_state", "lifecycle_msgs/srv/ChangeState"},
                      {"/robot/camera/get_state", "lifecycle_msgs/srv/GetState"},
                      {"/robot/camera/set_parameters", "rcl_interfaces/srv/SetParameters"},
                      {"/robot/camera/recalibrate", "std_srvs/srv/Trigger"},
                      {"/robot/camera/light", "std_srvs/srv/SetBool"}};
    robot.request_troubles = {
        {"/robot/camera/light", "on: true",
         "std_srvs/srv/SetBool: std_srvs/srv/SetBool_Request has no field 'on'; it has data"}};
    robot.diagnostics = {{"camera", "camera_0", 0, {{"entropy", "0.03"}}}};
    robot.unit_troubles = {
        {{"camra.service", false}, "systemd has no camra.service; did you mean camera.service?"}};
    robot.host_troubles = {
        {"robot@rovr2",
         "robot@rovr2: ssh: Could not resolve hostname rovr2: Name or service not known; is "
         "HOST its name? ssh robot@rovr2 should connect"}};
    robot.launch_troubles = {
        {"camera", LiveInventory::LaunchTrouble::Clause::kSetup, "/opt/ros/humbel/setup.bash",
         "SETUP: cannot find /opt/ros/humbel/setup.bash: No such file or "
         "directory"},
        {"lidar", LiveInventory::LaunchTrouble::Clause::kRunning, "scan_driver",
         "lidar runs with '--fps 30', and its LAUNCH has '--fps 15'"}};
    return robot;
  }();
  return kRobot;
}

const Explanation* find_explanation(std::string_view code) {
  if (code.starts_with('R') || code.starts_with('r')) code.remove_prefix(1);
  std::uint16_t number = 0;
  const auto [rest, error] = std::from_chars(code.data(), code.data() + code.size(), number);
  if (error != std::errc() || rest != code.data() + code.size()) return nullptr;
  const auto found =
      std::find_if(explanations().begin(), explanations().end(),
                   [&](const Explanation& e) { return e.code == static_cast<Code>(number); });
  return found == explanations().end() ? nullptr : &*found;
}

std::string page(const Explanation& e) {
  return to_string(e.code) + ": " + e.title + "\n\n" + wrapped(e.why, 80) + "\n\nWrong:\n\n" +
         indented(e.wrong) + "\nRight:\n\n" + indented(e.right);
}

std::string diagnostics_as_markdown() {
  std::string out =
      "# Diagnostics\n\n"
      "The diagnostics of `culprit check`, by code. A code never changes its meaning. `culprit "
      "explain "
      "R012`\n"
      "shows one of these pages, and `culprit explain --markdown` writes them all.\n\n"
      "| code | meaning |\n| --- | --- |\n";
  for (const Explanation& e : explanations()) {
    const std::string code = to_string(e.code);
    std::string anchor = code;
    anchor[0] = 'r';
    out += "| [" + code + "](#" + anchor + ") | " + e.title + " |\n";
  }
  for (const Explanation& e : explanations()) {
    out += "\n## " + to_string(e.code) + "\n\n**" + e.title + ".** " + e.why + "\n\nWrong:\n\n" +
           indented(e.wrong) + "\nRight:\n\n" + indented(e.right);
  }
  return out;
}

}  // namespace culprit
