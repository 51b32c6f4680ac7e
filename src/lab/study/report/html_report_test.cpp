#include "study/report/html_report.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "study/plot/plots.h"
#include "study/test_findings.h"

namespace culprit::study {
namespace {

const std::string& report() {
  static const std::string kReport =
      html_report(synthetic_findings(60), "Synthetic <study> & test");
  return kReport;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

// To look at: CULPRIT_WRITE_REPORT=<file>.
TEST(HtmlReport, HoldsEverything) {
  if (const char* path = std::getenv("CULPRIT_WRITE_REPORT"))
    std::ofstream(path, std::ios::binary) << report();
  EXPECT_EQ(count(report(), "<table"), 10u);
  EXPECT_EQ(count(report(), "<figure id=\"plot-"), kMetricCount + 2);
  EXPECT_NE(report().find("SYNTHETIC DATA OF A TEST, NOT MEASURED"), std::string::npos);
  EXPECT_NE(report().find("<strong>32 of 32</strong>"), std::string::npos);
  EXPECT_EQ(report(), html_report(synthetic_findings(60), "Synthetic <study> & test"));
}

TEST(HtmlReport, NeedsNothingFromOutside) {
  EXPECT_EQ(count(report(), "src="), 0u);
  EXPECT_EQ(count(report(), "<link"), 0u);
  EXPECT_EQ(count(report(), "@import"), 0u);
  EXPECT_EQ(count(report(), "url("), 0u);
  EXPECT_EQ(count(report(), "https://"), 0u);
  EXPECT_EQ(count(report(), "http://"), 1u) << "the name of SVG, in the script";
}

TEST(HtmlReport, EscapesWhatComesFromOutside) {
  EXPECT_NE(report().find("Synthetic &lt;study&gt; &amp; test"), std::string::npos);
  Findings findings = synthetic_findings(2);
  findings.campaign.campaign.command = "<script>alert(1)</script>";
  findings.timelines[0].entries[0].text = "</script><script>alert(2)</script>";
  findings.timelines[0].scenario = "<!--";
  findings.learning[0].strategy = "<b>\"'\x01";
  const std::string page = html_report(findings, "t");
  EXPECT_EQ(count(page, "<script>alert"), 0u);
  EXPECT_EQ(count(page, "</script>"), 2u);
  EXPECT_EQ(count(page, "<!--"), 0u);
  EXPECT_EQ(count(page, "<b>"), 0u);
  EXPECT_EQ(count(page, "\x01"), 0u);
}

TEST(HtmlReport, LeavesOutWhatThereIsNot) {
  const std::string page = html_report({synthetic_result(2), {}, {}}, "t");
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("Timeline of a run"), std::string::npos);
}

TEST(Plots, AreWrittenAsFilesOfTheirOwn) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "culprit-plots";
  std::filesystem::remove_all(folder);
  const auto written = write_plots(synthetic_findings(60), folder);
  ASSERT_TRUE(written) << written.error();
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    ++files;
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string svg(std::istreambuf_iterator<char>(in), {});
    EXPECT_TRUE(svg.starts_with("<?xml")) << entry.path();
    EXPECT_TRUE(svg.ends_with("</svg>\n")) << entry.path();
    EXPECT_EQ(count(svg, "nan"), 0u) << entry.path();
    EXPECT_EQ(count(svg, "inf"), 0u) << entry.path();
  }
  EXPECT_EQ(files, kMetricCount + 2);
  std::ofstream(folder / "file") << "x";
  EXPECT_FALSE(write_plots(synthetic_findings(1), folder / "file"));
}

// One run, no spread, no intervals, no values: there is still something to draw.
TEST(Plots, OfHardlyAnyDataAreWhole) {
  Campaign campaign;
  campaign.rows.resize(2);
  campaign.rows[1].planner = "bayes";
  campaign.runs = 1;
  CampaignFold fold(campaign);
  fold.add({});
  RunMetrics negative;
  negative.unnecessary_redeployments = -2;
  negative.downtime_s = 1e9;
  negative.is_left_out = true;
  fold.add(negative);
  for (const NamedPlot& plot : plots({fold.result(), {{"F1", "r", "s", 0.5, 0.5, {}}}, {}})) {
    const std::string svg = plot.svg.inside_page();
    EXPECT_EQ(count(svg, "nan"), 0u) << plot.id;
    EXPECT_EQ(count(svg, "inf"), 0u) << plot.id;
  }
}

}  // namespace
}  // namespace culprit::study
