// A terminal that is drawn on as a whole, and is as it was before when this ends.
#pragma once

#include <string>
#include <termios.h>
#include <vector>

namespace culprit::cli {

class TerminalScreen {
 public:
  // @pre the standard input and output are terminals
  TerminalScreen();
  ~TerminalScreen();
  TerminalScreen(const TerminalScreen&) = delete;

  struct Size {
    std::size_t rows = 24;
    std::size_t columns = 80;
  };
  static Size size();

  // Shows these lines from the top; what does not fit is left out.
  void draw(const std::vector<std::string>& lines);
  // The key that was pressed; 0: none was within the time.
  char key(int milliseconds);

 private:
  termios before_{};
};

// The first so many columns of a line, which may hold colours and UTF-8. A character counts as one
// column.
std::string cut_to(const std::string& line, std::size_t columns);

}  // namespace culprit::cli
