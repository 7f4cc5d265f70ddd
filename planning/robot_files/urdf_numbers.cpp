#include "planning/robot_files/urdf_numbers.hpp"

#include <tinyxml2.h>

#include <charconv>
#include <cmath>
#include <locale>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr char blank = ' ';  // urdfdom and its kin drop what tabs and new lines separate

/// What to add where a text that xacro would have replaced stands in its place.
std::string xacro_hint(std::string_view text) {
  const bool is_xacro =
      text.find("${") != std::string_view::npos || text.find("$(") != std::string_view::npos;
  return is_xacro ? ", which is xacro's: expected the file's name to end in .xacro, or what 'xacro FILE' "
                    "makes of it"
                  : "";
}

}  // namespace

double decimal_number(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool whole = error == std::errc{} && end == word.data() + word.size();
  return whole && std::isfinite(value) ? value : std::nan("");
}

std::string text_of(const UrdfRange& range) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << range.unit << " in [" << range.least << ", " << range.most << "]";
  return text.str();
}

void UrdfPlace::refuse(const std::string& what) const {
  throw std::invalid_argument(file.string() + ": " + (where.empty() ? "" : where + ": ") + what);
}

std::vector<double> urdf_numbers(const UrdfPlace& place, const tinyxml2::XMLElement& element,
                                 const char* attribute, std::size_t count, const UrdfRange& range) {
  const char* text = element.Attribute(attribute);
  const std::string name = std::string("<") + element.Name() + ">";
  const std::string wanted = name + " needs " + attribute + " with " + std::to_string(count) +
                             " finite number" + (count > 1 ? "s" : "");
  if (!text) place.refuse(wanted);
  std::vector<double> values;
  std::string_view rest = text;
  while (true) {
    rest.remove_prefix(std::min(rest.find_first_not_of(blank), rest.size()));
    if (rest.empty()) break;
    const std::string_view word = rest.substr(0, rest.find_first_of(blank));
    rest.remove_prefix(word.size());
    const double value = decimal_number(word);
    if (std::isnan(value) || values.size() == count)
      place.refuse(wanted + ", got " + quote(text) + xacro_hint(text));
    values.push_back(value);
  }
  if (values.size() != count) place.refuse(wanted + ", got " + quote(text));
  // urdfdom leaves out an element one number of which has a blank after it; these it does not read.
  const std::string_view key = attribute;
  const bool is_ours = key == "acceleration" || key == "deceleration" || key == "jerk";
  if (count == 1 && !is_ours && std::string_view(text).ends_with(blank))
    place.refuse(wanted + " and no blank after it, got " + quote(text));
  for (double value : values) {
    if (value >= range.least && value <= range.most) continue;
    place.refuse(name + " has " + attribute + " " + quote(text) + ", expected " + text_of(range));
  }
  return values;
}

void check_urdf_origin(const UrdfPlace& place, const tinyxml2::XMLElement& parent) {
  const tinyxml2::XMLElement* origin = parent.FirstChildElement("origin");
  if (!origin) return;
  if (origin->Attribute("xyz")) urdf_numbers(place, *origin, "xyz", 3, urdf_metres);
  if (origin->Attribute("rpy")) urdf_numbers(place, *origin, "rpy", 3, urdf_radians);
}

}  // namespace clearway
