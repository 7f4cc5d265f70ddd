#pragma once

#include <functional>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// Where a command speaks: results to `out`, log and progress to `log`. Commands end with an ExitStatus and
/// never touch the process's streams themselves.
class Console {
 public:
  /// @param is_terminal progress bars are drawn only when `log` is a terminal.
  /// @param in what commands that answer lines read; null: nothing
  Console(std::ostream& out, std::ostream& log, bool is_terminal = false, std::istream* in = nullptr);

  bool quiet = false;  ///< no log, no progress; warnings and results still appear
  bool json = false;   ///< one JSON object on `out`, nothing else there

  bool is_terminal() const { return is_terminal_; }
  std::istream& in() { return *in_; }
  std::ostream& out() { return *out_; }
  /// One line of log, unless quiet.
  void log(std::string_view line);
  /// One line that is shown even when quiet.
  void warn(std::string_view line);
  /// warn() of "note: …"; an empty sentence is none.
  void note(const std::string& sentence);
  void note(const std::vector<std::string>& sentences);
  /// Redraws the bar of `stage` at `fraction` (0..1); at 1 it goes away.
  void progress(std::string_view stage, double fraction);
  /// `progress` bound to a stage, for functions that report a fraction.
  std::function<void(double)> bar(std::string stage);

 private:
  void clear_bar();
  std::istream nothing_{nullptr};
  std::istream* in_;
  std::ostream* out_;
  std::ostream* log_;
  bool is_terminal_ = false;
  int drawn_ = -1;  ///< last permille drawn, -1 none
};

/// Exit statuses of the program, fixed by the design page.
enum ExitStatus : int { exit_done = 0, exit_no = 1, exit_bad_input = 2, exit_damaged = 3 };

}  // namespace clearway
