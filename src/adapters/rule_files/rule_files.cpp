#include "rule_files/rule_files.h"

#include <algorithm>

#include "base/closest.h"
#include "base/environment.h"

namespace culprit::rule_files {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExtension = ".rules";
constexpr std::size_t kMostIncludable = 300;
constexpr std::size_t kMostLookedAt = 10'000;
constexpr int kDeepest = 8;  // folders below one another that are looked into

fs::path folder_of(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

bool is_hidden(const fs::path& path) { return path.filename().native().starts_with('.'); }

// Files below `folder`, as they are called from there, after a look at so many of all.
std::vector<fs::path> below(const fs::path& folder, const std::string& extension,
                            std::size_t most = static_cast<std::size_t>(-1)) {
  std::vector<fs::path> all;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied,
                                              error);
       !error && entry != fs::recursive_directory_iterator() && most-- > 0;
       entry.increment(error)) {
    const bool is_folder = entry->is_directory(error);
    if (is_folder && (is_hidden(entry->path()) || entry.depth() >= kDeepest)) {
      entry.disable_recursion_pending();
    } else if (!is_folder && !is_hidden(entry->path()) && entry->path().extension() == extension) {
      all.push_back(entry->path().lexically_relative(folder));
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

// The file that `file` was probably meant to name: one beside its expected place.
std::string near_file(const fs::path& file, const std::vector<fs::path>& places) {
  for (const fs::path& place : places) {
    std::vector<std::string> names;
    std::error_code error;
    for (fs::directory_iterator entry(place.parent_path(), error);
         !error && entry != fs::directory_iterator(); entry.increment(error)) {
      if (entry->path().extension() == kExtension) names.push_back(entry->path().filename());
    }
    const std::string near = closest(file.filename().native(), {names.begin(), names.end()});
    if (!near.empty()) return (file.parent_path() / near).string();
  }
  return "";
}

}  // namespace

const fs::path& installed() {
  static const fs::path kFolder = (own_folder() / "../share/culprit/rules").lexically_normal();
  return kFolder;
}

Expected<Source> load(const std::string& file, const std::string& from) {
  const fs::path name(file);
  if (name.extension() != kExtension) {
    const bool is_yaml = name.extension() == ".yaml" || name.extension() == ".yml";
    return Error{
        "a file that is included is called *.rules, and not '" + file + "'; " +
        (is_yaml ? "parameters of a node stand behind --params-file in its LAUNCH" : "rename it")};
  }
  std::vector<fs::path> places = {(folder_of(from) / name).lexically_normal()};
  if (name.is_relative()) places.push_back((installed() / name).lexically_normal());
  for (const fs::path& place : places) {
    std::error_code error;
    if (fs::is_regular_file(place, error)) return Source::read(place.string());
  }
  const std::string near = near_file(name, places);
  std::string where = " in " + fs::path(places[0].parent_path()).string();
  if (places[0].parent_path().empty()) where = " in this folder";
  if (places.size() > 1) where += ", nor in " + installed().string();
  return Error{"there is no '" + file + "'" + where +
               (near.empty() ? "" : "; did you mean '" + near + "'?")};
}

Expected<Expansion> read(const std::string& path) {
  auto source = Source::read(path);
  if (!source) {
    std::error_code error;
    const bool is_there = fs::exists(path, error);
    const std::string near = is_there ? "" : near_file(path, {fs::absolute(path, error)});
    return Error{source.error() + (near.empty() ? "" : "; did you mean '" + near + "'?")};
  }
  return expand(std::move(*source), load);
}

std::vector<std::string> includable(const std::string& from) {
  std::vector<std::string> names;
  for (const fs::path& folder : {folder_of(from), installed()}) {
    for (const fs::path& file : below(folder, kExtension, kMostLookedAt)) {
      if (names.size() < kMostIncludable && (folder / file).lexically_normal() != from)
        names.push_back(file.string());
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

Expected<std::vector<std::string>> files_in(const std::string& path, const std::string& extension) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return std::vector<std::string>{path};
  std::vector<std::string> all;
  for (const fs::path& file : below(path, extension))
    all.push_back((fs::path(path) / file).string());
  if (all.empty()) return Error{"there is no *" + extension + " in " + path};
  return all;
}

}  // namespace culprit::rule_files
