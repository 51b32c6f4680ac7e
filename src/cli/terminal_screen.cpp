#include "cli/terminal_screen.h"

#include <algorithm>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "terminal/console.h"

namespace culprit::cli {
namespace {

// ECMA-48 and xterm: another screen, and no cursor on it.
constexpr const char* kEnter = "\033[?1049h\033[?25l";
constexpr const char* kLeave = "\033[?25h\033[?1049l";
constexpr const char* kHome = "\033[H";
constexpr const char* kEndOfLine = "\033[0m\033[K\r\n";
constexpr const char* kClearRest = "\033[J";

}  // namespace

TerminalScreen::TerminalScreen() {
  tcgetattr(STDIN_FILENO, &before_);
  termios raw = before_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  raw.c_cc[VMIN] = 0;
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  say_text(stdout, kEnter);
}

TerminalScreen::~TerminalScreen() {
  say_text(stdout, kLeave);
  tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

TerminalScreen::Size TerminalScreen::size() {
  winsize window{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_row == 0 || window.ws_col == 0)
    return {};
  return {window.ws_row, window.ws_col};
}

void TerminalScreen::draw(const std::vector<std::string>& lines) {
  const Size window = size();
  std::string text = kHome;
  const std::size_t count = std::min(lines.size(), window.rows - 1);
  for (std::size_t i = 0; i < count; ++i) text += cut_to(lines[i], window.columns) + kEndOfLine;
  say_text(stdout, text + kClearRest);
}

char TerminalScreen::key(int milliseconds) {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char key = 0;
  if (poll(&input, 1, milliseconds) <= 0 || read(STDIN_FILENO, &key, 1) != 1) return 0;
  return key;
}

std::string cut_to(const std::string& line, std::size_t columns) {
  std::string out;
  std::size_t shown = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\033') {  // up to its letter, and of no width
      do out += line[i];
      while (line[i] != 'm' && ++i < line.size());
      continue;
    }
    const bool is_first_byte = (static_cast<unsigned char>(line[i]) & 0xc0) != 0x80;
    if (is_first_byte && shown++ == columns) break;
    out += line[i];
  }
  return out;
}

}  // namespace culprit::cli
