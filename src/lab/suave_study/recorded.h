// Runs of the real exemplar, from the files that it writes: a header and a line for each run (CSV,
// RFC 4180).
//
//     mission name,datetime,"initial pos (x,y)",mission duration (s),pipeline found,time searching
//     pipeline (s),... suave
//     bt,01-Jul-2025-00-43-53,"(-17.0, 2.8)",250,True,117,33.6140403747559,0.0903712505
//
// It reads three columns, in any order: "mission name", whose last word is the manager; "time
// searching pipeline (s)", which is the whole mission if the pipeline was not found; and "distance
// inspected (m)". A line without a mission's name is no run. A campaign may be in several files,
// usually one for each manager.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "study/statistics/moments.h"

namespace culprit::study {

struct RecordedRow {
  std::string manager;  // as ours are called; the exemplar's "rosa_bt" is "rosa"
  Moments search_s;
  Moments distance_m;
};

struct RecordedCampaign {
  std::vector<RecordedRow> rows;     // as the managers first occur
  std::vector<std::string> unknown;  // managers that the study has not; their runs are left out
};

// Adds the runs of one file. `name` is the file's, for errors: a column is missing, a line has too
// few fields, or a field is no finite number of at least 0. In that case no run was added.
Expected<void> add_recorded(std::string_view name, std::string_view text,
                            RecordedCampaign& campaign);

// Errors also: a file cannot be read, or all have no run of a manager that the study has.
Expected<RecordedCampaign> read_recorded(const std::vector<std::string>& paths);

}  // namespace culprit::study
