#include "planning/robot_files/urdf_spelling.hpp"

#include <gtest/gtest.h>

#include "mapping/system/nearest_name.hpp"
#include "tests/worlds/hostile_robots.hpp"

namespace clearway {
namespace urdf_spelling_test {

TEST(MisspeltName, SlipsAreRecognisedAndOtherWordsLeftAlone) {
  const std::vector<std::string> known{"xyz", "rpy", "lower", "upper", "collision", "length"};
  for (const auto& [slip, meant] :
       std::vector<std::pair<std::string, std::string>>{{"xzy", "xyz"},
                                                        {"ypr", "rpy"},
                                                        {"XYZ", "xyz"},
                                                        {"uper", "upper"},
                                                        {"Lower", "lower"},
                                                        {"low", "lower"},
                                                        {"colision", "collision"},
                                                        {"lenght", "length"},
                                                        {"collisions", "collision"}}) {
    EXPECT_EQ(misspelt_name(slip, known), meant) << slip;
  }
  for (const std::string other :
       {"xyz", "lower", "name", "id", "visual", "acceleration", "contact", "", "collision_checking"}) {
    EXPECT_EQ(misspelt_name(other, known), "") << other;
  }
  EXPECT_EQ(misspelt_name(std::string(1'000'000, 'x'), known), "");
}

TEST(UrdfSpelling, NamesThatWouldDisappearInSilenceAreRefusedWithWhatWasMeant) {
  const RobotFolder folder;
  const std::string whole = two_links(
      "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' "
      "izz='1'/></inertial><collision><origin xyz='0 0 0.1' rpy='0 0 1'/><geometry><cylinder "
      "radius='0.1' length='1'/></geometry></collision>" +
          sphere_collision(),
      "revolute", "<origin xyz='1 0 0'/>" + free_turn());
  ASSERT_EQ(folder.refusal(whole), "accepted");
  struct Slip {
    std::string right, wrong, sentence;
  };
  for (const Slip& slip : std::vector<Slip>{
           {"<collision><geometry><sphere radius='0.1'/></geometry></collision>",
            "<colision><geometry><sphere radius='0.1'/></geometry></colision>",
            "link 'arm': unknown element <colision> in <link>, did you mean <collision>?"},
           {"rpy='0 0 1'", "ypr='0 0 1'",
            "link 'arm': <origin> has an unknown attribute 'ypr', did you mean 'rpy'?"},
           {"xyz='1 0 0'", "xzy='1 0 0'",
            "joint 'j': <origin> has an unknown attribute 'xzy', did you mean 'xyz'?"},
           {"<origin xyz='1 0 0'/>", "<orgin xyz='1 0 0'/>",
            "joint 'j': unknown element <orgin> in <joint>, did you mean <origin>?"},
           {"upper=", "uper=", "joint 'j': <limit> has an unknown attribute 'uper', did you mean 'upper'?"},
           {"<limit", "<limits", "joint 'j': unknown element <limits> in <joint>, did you mean <limit>?"},
           {"length='1'", "lenght='1'",
            "link 'arm': <cylinder> has an unknown attribute 'lenght', did you mean 'length'?"},
           {"radius='0.1' l", "radus='0.1' l",
            "link 'arm': <cylinder> has an unknown attribute 'radus', did you mean 'radius'?"},
           {"<axis xyz", "<Axis xyz", "joint 'j': unknown element <Axis> in <joint>, did you mean <axis>?"},
           {"<mass value", "<mas value",
            "link 'arm': unknown element <mas> in <inertial>, did you mean <mass>?"},
           {"rpy='0 0 1'", "quat_xyzw='0 0 0 1'",
            "link 'arm': <origin> has quat_xyzw, which is not read, expected rpy"},
           {"<link name='base'/>", "<lnk name='base'/>",
            "unknown element <lnk> in <robot>, did you mean <link>?"}}) {
    std::string text = whole;
    text.replace(text.find(slip.right), slip.right.size(), slip.wrong);
    EXPECT_EQ(folder.refusal(text), "r.urdf: " + slip.sentence);
  }
}

}  // namespace urdf_spelling_test
}  // namespace clearway
