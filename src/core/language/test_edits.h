// Edits of a rule file as people make them while they write it.
#pragma once

#include <string>

namespace culprit {

// A rule file of a few lines that make sense, with whatever edits make of it later. To be called
// within a property, as all here.
std::string random_start();

// `text` after one more edit: a keystroke, a line that comes, goes, is copied, split or joined, a
// part that is pasted or cut. The result may be no rules at all, and no UTF-8.
std::string edited(std::string text);

}  // namespace culprit
