#include "apps/pages/page_arrays.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/apps/page_reader.hpp"

namespace clearway {
namespace page_arrays_test {

using nlohmann::json;

PageReader read_back(const PageArrays& arrays) {
  return PageReader(
      "<script type=\"application/json\" id=\"page\">{}</script>"
      "<script type=\"text/plain\" id=\"arrays\">" +
      arrays.encode() + "</script>");
}

json place(const ArrayPlace& at) { return {{"type", at.type}, {"offset", at.offset}, {"count", at.count}}; }

TEST(PageArrays, ComeBackAsTheyWereWhateverTheirLengths) {
  std::mt19937_64 random(3);
  for (std::size_t length = 0; length < 40; ++length) {
    PageArrays arrays;
    std::string bytes(length, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    std::vector<std::uint16_t> shorts(length, static_cast<std::uint16_t>(random()));
    std::vector<std::uint32_t> words(length, static_cast<std::uint32_t>(random()));
    std::vector<float> floats(length, static_cast<float>(length) / 7.0F);
    const ArrayPlace b = arrays.add(std::string_view(bytes)),
                     s = arrays.add(std::span<const std::uint16_t>(shorts)),
                     w = arrays.add(std::span<const std::uint32_t>(words)),
                     f = arrays.add(std::span<const float>(floats));
    const PageReader reader = read_back(arrays);
    const auto back = reader.array<char>(place(b));
    EXPECT_EQ(std::string(back.begin(), back.end()), bytes);
    EXPECT_EQ(reader.array<std::uint16_t>(place(s)), shorts);
    EXPECT_EQ(reader.array<std::uint32_t>(place(w)), words);
    EXPECT_EQ(reader.array<float>(place(f)), floats);
  }
}

TEST(PageArrays, LargerThanZlibsBuffersComeBackWhole) {
  std::mt19937 random(4);
  std::vector<std::uint32_t> noise(1 << 19);
  for (std::uint32_t& word : noise) word = random();
  PageArrays arrays;
  const ArrayPlace at = arrays.add(std::span<const std::uint32_t>(noise));
  EXPECT_EQ(read_back(arrays).array<std::uint32_t>(place(at)), noise);
}

TEST(PageArrays, WithNothingInThemAreStillReadable) { EXPECT_NO_THROW(read_back(PageArrays())); }

}  // namespace page_arrays_test
}  // namespace clearway
