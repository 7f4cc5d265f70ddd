#include "apps/console/plain_stream.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace clearway {
namespace plain_stream_test {

TEST(PlainStream, a_name_from_a_file_cannot_command_the_terminal) {
  std::ostringstream target;
  PlainBuffer plain(target);
  std::ostream out(&plain);
  out << "a\tb\xc2";  // a character in two parts
  EXPECT_EQ(target.str(), "");
  out << "\xb5m \x1b[1m\n" << 'c';
  EXPECT_EQ(target.str(), "a\tb\xc2\xb5m \\x1b[1m\n");
  out.flush();
  EXPECT_TRUE(target.str().ends_with("\nc"));
}

TEST(PlainStream, results_that_could_not_be_written_are_noticed) {
  struct Full : std::streambuf {
  } full;
  std::ostream target(&full);
  PlainBuffer plain(target);
  std::ostream out(&plain);
  out << "x\n";
  EXPECT_FALSE(out.flush());
}

}  // namespace plain_stream_test
}  // namespace clearway
