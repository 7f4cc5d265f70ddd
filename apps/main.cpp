#include <unistd.h>

#include <iostream>
#include <string>
#include <vector>

#include "apps/command_line.hpp"
#include "apps/plain_stream.hpp"

int main(int argc, char** argv) {
  std::ios::sync_with_stdio(false);
  clearway::PlainBuffer plain(std::cout);
  std::ostream out(&plain);
  clearway::Console console(out, std::cerr, isatty(STDERR_FILENO) == 1);
  const int status = clearway::run_command_line(std::vector<std::string>(argv + 1, argv + argc), console);
  if (out.flush()) return status;
  console.warn("clearway: the result could not be written to standard output");
  return clearway::exit_bad_input;
}
