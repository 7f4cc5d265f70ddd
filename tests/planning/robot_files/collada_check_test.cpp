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

/// A second body "g2" behind the first: the node and the library's parts that place it.
std::string second_body(const std::string& placed_by, const std::string& libraries) {
  std::string text = as_dae(ellipsoid(3, 4, {0.1F, 0.2F, 0.3F}));
  const std::string node = "<instance_geometry url='#g'/>", scenes = "<library_visual_scenes>";
  text.replace(text.find(node), node.size(), node + "</node><node id='n2'>" + placed_by);
  text.insert(text.find(scenes), libraries);
  try {
    checked_collada(text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

std::string geometry(const std::string& content) {
  return "<library_geometries><geometry id='g2'>" + content + "</geometry></library_geometries>";
}

const std::string body = "<mesh><triangles count='1'><p>0 1 2</p></triangles></mesh>";

TEST(ColladaCheck, BodiesThatArePlacedAreMeshesOfFacesOrLines) {
  const std::string place = "<instance_geometry url='#g2'/>",
                    told = "its <geometry> 'g2' is placed, expected ";
  EXPECT_EQ(second_body(place, geometry(body)), "");
  for (const char* kind : {"polylist", "polygons", "trifans", "tristrips", "lines", "linestrips"}) {
    const std::string name(kind);
    const auto with = [&](const std::string& list) {
      return geometry("<mesh><" + name + " count='1'>" + list + "</" + name + "></mesh>");
    };
    EXPECT_EQ(second_body(place, with("<p>0 1 2</p>")), "") << kind;
    EXPECT_NE(second_body(place, with("<p> </p>")), "") << kind;
  }
  for (const char* other : {"<mesh/>", "<mesh><vertices/></mesh>", "<mesh><triangles count='0'/></mesh>"})
    EXPECT_EQ(second_body(place, geometry(other)), told + "triangles, polygons or lines in its <mesh>");
  for (const std::string& other : {std::string("<convex_mesh/>"), std::string("<spline/>"),
                                   std::string("<brep/>"), std::string(), body + "<brep/>", body + body}) {
    EXPECT_EQ(second_body(place, geometry(other)), told + "one <mesh> in it and nothing else") << other;
    EXPECT_EQ(second_body("", geometry(other)), "") << "placed by nothing: " << other;
  }
}

TEST(ColladaCheck, WhatNodesPlaceIsInTheFileOnce) {
  const auto refused = [](const std::string& element, const std::string& attribute, const std::string& url,
                          const std::string& kind) {
    return "its <" + element + "> has " + attribute + " '" + url + "', expected '#' and the id of one <" +
           kind + "> in this file";
  };
  const auto skin = [](const std::string& content, const std::string& source = "#g2") {
    return "<library_controllers><controller id='c'><skin source='" + source + "'>" + content +
           "</skin></controller></library_controllers>";
  };
  const auto matrix = [](const std::string& numbers) {
    return "<bind_shape_matrix>" + numbers + "</bind_shape_matrix>";
  };
  const std::string place = "<instance_controller url='#c'/>", identity = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 ";
  EXPECT_EQ(second_body("<instance_geometry url='#g2'/>", geometry(body) + geometry(body)),
            refused("instance_geometry", "url", "#g2", "geometry"));
  EXPECT_EQ(second_body("", geometry(body) + geometry(body)), "") << "nothing places them";
  EXPECT_EQ(second_body("<instance_controller url='#none'/>", ""),
            refused("instance_controller", "url", "#none", "controller"));
  EXPECT_EQ(second_body(place, geometry(body) + skin("")), "");
  EXPECT_EQ(second_body(place, geometry(body) + skin("") + skin("")),
            refused("instance_controller", "url", "#c", "controller"));
  EXPECT_EQ(second_body(place, geometry(body) + skin("", "#none")),
            refused("skin", "source", "#none", "geometry"));
  EXPECT_NE(second_body(place, geometry("<spline/>") + skin("")), "");
  EXPECT_EQ(second_body(place, geometry(body) + skin(matrix(identity + "1"))), "");
  for (const std::string& other : {identity + "2", identity, identity + "1 0", std::string("2 ") + identity})
    EXPECT_EQ(second_body(place, geometry(body) + skin(matrix(other))),
              "its <bind_shape_matrix> moves the body, expected the identity");
  EXPECT_EQ(second_body(place,
                        "<library_controllers><controller id='c'><morph source='#g'/></controller>"
                        "</library_controllers>"),
            "its <controller> 'c' is placed, expected one <skin> in it and nothing else");
  EXPECT_EQ(second_body("<instance_node url='#m'/>", "<library_nodes><node id='m'/></library_nodes>"), "");
  EXPECT_EQ(second_body("<instance_node url='#m'/>",
                        "<library_nodes><node id='k'><node id='m'/></node></library_nodes>"),
            refused("instance_node", "url", "#m", "node"))
      << "assimp looks for those at the top";
  EXPECT_EQ(
      second_body("<instance_node url='#m'/>", "<library_nodes><node id='m'/><node id='m'/></library_nodes>"),
      refused("instance_node", "url", "#m", "node"));
  EXPECT_EQ(refusal("<visual_scene id='s'>", "<visual_scene id='s'/><visual_scene id='s'>"),
            refused("instance_visual_scene", "url", "#s", "visual_scene"));
}

TEST(ColladaCheck, NoTurnNeedsNoAxis) {
  EXPECT_EQ(refusal("<matrix>", "<rotate>0 0 0 0</rotate><matrix>"), "");
  EXPECT_EQ(refusal("<matrix>", "<rotate>0 0 0 30</rotate><matrix>"),
            "its <rotate> has an axis without length");
}

TEST(ColladaCheck, TextThatIsNoXmlIsRefused) {
  EXPECT_EQ(refusal("</COLLADA>", "").find("it cannot be read as .dae: line "), 0U);
}

}  // namespace collada_check_test
}  // namespace clearway
