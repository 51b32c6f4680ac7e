#include "suave_study/recorded.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/core.h>

#include "base/text_file.h"
#include "suave_study/run.h"

namespace culprit::study {
namespace {

// Takes a line of CSV off the front of `text`; a quoted field may span lines.
std::vector<std::string> take_line(std::string_view& text) {
  std::vector<std::string> fields(1);
  bool is_quoted = false;
  std::size_t i = 0;
  for (; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      const bool is_doubled = is_quoted && i + 1 < text.size() && text[i + 1] == '"';
      if (is_doubled) fields.back() += text[++i];
      if (!is_doubled) is_quoted = !is_quoted;
    } else if (c == ',' && !is_quoted) {
      fields.emplace_back();
    } else if (c == '\n' && !is_quoted) {
      break;
    } else if (c != '\r' || is_quoted) {
      fields.back() += c;
    }
  }
  text.remove_prefix(std::min(i + 1, text.size()));
  return fields;
}

std::optional<double> amount(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return std::isfinite(value) && value >= 0 ? std::optional(value) : std::nullopt;
}

// "suave_extended rosa_bt": the mission's name and the manager's.
std::string manager_of(const std::string& mission) {
  const std::string manager = mission.substr(mission.find_last_of(' ') + 1);
  return manager == "rosa_bt" ? "rosa" : manager;
}

bool is_known(const std::string& manager) {
  const auto all = suave_contenders();
  return std::any_of(all.begin(), all.end(),
                     [&](const SuaveContender& each) { return each.name == manager; });
}

struct RecordedRun {
  std::string manager;
  double search_s;
  double distance_m;
};

void add(const RecordedRun& run, RecordedCampaign& campaign) {
  if (!is_known(run.manager)) {
    if (std::count(campaign.unknown.begin(), campaign.unknown.end(), run.manager) == 0)
      campaign.unknown.push_back(run.manager);
    return;
  }
  auto row = std::find_if(campaign.rows.begin(), campaign.rows.end(),
                          [&](const RecordedRow& each) { return each.manager == run.manager; });
  if (row == campaign.rows.end()) row = campaign.rows.insert(row, {run.manager, {}, {}});
  row->search_s.add(run.search_s);
  row->distance_m.add(run.distance_m);
}

}  // namespace

Expected<void> add_recorded(std::string_view name, std::string_view text,
                            RecordedCampaign& campaign) {
  const std::vector<std::string> head = take_line(text);
  const auto column = [&](std::string_view title) -> Expected<std::size_t> {
    const auto found = std::find(head.begin(), head.end(), title);
    if (found != head.end()) return static_cast<std::size_t>(found - head.begin());
    return Error{
        fmt::format("{}:1: there is no column \"{}\"; is it a file of SUAVE's runs?", name, title)};
  };
  const auto mission = column("mission name");
  const auto search = column("time searching pipeline (s)");
  const auto distance = column("distance inspected (m)");
  for (const auto* each : {&mission, &search, &distance})
    if (!*each) return Error{each->error()};

  std::vector<RecordedRun> runs;
  for (int line = 2; !text.empty(); ++line) {
    const std::vector<std::string> fields = take_line(text);
    if (fields == std::vector<std::string>{""}) continue;
    if (fields.size() != head.size())
      return Error{fmt::format("{}: record {} has {} fields, but the head has {}", name, line,
                               fields.size(), head.size())};
    // A spreadsheet's lines of means have no mission.
    if (fields[*mission].empty()) continue;
    const auto search_s = amount(fields[*search]);
    const auto distance_m = amount(fields[*distance]);
    if (!search_s || !distance_m)
      return Error{fmt::format("{}: record {}: '{}' is no number of at least 0", name, line,
                               fields[search_s ? *distance : *search])};
    runs.push_back({manager_of(fields[*mission]), *search_s, *distance_m});
  }
  for (const RecordedRun& run : runs) add(run, campaign);
  return {};
}

Expected<RecordedCampaign> read_recorded(const std::vector<std::string>& paths) {
  RecordedCampaign campaign;
  for (const std::string& path : paths) {
    const auto text = read_text(path);
    if (!text) return Error{text.error()};
    if (auto added = add_recorded(path, *text, campaign); !added) return Error{added.error()};
  }
  if (campaign.rows.empty()) return Error{"there is no run of a manager that the study has"};
  return campaign;
}

}  // namespace culprit::study
