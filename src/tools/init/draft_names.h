// Names for what a draft declares.
#pragma once

#include <set>
#include <string>

namespace culprit::init {

class Names {
 public:
  // The words of the language are taken.
  Names();

  // An identifier like `wanted` that is not used yet. With a number or `suffix` if necessary.
  std::string take(const std::string& wanted, const std::string& suffix = "");

 private:
  std::set<std::string> taken_;
};

}  // namespace culprit::init
