#include "study/report/html_report.h"

#include <fmt/core.h>

#include "json/json.h"
#include "study/comparison.h"
#include "study/markup.h"
#include "study/plot/plots.h"
#include "study/report/assets.h"
#include "study/report/page.h"
#include "study/tables/render.h"
#include "study/tables/study_tables.h"

namespace culprit::study {
namespace {

std::string provenance(const Campaign& campaign) {
  return "<dl class=\"facts\">\n" +
         page_fact("Command", "<code>" + markup_escaped(campaign.command) + "</code>") +
         page_fact("Seed", fmt::format("<code>{}</code>", campaign.seed)) +
         page_fact("Version", "culprit " + markup_escaped(campaign.version)) +
         page_fact("Runs", fmt::format("{} configurations × {} runs", campaign.rows.size(),
                                       campaign.runs)) +
         "</dl>\n<p>The command with this seed and this version gives this page again, to the last "
         "digit.</p>\n";
}

std::string score(int part, int whole, const std::string& what) {
  return fmt::format("<div class=\"score\"><strong>{} of {}</strong><span>{}</span></div>\n", part,
                     whole, what);
}

std::string agreement_html(const Ablation& ablation) {
  const Agreement count = agreement(ablation);
  return fmt::format("<h3>{} planner, {} profile</h3>\n<div class=\"scores\">\n{}{}{}</div>\n",
                     markup_escaped(ablation.planner), markup_escaped(ablation.profile),
                     score(count.means_within, count.means, "means within the paper's mean ± 1 sd"),
                     score(count.significant_signs, count.significant,
                           "significant effects with the paper's sign"),
                     score(count.same_significance, count.effects,
                           "effects with the paper's verdict (better, worse, not significant)"));
}

std::string agreements(const std::vector<Ablation>& found) {
  if (found.empty()) return "";
  std::string out = "<section id=\"agreement\">\n<h2>Agreement with the paper</h2>\n";
  for (const Ablation& ablation : found) out += agreement_html(ablation);
  return out + "</section>\n";
}

std::string table_section(const Findings& findings) {
  std::string out = "<section id=\"tables\">\n<h2>Tables</h2>\n";
  for (const Table& table : tables(findings)) out += html(table);
  return out + "</section>\n";
}

std::string plot_section(const Findings& findings) {
  std::string out = "<section id=\"plots\">\n<h2>Plots</h2>\n<div class=\"plots\">\n";
  for (const NamedPlot& plot : plots(findings)) {
    out += fmt::format(
        "<figure id=\"plot-{}\">\n<figcaption><strong>{}</strong> {}</figcaption>\n{}</figure>\n",
        plot.id, markup_escaped(plot.title), markup_escaped(plot.caption), plot.svg.inside_page());
  }
  return out + "</div>\n</section>\n";
}

std::string timeline_label(const Timeline& timeline) {
  std::string text = fmt::format("run {} of {}", timeline.run, label(timeline.configuration));
  if (!timeline.scenario.empty()) text += ": " + timeline.scenario;
  return text;
}

// JSON for a <script> element: nothing in it can end the element.
std::string embedded(const std::vector<Timeline>& timelines) {
  Json runs = Json::array();
  for (const Timeline& timeline : timelines) {
    Json entries = Json::array();
    for (const TimelineEntry& entry : timeline.entries) {
      entries.push_back({{"time", entry.time_s},
                         {"kind", name(entry.kind)},
                         {"text", entry.text},
                         {"component", entry.component}});
    }
    runs.push_back({{"label", timeline_label(timeline)}, {"entries", std::move(entries)}});
  }
  std::string out;
  for (const char c : runs.dump(-1, ' ', true, Json::error_handler_t::replace)) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

std::string timeline_section(const std::vector<Timeline>& timelines) {
  if (timelines.empty()) return "";
  return "<section id=\"runs\">\n"
         "<h2>Timeline of a run</h2>\n"
         "<p>Failures, blamed components, and repairs. A broad line shows how long a component was "
         "failing.</p>\n"
         "<noscript><p>The timelines need JavaScript; all else on this page does "
         "not.</p></noscript>\n"
         "<div class=\"chooser\"><label for=\"run\">Run</label><select id=\"run\"></select></div>\n"
         "<ul class=\"kinds\" id=\"kinds\"></ul>\n"
         "<div id=\"timeline-drawing\"></div>\n"
         "<div class=\"wide\"><table id=\"timeline-table\">\n"
         "<caption>The same in words</caption>\n"
         "<thead><tr><th scope=\"col\" class=\"right\">time [s]</th><th scope=\"col\" "
         "class=\"left\">kind</th><th scope=\"col\" class=\"left\">component</th><th scope=\"col\" "
         "class=\"left\">what</th></tr></thead>\n"
         "<tbody></tbody>\n"
         "</table></div>\n"
         "</section>\n"
         "<script type=\"application/json\" id=\"timelines\">" +
         embedded(timelines) + "</script>\n<script>\n" + kReportScript + "</script>\n";
}

std::string contents(const Findings& findings, bool has_agreement) {
  const auto entry = [](const char* id, const char* name) {
    return fmt::format("<li><a href=\"#{}\">{}</a></li>", id, name);
  };
  std::string out = "<nav aria-label=\"Contents\"><ul>";
  if (has_agreement) out += entry("agreement", "Agreement with the paper");
  out += entry("tables", "Tables") + entry("plots", "Plots");
  if (!findings.timelines.empty()) out += entry("runs", "Timeline of a run");
  return out + "</ul></nav>\n";
}

}  // namespace

std::string html_report(const Findings& findings, const std::string& title) {
  const std::vector<Ablation> found = ablations(findings.campaign);
  return page_head(title) +
         "<body>\n<a class=\"skip\" href=\"#main\">Skip to the results</a>\n<header>\n<h1>" +
         markup_escaped(title) + "</h1>\n" + provenance(findings.campaign.campaign) +
         contents(findings, !found.empty()) + "</header>\n<main id=\"main\">\n" +
         agreements(found) + table_section(findings) + plot_section(findings) +
         timeline_section(findings.timelines) + "</main>\n</body>\n</html>\n";
}

}  // namespace culprit::study
