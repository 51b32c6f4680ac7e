#include "suave_study/html_report.h"

#include <fmt/core.h>

#include "study/markup.h"
#include "study/report/page.h"
#include "study/tables/render.h"
#include "suave_study/report.h"
#include "suave_study/track_plot.h"

namespace culprit::study {
namespace {

std::string happenings(const Track& track) {
  std::string out = "<ol class=\"happenings\">\n";
  for (const TrackMark& mark : track.marks)
    out += fmt::format("<li>{:.1f} s: {}</li>\n", mark.time_s, markup_escaped(mark.what));
  return out + "</ol>\n";
}

std::string track_section(const std::vector<Track>& tracks) {
  std::string out = fmt::format(
      "<section id=\"tracks\">\n<h2>The first run of each manager</h2>\n"
      "<p>Seen from above, in metres. The broad line is the pipeline, the thin one the way of the "
      "vehicle; the dot is the vehicle, {:.0f} times as fast as it went. Numbers stand where "
      "something happened.</p>\n",
      kTrackSpeed);
  const TrackFrame frame = frame_of(tracks);
  for (const Track& track : tracks) {
    out += fmt::format("<figure id=\"track-{}\">\n<figcaption><strong>{}</strong></figcaption>\n",
                       safe_id(track.manager), markup_escaped(track.manager)) +
           track_plot(track, frame).inside_page() + happenings(track) + "</figure>\n";
  }
  return out + "</section>\n";
}

}  // namespace

std::string suave_html(const SuaveResult& result, const std::vector<Track>& tracks) {
  const SuaveCampaign& campaign = result.campaign;
  const std::string title = fmt::format("SUAVE, {} mission", campaign.plan->name);
  std::string out = page_head(title) + "<body>\n<header>\n<h1>" + title + "</h1>\n<p>" +
                    markup_escaped(campaign.plan->summary) + "</p>\n<dl class=\"facts\">\n" +
                    page_fact("Command", "<code>" + markup_escaped(campaign.command) + "</code>") +
                    page_fact("Seed", fmt::format("<code>{}</code>", campaign.seed)) +
                    page_fact("Version", "culprit " + markup_escaped(campaign.version)) +
                    page_fact("Runs", fmt::format("{} of each manager", campaign.runs)) +
                    "</dl>\n</header>\n<main>\n<section id=\"tables\">\n<h2>Tables</h2>\n";
  for (const Table& table : suave_tables(result)) out += html(table);
  return out + "</section>\n" + track_section(tracks) + "</main>\n</body>\n</html>\n";
}

}  // namespace culprit::study
