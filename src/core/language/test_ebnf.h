// A grammar in EBNF (ISO/IEC 14977, without comments inside productions' names), to make sentences
// of and to take them apart.
//
// Productions whose names begin with a capital are tokens; between the pieces of the others blanks
// may stand.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

namespace culprit {

class Grammar {
 public:
  // What a special sequence, ? like this ?, stands for.
  struct Special {
    std::vector<std::string> samples;  // none: it is in no sentence that is made
    // How many bytes at `at` it is; empty: it is not.
    std::optional<std::size_t> (*match)(const std::string& text, std::size_t at);
  };
  using Specials = std::map<std::string, Special>;
  using Productions = std::set<std::string>;

  // Throws std::runtime_error if `text` is no grammar, or uses what it does not define.
  Grammar(const std::string& text, Specials specials);
  ~Grammar();
  Grammar(const Grammar&) = delete;

  Productions productions() const;

  // A random sentence; the productions that it is made of are entered into `used`. Productions that
  // are nested deeper than `depth` are as short as they can be.
  std::string sentence(const std::string& start, int depth, std::mt19937& random,
                       Productions& used) const;

  // The productions that `text` is made of, if it is a sentence.
  std::optional<Productions> derive(const std::string& start, const std::string& text) const;

  struct Node;

 private:
  Specials specials_;
  std::map<std::string, std::unique_ptr<Node>> bodies_;
};

}  // namespace culprit
