// The colours of text on the pages: WCAG 2.2, contrast (minimum), 4.5 : 1.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <regex>
#include <string>

namespace clearway {
namespace theme_test {

/// Of the light or the dark theme, "--name: #rrggbb".
std::map<std::string, std::string> colours(const std::string& selector) {
  std::ifstream stream(std::string(CLEARWAY_SOURCE_DIR) + "/apps/viewer/src/theme.css");
  const std::string css((std::istreambuf_iterator<char>(stream)), {});
  const std::size_t at = css.find(selector + " {");
  EXPECT_NE(at, std::string::npos);
  const std::string block = css.substr(at, css.find('}', at) - at);
  std::map<std::string, std::string> found;
  const std::regex entry("--([a-z-]+): (#[0-9a-f]{6});");
  for (std::sregex_iterator i(block.begin(), block.end(), entry), end; i != end; ++i)
    found[(*i)[1]] = (*i)[2];
  return found;
}

/// Relative luminance as WCAG defines it.
double luminance(const std::string& hex) {
  constexpr std::array<double, 3> weights{0.2126, 0.7152, 0.0722};
  double sum = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double value = std::stoi(hex.substr(1 + 2 * k, 2), nullptr, 16) / 255.0;
    sum += weights[k] * (value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
  }
  return sum;
}

double contrast(const std::string& a, const std::string& b) {
  const double x = luminance(a), y = luminance(b);
  return (std::max(x, y) + 0.05) / (std::min(x, y) + 0.05);
}

TEST(Theme, TextStandsOutFromWhatItIsWrittenOn) {
  EXPECT_NEAR(contrast("#ffffff", "#000000"), 21.0, 1e-9);
  EXPECT_NEAR(contrast("#777777", "#ffffff"), 4.48, 0.005);  // known to just fail
  for (const char* selector : {":root", ":root[data-theme=\"dark\"]"}) {
    auto of = colours(selector);
    for (const char* text : {"ink", "muted", "accent"})
      for (const char* ground : {"page", "card", "hover", "accent-soft"})
        EXPECT_GE(contrast(of[text], of[ground]), 4.5) << selector << ' ' << text << " on " << ground;
    for (const char* badge : {"good", "bad", "warn"})
      for (const std::string& ground :
           {std::string(badge) + "-soft", std::string("card"), std::string("page")})
        EXPECT_GE(contrast(of[badge], of[ground]), 4.5) << selector << ' ' << badge << " on " << ground;
  }
}

}  // namespace theme_test
}  // namespace clearway
