#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <iostream>
#include <string>
#include <vector>

#include "apps/commands/command_line.hpp"
#include "apps/console/plain_stream.hpp"
#include "mapping/system/interruption.hpp"

int main(int argc, char** argv) {
  // A file opened where a standard stream is missing would get what is written to that stream.
  int free_number = open("/dev/null", O_RDWR);
  while (free_number >= 0 && free_number <= STDERR_FILENO) free_number = open("/dev/null", O_RDWR);
  if (free_number >= 0) close(free_number);
  std::ios::sync_with_stdio(false);
  const bool is_terminal = isatty(STDERR_FILENO) == 1;
  clearway::PlainBuffer plain(std::cout);
  std::ostream out(&plain);
  clearway::Console console(out, std::cerr, is_terminal, &std::cin);
  // What fails then is reported as any other error: a file that grows too large, a reader that went away.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  clearway::end_in_order_on_signals([is_terminal](int signal, const std::string& what_is_there) {
    const std::string line = std::string(is_terminal ? "\r\x1b[K" : "") + "clearway: ended by SIG" +
                             sigabbrev_np(signal) + ": " + what_is_there + "\n";
    [[maybe_unused]] const ssize_t reported = write(STDERR_FILENO, line.data(), line.size());
  });
  const int status = clearway::run_command_line(std::vector<std::string>(argv + 1, argv + argc), console);
  if (out.flush()) return status;
  console.warn("clearway: the result could not be written to standard output");
  return clearway::exit_bad_input;
}
