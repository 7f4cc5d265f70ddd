#include "datasets/cameras/opencv_xml.hpp"

#include <tinyxml2.h>

#include <array>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace clearway {
namespace {

constexpr int deepest = 32;
constexpr std::string_view blanks = " \t\r\n";

[[noreturn]] void refuse(const std::string& name, int line, const std::string& what) {
  throw std::invalid_argument(name + ", line " + std::to_string(line) + ": " + what + ".");
}

/// A word of YAML between double quotes.
std::string yaml_word(std::string_view word) {
  std::string text = "\"";
  for (const char c : word) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') text += '\\';
    if (code >= 0x20 && code != 0x7f) {
      text += c;
      continue;
    }
    constexpr std::string_view digits = "0123456789abcdef";
    text += "\\x";
    text += digits[code / 16];
    text += digits[code % 16];
  }
  return text + '"';
}

/// Words apart by blanks; OpenCV puts a text with blanks in it between double quotes.
std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  for (;;) {
    text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
    if (text.empty()) return words;
    const bool is_quoted = text.front() == '"';
    const std::size_t end = is_quoted ? text.find('"', 1) : text.find_first_of(blanks);
    const std::size_t size = std::min(end, text.size());
    words.emplace_back(text.substr(is_quoted ? 1 : 0, size - (is_quoted ? 1 : 0)));
    text.remove_prefix(std::min(size + (is_quoted ? 1 : 0), text.size()));
  }
}

class Translation {
 public:
  explicit Translation(std::string name) : name_(std::move(name)) {}

  std::string of(const tinyxml2::XMLElement& storage) {
    write_children(storage, 0);
    return std::move(yaml_);
  }

 private:
  void write_children(const tinyxml2::XMLElement& parent, int depth) {
    if (depth > deepest) refuse(name_, parent.GetLineNum(), "expected at most 32 elements inside each other");
    const tinyxml2::XMLElement* child = parent.FirstChildElement();
    const bool is_list = child != nullptr && std::string_view(child->Name()) == "_";
    yaml_ += is_list ? "[" : "{";
    for (; child != nullptr; child = child->NextSiblingElement()) {
      for (; line_ < child->GetLineNum(); ++line_) yaml_ += '\n';
      const std::string_view key = child->Name();
      if ((key == "_") != is_list)
        refuse(name_, child->GetLineNum(), "expected either elements '_' alone or none");
      if (!is_list) yaml_ += yaml_word(key) + ": ";
      write(*child, depth + 1);
      yaml_ += ", ";
    }
    yaml_ += is_list ? "]" : "}";
  }

  void write(const tinyxml2::XMLElement& element, int depth) {
    if (element.FirstChildElement() != nullptr) return write_children(element, depth);
    const char* text = element.GetText();
    const std::vector<std::string> words = words_of(text == nullptr ? "" : text);
    const bool is_list = words.size() > 1 || std::string_view(element.Name()) == "data";
    if (is_list) yaml_ += '[';
    for (const std::string& word : words) yaml_ += yaml_word(word) + (is_list ? ", " : "");
    if (is_list) yaml_ += ']';
    if (!is_list && words.empty()) yaml_ += "null";
  }

  std::string name_, yaml_;
  int line_ = 1;
};

}  // namespace

bool is_xml(const std::string& text) {
  const std::string_view mark = text.starts_with("\xef\xbb\xbf") ? "\xef\xbb\xbf" : "";
  const std::size_t first = text.find_first_not_of(blanks, mark.size());
  return first != std::string::npos && text[first] == '<';
}

std::string yaml_of_opencv_xml(const std::string& text, const std::string& name) {
  tinyxml2::XMLDocument xml;
  const tinyxml2::XMLError error = xml.Parse(text.data(), text.size());
  if (error == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED)
    refuse(name, xml.ErrorLineNum(), "expected at most 32 elements inside each other");
  if (error != tinyxml2::XML_SUCCESS)
    refuse(name, xml.ErrorLineNum(), "not valid XML, expected OpenCV's `opencv_storage`");
  const tinyxml2::XMLElement* storage = xml.RootElement();
  if (storage == nullptr || std::string_view(storage->Name()) != "opencv_storage")
    refuse(name, storage == nullptr ? 1 : storage->GetLineNum(),
           "expected the XML of OpenCV, whose outermost element is `opencv_storage`");
  return Translation(name).of(*storage);
}

}  // namespace clearway
