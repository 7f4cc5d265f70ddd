#include "planning/robot_files/collada_check.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/worlds/mesh_samples.hpp"

namespace clearway {
namespace collada_check_test {

/// What is said of an ellipsoid's file in which `to` stands for `from`.
std::string refusal(const std::string& from, const std::string& to) {
  std::string text = as_dae(ellipsoid(3, 4, {0.1F, 0.2F, 0.3F}));  // 10 vertices
  text.replace(text.find(from), from.size(), to);
  try {
    checked_collada(text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(ColladaCheck, AUnitIsALengthThatPeopleUse) {
  for (const std::string good : {"1", "0.001", "0.0254", "1e-6", "1000"})
    EXPECT_EQ(refusal("meter='1'", "meter='" + good + "'"), "");
  EXPECT_EQ(refusal("meter='1'", ""), "");
  for (const std::string bad : {"0", "-1", "nan", "inf", "1e-9", "1e9", "0,01", "2m", ""})
    EXPECT_EQ(refusal("meter='1'", "meter='" + bad + "'"),
              "its <unit> has meter '" + bad + "', expected metres in [0.000001, 1000]");
}

TEST(ColladaCheck, CountsAndStridesStayWithinTheNumbersThatAreThere) {
  EXPECT_EQ(refusal("stride='3'", "stride='3' offset='0'"), "");
  const std::string accessor = "its <accessor> has ",
                    held = ", expected as many vertices as the <float_array> holds";
  EXPECT_EQ(refusal("stride='3'", "stride='0'"), accessor + "stride '0', expected 3 or more");
  EXPECT_EQ(refusal("stride='3'", ""), accessor + "stride '', expected 3 or more");
  EXPECT_EQ(refusal("stride='3'", "stride='-3'"), accessor + "stride '-3', expected a whole number");
  EXPECT_EQ(refusal("stride='3'", "stride='6'"), accessor + "count '10'" + held);
  EXPECT_EQ(refusal("stride='3'", "stride='3' offset='1'"), accessor + "count '10'" + held);
  EXPECT_EQ(refusal(" count='10'", " count='11'"), accessor + "count '11'" + held);
  EXPECT_EQ(refusal(" count='10'", " count='0'"), "");  // faces that name a vertex are refused by assimp
  EXPECT_EQ(refusal("count='30'", "count='29'"),
            "its <float_array> has count '29', expected the count of its numbers, 30");
  EXPECT_EQ(refusal("name='Y'", "name='y'"), "its <accessor> of positions has not the params X, Y and Z");
}

TEST(ColladaCheck, CoordinatesAndPosesOfNodesAreNumbers) {
  EXPECT_EQ(refusal("count='30'>", "count='31'> 2m"), "its <float_array> has '2m', expected numbers");
  EXPECT_EQ(refusal("<matrix>1 0", "<matrix>1 0,5"), "its <matrix> has '0,5', expected numbers");
  EXPECT_EQ(refusal("<matrix>", "<translate>1 2m 3</translate><matrix>"),
            "its <translate> has '2m', expected numbers");
  EXPECT_EQ(refusal("<matrix>", "<scale>\n+1 1.0e+0\t1 </scale><matrix>"), "");
}

TEST(ColladaCheck, InterleavedPositionsMayEndTheirArray) {
  // three other numbers before each vertex, none behind the last
  std::string text = as_dae(ellipsoid(3, 4, {0.1F, 0.2F, 0.3F}));
  const auto put = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  put("stride='3' count='10'", "stride='6' offset='3' count='5'");
  EXPECT_NO_THROW(checked_collada(text));
}

TEST(ColladaCheck, TextThatIsNoXmlIsRefused) {
  EXPECT_EQ(refusal("</COLLADA>", "").find("it cannot be read as .dae: line "), 0U);
}

}  // namespace collada_check_test
}  // namespace clearway
