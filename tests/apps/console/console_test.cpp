#include "apps/console/console.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace clearway {
namespace console_test {

TEST(Console, draws_a_bar_on_a_terminal_only_and_leaves_no_trace_of_it_at_the_end) {
  std::ostringstream out, log;
  Console terminal(out, log, true);
  for (int i = 0; i <= 100; ++i) terminal.progress("fusing", i / 100.0);
  const std::string drawn = log.str();
  EXPECT_NE(drawn.find("fusing [====================                    ] 50 %"), std::string::npos);
  EXPECT_TRUE(drawn.ends_with("\r\x1b[K"));
  EXPECT_EQ(std::count(drawn.begin(), drawn.end(), '\n'), 0);
  const std::size_t before = log.str().size();
  terminal.progress("fusing", 1.0);
  EXPECT_EQ(log.str().size(), before);

  std::ostringstream file;
  Console plain(out, file, false);
  plain.progress("fusing", 0.5);
  EXPECT_TRUE(file.str().empty());
  EXPECT_TRUE(out.str().empty());
}

TEST(Console, a_line_of_log_replaces_the_bar_and_quiet_silences_all_but_warnings) {
  std::ostringstream out, log;
  Console console(out, log, true);
  console.progress("fusing", 0.5);
  console.log("planning");
  EXPECT_TRUE(log.str().ends_with("\r\x1b[Kplanning\n"));
  log.str("");
  console.quiet = true;
  console.progress("fusing", 0.6);
  console.log("planning");
  EXPECT_TRUE(log.str().empty());
  console.warn("clearway: no");
  EXPECT_EQ(log.str(), "clearway: no\n");
}

TEST(Console, a_name_from_a_file_cannot_command_the_terminal) {
  std::ostringstream out, log;
  Console console(out, log);
  console.warn("label \x1b[2J");
  console.log("label \x1b]0;owned\a\r");
  EXPECT_EQ(log.str(), "label \\x1b[2J\nlabel \\x1b]0;owned\\x07\\r\n");
}

}  // namespace console_test
}  // namespace clearway
