#include "apps/inspect/picture.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace picture_test {

TEST(Picture, SpellsLettersThatItsFontLacks) {
  EXPECT_EQ(Picture::text_width("\u65e5"), Picture::text_width("U+65E5"));
  EXPECT_EQ(Picture::text_width("a \u65e5\u672c"), Picture::text_width("a U+65E5U+672C"));
  EXPECT_NE(Picture::text_width("\u00fc"), Picture::text_width("U+00FC"));  // it has that one
  Picture spelt(120, 30, {255, 255, 255}), written(120, 30, {255, 255, 255});
  spelt.write("\u65e5", 5, 20);
  written.write("U+65E5", 5, 20);
  EXPECT_EQ(spelt.png(), written.png());
}

}  // namespace picture_test
}  // namespace clearway
