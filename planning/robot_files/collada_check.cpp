#include "planning/robot_files/collada_check.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/files/number_words.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

using XmlNode = tinyxml2::XMLElement;

[[noreturn]] void refuse_attribute(const XmlNode& element, const char* attribute,
                                   const std::string& expected) {
  const char* value = element.Attribute(attribute);
  throw std::runtime_error("its <" + std::string(element.Name()) + "> has " + attribute + " " +
                           quote(value ? value : "") + ", expected " + expected);
}

/// The number that a whole text is.
template <class Number>
std::optional<Number> whole_number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::uint64_t count_in(const XmlNode& element, const char* attribute, std::uint64_t otherwise) {
  const char* text = element.Attribute(attribute);
  if (!text) return otherwise;
  const auto count = whole_number<std::uint32_t>(text);
  if (!count) refuse_attribute(element, attribute, "a whole number");
  return *count;
}

void check_unit(const XmlNode& root) {
  constexpr double least = 1e-6, most = 1e3;
  for (auto* asset = root.FirstChildElement("asset"); asset; asset = asset->NextSiblingElement("asset")) {
    const XmlNode* unit = asset->FirstChildElement("unit");
    if (!unit || !unit->Attribute("meter")) continue;
    const auto metres = whole_number<double>(unit->Attribute("meter"));
    if (!metres || !(*metres >= least && *metres <= most))
      refuse_attribute(*unit, "meter", "metres in [0.000001, 1000]");
  }
}

/// How many numbers an element holds. assimp would take "2m" for 2.
std::uint64_t count_numbers(const XmlNode& element) {
  std::string_view text = element.GetText() ? element.GetText() : "";
  std::uint64_t count = 0;
  for (std::string_view word = next_word(text); !word.empty(); word = next_word(text), ++count) {
    if (!parsed_number(word))
      throw std::runtime_error("its <" + std::string(element.Name()) + "> has " + quote(word) +
                               ", expected numbers");
  }
  return count;
}

/// An axis of length 1 in a rotation. Whether the text was another.
bool make_unit(XmlNode& rotate) {
  std::string_view text = rotate.GetText() ? rotate.GetText() : "";
  std::vector<double> numbers;
  for (std::string_view word = next_word(text); !word.empty(); word = next_word(text))
    numbers.push_back(parsed_number(word).value_or(0.0));
  if (numbers.size() != 4) throw std::runtime_error("its <rotate> has not four numbers");
  const double length = std::hypot(numbers[0], numbers[1], numbers[2]);
  if (!(length > 1e-9) && numbers[3] == 0.0) {  // no turn, about whatever axis
    rotate.SetText("0 0 1 0");
    return true;
  }
  if (!(length > 1e-9)) throw std::runtime_error("its <rotate> has an axis without length");
  if (std::abs(length - 1.0) < 1e-12) return false;
  std::string unit;
  for (int axis = 0; axis < 3; ++axis)
    unit += to_text(numbers[static_cast<std::size_t>(axis)] / length) + " ";
  rotate.SetText((unit + to_text(numbers[3])).c_str());
  return true;
}

/// Of an element that holds text, which assimp reads up to the first of them. Whether there were any.
bool drop_comments(XmlNode& element) {
  std::string text;
  bool has_comment = false;
  for (auto *node = element.FirstChild(), *next = node; node; node = next) {
    next = node->NextSibling();
    if (XmlNode* child = node->ToElement()) has_comment |= drop_comments(*child);
    if (node->ToText()) text.append(node->Value()).append(" ");
    if (!node->ToComment()) continue;
    has_comment = true;
    element.DeleteChild(node);
  }
  if (!has_comment || text.empty() || element.FirstChildElement()) return has_comment;
  element.DeleteChildren();
  element.SetText(text.c_str());
  return true;
}

bool make_axes_unit(XmlNode& parent) {
  bool is_other = false;
  for (auto* child = parent.FirstChildElement(); child; child = child->NextSiblingElement())
    is_other |= std::string_view(child->Name()) == "rotate" ? make_unit(*child) : make_axes_unit(*child);
  return is_other;
}

