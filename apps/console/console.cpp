#include "apps/console/console.hpp"

#include <algorithm>
#include <ostream>

#include "apps/console/plain_stream.hpp"

namespace clearway {

Console::Console(std::ostream& out, std::ostream& log, bool is_terminal, std::istream* in)
    : in_(in != nullptr ? in : &nothing_), out_(&out), log_(&log), is_terminal_(is_terminal) {}

void Console::log(std::string_view line) {
  if (quiet) return;
  clear_bar();
  *log_ << plain_lines(line) << '\n' << std::flush;
}

void Console::warn(std::string_view line) {
  clear_bar();
  *log_ << plain_lines(line) << '\n' << std::flush;
}

void Console::note(const std::string& sentence) {
  if (!sentence.empty()) warn("note: " + sentence);
}

void Console::note(const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences) note(sentence);
}

void Console::progress(std::string_view stage, double fraction) {
  if (quiet || !is_terminal_) return;
  const int permille = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * 1000.0);
  if (permille == 1000) return clear_bar();
  if (permille == drawn_) return;
  drawn_ = permille;
  constexpr int width = 40;
  const int filled = permille * width / 1000;
  *log_ << '\r' << stage << " [" << std::string(filled, '=') << std::string(width - filled, ' ') << "] "
        << permille / 10 << " %\x1b[K" << std::flush;
}

std::function<void(double)> Console::bar(std::string stage) {
  return [this, name = std::move(stage)](double fraction) { progress(name, fraction); };
}

void Console::clear_bar() {
  if (drawn_ >= 0) *log_ << "\r\x1b[K" << std::flush;
  drawn_ = -1;
}

}  // namespace clearway
