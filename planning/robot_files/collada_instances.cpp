#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/files/number_words.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/collada_check.hpp"

namespace clearway {
namespace {

using Element = tinyxml2::XMLElement;

/// What a file holds of a kind, by its ids. Among several of an id assimp takes one.
using Library = std::multimap<std::string, const Element*>;

std::vector<const Element*> children_of(const Element& parent, const char* name) {
  std::vector<const Element*> children;
  for (auto* child = parent.FirstChildElement(name); child; child = child->NextSiblingElement(name))
    children.push_back(child);
  return children;
}

void add_to(Library& library, const Element& element) {
  if (const char* id = element.Attribute("id")) library.emplace(id, &element);
}

Library library_of(const Element& root, const char* library, const char* name) {
  Library all;
  for (const Element* each : children_of(root, library))
    for (const Element* element : children_of(*each, name)) add_to(all, *element);
  return all;
}

/// assimp looks for nodes of a scene by their names, too.
void add_nodes(Library& library, const Element& parent) {
  for (const Element* node : children_of(parent, "node")) {
    add_to(library, *node);
    const char *name = node->Attribute("name"), *id = node->Attribute("id");
    if (name && !(id && std::string_view(name) == id)) library.emplace(name, node);
    add_nodes(library, *node);
  }
}

/// Whether there is a face or a line in a mesh; assimp leaves out one without.
bool has_primitives(const Element& mesh) {
  constexpr std::array<const char*, 7> kinds{"triangles", "polylist", "polygons",  "trifans",
                                             "tristrips", "lines",    "linestrips"};
  return std::any_of(kinds.begin(), kinds.end(), [&](const char* kind) {
    const auto all = children_of(mesh, kind);
    return std::any_of(all.begin(), all.end(), [](const Element* primitives) {
      for (const Element* list : children_of(*primitives, "p")) {
        std::string_view text = list->GetText() ? list->GetText() : "";
        if (!next_word(text).empty()) return true;
      }
      return !children_of(*primitives, "ph").empty();
    });
  });
}

void check_body(const Element& geometry) {
  const auto meshes = children_of(geometry, "mesh");
  const std::string placed = "its <geometry> " + quote(geometry.Attribute("id")) + " is placed, expected ";
  for (const char* other : {"convex_mesh", "spline", "brep"})
    if (meshes.size() != 1 || geometry.FirstChildElement(other))
      throw std::runtime_error(placed + "one <mesh> in it and nothing else");
  if (!has_primitives(*meshes.front()))
    throw std::runtime_error(placed + "triangles, polygons or lines in its <mesh>");
}

/// assimp does not move the body by it.
void check_bind_shape(const Element& skin) {
  const Element* matrix = skin.FirstChildElement("bind_shape_matrix");
  if (!matrix) return;
  std::string_view text = matrix->GetText() ? matrix->GetText() : "";
  std::size_t at = 0;
  bool is_identity = true;
  for (std::string_view word = next_word(text); !word.empty(); word = next_word(text), ++at)
    is_identity &= std::abs(parsed_number(word).value_or(HUGE_VAL) - (at % 5 == 0 ? 1.0 : 0.0)) <= 1e-6;
  if (!is_identity || at != 16)
    throw std::runtime_error("its <bind_shape_matrix> moves the body, expected the identity");
}

/// Follows what a file places, from node to body.
class Placements {
 public:
  explicit Placements(const Element& root)
      : bodies_(library_of(root, "library_geometries", "geometry")),
        nodes_(library_of(root, "library_nodes", "node")),
        scenes_(library_of(root, "library_visual_scenes", "visual_scene")) {
    bodies_.merge(library_of(root, "library_controllers", "controller"));
    for (const auto& [id, scene] : scenes_) add_nodes(nodes_of_scenes_, *scene);
    for (const auto& [id, node] : nodes_) check_placed_by(*node);
    for (const auto& [id, scene] : scenes_) check_placed_by(*scene);
    for (const Element* scene : children_of(root, "scene"))
      for (const Element* instance : children_of(*scene, "instance_visual_scene"))
        named_by(*instance, "url", "visual_scene", scenes_);
  }

 private:
  void check_placed_by(const Element& node) const {
    for (const Element* instance : children_of(node, "instance_geometry"))
      check_body(named_by(*instance, "url", "geometry", bodies_));
    for (const Element* instance : children_of(node, "instance_controller"))
      check_controller(named_by(*instance, "url", "controller", bodies_));
    for (const Element* instance : children_of(node, "instance_node")) {
      const char* url = instance->Attribute("url");
      const bool is_in_library = url && *url == '#' && nodes_.contains(url + 1);
      named_by(*instance, "url", "node", is_in_library ? nodes_ : nodes_of_scenes_);
    }
    for (const Element* child : children_of(node, "node")) check_placed_by(*child);
  }

  void check_controller(const Element& controller) const {
    const auto skins = children_of(controller, "skin");
    if (skins.size() != 1 || controller.FirstChildElement("morph"))
      throw std::runtime_error("its <controller> " + quote(controller.Attribute("id")) +
                               " is placed, expected one <skin> in it and nothing else");
    check_bind_shape(*skins.front());
    check_body(named_by(*skins.front(), "source", "geometry", bodies_));
  }

  static const Element& named_by(const Element& element, const char* attribute, const std::string& kind,
                                 const Library& library) {
    const char* url = element.Attribute(attribute);
    const std::string id = url && *url == '#' ? url + 1 : "";
    const auto [first, end] = library.equal_range(id);
    if (!id.empty() && std::distance(first, end) == 1 && first->second->Name() == kind) return *first->second;
    throw std::runtime_error("its <" + std::string(element.Name()) + "> has " + attribute + " " +
                             quote(url ? url : "") + ", expected '#' and the id of one <" + kind +
                             "> in this file");
  }

  Library bodies_, nodes_, nodes_of_scenes_, scenes_;
};

}  // namespace

void check_collada_instances(const tinyxml2::XMLElement& root) { Placements{root}; }

}  // namespace clearway