/// Poses and scales of all nodes.
void check_transforms(const XmlNode& parent) {
  for (auto* child = parent.FirstChildElement(); child; child = child->NextSiblingElement()) {
    const std::string_view name = child->Name();
    if (name == "skew") throw std::runtime_error("it has a <skew>, expected poses and scales alone");
    if (name == "matrix" || name == "translate" || name == "rotate" || name == "scale" || name == "lookat")
      count_numbers(*child);
    else
      check_transforms(*child);
  }
}

/// How many numbers make a vertex. X, Y and Z are among them: assimp takes the first for one that is not.
std::uint64_t numbers_of_vertex(const XmlNode& accessor) {
  std::string axes;
  std::uint64_t count = 0;
  for (auto* param = accessor.FirstChildElement("param"); param; param = param->NextSiblingElement("param")) {
    ++count;
    if (const char* name = param->Attribute("name")) axes += name;
  }
  if (axes != "XYZ") throw std::runtime_error("its <accessor> of positions has not the params X, Y and Z");
  return count;
}

/// A source of positions: an array of numbers, and an accessor that cuts it up.
void check_positions(const XmlNode& source) {
  const XmlNode* array = source.FirstChildElement("float_array");
  const XmlNode* technique = source.FirstChildElement("technique_common");
  const XmlNode* accessor = technique ? technique->FirstChildElement("accessor") : nullptr;
  if (!array || !accessor) throw std::runtime_error("its positions have no <float_array> or no <accessor>");
  const std::uint64_t numbers = count_numbers(*array);
  if (count_in(*array, "count", 0) != numbers)
    refuse_attribute(*array, "count", "the count of its numbers, " + std::to_string(numbers));
  const std::uint64_t stride = count_in(*accessor, "stride", 1), count = count_in(*accessor, "count", 0);
  const std::uint64_t each = numbers_of_vertex(*accessor);
  if (stride < each) refuse_attribute(*accessor, "stride", std::to_string(each) + " or more");
  if (count > 0 && count_in(*accessor, "offset", 0) + (count - 1) * stride + each > numbers)
    refuse_attribute(*accessor, "count", "as many vertices as the <float_array> holds");
}

/// The child of that name with that id.
const XmlNode* with_id(const XmlNode& parent, const char* name, const char* reference) {
  for (auto* child = parent.FirstChildElement(name); child; child = child->NextSiblingElement(name)) {
    const char* id = child->Attribute("id");
    if (id && reference && std::string("#") + id == reference) return child;
  }
  return nullptr;
}

void check_mesh(const XmlNode& mesh) {
  const XmlNode* vertices = mesh.FirstChildElement("vertices");
  if (!vertices) return;
  for (auto* input = vertices->FirstChildElement("input"); input;
       input = input->NextSiblingElement("input")) {
    const char* semantic = input->Attribute("semantic");
    if (!semantic || std::string_view(semantic) != "POSITION") continue;
    if (const XmlNode* source = with_id(mesh, "source", input->Attribute("source"))) check_positions(*source);
  }
}

}  // namespace

std::string checked_collada(const std::string& content) {
  tinyxml2::XMLDocument xml;
  xml.Parse(content.data(), content.size());
  XmlNode* root = xml.Error() ? nullptr : xml.RootElement();
  if (!root)
    throw std::runtime_error("it cannot be read as .dae: line " +
                             std::to_string(std::max(xml.ErrorLineNum(), 1)) + " is not XML");
  bool is_other = drop_comments(*root);
  check_unit(*root);
  for (auto* library = root->FirstChildElement("library_geometries"); library;
       library = library->NextSiblingElement("library_geometries"))
    for (auto* geometry = library->FirstChildElement("geometry"); geometry;
         geometry = geometry->NextSiblingElement("geometry"))
      if (const XmlNode* mesh = geometry->FirstChildElement("mesh")) check_mesh(*mesh);
  for (const char* nodes : {"library_nodes", "library_visual_scenes"})
    for (auto* library = root->FirstChildElement(nodes); library;
         library = library->NextSiblingElement(nodes))
      check_transforms(*library);
  check_collada_instances(*root);
  is_other |= make_axes_unit(*root);
  if (!is_other) return content;
  tinyxml2::XMLPrinter printer;
  xml.Print(&printer);
  return printer.CStr();
}

}  // namespace clearway
