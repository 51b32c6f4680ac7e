// The file of an incident: what is in it, that it needs nothing else, and that names of strangers stay names.
#include "incident_reports/incident_page.h"

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "incident_reports/curve_plot.h"
#include "incident_reports/incident_words.h"

namespace culprit::incident_reports {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kDetectedAt = 1'800'000'000;  // s since 1970

std::int64_t nanoseconds_after(double seconds) {
  return static_cast<std::int64_t>((kDetectedAt + seconds) * 1e9);
}

// A curve that rises, is interrupted for two seconds, and has a spike.
Curve speed_curve() {
  Curve curve{"speed (/speed data)", "read by TooFast", "", {2.5}, {}, 500'000'000};
  for (int i = -20; i <= 20; ++i) {
    if (i > 0 && i < 10) continue;
    curve.points.push_back({nanoseconds_after(0.2 * i), i == 15 ? 9.0 : 1 + 0.1 * i});
  }
  return curve;
}

PageContent page_of_rover() {
  PageContent content;
  content.incident.began = kDetectedAt;
  content.incident.seconds = 2;
  content.incident.is_over = true;
  content.incident.worst = Criticality::kError;
  content.incident.causes = {"drive"};
  content.incident.rules = {"TooFast", "ScanSilent"};
  content.incident.consequences = {"ScanSilent"};
  content.incident.helped = {"slow_down"};
  content.robot = "rover";
  content.written_at = kDetectedAt + 3600;
  const auto event = [&](double after, const char* type, Json more) {
    Json json{{"clock", kDetectedAt + after}, {"type", type}};
    json.update(more);
    content.events.push_back(std::move(json));
  };
  event(0, "failure_detected",
        {{"rule", "TooFast"},
         {"label", "detected"},
         {"criticality", "ERROR"},
         {"text", "TooFast detected"}});
  event(0.01, "strategy_chosen",
        {{"rule", "TooFast"},
         {"strategy", "slow_down"},
         {"label", "decided"},
         {"text", "drive is held responsible"},
         {"suspects",
          {{{"component", "drive"},
            {"probability", 0.75},
            {"evidence",
             {{{"source", "kernel"},
               {"text", "drive is stopped"},
               {"age_ns", 1'510'000'000},
               {"log_odds", 2.9},
               {"without", "lidar"}},
              {{"source", "learned"}, {"text", "one stayed before"}, {"log_odds", -1.2}},
              {{"source", "answer"},
               {"text", "lidar answered"},
               {"age_ns", 200'000'000},
               {"log_odds", 0.0}}}}}}},
         {"candidates",
          {{{"strategy", "slow_down"}, {"cost", 0.4}, {"excluded", nullptr}},
           {{"strategy", "stop"},
            {"cost", 0.0},
            {"excluded", {{"condition", "tried"}, {"text", "it was tried already"}}}}}}});
  event(2, "failure_resolved",
        {{"rule", "TooFast"},
         {"strategy", "slow_down"},
         {"label", "resolved"},
         {"text", "TooFast resolved"}});
  content.requests = {{kDetectedAt + 0.02, "drive: set speed to 0.2", "done", 0.04},
                      {kDetectedAt + 0.03, "lidar: restart"}};
  content.recordings = {"rover_20270115T080000.000Z_TooFast.mcap"};
  content.curves = RecordedCurves{
      nanoseconds_after(-4), nanoseconds_after(4), {speed_curve()}, {"Something is missing."}};
  return content;
}

struct IncidentPage : testing::Test {
  IncidentPage() {
    setenv("TZ", "UTC-2", 1);
    tzset();
  }
  ~IncidentPage() override {
    unsetenv("TZ");
    tzset();
  }
};

TEST_F(IncidentPage, ReportsTheBlameTheDecisionAndTheRecording) {
  const std::string html = incident_page(page_of_rover());
  for (const char* text :
       {"<title>drive, 2027-01-15 10:00:00</title>", "rover", "ScanSilent", "2.0 s", "slow_down",
        "drive is held responsible", "drive 75 %", "<b>chosen</b>", "it was tried already",
        "10:00:02.000", "Something is missing.", "speed (/speed data)", "read by TooFast",
        "rover_20270115T080000.000Z_TooFast.mcap", "UTC+02:00", "2027-01-15 11:00:00"})
    EXPECT_THAT(html, HasSubstr(text));
  for (const char* text : {"<script", "src=", "href=", "url(", "@import"})
    EXPECT_THAT(html, Not(HasSubstr(text))) << "it needs something beside itself";
  EXPECT_THAT(html, HasSubstr("prefers-color-scheme:dark"));
}

TEST_F(IncidentPage, ShowsTheEvidenceOnOneTimeAxis) {
  const std::string html = incident_page(page_of_rover());
  for (const char* text :
       {"What began first", "09:59:58.500", "drive is stopped", "kernel", "+2.9", "1.5 s before",
        "class=\"for\"", "<circle class=\"ERROR\"", "Hollow: evidence against", "one stayed before",
        "-1.2", "Without “drive is stopped”, <b>lidar</b> would be held responsible"})
    EXPECT_THAT(html, HasSubstr(text));
  EXPECT_LT(html.find("09:59:58.500"), html.find("10:00:00.000</td><td>TooFast"))
      << "the earliest first";
  PageContent content = page_of_rover();
  content.events[0]["criticality"] = "WARNING";
  EXPECT_THAT(incident_page(content), HasSubstr("<circle class=\"WARNING\""));
  content.events[1].erase("suspects");
  EXPECT_THAT(incident_page(content), Not(HasSubstr("What began first")));
}

TEST_F(IncidentPage, TellsWhatWasAskedAndAnswered) {
  const std::string html = incident_page(page_of_rover());
  EXPECT_THAT(html, HasSubstr("<td>lidar answered</td><td>0.2 s before</td>"));
  EXPECT_THAT(html, Not(HasSubstr("<td>drive</td><td>lidar answered</td>")))
      << "an answer is neither evidence for the suspect nor an onset";
  EXPECT_THAT(html, HasSubstr("<td>drive: set speed to 0.2</td><td>done</td><td>40 ms</td>"));
  EXPECT_THAT(html, HasSubstr("<td>lidar: restart</td><td>none was recorded</td>"));
}

TEST_F(IncidentPage, SaysWhyThereAreNoPlots) {
  PageContent content = page_of_rover();
  content.curves.reset();
  content.remarks = {"There is no recording of it."};
  EXPECT_THAT(incident_page(content),
              AllOf(HasSubstr("There is no recording of it."), Not(HasSubstr("<figure>"))));
  content.curves.emplace();
  EXPECT_THAT(incident_page(content), HasSubstr("There is no number in it"));
}

TEST_F(IncidentPage, TakesNamesAndTextsForNothingElse) {
  constexpr const char* kEvil = "<img src=x onerror=\"alert(1)\">\x01\xff";
  PageContent content = page_of_rover();
  content.robot = kEvil;
  content.incident.causes = content.incident.rules = content.incident.consequences =
      content.incident.helped = content.recordings = content.remarks = {kEvil};
  for (Json& event : content.events) {
    for (const char* key : {"label", "text", "strategy", "rule", "criticality"}) event[key] = kEvil;
    if (event.contains("suspects")) {
      Json& suspect = event["suspects"][0];
      suspect["component"] = kEvil;
      for (const char* key : {"text", "source", "without"}) suspect["evidence"][0][key] = kEvil;
    }
    if (event.contains("candidates")) event["candidates"][1]["excluded"]["text"] = kEvil;
  }
  content.requests[0].text = content.requests[0].answer = kEvil;
  Curve& curve = content.curves->curves[0];
  curve.name = curve.about = curve.unit = kEvil;
  content.curves->remarks = {kEvil};
  const std::string html = incident_page(content);
  EXPECT_THAT(html, AllOf(Not(HasSubstr("<img")), Not(HasSubstr("\x01")), Not(HasSubstr("\xff")),
                          HasSubstr("&lt;img")));
  for (Json& event : content.events) {
    for (const char* key : {"clock", "candidates", "suspects", "type"}) event[key] = Json{{"a", 7}};
  }
  content.events.push_back(7);
  content.events.push_back(
      Json{{"suspects", Json::array({7, Json{{"evidence", Json::array({7, Json::object()})}}})}});
  content.events.push_back(
      Json{{"candidates", Json::array({7, nullptr, Json{{"excluded", "word"}}})}});
  EXPECT_THAT(incident_page(content), HasSubstr("</html>"));
}

TEST(CurvePlot, IsAsItWas) {
  const std::string golden = "src/tools/incident_reports/golden/speed_plot.html";
  const PlotFrame frame{kDetectedAt - 4,
                        kDetectedAt + 4,
                        kDetectedAt,
                        {{Mark::Kind::kDetected, kDetectedAt, "TooFast detected"},
                         {Mark::Kind::kDecided, kDetectedAt + 0.01, "drive is held responsible"},
                         {Mark::Kind::kDecided, kDetectedAt + 0.02, "one sign is enough"},
                         {Mark::Kind::kResolved, kDetectedAt + 2, "TooFast resolved"},
                         {Mark::Kind::kGivenUp, kDetectedAt + 5, "not within the picture"}}};
  const std::string drawn = plot_of(speed_curve(), frame, 1);
  if (std::getenv("CULPRIT_WRITE_GOLDEN") != nullptr) std::ofstream(golden) << drawn;
  std::ostringstream before;
  before << std::ifstream(golden).rdbuf();
  EXPECT_EQ(drawn, before.str()) << golden;
}

// It would make the curve a line without a shape.
TEST(CurvePlot, NamesALimitThatIsFarAwayAndDoesNotDrawIt) {
  Curve curve = speed_curve();
  curve.limits = {2.5, 1000};
  curve.unit = "m/s";
  const std::string drawn = plot_of(curve, {kDetectedAt - 4, kDetectedAt + 4, kDetectedAt, {}}, 1);
  EXPECT_THAT(drawn, HasSubstr("read by TooFast; its limit of 1e+03 m/s is far away"));
  EXPECT_THAT(drawn, Not(HasSubstr("a rule's limit: 1e+03")));
  EXPECT_THAT(drawn, HasSubstr("a rule's limit: 2.5"));
}

TEST(CurvePlot, IsFiniteWhateverTheNumbersAre) {
  for (const double value : {0.0, 1e300, -1e300, 1e-300}) {
    for (const double seconds : {0.0, 1e-9, 4e9}) {
      Curve curve{"n", "", "s", {value, 1e300}, {{0, value}, {1, -value}, {2, 0}}, 0};
      const std::string drawn = plot_of(curve, {0, seconds, kDetectedAt, {}}, 1);
      EXPECT_THAT(drawn, AllOf(Not(HasSubstr("nan")), Not(HasSubstr("inf")), HasSubstr("</svg>")))
          << value << " " << seconds;
    }
  }
}

TEST(IncidentWords, TellHowItEndedAndHowLongItTook) {
  Incident incident;
  incident.rules = {"R"};
  EXPECT_EQ(cause_of(incident), "R");
  EXPECT_EQ(outcome_of(incident), "not over");
  incident.is_over = true;
  EXPECT_EQ(outcome_of(incident), "cleared without a repair");
  incident.causes = {"a", "b", "c"};
  EXPECT_EQ(cause_of(incident), "a, b and c");
  incident.is_given_up = true;
  EXPECT_EQ(outcome_of(incident), "exhausted: a person must look");
  for (const auto& [seconds, text] : {std::pair{0.0, "0.0 s"},
                                      {0.0401, "40 ms"},
                                      {9.94, "9.9 s"},
                                      {11.6, "12 s"},
                                      {185.0, "3 min 5 s"},
                                      {7800.0, "2 h 10 min"},
                                      {97'300.0, "1 d 3 h"}})
    EXPECT_EQ(lasting_text(seconds), text);
}

}  // namespace
}  // namespace culprit::incident_reports
